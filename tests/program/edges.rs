//! Exit codes, earlier names, and the number of rows of queries.

use std::fs;

use crate::support::home::{Home, id};

#[test]
fn a_bankruptcy_is_exit_code_4_where_the_caller_wants_to_know() {
    let home = Home::new();
    // Capacity costs $85 per day in any case.
    let idle = |extra: &[&str]| {
        home.run(&[&["run", "--policy", "P0", "--seed", "3", "--days", "14"], extra].concat())
    };
    let ruined = idle(&["--cash", "500", "--fail-on-bankruptcy"]);
    assert_eq!((ruined.code, ruined.err.as_str()), (4, ""), "{}", ruined.out);
    assert!(ruined.out.contains("bankrupt on day 6"), "{}", ruined.out);
    assert_eq!(idle(&["--cash", "500"]).code, 0, "the option is not given");
    assert_eq!(idle(&["--cash", "50000", "--fail-on-bankruptcy"]).code, 0, "no run is bankrupt");
    // One of several runs is enough, regardless of its position.
    let options = ["--cash", "500", "--fail-on-bankruptcy", "--json"];
    let several =
        home.run(&[&["run", "--policy", "P0", "--seed", "3..4", "--days", "14"], &options[..]].concat());
    assert_eq!((several.code, several.out.lines().count()), (4, 2));
}

#[test]
fn every_kind_of_failure_has_its_exit_code() {
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
        assert_eq!(home.run(arguments).code, code, "{arguments:?}");
    }
}

#[test]
fn earlier_names_of_commands_and_options_still_work() {
    let home = Home::new();
    for command in [&["runs", "rescue"][..], &["lab", "laws"], &["lab", "behaviour"], &["study", "anonymise"]]
    {
        assert_eq!(home.run(&[command, &["--help"]].concat()).code, 0, "{command:?}");
    }
    let seeded = |option: &str| {
        let options = ["--new", "--mode", "debug", "--seed", "7", option, "2"];
        let played = home.play(&options, "step\nback cash > 1\nsince cash > 1\nagain\nretry\n");
        assert_eq!(played.code, 0, "{option}: {}", played.err);
        assert!(!played.out.contains("is not a command"), "{option}: {}", played.out);
        played.out.matches("cash > 1").count()
    };
    assert!(seeded("--fault") >= 2);
    assert_eq!(seeded("--planted"), seeded("--fault"));
}

fn counting_to(most: u32) -> String {
    format!(
        "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n WHERE x < {most}) SELECT x FROM n"
    )
}

#[test]
fn a_query_brings_five_thousand_rows_whether_or_not_the_database_is_there() {
    let home = Home::new();
    let run = home.two_weeks();
    let rows = |most: u32| {
        let said = home.run(&["query", &id(&run), &counting_to(most), "--format", "csv"]);
        assert_eq!(said.code, 0, "{}", said.err);
        let rows: Vec<u32> = said.out.lines().skip(1).map(|line| line.parse().expect("a number")).collect();
        assert!(rows.iter().copied().eq(1..=rows.len() as u32), "in their order");
        rows.len()
    };
    for database in ["there", "missing"] {
        for (most, expected) in [(499, 499), (501, 501), (1_200, 1_200), (5_000, 5_000), (5_003, 5_000)] {
            assert_eq!(rows(most), expected, "of {most}, the database is {database}");
        }
        let cut = home.run(&["query", &id(&run), &counting_to(5_001), "--format", "json"]);
        assert!(cut.out.contains("\"truncated\":true"), "omitted rows are reported");
        fs::remove_file(run.join("world.db")).unwrap_or_default();
    }
}

#[test]
fn a_query_of_the_library_is_asked_by_its_name_and_written_as_a_table_of_a_document() {
    let home = Home::new();
    let run = home.two_weeks();
    let said = home.run(&["query", &id(&run), "economy", "--format", "md"]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(
        said.out.starts_with("| ") && said.out.lines().nth(1).is_some_and(|line| line.contains("---")),
        "{}",
        said.out
    );
    let told = home.run(&["query", &id(&run), "SELECT 'a|b' AS text, 7 AS n, 8 AS n", "--format", "md"]);
    assert_eq!(told.out, "| text | n | n |\n| --- | --: | --: |\n| a\\|b | 7 | 8 |\n");
    let near = home.run(&["query", &id(&run), "cash-by-weeks"]);
    assert_eq!(near.code, 2);
    assert!(near.err.contains("cash-by-week"), "{}", near.err);
}
