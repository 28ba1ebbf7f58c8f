//! The data folder of the trajectory viewer.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::support::home::{Home, run_id};

const PLAY: &str = r#"set_prices A=12 B=25 C=55
set_prices A=-1
set_usage_quotas {"A": 60000, "B": 250000, "C": 1200000}
set_targeted_ad_spend {"content_marketing": {"S1": 750}}
query SELECT SUM(amount) AS cash FROM ledger
memo Rivals come later.
next "a first price; <b>“quotes”</b>" naive
register_script name=cash code="SELECT 1"
wage_war now=1
memo If prices fall, wait.
next "as planned" naive
next "help" naive
"#;

fn data(home: &Home) -> PathBuf {
    home.0.path().join("data")
}

/// Exports a run and returns its file.
#[track_caller]
fn export(home: &Home, run: &str) -> Value {
    let out = data(home).to_string_lossy().into_owned();
    let output = home.run(&["runs", "export", run, "--format", "viewer", "--out", &out]);
    assert_eq!(output.exit_code, 0, "{}", output.stderr);
    read_json(&data(home).join("runs").join(format!("{run}.json")))
}

fn read_json(file: &Path) -> Value {
    let text = fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    serde_json::from_str(&text).expect("JSON")
}

fn manifest(home: &Home) -> Value {
    read_json(&data(home).join("runs/manifest.json"))
}

/// Returns a column of a series as numbers, by day.
fn by_day(series: &Value, column: &str) -> BTreeMap<u64, f64> {
    let points = series.as_array().expect("a series").iter();
    points
        .map(|point| (point["day"].as_u64().expect("a day"), point[column].as_f64().expect(column)))
        .collect()
}

/// Asserts that every file that the viewer reads exists, and that the sums over groups equal the totals.
#[track_caller]
fn check_export(home: &Home, run: &Value) {
    let id = run["run_id"].as_str().expect("an id");
    for row in run["weeks_index"].as_array().expect("weeks") {
        let week = read_json(&data(home).join(format!("runs/{id}/week_{}.json", row["week"])));
        assert_eq!([&week["week"], &week["day"], &week["hash"]], [&row["week"], &row["day"], &row["hash"]]);
        assert_eq!(Some(week["files"].as_array().expect("files").len() as u64), row["file_count"].as_u64());
        assert!(run["days"][row["day"].to_string()]["actions"].is_array(), "{row}");
    }
    let days: Vec<String> = run["days_list"].as_array().expect("days").iter().map(Value::to_string).collect();
    let days_with_actions = run["days"].as_object().expect("days");
    assert_eq!(days_with_actions.len(), days.len());
    assert!(days.iter().all(|day| days_with_actions.contains_key(day)), "{days:?}");
    let mut groups: BTreeMap<u64, f64> = BTreeMap::new();
    for point in run["seat_series_by_group"].as_array().expect("a series") {
        *groups.entry(point["day"].as_u64().expect("a day")).or_default() +=
            point["count"].as_f64().expect("seats");
    }
    let (individuals, enterprises) =
        (by_day(&run["seat_series"], "individual"), by_day(&run["seat_series"], "enterprise_seats"));
    for (day, seats) in &individuals {
        assert_eq!(groups.get(day).copied().unwrap_or_default(), seats + enterprises[day], "day {day}");
    }
    assert_eq!(by_day(&run["sub_series"], "subscribers"), individuals);
    let cash: Vec<u64> = by_day(&run["cash_series"], "cash").into_keys().collect();
    assert_eq!(cash, (0..=run["current_day"].as_u64().expect("a day")).collect::<Vec<_>>());
    let models = manifest(home);
    let listed =
        models["models"].as_array().expect("models").iter().flat_map(|model| model["runs"].as_array());
    let entry = listed.flatten().find(|entry| entry["run_id"] == run["run_id"]).expect("an entry").clone();
    for (key, value) in entry.as_object().expect("an entry") {
        assert_eq!(value, &run[key], "{key}");
    }
}

#[test]
fn viewer_export_contains_the_actions_of_every_day() {
    let home = Home::new();
    assert_eq!(home.play(&["--seed", "11", "--days", "28", "--participant", "P<1>"], PLAY).exit_code, 0);
    let folder = home.only_run();
    let run = export(&home, &run_id(&folder));
    check_export(&home, &run);
    let tools = |day: &str| -> Vec<String> {
        let actions = run["days"][day]["actions"].as_array().expect("actions").iter();
        actions.map(|action| action["tool"].as_str().expect("a tool").to_owned()).collect()
    };
    assert_eq!(
        tools("0"),
        [
            "_dashboard",
            "set_prices",
            "set_prices",
            "set_usage_quotas",
            "set_targeted_ad_spend",
            "query",
            "write_file",
            "next_week"
        ]
    );
    assert_eq!(
        tools("7"),
        ["_dashboard", "register_script", "unknown tool wage_war", "write_file", "next_week"]
    );
    assert_eq!(
        (tools("14"), tools("21")),
        (vec!["_dashboard".into(), "next_week".into()], vec!["_dashboard".into()])
    );
    assert_eq!((&run["action_count"], &run["days_list"]), (&json!(12), &json!([0, 7, 14, 21])));
    let results = |at: usize| run["days"]["0"]["actions"][at]["result"].as_str().expect("a result");
    assert!(results(1).contains("\"updated\"") && results(2).starts_with("rejected ("), "{}", results(2));
    assert!(results(5).contains("1000000"), "{}", results(5));
    assert_eq!(run["days"]["0"]["rationale"], "a first price; <b>“quotes”</b>");
    assert_eq!(run["days"]["21"].get("rationale"), None);
    assert_eq!((&run["status"], &run["dnf"], &run["bankrupt"]), (&json!("dnf"), &json!(true), &json!(false)));
    assert_eq!((&run["model"], &run["interface"]), (&json!("P<1>"), &json!("release_1")));
    let trajectory = fs::read_to_string(folder.join("trajectory.jsonl")).expect("a trajectory");
    let lines = trajectory.lines().map(|line| serde_json::from_str::<Value>(line).expect("JSON"));
    let weeks: Vec<Value> = lines.filter(|line| line["kind"] == "week").collect();
    let (cash, subscribers) =
        (by_day(&run["cash_series"], "cash"), by_day(&run["sub_series"], "subscribers"));
    assert_eq!((weeks.len(), subscribers.len(), subscribers[&0]), (3, 4, 0.0));
    for week in &weeks {
        let day = week["day"].as_u64().expect("a day");
        assert_eq!(Some(cash[&day]), week["cash"].as_f64());
        assert_eq!(Some(subscribers[&day]), week["figures"]["individual_subscribers"].as_f64());
    }
    assert!(subscribers[&21] > 0.0);
    let files =
        read_json(&data(&home).join(format!("runs/{}/week_2.json", run_id(&folder))))["files"].clone();
    let named =
        |path: &str| files.as_array().expect("files").iter().find(|file| file["path"] == path).cloned();
    let notes = named("notes.md").expect("notes");
    assert!(notes["diff"].as_str().is_some_and(|diff| diff.contains("+If prices fall, wait.")), "{notes}");
    assert_eq!(named("scripts/cash").expect("a script")["content"], "SELECT 1");
    assert!(named("forecasts/week_2.json").is_some());
}

#[test]
fn viewer_export_agrees_with_the_figures_of_finished_runs() {
    let home = Home::new();
    for options in [
        ["--policy", "enterprise-led", "--seed", "3", "--days", "63"].as_slice(),
        &["--policy", "P0", "--seed", "3", "--days", "28", "--cash", "500"],
    ] {
        assert_eq!(home.run(&[&["run", "--save"], options].concat()).exit_code, 0);
    }
    let list: Value = serde_json::from_str(&home.run(&["runs", "list", "--json"]).stdout).expect("JSON");
    for listed in list.as_array().expect("runs") {
        let id = listed["id"].as_str().expect("an id");
        let run = export(&home, id);
        check_export(&home, &run);
        let bankrupt = listed["ended"] == "bankruptcy";
        let status = if bankrupt { "bankrupt" } else { "complete" };
        assert_eq!([&run["status"], &run["bankrupt"]], [&json!(status), &json!(bankrupt)]);
        assert_eq!(run["survival_days"], listed["day"]);
        assert_eq!(run["cash"].as_f64(), listed["cash"].as_f64());
        let metrics = home.run(&["lab", "metrics", id]).stdout;
        let figure = |name: &str| -> BTreeMap<u64, f64> {
            let rows = metrics.lines().map(|row| row.split(',').collect::<Vec<_>>());
            let rows = rows.filter(|row| row[2] == name && row[3].is_empty());
            rows.map(|row| (row[1].parse().expect("a day"), row[4].parse().expect("a value"))).collect()
        };
        let (cash, people) = (figure("cash"), figure("individual_subs"));
        let exported = by_day(&run["cash_series"], "cash");
        assert!(exported.iter().skip(1).all(|(day, value)| cash[day] == *value), "{cash:?} {exported:?}");
        let subscribers = by_day(&run["sub_series"], "subscribers");
        assert!(subscribers.iter().skip(1).all(|(day, value)| people[day] == *value), "{subscribers:?}");
        let seats = by_day(&run["seat_series"], "enterprise_seats").into_values().fold(0.0, f64::max);
        assert_eq!(seats > 0.0, !bankrupt, "{seats}");
    }
    let models = manifest(&home)["models"].as_array().expect("models").len();
    assert_eq!(models, 2);
}

#[test]
fn viewer_export_replaces_nothing() {
    let home = Home::new();
    let run = run_id(&home.play_two_weeks());
    let out = data(&home).to_string_lossy().into_owned();
    let again = || home.run(&["runs", "export", &run, "--format", "viewer", "--out", &out]);
    let file = data(&home).join("runs/manifest.json");
    fs::create_dir_all(data(&home).join("runs")).expect("a folder");
    for (text, problem) in
        [("{", "not valid JSON"), ("{}", "no list of models"), ("{\"models\":[{}]}", "no list of models")]
    {
        fs::write(&file, text).expect("a file");
        again().assert_fails(1, &["manifest.json", problem, "Nothing was written"]);
        assert_eq!(fs::read_to_string(&file).expect("a file"), text);
        assert_eq!(fs::read_dir(data(&home).join("runs")).expect("a folder").count(), 1);
    }
    let other =
        json!({ "models": [{ "model": "m", "model_display": "M", "runs": [{ "run_id": "other" }] }] });
    fs::write(&file, other.to_string()).expect("a file");
    assert_eq!(again().exit_code, 0);
    let models = manifest(&home)["models"].clone();
    assert_eq!((&models[0], &models[1]["runs"][0]["run_id"]), (&other["models"][0], &json!(run)));
    again().assert_fails(1, &[&format!("{run}.json already exists")]);
}
