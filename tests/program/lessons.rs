//! User-defined lessons, as described in the guide for authors, and lessons in plain mode.

use std::fs;

use serde_json::Value;

use crate::support::home::{Home, run_with_input};

#[test]
fn user_lesson_is_copied_changed_and_checked() {
    let home = Home::new();
    let program_output = home.run(&["lesson", "copy", "cheapest-dollar", "late-help"]);
    assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    assert!(
        program_output.stdout.contains("late-help.toml")
            && program_output.stdout.contains("novamind lesson check late-help"),
        "{}",
        program_output.stdout
    );
    assert!(
        home.run(&["lesson", "list"])
            .stdout
            .lines()
            .last()
            .is_some_and(|line| line.starts_with("late-help "))
    );
    let [plan, texts] =
        ["toml", "md"].map(|ending| home.0.path().join(format!("configuration/lessons/late-help.{ending}")));
    assert!(fs::read_to_string(texts).expect("texts").contains("## For the teacher"));
    // An existing lesson must not be replaced.
    for taken in ["late-help", "ladder"] {
        let message = format!("lesson {taken} already exists");
        home.run(&["lesson", "copy", "ladder", taken]).assert_fails(2, &[&message]);
    }
    for no_name in ["", "two words"] {
        home.run(&["lesson", "copy", "ladder", no_name]).assert_fails(2, &["letters, digits, - and _"]);
    }
    let no_world =
        fs::read_to_string(&plan).expect("a plan").replacen("scenario = \"", "scenario = \"no-", 1);
    let elsewhere = home.0.path().join("no-world.toml");
    fs::write(&elsewhere, no_world).expect("a plan");
    fs::copy(plan.with_extension("md"), elsewhere.with_extension("md")).expect("texts");
    let elsewhere = elsewhere.to_string_lossy().into_owned();
    home.run(&["lesson", "check", &elsewhere]).assert_fails(2, &["no-world.toml: there is no scenario no-"]);
    let wrong = fs::read_to_string(&plan).expect("a plan").replacen("minutes = ", "minuets = ", 1);
    fs::write(&plan, wrong).expect("a plan");
    home.run(&["lesson", "check", "late-help"]).assert_fails(3, &["late-help.toml, line 2", "minuets"]);
    let path = home.0.path().join("elsewhere/another.toml").to_string_lossy().into_owned();
    assert_eq!(home.run(&["lesson", "copy", "ladder", &path]).exit_code, 0);
    assert_eq!(home.run(&["lesson", "show", &path]).exit_code, 0);
    home.run(&["lesson", "copy", "ladder", "somewhere/lesson.txt"]).assert_fails(2, &[".toml"]);
    home.run(&["lesson", "copy", "nothing", "mine"]).assert_fails(2, &["there is no lesson nothing"]);
}

#[test]
fn retry_is_judged_by_a_reference_play_that_answers_by_rules() {
    let home = Home::new();
    let plan = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/lessons/answers-by-rules.toml");
    let lines = "next\nnext\nnext\nnext\nagain 1\nnext\nnext\nnext\nnext\nnext\n";
    let played = run_with_input(home.program().args(["lesson", "play", plan, "--plain", "--json"]), lines);
    let pages = played.json_lines();
    let weeks: Vec<bool> =
        pages.iter().filter(|page| page["command"] == "next").map(|page| page["ok"] == true).collect();
    assert_eq!(weeks, [true; 9], "the second step begins once the first is judged: {}", played.stdout);
    let again = pages.iter().find(|page| page["command"] == "again").expect("another try");
    assert_eq!(again["data"]["goals"][0]["met"], Value::Null, "it is not judged yet: {again}");
}
