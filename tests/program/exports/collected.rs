//! A study collected from three machines: later states, archives, conflicts, labels, gaps.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::{export, id, played, table, text};
use crate::support::home::{Home, Said, bytes_of};

fn collect(lab: &Home, sources: &[&Path], more: &[&str]) -> (Said, std::path::PathBuf) {
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
        fs::write(to.join(name), bytes_of(from, name)).expect("a copy");
    }
}

#[test]
fn every_run_is_taken_once_in_its_latest_state() {
    let (one, two, lab) = (Home::new(), Home::new(), Home::new());
    let (first, second) = (played(&one, "P01"), played(&two, "P02"));
    // An early archive, and the run continued after it.
    let (archive, _) = export(&one, &first, "early.tar.gz");
    assert_eq!(one.play(&["--run", &id(&first)], "next \"the end\" naive\n").code, 0);
    let sources = [one.runs(), archive, two.runs()];
    let sources: Vec<&Path> = sources.iter().map(std::path::PathBuf::as_path).collect();
    let (said, out) = collect(&lab, &sources, &[]);
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    assert!(said.out.contains("early.tar.gz is an earlier state or a copy of"), "{}", said.out);
    let runs = table(&out.join("runs.csv"));
    let days: Vec<(&str, &str)> = runs.iter().map(|row| (&*row["run"], &*row["day"])).collect();
    assert_eq!(days, [(&*id(&first), "28"), (&*id(&second), "21")]);
    assert_eq!(fs::read_to_string(out.join("collect.log")).expect("a log").lines().count(), 1);
    assert!(out.join(format!("{}.tar.gz", id(&second))).exists() && out.join("events.csv").exists());
    let hidden = fs::read_dir(&out).expect("a folder").flatten();
    assert!(!hidden.into_iter().any(|entry| entry.file_name().to_string_lossy().starts_with('.')));
    // Again, into the same folder: its contents are not a source.
    let (said, out) = collect(&lab, &[lab.0.path(), &one.runs()], &["--json"]);
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    let object: Value = serde_json::from_str(&said.out).expect("JSON");
    assert_eq!(object["runs"].as_array().expect("runs").len(), 1);
    assert_eq!(table(&out.join("runs.csv")).len(), 1);
}

#[test]
fn contradictions_shared_labels_and_damage_are_told() {
    let (one, two, lab) = (Home::new(), Home::new(), Home::new());
    let first = played(&one, "P01");
    // The same run, continued differently on two machines.
    let copied = two.runs().join(id(&first));
    copy(&first, &copied);
    for (home, price) in [(&one, "A=13"), (&two, "A=14")] {
        assert_eq!(home.play(&["--run", &id(&first)], &format!("set_prices {price}\n")).code, 0);
    }
    let (third, fourth) = (played(&two, "P02"), played(&one, "P02"));
    let broken = two.runs().join("0badc0de");
    copy(&third, &broken);
    fs::write(broken.join("trajectory.jsonl"), "nonsense\n").expect("damage");
    let labels = lab.0.path().join("labels.csv");
    fs::write(&labels, format!("run,participant\n{},P 9\nffffffff,P10\n", id(&fourth))).expect("labels");
    let (said, out) = collect(&lab, &[&one.runs(), &two.runs()], &["--labels", &text(&labels)]);
    assert_eq!(said.code, 1, "{}{}", said.out, said.err);
    for part in [
        format!("conflict: run {} has two records that differ from line ", id(&first)),
        "label P02 has 2 sessions".to_owned(),
        format!("run {}: label \"P02\" becomes \"P 9\"", id(&fourth)),
        "the mapping names run ffffffff, which was not found".to_owned(),
        "0badc0de".to_owned(),
    ] {
        assert!(said.out.contains(&part), "{part} is missing in {}", said.out);
    }
    let runs = table(&out.join("runs.csv"));
    let row = |run: &str| runs.iter().find(|row| row["run"] == run).expect("a row").clone();
    assert!(row(&id(&first))["problem"].contains("contradict") && row(&id(&first))["cash"].is_empty());
    assert_eq!([&*row(&id(&fourth))["participant"], &*row(&id(&third))["participant"]], ["P 9", "P02"]);
    for number in 1..=2 {
        assert!(out.join(format!("conflicts/{}-{number}.tar.gz", id(&first))).exists());
    }
    let (said, _) = collect(&lab, &[&lab.0.path().join("nowhere")], &[]);
    said.fails(1, &["1 note"]);
}

#[test]
fn places_without_a_session_are_listed() {
    let (machine, lab) = (Home::new(), Home::new());
    let pilot = text(&lab.0.path().join("pilot"));
    for arguments in [&["study", "new", &pilot][..], &["study", "assign", &pilot, "--participants", "2"]] {
        let said = lab.run(arguments);
        assert_eq!(said.code, 0, "{}", said.err);
    }
    let assigned = fs::read_to_string(lab.0.path().join("pilot/assignment.csv")).expect("an assignment");
    let label = assigned.lines().nth(1).and_then(|line| line.split(',').next()).expect("a label").to_owned();
    played(&machine, &label);
    let (said, _) = collect(&lab, &[&machine.runs()], &["--protocol", &pilot]);
    assert!(said.code == 1 && said.out.matches("has no session").count() == 1, "{}{}", said.out, said.err);
    assert!(!said.out.contains(&format!("label {label} has no session")), "{}", said.out);
}

#[test]
fn every_reading_command_finds_what_a_list_shows() {
    let home = Home::new();
    let mut own = home.program();
    own.args(["--as", "P01", "play", "--plain", "--days", "14"]);
    let said = crate::support::home::said(&mut own, "set_prices A=12\nnext \"a\" naive\n");
    assert_eq!(said.code, 0, "{}", said.err);
    let list = home.run(&["runs", "list"]).out;
    let run = list.split_whitespace().next().expect("a run").to_owned();
    for arguments in [
        &["report", &run][..],
        &["report", "latest", "--session"],
        &["query", &run, "SELECT 1"],
        &["replay", &run, "--verify"],
        &["lab", "compare", &run[..4]],
        &["runs", "show", &run],
    ] {
        let said = home.run(arguments);
        assert_eq!(said.code, 0, "{arguments:?}: {}", said.err);
    }
}
