//! `doctor`, manual pages, and the page of third-party licences.

use std::collections::BTreeSet;
use std::fs;
use std::process::Command;

use crate::support::home::Home;

/// Returns the verdicts of `doctor`, by check, and its exit code.
fn doctor(home: &Home) -> (Vec<(String, String)>, i32) {
    let output = home.run(&["doctor", "--json"]);
    let report = output.json_lines().remove(0);
    let checks = report["checks"].as_array().expect("checks").iter();
    let text = |value: &serde_json::Value| value.as_str().expect("a text").to_owned();
    (checks.map(|check| (text(&check["name"]), text(&check["verdict"]))).collect(), output.exit_code)
}

/// Returns the checks that failed.
fn failed_checks(home: &Home) -> Vec<String> {
    let (checks, exit_code) = doctor(home);
    let mut failed: Vec<String> =
        checks.into_iter().filter(|(_, verdict)| verdict == "wrong").map(|(name, _)| name).collect();
    assert_eq!(exit_code, i32::from(!failed.is_empty()));
    // The checks of the clock and the disk depend on the machine.
    failed.retain(|name| name != "clock" && name != "disk");
    failed
}

#[test]
fn doctor_reports_problems_and_creates_no_files() {
    let home = Home::new();
    fs::remove_dir(home.runs()).expect("an empty folder");
    assert!(failed_checks(&home).is_empty());
    assert!(!home.runs().exists(), "the folder of runs is not created");
    home.write("keys.toml", "this is not TOML");
    assert_eq!(failed_checks(&home), ["settings"]);
    fs::write(home.runs(), "a file instead of a folder").expect("a file");
    assert_eq!(failed_checks(&home), ["runs", "settings"]);
}

#[test]
fn manual_pages_exist_for_commands_only() {
    let home = Home::new();
    let page = home.run(&["man", "runs", "list"]);
    assert_eq!(page.exit_code, 0, "{}", page.stderr);
    assert!(page.stdout.contains(".TH novamind-runs-list 1"), "{}", page.stdout);
    home.run(&["man", "runs", "nonsense"]).assert_fails(2, &["novamind runs has no command nonsense"]);
}

/// The page lists every crate that is compiled into the program on any system.
#[test]
fn third_party_page_is_complete() {
    let output = Command::new(env!("CARGO"))
        .args([
            "tree",
            "--workspace",
            "--all-features",
            "--edges",
            "normal",
            "--target",
            "all",
            "--prefix",
            "none",
        ])
        // Not offline: cargo downloads crates of other systems, which no build on this system needs.
        .args(["--format", "{p}", "--locked", "--no-dedupe"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    // Crates of this workspace have a path in parentheses. Procedural macros have the word `proc-macro`.
    let crates: BTreeSet<&str> = text
        .lines()
        .filter(|line| !line.contains("(/") && !line.contains("(proc-macro)") && !line.is_empty())
        .map(str::trim)
        .collect();
    assert!(crates.len() > 150, "{}", crates.len());
    let page = fs::read_to_string("docs/third-party.md").expect("the page");
    let missing: Vec<&&str> = crates
        .iter()
        .filter(|name| !page.contains(&format!("\n| {} |", name.replacen(" v", " ", 1))))
        .collect();
    assert!(missing.is_empty(), "run packaging/third-party: {missing:?} are missing");
}
