//! Figures agree with the released simulator over many seeds (docs/interfaces/golden.md), and equal the figures of the
//! last release of this program.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn data_path(below: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(below)
}

/// Policies that every test run compares, because their small companies are simulated fast.
const FAST_POLICIES: [&str; 2] = ["P6", "P8"];

#[test]
fn fast_policies_match_golden_figures() {
    check_policies(&FAST_POLICIES);
}

#[test]
#[ignore = "slow: .ci/full runs it"]
fn all_policies_match_golden_figures() {
    check_policies(&["P0", "P10", "P1a", "P1b", "P6", "P8"]);
}

/// Policies agree with the figures of release 2 under the scenario `release-2`, and differ under `default`.
#[test]
#[ignore = "slow: .ci/full runs it"]
fn golden_figures_of_release_2_match_their_generation_only() {
    let policies = ["P1a", "P1b"];
    let (text, agrees) = compare_with_golden("golden-r2", &policies, &["--seeds", "1..48"]);
    assert!(agrees && text.starts_with("scenario release-2\n"), "{text}");
    for policy in policies {
        assert!(text.contains(&format!("{policy} ")), "{policy} was not compared:\n{text}");
    }
    let options = ["--scenario", "default", "--seeds", "1..48"];
    let (text, agrees) = compare_with_golden("golden-r2", &policies, &options);
    assert!(!agrees && text.starts_with("scenario default\n"), "{text}");
    assert!(text.contains("less than 97 % of the cells of all policies"), "{text}");
    // Release 1 counts drift twice, so its subscribers are less satisfied, in both policies.
    let worst = |line: &str| line.split_once("worst")?.1.split_whitespace().next()?.parse::<f64>().ok();
    let satisfaction = text.lines().filter(|line| line.trim_start().starts_with("sat_mean "));
    let worst: Vec<f64> = satisfaction.filter_map(worst).collect();
    assert!(worst.len() == 2 && worst.iter().all(|deviation| *deviation < -5.0), "{worst:?}: {text}");
}

/// Compares policies with a folder of golden figures. Returns the output and whether the figures agree.
fn compare_with_golden(folder: &str, policies: &[&str], options: &[&str]) -> (String, bool) {
    let runs = tempfile::tempdir().expect("a folder");
    let mut command = Command::new(env!("CARGO_BIN_EXE_novamind"));
    command.args(["lab", "golden"]).arg(data_path(folder)).env("NOVAMIND_RUNS", runs.path());
    command.args(options).args(policies.iter().flat_map(|policy| ["--only", policy]));
    let output = command.output().expect("the program starts");
    let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    (text.concat(), output.status.success())
}

fn check_policies(policies: &[&str]) {
    let (text, agrees) = compare_with_golden("golden", policies, &[]);
    assert!(agrees, "{text}");
    for policy in policies {
        assert!(text.contains(&format!("{policy} ")), "{policy} was not compared:\n{text}");
    }
    check_deviation_changes(policies, &text);
}

/// Maximum change of a figure's deviation from the released simulator between two versions, in standard errors. The
/// seeds are the same, so deviations change only if the mechanics change.
const MAX_DEVIATION_CHANGE: f64 = 0.25;

/// Compares the median deviation of every figure with the last release. This comparison is stricter than the verdict
/// of the laboratory, which allows any difference that chance can explain.
fn check_deviation_changes(policies: &[&str], output: &str) {
    let text = fs::read_to_string(data_path("medians.csv")).expect("the deviations of the last release");
    let mut policy = "";
    let mut medians: BTreeMap<(String, String), f64> = BTreeMap::new();
    for line in output.lines() {
        if let Some((name, _)) = line.split_once("  ").filter(|(name, _)| !name.is_empty()) {
            policy = name;
        }
        let words: Vec<&str> = line.split_whitespace().collect();
        if let [figure, _, "cells", "median", "z", median, ..] = words[..] {
            medians.insert((policy.to_owned(), figure.to_owned()), median.parse().expect("a number"));
        }
    }
    let mut moved = Vec::new();
    for line in text.lines().skip(1) {
        let [policy, figure, _, before] = line.split(',').collect::<Vec<_>>()[..] else { panic!("{line}") };
        if !policies.contains(&policy) {
            continue;
        }
        let now = medians.remove(&(policy.to_owned(), figure.to_owned()));
        let before: f64 = before.parse().expect("a number");
        if now.is_none_or(|now| (now - before).abs() > MAX_DEVIATION_CHANGE) {
            moved.push(format!("  {policy} {figure}: {now:?}, not {before}"));
        }
    }
    assert!(medians.is_empty(), "figures without an earlier value: {medians:?}");
    assert!(moved.is_empty(), "{} figures have changed:\n{}", moved.len(), moved.join("\n"));
}

/// Figures by seed, day, name and group.
type Figures = BTreeMap<String, String>;

fn figures(path: &Path) -> Figures {
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let row = |line: &str| line.rsplit_once(',').map(|(key, value)| (key.to_owned(), value.to_owned()));
    text.lines().skip(1).map(|line| row(line).expect("five columns")).collect()
}

/// Compares exact figures with the last release. Random streams are the same in every version, so a difference is
/// either an error or an intended change with a new mechanics number and new figures.
#[track_caller]
fn check_figures(name: &str, policy: &str, scenario: &str, seeds: &str, until: &str, days: &str) {
    let folder = tempfile::tempdir().expect("a folder");
    let (path, kept) = (folder.path().join("own.csv"), data_path("paired").join(name));
    let options = [
        "run",
        "--policy",
        policy,
        "--scenario",
        scenario,
        "--seed",
        seeds,
        "--days",
        "500",
        "--until",
        until,
        "--metrics-days",
        days,
    ];
    let mut command = Command::new(env!("CARGO_BIN_EXE_novamind"));
    command.args(options).arg("--metrics").arg(&path).env("NOVAMIND_RUNS", folder.path());
    let output = command.output().expect("the program starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let (current, kept) = (figures(&path), figures(&kept));
    let keys: std::collections::BTreeSet<&String> = current.keys().chain(kept.keys()).collect();
    assert!(keys.len() > 200, "{name} has {} figures", keys.len());
    let value = |figures: &Figures, key: &str| figures.get(key).map_or("nothing", String::as_str).to_owned();
    let different: Vec<String> = keys
        .into_iter()
        .filter(|key| current.get(*key) != kept.get(*key))
        .map(|key| format!("  {key}: {}, not {}", value(&current, key), value(&kept, key)))
        .collect();
    assert!(
        different.is_empty(),
        "{} figures differ from those of the last release, for instance\n{}\nIf this is intended, raise MECHANICS and \
         write them anew: novamind {} --metrics tests/data/paired/{name}",
        different.len(),
        different[..different.len().min(20)].join("\n"),
        options.join(" ")
    );
}

#[test]
fn run_with_every_setting_keeps_released_figures() {
    let policy = data_path("policies/everything.toml");
    check_figures("everything.csv", &policy.to_string_lossy(), "default", "1..2", "182", "56,119,182");
}

#[test]
fn run_under_release_2_keeps_released_figures() {
    let policy = data_path("policies/everything.toml");
    check_figures("everything-r2.csv", &policy.to_string_lossy(), "release-2", "1", "182", "56,182");
}

#[test]
fn run_with_saturated_market_keeps_released_figures() {
    check_figures("P1a.csv", "P1a", "default", "3", "300", "120,300");
}

#[test]
fn other_policies_keep_released_figures() {
    check_figures("P8.csv", "P8", "default", "4", "200", "60,200");
    check_figures("P10.csv", "P10", "default", "5", "200", "60,200");
}
