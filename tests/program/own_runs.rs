//! The laboratory's tables of the user's runs: results with published figures, behavior, and consistency with common
//! random draws.

use std::collections::BTreeMap;
use std::fs;

use crate::support::home::{Home, ProgramOutput, run_id};

/// Parses CSV output into one map per row, keyed by column name.
fn csv_rows(program_output: &ProgramOutput) -> Vec<BTreeMap<String, String>> {
    assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    let mut reader = csv::Reader::from_reader(program_output.stdout.as_bytes());
    reader.deserialize().map(|row| row.expect("a row")).collect()
}

fn row_named<'a>(rows: &'a [BTreeMap<String, String>], name: &str) -> &'a BTreeMap<String, String> {
    rows.iter().find(|row| row["name"] == name).unwrap_or_else(|| panic!("no {name} in {rows:?}"))
}

#[test]
fn results_table_lists_comparable_runs_and_explains_omissions() {
    let home = Home::new();
    let saved = home.run(&["run", "--policy", "P0", "--seed", "7", "--surges", "on", "--save"]);
    assert_eq!(saved.exit_code, 0, "{}", saved.stderr);
    // Runs with a changed parameter and with a different length are not comparable.
    for options in [&["--surges", "off", "--days", "500"][..], &["--surges", "on", "--days", "28"]] {
        let program_output = home.run(&[&["run", "--policy", "P0", "--save"], options].concat());
        assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    }
    let table = csv_rows(&home.run(&["lab", "table", "--csv"]));
    let policy_row = row_named(&table, "P0");
    assert_eq!(
        [&policy_row["bankrupt"], &policy_row["runs"], &policy_row["source"]],
        ["0", "1", "own policy"]
    );
    let idle = row_named(&table, "idle company");
    for column in ["best_cash", "beats", "max_survival_days", "calls_per_week"] {
        assert_eq!(policy_row[column], idle[column], "{column}: an idle company does not depend on the seed");
    }
    assert_eq!(idle["beats"], "13");
    assert_eq!(row_named(&table, "GPT-5.6 Sol")["std_survival_days"], "145.7");
    let (ranked, others): (Vec<_>, Vec<_>) = table.iter().partition(|row| row["generation"] == "release 1");
    assert_eq!((ranked.len(), others.len()), (1 + 1 + 16 + 1, 3));
    assert!(others.iter().all(|row| row["generation"] == "not stated" && row["beats"].is_empty()));
    assert_eq!(
        (&*policy_row["horizon_days"], &*row_named(&table, "Claude Fable 5")["horizon_days"]),
        ("500", "504")
    );
    let cash: Vec<f64> = ranked.iter().map(|row| row["best_cash"].parse().expect("a number")).collect();
    assert!(cash.is_sorted_by(|one, other| one >= other), "{cash:?}");

    let text = home.run(&["lab", "table", "--by", "policy"]).stdout;
    assert!(
        text.contains("2 finished runs are not ranked: different length (1), changed parameters (1)."),
        "{text}"
    );
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    let drawing = home.0.path().join("table.svg");
    let output = home.run(&["lab", "table", "--svg", &drawing.to_string_lossy()]);
    assert_eq!(output.exit_code, 0, "{}", output.stderr);
    assert!(fs::read_to_string(drawing).expect("a drawing").starts_with("<svg"));
}

#[test]
fn runs_of_release_2_have_a_separate_ranking() {
    let home = Home::new();
    let options = ["run", "--policy", "P0", "--seed", "7", "--surges", "on", "--save"];
    for scenario in [&[][..], &["--scenario", "release-2"]] {
        let program_output = home.run(&[&options[..], scenario].concat());
        assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    }
    let list = home.run(&["runs", "list"]).stdout;
    assert!(list.contains("release-2 (release 2)"), "{list}");
    let table = csv_rows(&home.run(&["lab", "table", "--csv"]));
    let of = |generation: &str| {
        let rows = table.iter().filter(|row| row["generation"] == generation && row["name"] == "P0");
        rows.map(|row| row["beats"].clone()).collect::<Vec<_>>()
    };
    assert_eq!((of("release 1"), of("release 2")), (vec!["13".to_owned()], vec![String::new()]));
    let folders = fs::read_dir(home.runs()).expect("a folder").flatten().map(|entry| entry.path());
    let runs: Vec<String> = folders.filter(|path| path.is_dir()).map(|path| run_id(&path)).collect();
    let text = home.run(&["lab", "compare", &runs[0], &runs[1], "--width", "400"]).stdout;
    assert!(text.contains("they are shown side by side and are not ranked."), "{text}");
    let row = |name: &str| text.lines().find(|line| line.starts_with(name)).unwrap_or_default().to_owned();
    assert!(row("generation").contains("release 2") && row("scenario").contains("release-2"), "{text}");
    assert!(text.contains("Kimi K3"), "{text}");
    let second = runs.iter().find(|run| home.run(&["report", run]).stdout.contains("scenario release-2"));
    let report = home.run(&["report", second.expect("the run of release 2")]).stdout;
    assert!(
        report.contains("no results of release 2 in the published tables") && !report.contains("Fable"),
        "{report}"
    );
}

const PLAY: &str = "set_prices A=12 B=25 C=55
set_targeted_ad_spend {\"content_marketing\": {\"S1\": 750}, \"linkedin\": {\"S1\": 100}}
memo Costs are fine. If rivals move, cut ads.
next \"If it goes well, we wait\" naive
next \"as planned\" naive
";

#[test]
fn behaviour_command_accepts_one_or_many_runs() {
    let home = Home::new();
    for seed in ["3", "4"] {
        assert_eq!(home.play(&["--seed", seed, "--days", "14", "--participant", "P01"], PLAY).exit_code, 0);
    }
    let list = home.run(&["runs", "list"]).stdout;
    let runs: Vec<&str> = list.lines().filter_map(|line| line.split_whitespace().next()).collect();
    let table =
        |name: &str| csv_rows(&home.run(&["lab", "behaviour", runs[0], runs[1], "--csv", "--table", name]));
    let measures = table("measures");
    let share = |row: &BTreeMap<String, String>| {
        row["ad_spend_on_the_truly_best_channel"].parse::<f64>().expect("a share")
    };
    let shares: Vec<f64> = measures.iter().map(share).collect();
    assert_eq!(shares.len(), 2, "rows of runs alone: {measures:?}");
    assert!((shares[0] - 750.0 / 850.0).abs() < 1e-9 && shares[0] == shares[1], "{measures:?}");
    let text = home.run(&["lab", "behaviour", runs[0], runs[1], "--json"]).stdout;
    let value: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let summary = &value["tables"]["measures"]["summary"];
    assert_eq!(summary[0]["ad_spend_on_the_truly_best_channel"].as_f64(), Some(shares[0]));
    assert_eq!(summary[1]["ad_spend_on_the_truly_best_channel"].as_f64(), Some(0.0));
    assert_eq!(measures[0]["if_in_notes"], "1");
    assert_eq!(table("tools")[0]["tool"], "set_prices");
    let cash = table("cash");
    assert_eq!((cash.len(), cash[0]["day"].as_str(), cash[0]["cash"].as_str()), (2 * 15, "0", "1000000"));
    let notes = table("notes");
    assert_eq!((notes.len(), notes[0]["plans"].as_str()), (2, "If rivals move, cut ads."));
    assert!(table("customers").iter().any(|row| row["group"] == "S1"));
    home.run(&["lab", "behaviour", runs[0], "--csv", "--table", "nothing"])
        .assert_fails(2, &["measures", "notes"]);
    let drawing = home.0.path().join("behaviour.svg");
    let program_output =
        home.run(&["lab", "behaviour", runs[0], runs[1], "--svg", &drawing.to_string_lossy()]);
    assert!(program_output.stdout.contains("correlation"), "{}", program_output.stdout);
    let drawn = fs::read_to_string(drawing).expect("a drawing");
    assert!(drawn.contains("Cash by day, P01") && drawn.contains(&format!("run {}", runs[1])), "{drawn}");
}

#[test]
fn consistency_command_accepts_user_policies() {
    let home = Home::new();
    let program_output =
        home.run(&["lab", "consistency", "--policy", "P0", "--policy", "P1b", "--until", "98", "--csv"]);
    let claims = csv_rows(&program_output);
    let verdict = |part: &str| {
        let claim = claims.iter().find(|row| row["claim"].contains(part)).expect(part);
        (claim["verdict"].clone(), claim["different"].clone())
    };
    assert_eq!(verdict("index of the economy"), ("holds".to_owned(), "0".to_owned()));
    assert_eq!(verdict("same company"), ("holds".to_owned(), "0".to_owned()));
    assert_eq!(verdict("R&D tier").0, "not tried", "neither policy starts a project");
    home.run(&["lab", "consistency", "--policy", "P0"])
        .assert_fails(2, &["give --policy twice or not at all"]);
}

#[test]
fn comparison_of_many_runs_fits_the_line_width() {
    let home = Home::new();
    for seed in 1..=3 {
        home.run(&["run", "--policy", "P1b", "--seed", &seed.to_string(), "--days", "14", "--save"]);
    }
    let folders = fs::read_dir(home.runs()).expect("a folder").flatten().map(|entry| entry.path());
    let runs: Vec<String> = folders.filter(|path| path.is_dir()).map(|path| run_id(&path)).collect();
    let compare: Vec<&str> =
        [&["lab", "compare", "--width", "80"], &*runs.iter().map(String::as_str).collect::<Vec<_>>()]
            .concat();
    let program_output = home.run(&compare);
    assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    assert!(
        program_output.stdout.lines().all(|line| line.chars().count() <= 80),
        "{}",
        program_output.stdout
    );
    assert!(program_output.stdout.starts_with("3 runs, best result first"), "{}", program_output.stdout);
    for run in &runs {
        assert!(program_output.stdout.contains(run), "{}", program_output.stdout);
    }
}

/// Returns the commands in a section of the page with their documented output: the first two cells of the table rows
/// after each command.
fn documented_outputs(section: &str) -> BTreeMap<&'static str, Vec<&'static str>> {
    let page = include_str!("../../docs/experiments.md");
    let (_, from) = page.split_once(&format!("\n## {section}\n")).expect(section);
    let cells = |line: &'static str| -> Option<(&'static str, &'static str)> {
        let mut parts = line.strip_prefix("| `novamind ")?.split('`');
        Some((parts.next()?, parts.nth(1)?))
    };
    let mut claims: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (command, says) in from.lines().take_while(|line| !line.starts_with("## ")).filter_map(cells) {
        claims.entry(command).or_default().push(says);
    }
    assert!(claims.len() > 1, "{section}: {claims:?}");
    claims
}

fn check_documented_outputs(section: &str) {
    let home = Home::new();
    for (command, claims) in documented_outputs(section) {
        let program_output = home.run(&command.split(' ').collect::<Vec<_>>());
        assert_eq!(program_output.exit_code, 0, "{command}: {}", program_output.stderr);
        for says in claims {
            assert!(
                program_output.stdout.contains(says),
                "{command} does not print {says}: {}",
                program_output.stdout
            );
        }
    }
}

#[test]
fn documented_experiment_figures_match_their_commands() {
    check_documented_outputs("Figures that are checked");
}

#[test]
#[ignore = "slow: .ci/full runs it"]
fn documented_figures_of_slow_commands_match() {
    check_documented_outputs("Figures that take minutes");
}
