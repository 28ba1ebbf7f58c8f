//! Laboratory commands: tables, JSON, drawings, invalid grids.

use std::fs;

use serde_json::Value;

use crate::support::home::Home;

/// Returns the JSON output of a command.
fn json(home: &Home, arguments: &[&str]) -> Value {
    let program_output = home.run(&[arguments, &["--json"]].concat());
    assert_eq!(program_output.exit_code, 0, "{arguments:?}: {}", program_output.stderr);
    serde_json::from_str(&program_output.stdout).expect("JSON")
}

#[test]
fn lab_commands_without_runs_support_all_formats() {
    let home = Home::new();
    for (command, table) in [
        (vec!["lab", "bound", "--slack", "4"], "account"),
        (vec!["lab", "laws", "--draws", "200"], "laws"),
        (vec!["lab", "laws", "c_max", "--of", "E2", "--draws", "2000"], "moments"),
        (vec!["lab", "curves"], "curves"),
        (vec!["lab", "curves", "D_S03"], "curve"),
    ] {
        let rows = json(&home, &command)["tables"][table]["rows"].as_array().map_or(0, Vec::len);
        let csv = home.run(&[&command[..], &["--csv"]].concat());
        assert_eq!((csv.stdout.lines().count(), csv.exit_code), (rows + 1, 0), "{command:?}");
        let text = home.run(&[&command[..], &["--width", "80"]].concat()).stdout;
        assert!(text.lines().all(|line| line.chars().count() <= 80), "{command:?}\n{text}");
    }
    let drawing = home.0.path().join("curves.svg");
    let path = drawing.to_string_lossy();
    assert_eq!(home.run(&["lab", "curves", "--svg", &path]).exit_code, 0);
    assert!(fs::read_to_string(&drawing).expect("a drawing").starts_with("<svg"));
    // Changed parameters change the computed bound.
    let bound_value = |row: usize, arguments: &[&str]| {
        let all = json(&home, &[&["lab", "bound"], arguments].concat());
        all["tables"]["account"]["rows"][row]["own"].as_f64().expect("a number")
    };
    let (development, estimate) = (6, 15);
    let off = ["--scenario", "competitor-off"];
    assert!(
        bound_value(development, &off) < bound_value(development, &[]),
        "without competitors development is cheap"
    );
    let output = json(&home, &["lab", "bound", "--scenario", "competitor-off"]).to_string();
    assert!(
        output.contains("no competitors: the current parameters have none")
            && !output.contains("seeds of the simulator"),
        "{output}"
    );
    // With slack 1, the estimate is higher without competitors.
    let once = ["--slack", "1"];
    assert!(bound_value(estimate, &[once, off].concat()) > bound_value(estimate, &once));
}

#[test]
fn unknown_names_list_the_valid_ones() {
    let home = Home::new();
    for (arguments, code, part) in [
        (vec!["lab", "laws", "cmax"], 2, "did you mean c_max?"),
        (vec!["lab", "laws", "c_max", "--of", "S9"], 2, "S1, S2"),
        (vec!["lab", "laws", "lead_noise", "--of", "S1"], 2, "leave out --of"),
        (vec!["lab", "curves", "S9"], 2, "S1, S2"),
        (vec!["lab", "bound", "--slack", "2.5"], 2, "1, 2, 3 or 4"),
        (vec!["lab", "bound", "--scenario", "short"], 2, "runs of 500 days"),
        (vec!["lab", "bound", "--set", "run.total_days=200"], 2, "these parameters have 200 days"),
        (vec!["lab", "baseline", "--grid", "none"], 2, "content-ads, paper"),
        (vec!["lab", "ablate", "--day", "141"], 2, "last day of a week"),
        (vec!["lab", "ablate", "--policy", "none"], 2, "P1a"),
        (vec!["run", "--policy", "none"], 2, "P1a"),
        (vec!["run", "--scenario", "none", "--policy", "P0"], 2, "default"),
    ] {
        let program_output = home.run(&arguments);
        assert!(
            program_output.exit_code == code && program_output.stderr.contains(part),
            "{arguments:?}: {} {}",
            program_output.exit_code,
            program_output.stderr
        );
    }
}

#[test]
fn user_grid_is_cached_and_errors_name_line_and_key() {
    let home = Home::new();
    let path = home.0.path().join("grid.toml");
    let file = path.to_string_lossy();
    let grid = "name = \"floors\"\n\n[[axis]]\nname = \"floor\"\n\n[[axis.level]]\nname = \"none\"\n\
                set = { rule_based = { cash_floor = -1 } }\n\n[[axis.level]]\nname = \"high\"\n\
                set = { rule_based = { cash_floor = 990_000 } }\n";
    fs::write(&path, grid).expect("a file");
    let arguments = ["lab", "baseline", "--grid", &file, "--seeds", "1..2", "--days", "28"];
    let first = json(&home, &arguments);
    let cash =
        |at: usize| first["tables"]["configurations"]["rows"][at]["median_cash"].as_f64().expect("cash");
    assert!(cash(0) > cash(1), "a high floor stops spending early");
    assert_eq!(first["tables"]["configurations"]["rows"][0]["floor"], "high");
    let store = home.runs().join(".lab/baseline.jsonl");
    let kept = fs::read_to_string(&store).expect("results");
    assert_eq!(json(&home, &arguments), first);
    assert_eq!(fs::read_to_string(&store).expect("results"), kept, "stored runs are not repeated");
    fs::write(&path, grid.replace("990_000", "990_000, cashfloor = 1")).expect("a file");
    let program_output = home.run(&arguments);
    assert!(
        program_output.exit_code == 3
            && program_output.stderr.contains("line 12")
            && program_output.stderr.contains("`cashfloor`"),
        "{}",
        program_output.stderr
    );
}

#[test]
fn opponents_play_the_seed_and_scenario_of_a_finished_run() {
    let home = Home::new();
    let program_output =
        home.run(&["run", "--policy", "P1a", "--seed", "9", "--days", "28", "--surges", "on", "--save"]);
    assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    let output = home.run(&["lab", "opponents", "latest", "--json"]);
    assert_eq!(output.exit_code, 0, "{}", output.stderr);
    let opponents: serde_json::Value = serde_json::from_str(&output.stdout).expect("JSON");
    let policies = opponents["policies"].as_array().expect("policies");
    assert_eq!((opponents["day"].as_u64(), policies.len()), (Some(28), 5));
    for value in policies {
        let name = value["policy"].as_str().expect("a name");
        let alone =
            home.run(&["run", "--policy", name, "--seed", "9", "--days", "28", "--surges", "on", "--json"]);
        let alone: serde_json::Value =
            serde_json::from_str(alone.stdout.lines().next().expect("a line")).expect("JSON");
        assert_eq!((&value["cash"], &value["day"]), (&alone["cash"], &alone["day"]), "{name}");
    }
    let text = home.run(&["lab", "opponents", "latest"]).stdout;
    assert!(text.contains("same seed") && text.contains("harvest-late"), "{text}");
    let other = Home::new();
    other.play_two_weeks();
    other.run(&["lab", "opponents", "latest"]).assert_fails(1, &["End this run first"]);
}
