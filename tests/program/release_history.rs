//! Import of histories of release 2.

use std::fs;

use serde_json::{Map, Value, json};

use crate::support::home::Home;

const PLAY: &str = r#"set_prices A=12 B=25 C=55
set_prices A=-1
set_usage_quotas {"A": 60000, "B": 250000, "C": 1200000}
set_targeted_ad_spend {"content_marketing": {"S1": 750}}
next "a first price" naive
research_market
post_social_media content="We doubled every quota!"
next "as planned" naive
set_daily_spend operations=120
next "help" naive
"#;

/// Plays a run of release 2, and returns its calls and weeks as a history, and its last state hash.
fn history_of_run() -> (String, String) {
    let home = Home::new();
    let options = ["--seed", "11", "--days", "28", "--scenario", "release-2"];
    assert_eq!(home.play(&options, PLAY).exit_code, 0);
    let text = fs::read_to_string(home.only_run().join("trajectory.jsonl")).expect("a trajectory");
    let (mut history, mut hash) = (String::new(), String::new());
    for line in text.lines().map(|line| serde_json::from_str::<Value>(line).expect("JSON")) {
        let day = line["day"].as_u64().expect("a day");
        let (operation, input, after) = match line["kind"].as_str() {
            Some("call") => {
                (format!("call:{}", line["tool"].as_str().expect("a tool")), line["args"].clone(), day)
            }
            Some("advance") => ("next-week".to_owned(), week_input(&line), day + 7),
            Some("week") => {
                hash = line["state_hash"].as_str().expect("a hash").to_owned();
                continue;
            }
            _ => continue,
        };
        let entry = json!({
            "type": "mutation", "request_id": format!("line {}", line["seq"]), "operation": operation,
            "input": input, "day_before": day, "day": after, "started_at": 1.5, "timestamp": 2.5,
            "outcome": "completed", "success": line["ok"] != false,
        });
        history += &format!("{entry}\n");
    }
    (history, hash)
}

fn week_input(line: &Value) -> Value {
    let keys = ["cash_1wk", "cash_4wk", "cash_12wk", "cash_26wk"];
    let filed = line["forecasts"].as_array().expect("forecasts");
    let values =
        |filed: &Value| json!({ "point": filed["point"], "lower": filed["lower"], "upper": filed["upper"] });
    let predictions: Map<String, Value> =
        keys.iter().zip(filed).map(|(key, filed)| ((*key).to_owned(), values(filed))).collect();
    json!({ "predictions": predictions, "rationale": line["rationale"] })
}

#[test]
fn imported_history_reaches_the_same_state_with_the_same_draws() {
    let (history, hash) = history_of_run();
    let home = Home::new();
    let file = home.0.path().join("history.jsonl");
    fs::write(&file, &history).expect("a file");
    let file = file.to_string_lossy().into_owned();
    let import = |options: &[&str]| home.run(&[&["runs", "import", "--transcript", &file], options].concat());
    let output = import(&["--seed", "11", "--days", "28"]);
    assert_eq!(output.exit_code, 0, "{}", output.stderr);
    assert!(output.stdout.contains("day 21, cash $") && output.stdout.contains(&hash), "{}", output.stdout);
    for line in
        ["entries: 10", "executed: 10", "successful in the released simulator: 0", "released simulator: 0"]
    {
        assert!(output.stdout.contains(line), "{line}: {}", output.stdout);
    }
    assert!(output.stdout.contains("random draws differ"), "{}", output.stdout);
    let folder = home.only_run();
    let manifest = fs::read_to_string(folder.join("run.toml")).expect("a manifest");
    for line in ["scenario = \"release-2\"", "mode = \"sandbox\"", "participant = \"imported history\""] {
        assert!(manifest.contains(line), "{line}: {manifest}");
    }
    let text = fs::read_to_string(folder.join("trajectory.jsonl")).expect("a trajectory");
    let lines: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let requests: Vec<&Value> = lines.iter().filter(|line| line.get("via").is_some()).collect();
    assert_eq!(requests.len(), 10);
    for line in requests {
        assert_eq!(line["via"], "import");
        let has_id = line["request_id"].as_str().is_some_and(|id| id.starts_with("line "));
        assert!(has_id, "{line}");
    }
    assert_eq!(home.run(&["replay", "latest", "--verify"]).exit_code, 0);
}

#[test]
fn import_with_other_draws_lists_different_outcomes() {
    let (history, hash) = history_of_run();
    let home = Home::new();
    let file = home.0.path().join("history.jsonl");
    let history = history.replacen("\"success\":false", "\"success\":true", 1);
    fs::write(&file, history + "{\"type\": \"mut").expect("a file");
    let options = ["--transcript", &file.to_string_lossy(), "--seed", "12", "--days", "16", "--json"];
    let output = home.run(&[&["runs", "import"], options.as_slice()].concat());
    assert_eq!(output.exit_code, 0, "{}", output.stderr);
    let summary = output.json_lines().remove(0);
    assert_eq!(
        [&summary["entries"], &summary["executed"], &summary["day"]],
        [&json!(11), &json!(10), &json!(16)]
    );
    assert_eq!(summary["skipped"], json!([{ "line": 11, "reason": "the line is incomplete" }]));
    assert_eq!(summary["rejected_here"][0]["line"], 2);
    assert_eq!(summary["different_days"], json!([{ "line": 10, "reason": "day 16 here, day 21 there" }]));
    assert_ne!(summary["state_hash"], json!(hash));
}

#[test]
fn rejected_history_leaves_no_run() {
    let (history, _) = history_of_run();
    let home = Home::new();
    let file = home.0.path().join("history.jsonl").to_string_lossy().into_owned();
    let import = |text: &str, options: &[&str]| {
        fs::write(&file, text).expect("a file");
        home.run(&[&["runs", "import", "--transcript", &file], options].concat())
    };
    let lines: Vec<&str> = history.lines().collect();
    let swapped = [lines[5], lines[4]].join("\n");
    import(&swapped, &["--seed", "1"]).assert_fails(1, &["history.jsonl", "line 1", "Nothing was imported"]);
    let broken = format!("{}\nNaN\n{}\n", lines[0], lines[1]);
    import(&broken, &["--seed", "1"]).assert_fails(1, &["line 2", "Nothing was imported"]);
    let older = "{\"type\":\"next_week\",\"day\":7}\n{\"type\":\"next_week\",\"day\":14}\n";
    import(older, &["--seed", "1"]).assert_fails(1, &["line 1", "older clients", "Nothing was imported"]);
    import(&history, &[]).assert_fails(2, &["--seed", "Nothing was imported"]);
    for mode in ["baseline", "debug"] {
        let options = ["--seed", "1", "--mode", mode];
        assert_ne!(import(&history, &options).exit_code, 0, "{mode}");
    }
    assert_eq!(fs::read_dir(home.runs()).expect("a folder").count(), 0);
}
