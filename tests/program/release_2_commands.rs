//! Effects of the rules of release 2, measured on paired runs with the same seeds, and commands that accept the scenario
//! `release-2`.

use std::collections::BTreeMap;
use std::fs;

use serde_json::Value;

use crate::interfaces::Server;
use crate::support::home::{Home, run_with_input};

const RELEASE_2: [&str; 2] = ["--scenario", "release-2"];
const ONCE: [&str; 4] = ["--set", "fidelity.drift_counted=once", "--set", "billing.billing_c_max_min=0.0"];

/// Figures by name, group, day and seed.
struct Figures(BTreeMap<(String, String, u32, u64), f64>);

impl Figures {
    /// Plays a policy on the seeds 1 and 2 and reads its figures on some days.
    fn of(policy: &str, days: &[u32], options: &[&str]) -> Figures {
        let home = Home::new();
        let path = home.0.path().join("figures.csv").display().to_string();
        let until = days.last().expect("a day").to_string();
        let listed = days.iter().map(u32::to_string).collect::<Vec<_>>().join(",");
        let fixed = ["run", "--policy", policy, "--seed", "1..2", "--days", "500", "--until", &until];
        let written = ["--metrics", &path, "--metrics-days", &listed];
        let program_output = home.run(&[&fixed[..], &written, options].concat());
        assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
        let text = fs::read_to_string(&path).expect("figures");
        let row = |line: &str| {
            let [seed, day, figure, group, value] = line.split(',').collect::<Vec<_>>()[..] else {
                panic!("{line}");
            };
            let key = (figure.to_owned(), group.to_owned(), day.parse().ok()?, seed.parse().ok()?);
            Some((key, value.parse().ok()?))
        };
        Figures(text.lines().skip(1).map(|line| row(line).expect("numbers")).collect())
    }

    /// Returns the values of a figure, one for each seed.
    fn values(&self, figure: &str, group: &str, day: u32) -> [f64; 2] {
        [1, 2].map(|seed| {
            let key = (figure.to_owned(), group.to_owned(), day, seed);
            *self.0.get(&key).unwrap_or_else(|| panic!("{key:?} is missing"))
        })
    }

    fn mean(&self, figure: &str, group: &str, day: u32) -> f64 {
        self.values(figure, group, day).iter().sum::<f64>() / 2.0
    }
}

/// Checks that a figure is higher in the second company than in the first company, on every seed.
#[track_caller]
fn assert_higher([one, other]: [&Figures; 2], figure: &str, group: &str, day: u32) {
    let (one, other) = (one.values(figure, group, day), other.values(figure, group, day));
    assert!(one.iter().zip(&other).all(|(one, other)| one < other), "{figure} {group}: {one:?} {other:?}");
}

fn data_path(below: &str) -> String {
    format!("{}/tests/data/{below}", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn release_2_keeps_more_subscribers() {
    let [one, other] = [Figures::of("P1a", &[154], &[]), Figures::of("P1a", &[154], &RELEASE_2)];
    for (figure, group) in [("subs_total", ""), ("cash", ""), ("sat_mean", "S1")] {
        assert_higher([&one, &other], figure, group, 154);
    }
}

#[test]
#[ignore = "slow: .ci/full runs it"]
fn release_2_keeps_the_cash_of_a_cheap_company_for_longer() {
    let days = [300, 500];
    let [one, other] = [Figures::of("P1b", &days, &[]), Figures::of("P1b", &days, &RELEASE_2)];
    for day in days {
        assert_higher([&one, &other], "cash", "", day);
    }
}

#[test]
fn closed_threads_preserve_reputation_but_not_cash() {
    let closed = Figures::of("P10", &[154], &["--set", "fidelity.reappearing_threads=false"]);
    let one = Figures::of("P10", &[154], &[]);
    assert_higher([&one, &closed], "reputation", "E1", 154);
    assert_higher([&closed, &one], "notif_cum", "lead_lost_timeout", 154);
    let [before, after] = [one.mean("cash", "", 154), closed.mean("cash", "", 154)];
    assert!((after / before - 1.0).abs() < 0.02, "{before} {after}");
}

#[test]
fn renewal_price_matters_only_after_a_price_increase() {
    let policy = data_path("policies/price-rise.toml");
    let lower = ["--set", "fidelity.renewal_price=lower_of_list_and_stored"];
    let [one, other] = [Figures::of(&policy, &[84, 119], &[]), Figures::of(&policy, &[84, 119], &lower)];
    let until_day_84 = |figures: &Figures| {
        figures.0.clone().into_iter().filter(|((_, _, day, _), _)| *day == 84).collect::<Vec<_>>()
    };
    assert_eq!(until_day_84(&one), until_day_84(&other));
    assert_higher([&other, &one], "downgrades_cum", "", 119);
    assert_higher([&other, &one], "cancel_quality_or_price_cum", "S1", 119);
    assert_higher([&one, &other], "subs_total", "", 119);
}

#[test]
fn uncapped_quality_lets_loss_making_deals_succeed() {
    let policy = data_path("policies/loss-making-deals.toml");
    let uncapped = Figures::of(&policy, &[154], &["--set", "fidelity.enterprise_quality_cap=none"]);
    let [one, other] = [Figures::of(&policy, &[154], &[]), Figures::of(&policy, &[154], &RELEASE_2)];
    assert_higher([&one, &uncapped], "ent_seats", "", 154);
    assert_higher([&other, &one], "cash", "", 154);
    let [one, other, uncapped] = [one, other, uncapped].map(|figures| figures.mean("cash", "", 154));
    assert!((one - uncapped) / (one - other) > 0.5, "{one} {other} {uncapped}");
}

#[test]
fn drift_that_counts_once_explains_the_satisfaction() {
    let [one, other] = [Figures::of("P1a", &[154], &ONCE), Figures::of("P1a", &[154], &RELEASE_2)];
    assert_eq!(one.0, other.0, "policy P1a has no enterprises and does not change prices");
}

#[test]
fn scenario_diff_lists_differences_with_their_meaning() {
    let home = Home::new();
    let text = home.run(&["scenario", "diff", "release-2", "default"]).stdout;
    for part in ["6 differences", "fidelity.renewal_price", "a price increase does not count", "\"list\""] {
        assert!(text.contains(part), "{part} is missing:\n{text}");
    }
    let columns = text.lines().find(|line| line.contains("fidelity.reappearing_threads")).expect("a row");
    assert_eq!(columns.split_whitespace().skip(1).collect::<Vec<_>>(), ["false", "true"]);
    let text = home.run(&["scenario", "diff", "short", "default"]).stdout;
    assert!(text.contains("1 difference ") && text.contains("last day of a run"), "{text}");
    assert!(home.run(&["scenario", "diff", "paper", "paper"]).stdout.contains("are equal"));
    home.run(&["scenario", "diff", "default", "none"]).assert_fails(2, &["release-2"]);
    // Every parameter that a bundled scenario overrides has a meaning.
    for line in home.run(&["scenario", "list"]).stdout.lines() {
        let name = line.split_whitespace().next().expect("a name");
        let text = home.run(&["scenario", "diff", "default", name]).stdout;
        let rows = text.lines().skip(3).filter(|row| !row.is_empty());
        let (meanings, keys): (Vec<&str>, Vec<&str>) = rows.partition(|row| row.starts_with("    "));
        assert_eq!(meanings.len(), keys.len(), "{name}:\n{text}");
    }
}

/// Returns the scenario in the only run of a home.
fn recorded_scenario(home: &Home) -> Value {
    let record = fs::read_to_string(home.only_run().join("trajectory.jsonl")).expect("a record");
    let start: Value = serde_json::from_str(record.lines().next().expect("a line")).expect("JSON");
    start["scenario"].clone()
}

#[test]
fn players_and_programs_play_release_2() {
    let home = Home::new();
    assert_eq!(home.play(&RELEASE_2, "next naive\n").exit_code, 0);
    assert_eq!(recorded_scenario(&home), "release-2");
    let verified = home.run(&["replay", "latest", "--verify"]);
    assert_eq!(verified.exit_code, 0, "{}", verified.stderr);
    let home = Home::new();
    drop(Server::start(&home, &["--new", "--scenario", "release-2"]));
    assert_eq!(recorded_scenario(&home), "release-2");
    let home = Home::new();
    let made = home.run(&["agent", "new", "--scenario", "release-2"]);
    assert_eq!(made.exit_code, 0, "{}", made.stderr);
    assert_eq!(recorded_scenario(&home), "release-2");
    let home = Home::new();
    let initialize = r#"{"jsonrpc":"2.0","id":1,"method":"initialize","params":{"protocolVersion":"2025-06-18","capabilities":{},"clientInfo":{"name":"test","version":"1"}}}"#;
    let mut command = home.program();
    command.args(["mcp", "--new"]).args(RELEASE_2);
    let served = run_with_input(&mut command, &format!("{initialize}\n"));
    assert!(!served.stderr.contains("sandbox"), "a baseline run: {}", served.stderr);
    assert_eq!(recorded_scenario(&home), "release-2");
}

#[test]
fn lesson_and_class_run_under_release_2() {
    let home = Home::new();
    let path = home.0.path().join("ladder.toml").display().to_string();
    assert_eq!(home.run(&["lesson", "copy", "ladder", &path]).exit_code, 0);
    let text = fs::read_to_string(&path).expect("a lesson");
    fs::write(&path, text.replace("scenario = \"competitor-off\"", "scenario = \"release-2\""))
        .expect("a lesson");
    let played = run_with_input(home.program().args(["lesson", "play", &path, "--plain"]), "next\n");
    assert_eq!(recorded_scenario(&home), "release-2", "{}", played.stdout);
    let class = home.0.path().join("class").display().to_string();
    let made = home.run(&["class", "new", &path, "--students", "1", "--out", &class]);
    assert_eq!(made.exit_code, 0, "{}", made.stderr);
    let stored = fs::read_to_string(home.0.path().join("class/lesson.toml")).expect("the lesson");
    assert!(stored.contains("scenario = \"release-2\""), "{stored}");
}

#[test]
fn laboratory_plays_release_2() {
    let home = Home::new();
    let study = home.0.path().join("study.toml").display().to_string();
    let text = "name = \"generations\"\npolicies = [\"P1b\"]\nscenarios = [\"default\", \"release-2\"]\nseeds = \"1..2\"\n\
                days = 84\n";
    fs::write(&study, text).expect("a file");
    let rows = home.run(&["lab", "study", &study, "--csv"]).stdout;
    assert_eq!(rows.lines().filter(|line| line.contains("release-2")).count(), 2, "{rows}");
    let differs = |command: &[&str]| {
        let [one, other] = [&[][..], &RELEASE_2].map(|options| home.run(&[command, options].concat()));
        assert_eq!((one.exit_code, other.exit_code), (0, 0), "{command:?}: {}{}", one.stderr, other.stderr);
        assert_ne!(one.stdout, other.stdout, "{command:?}");
    };
    let grid = home.0.path().join("grid.toml").display().to_string();
    let text = "name = \"books\"\n\n[[axis]]\nname = \"book\"\n\n[[axis.level]]\nname = \"cheap\"\n\
                set = { rule_based = { price_book = \"cheap\" } }\n";
    fs::write(&grid, text).expect("a file");
    differs(&["lab", "baseline", "--grid", &grid, "--seeds", "1..2", "--days", "119"]);
    differs(&["lab", "forecasts", "--seeds", "1..1", "--only", "P1b"]);
    for command in [&["lab", "consistency", "--until", "63"][..], &["lab", "bound"]] {
        let program_output = home.run(&[command, &RELEASE_2].concat());
        assert_eq!(program_output.exit_code, 0, "{command:?}: {}", program_output.stderr);
    }
    let golden = data_path("golden-r2");
    for command in [
        ["lab", "golden", &golden],
        ["lab", "forecasts", "--only=P0"],
        ["lab", "ablate", "--day=140"],
        ["bench", "--quick", "--only=run"],
    ] {
        home.run(&[&command[..], &["--scenario", "none"]].concat())
            .assert_fails(2, &["there is no scenario none"]);
    }
}
