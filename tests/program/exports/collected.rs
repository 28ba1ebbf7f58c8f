//! Collection of a study from three machines: later states of runs, archives, conflicts, labels and missing sessions.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::{export_run, played_run, read_table, run_id, text};
use crate::support::home::{Home, ProgramOutput, read_bytes};

fn collect(lab: &Home, sources: &[&Path], more: &[&str]) -> (ProgramOutput, std::path::PathBuf) {
    let out = lab.0.path().join("all");
    let sources: Vec<String> = sources.iter().map(|source| text(source)).collect();
    let (mut arguments, place) = (vec!["study", "collect"], text(&out));
    arguments.extend(sources.iter().map(String::as_str));
    arguments.extend(["--out", &place]);
    arguments.extend(more);
    (lab.run(&arguments), out)
}

/// Copies the folder of a run.
fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder");
    for name in ["run.toml", "trajectory.jsonl"] {
        fs::write(to.join(name), read_bytes(from, name)).expect("a copy");
    }
}

#[test]
fn collect_takes_each_run_in_its_latest_state() {
    let (one, two, lab) = (Home::new(), Home::new(), Home::new());
    let (first, second) = (played_run(&one, "P01"), played_run(&two, "P02"));
    // The run is exported as an archive and then continued.
    let (archive, _) = export_run(&one, &first, "early.tar.gz");
    assert_eq!(one.play(&["--run", &run_id(&first)], "next \"the end\" naive\n").exit_code, 0);
    let sources = [one.runs(), archive, two.runs()];
    let sources: Vec<&Path> = sources.iter().map(std::path::PathBuf::as_path).collect();
    let (program_output, out) = collect(&lab, &sources, &[]);
    assert_eq!(program_output.exit_code, 0, "{}{}", program_output.stdout, program_output.stderr);
    assert!(
        program_output.stdout.contains("early.tar.gz is an earlier state or a copy of"),
        "{}",
        program_output.stdout
    );
    let runs = read_table(&out.join("runs.csv"));
    let days: Vec<(&str, &str)> = runs.iter().map(|row| (&*row["run"], &*row["day"])).collect();
    assert_eq!(days, [(&*run_id(&first), "28"), (&*run_id(&second), "21")]);
    assert_eq!(fs::read_to_string(out.join("collect.log")).expect("a log").lines().count(), 1);
    assert!(out.join(format!("{}.tar.gz", run_id(&second))).exists() && out.join("events.csv").exists());
    let hidden = fs::read_dir(&out).expect("a folder").flatten();
    assert!(!hidden.into_iter().any(|entry| entry.file_name().to_string_lossy().starts_with('.')));
    // The study is collected again into the same folder, whose contents must not be used as a source.
    let (output, out) = collect(&lab, &[lab.0.path(), &one.runs()], &["--json"]);
    assert_eq!(output.exit_code, 0, "{}{}", output.stdout, output.stderr);
    let object: Value = serde_json::from_str(&output.stdout).expect("JSON");
    assert_eq!(object["runs"].as_array().expect("runs").len(), 1);
    assert_eq!(read_table(&out.join("runs.csv")).len(), 1);
}

#[test]
fn collect_reports_conflicts_shared_labels_and_damage() {
    let (one, two, lab) = (Home::new(), Home::new(), Home::new());
    let first = played_run(&one, "P01");
    // The same run is continued differently on two machines.
    let copied = two.runs().join(run_id(&first));
    copy(&first, &copied);
    for (home, price) in [(&one, "A=13"), (&two, "A=14")] {
        assert_eq!(home.play(&["--run", &run_id(&first)], &format!("set_prices {price}\n")).exit_code, 0);
    }
    let (third, fourth) = (played_run(&two, "P02"), played_run(&one, "P02"));
    let broken = two.runs().join("0badc0de");
    copy(&third, &broken);
    fs::write(broken.join("trajectory.jsonl"), "nonsense\n").expect("damage");
    let labels = lab.0.path().join("labels.csv");
    fs::write(&labels, format!("run,participant\n{},P 9\nffffffff,P10\n", run_id(&fourth))).expect("labels");
    let (program_output, out) = collect(&lab, &[&one.runs(), &two.runs()], &["--labels", &text(&labels)]);
    assert_eq!(program_output.exit_code, 1, "{}{}", program_output.stdout, program_output.stderr);
    for part in [
        format!("conflict: run {} has two records that differ from line ", run_id(&first)),
        "label P02 has 2 sessions".to_owned(),
        format!("run {}: label \"P02\" becomes \"P 9\"", run_id(&fourth)),
        "the mapping names run ffffffff, which was not found".to_owned(),
        "0badc0de".to_owned(),
    ] {
        assert!(program_output.stdout.contains(&part), "{part} is missing in {}", program_output.stdout);
    }
    let runs = read_table(&out.join("runs.csv"));
    let row = |run: &str| runs.iter().find(|row| row["run"] == run).expect("a row").clone();
    assert!(
        row(&run_id(&first))["problem"].contains("contradict") && row(&run_id(&first))["cash"].is_empty()
    );
    assert_eq!(
        [&*row(&run_id(&fourth))["participant"], &*row(&run_id(&third))["participant"]],
        ["P 9", "P02"]
    );
    for number in 1..=2 {
        assert!(out.join(format!("conflicts/{}-{number}.tar.gz", run_id(&first))).exists());
    }
    let (output, _) = collect(&lab, &[&lab.0.path().join("nowhere")], &[]);
    output.assert_fails(1, &["1 note"]);
}

#[test]
fn collect_lists_missing_participants() {
    let (machine, lab) = (Home::new(), Home::new());
    let pilot = text(&lab.0.path().join("pilot"));
    for arguments in [&["study", "new", &pilot][..], &["study", "assign", &pilot, "--participants", "2"]] {
        let program_output = lab.run(arguments);
        assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    }
    let assigned = fs::read_to_string(lab.0.path().join("pilot/assignment.csv")).expect("an assignment");
    let label = assigned.lines().nth(1).and_then(|line| line.split(',').next()).expect("a label").to_owned();
    played_run(&machine, &label);
    let (output, _) = collect(&lab, &[&machine.runs()], &["--protocol", &pilot]);
    assert!(
        output.exit_code == 1 && output.stdout.matches("has no session").count() == 1,
        "{}{}",
        output.stdout,
        output.stderr
    );
    assert!(!output.stdout.contains(&format!("label {label} has no session")), "{}", output.stdout);
}

#[test]
fn read_only_commands_find_runs_of_participants() {
    let home = Home::new();
    let mut command = home.program();
    command.args(["--as", "P01", "play", "--plain", "--days", "14"]);
    let program_output =
        crate::support::home::run_with_input(&mut command, "set_prices A=12\nnext \"a\" naive\n");
    assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    let list = home.run(&["runs", "list"]).stdout;
    let run = list.split_whitespace().next().expect("a run").to_owned();
    for arguments in [
        &["report", &run][..],
        &["report", "latest", "--session"],
        &["query", &run, "SELECT 1"],
        &["replay", &run, "--verify"],
        &["lab", "compare", &run[..4]],
        &["runs", "show", &run],
    ] {
        let output = home.run(arguments);
        assert_eq!(output.exit_code, 0, "{arguments:?}: {}", output.stderr);
    }
}
