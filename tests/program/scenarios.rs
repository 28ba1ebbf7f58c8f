//! Scenarios in the built program: listing, showing and playing them.

use std::path::Path;
use std::process::{Command, Output};

fn program(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_novamind"))
        .args(arguments)
        .env("NOVAMIND_RUNS", folder)
        .env("NOVAMIND_CONFIG", folder.join("configuration"))
        .output()
        .expect("the program starts")
}

fn program_output(folder: &Path, arguments: &[&str]) -> String {
    let output = program(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("UTF-8")
}

#[test]
fn scenarios_are_listed_and_shown_with_their_parameters() {
    let folder = tempfile::tempdir().expect("a folder");
    let list = program_output(folder.path(), &["scenario", "list"]);
    for name in ["default", "short", "competitor-hard", "paper", "corrected", "reference-seed42"] {
        assert!(list.lines().any(|line| line.starts_with(&format!("{name} "))), "{name} is missing:\n{list}");
    }
    let shown = program_output(folder.path(), &["scenario", "show", "reference-seed42"]);
    let table: toml::Table = shown.parse().expect("TOML");
    assert_eq!(table["series"]["replayed"].as_str(), Some("seed42"));
    assert!(shown.starts_with("# Reference seed 42: "));
    let usual: toml::Table =
        program_output(folder.path(), &["scenario", "show", "default"]).parse().expect("TOML");
    assert_eq!(usual["series"]["replayed"].as_str(), Some("none"));
}

/// With every seed, the hidden index and the competitors equal the recorded market.
#[test]
fn reference_scenario_uses_the_recorded_market() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("figures.csv");
    let file = file.to_str().expect("a path");
    let common = ["run", "--policy", "P0", "--scenario", "reference-seed42", "--seed", "5", "--until", "140"];
    let days = ["--metrics-days", "1,100,140", "--metrics", file];
    program_output(folder.path(), &[&common[..], &days[..]].concat());
    let text = std::fs::read_to_string(file).expect("figures");
    let recorded = include_str!("../data/seed42/pmi_daily.csv");
    for day in [1, 100, 140] {
        let pmi = recorded.lines().nth(day).and_then(|line| line.split(',').nth(1)).expect("a value");
        assert!(text.contains(&format!("\n5,{day},pmi,,{pmi}\n")), "day {day}, {pmi}:\n{text}");
    }
    let events = include_str!("../data/seed42/competitor_events_dev_groups_0.csv").lines().skip(1);
    let until = |last: u32| {
        let day = |line: &str| line.split(',').next().and_then(|day| day.parse::<u32>().ok()).expect("a day");
        events.clone().filter(|line| day(line) <= last).count()
    };
    for day in [100, 140] {
        assert!(text.contains(&format!("\n5,{day},comp_events_cum,,{}\n", until(day))), "day {day}:\n{text}");
    }
}

#[test]
fn missing_reference_policy_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let figures = "policy,figure,group,day,n_seeds,mean,std\nP77,cash,,30,8,1.0,1.0\n";
    std::fs::write(folder.path().join("P77.csv"), figures).expect("a file");
    let output = program(folder.path(), &["lab", "golden", folder.path().to_str().expect("a path")]);
    assert_eq!(output.status.code(), Some(1));
    let problem = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(problem.contains("P77 cannot be played"), "{problem}");
}
