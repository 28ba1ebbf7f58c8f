//! Exit codes, earlier names of commands and options, and the row limit of queries.

use std::fs;

use crate::support::home::{Home, run_id};

#[test]
fn bankruptcy_is_exit_code_4_on_request() {
    let home = Home::new();
    // Without any decision, capacity costs $85 per day.
    let idle = |extra: &[&str]| {
        home.run(&[&["run", "--policy", "P0", "--seed", "3", "--days", "14"], extra].concat())
    };
    let ruined = idle(&["--cash", "500", "--fail-on-bankruptcy"]);
    assert_eq!((ruined.exit_code, ruined.stderr.as_str()), (4, ""), "{}", ruined.stdout);
    assert!(ruined.stdout.contains("bankrupt on day 6"), "{}", ruined.stdout);
    assert_eq!(idle(&["--cash", "500"]).exit_code, 0, "the option is not given");
    assert_eq!(idle(&["--cash", "50000", "--fail-on-bankruptcy"]).exit_code, 0, "no run is bankrupt");
    // One bankruptcy in several runs is sufficient, regardless of its position.
    let options = ["--cash", "500", "--fail-on-bankruptcy", "--json"];
    let several =
        home.run(&[&["run", "--policy", "P0", "--seed", "3..4", "--days", "14"], &options[..]].concat());
    assert_eq!((several.exit_code, several.stdout.lines().count()), (4, 2));
}

#[test]
fn failures_have_the_documented_exit_codes() {
    let home = Home::new();
    for (code, arguments) in [
        (1, &["run", "--policy", "P0", "--days", "14", "--metrics", "/nowhere/at/all.csv"][..]),
        (2, &["run", "--policy", "P0", "--days", "14", "--jobs", "0"]),
        (2, &["run", "--policy", "P0", "--days", "3"]),
        (2, &["run", "--policy", "P0", "--seed", "5..4"]),
        (2, &["nonsense"]),
        (2, &["run", "--policy", "nowhere"]),
        (3, &["run", "--policy", "nowhere.toml"]),
        (3, &["query", "nothere", "SELECT 1"]),
        (3, &["replay", "nothere", "--verify"]),
        (3, &["runs", "import", "/nowhere/at/all.tar"]),
        (0, &["run", "--policy", "P0", "--days", "14", "--until", "7"]),
    ] {
        assert_eq!(home.run(arguments).exit_code, code, "{arguments:?}");
    }
}

#[test]
fn earlier_names_of_commands_and_options_still_work() {
    let home = Home::new();
    for command in [&["runs", "rescue"][..], &["lab", "laws"], &["lab", "behaviour"], &["study", "anonymise"]]
    {
        assert_eq!(home.run(&[command, &["--help"]].concat()).exit_code, 0, "{command:?}");
    }
    let seeded = |option: &str| {
        let options = ["--new", "--mode", "debug", "--seed", "7", option, "2"];
        let played = home.play(&options, "step\nback cash > 1\nsince cash > 1\nagain\nretry\n");
        assert_eq!(played.exit_code, 0, "{option}: {}", played.stderr);
        assert!(!played.stdout.contains("is not a command"), "{option}: {}", played.stdout);
        played.stdout.matches("cash > 1").count()
    };
    assert!(seeded("--fault") >= 2);
    assert_eq!(seeded("--planted"), seeded("--fault"));
}

fn counting_statement(most: u32) -> String {
    format!(
        "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n WHERE x < {most}) SELECT x FROM n"
    )
}

#[test]
fn query_returns_5000_rows_without_a_database() {
    let home = Home::new();
    let run = home.play_two_weeks();
    let rows = |most: u32| {
        let program_output =
            home.run(&["query", &run_id(&run), &counting_statement(most), "--format", "csv"]);
        assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
        let rows: Vec<u32> =
            program_output.stdout.lines().skip(1).map(|line| line.parse().expect("a number")).collect();
        assert!(rows.iter().copied().eq(1..=rows.len() as u32), "in their order");
        rows.len()
    };
    for database in ["there", "missing"] {
        for (most, expected) in [(499, 499), (501, 501), (1_200, 1_200), (5_000, 5_000), (5_003, 5_000)] {
            assert_eq!(rows(most), expected, "of {most}, the database is {database}");
        }
        let cut = home.run(&["query", &run_id(&run), &counting_statement(5_001), "--format", "json"]);
        assert!(cut.stdout.contains("\"truncated\":true"), "omitted rows are reported");
        fs::remove_file(run.join("world.db")).unwrap_or_default();
    }
}

#[test]
fn named_query_is_printed_as_markdown() {
    let home = Home::new();
    let run = home.play_two_weeks();
    let program_output = home.run(&["query", &run_id(&run), "economy", "--format", "md"]);
    assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    assert!(
        program_output.stdout.starts_with("| ")
            && program_output.stdout.lines().nth(1).is_some_and(|line| line.contains("---")),
        "{}",
        program_output.stdout
    );
    let output =
        home.run(&["query", &run_id(&run), "SELECT 'a|b' AS text, 7 AS n, 8 AS n", "--format", "md"]);
    assert_eq!(output.stdout, "| text | n | n |\n| --- | --: | --: |\n| a\\|b | 7 | 8 |\n");
    let near = home.run(&["query", &run_id(&run), "cash-by-weeks"]);
    assert_eq!(near.exit_code, 2);
    assert!(near.stderr.contains("cash-by-week"), "{}", near.stderr);
}
