//! Runs in the formats of programs that study or train agents.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::support::home::{Home, run_id};

const PLAY: &str = r#"set_prices A=12 B=25 C=55
set_prices A=-1
set_usage_quotas {"A": 60000, "B": 250000, "C": 1200000}
set_targeted_ad_spend {"content_marketing": {"S1": 750}}
query SELECT SUM(amount) AS cash FROM ledger
memo Rivals come later. If prices fall, wait.
next "a first price; “quotes” and \\ too" naive
register_script name=cash code="SELECT cash FROM ledger"
post_social_media content="We doubled every quota!"
query SELECT nothing FROM ledger
next "as planned" naive
undo
set_daily_spend operations=120
next "help" naive
"#;

/// Plays a run in plain mode, and returns its ID and its last state hash.
fn played_run(home: &Home) -> (String, String) {
    played_run_with(home, &["--seed", "11", "--days", "28", "--participant", "P01"])
}

fn played_run_with(home: &Home, options: &[&str]) -> (String, String) {
    let program_output = home.play(options, PLAY);
    assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    let folder = home.only_run();
    (run_id(&folder), last_state_hash(&folder))
}

fn last_state_hash(folder: &Path) -> String {
    let text = fs::read_to_string(folder.join("trajectory.jsonl")).expect("a trajectory");
    let mut lines = text.lines().map(|line| serde_json::from_str::<Value>(line).expect("JSON"));
    let last = lines.rfind(|line| line["kind"] == "week").expect("a week");
    last["state_hash"].as_str().expect("a hash").to_owned()
}

fn export(home: &Home, run: &str, format: &str) -> Value {
    let out = home.0.path().join(format!("{format}.json"));
    let program_output =
        home.run(&["runs", "export", run, "--format", format, "--out", &out.to_string_lossy()]);
    assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    serde_json::from_str(&fs::read_to_string(out).expect("a file")).expect("JSON")
}

#[test]
fn exported_script_reaches_the_same_state() {
    check_exported_script(&["--seed", "11", "--days", "28", "--participant", "P01"]);
}

#[test]
fn exported_baseline_script_reaches_the_same_state() {
    check_exported_script(&["--seed", "11", "--mode", "baseline", "--participant", "P01"]);
}

#[test]
fn export_accepts_a_bare_file_name() {
    let home = Home::new();
    let (run, _) = played_run(&home);
    for format in ["archive", "atif"] {
        let mut command = home.program();
        command
            .current_dir(home.0.path())
            .args(["runs", "export", &run, "--format", format, "--out", format]);
        let output = command.output().expect("the program starts");
        assert!(output.status.success(), "{format}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(home.0.path().join(format).is_file(), "{format}");
    }
}

#[track_caller]
fn check_exported_script(options: &[&str]) {
    let home = Home::new();
    let (run, hash) = played_run_with(&home, options);
    let out = home.0.path().join("script");
    let program_output =
        home.run(&["runs", "export", &run, "--format", "script", "--out", &out.to_string_lossy()]);
    assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    let script = fs::read_to_string(out.join("play.txt")).expect("a script");
    let command = script.lines().nth(1).expect("a command");
    let options = command.strip_prefix("# novamind play --plain --strict ").expect(command);
    let options: Vec<&str> = options.trim_end_matches(" < THIS FILE").split(' ').collect();
    let other = Home::new();
    let output = other.play(&[&["--strict"], &*options].concat(), &script);
    assert_eq!(output.exit_code, 0, "{}{}", output.stdout, output.stderr);
    assert_eq!(last_state_hash(&other.only_run()), hash);
    let again = home.run(&["runs", "export", &run, "--format", "script", "--out", &out.to_string_lossy()]);
    again.assert_fails(1, &["play.txt already exists"]);
}

#[test]
fn atif_export_contains_calls_and_responses_only() {
    let home = Home::new();
    let (run, hash) = played_run(&home);
    let value = export(&home, &run, "atif");
    assert_eq!(value["schema_version"], "ATIF-v1.8");
    assert_eq!(
        (&value["agent"]["name"], &value["final_metrics"]["extra"]["state_hash"]),
        (&json!("P01"), &json!(hash))
    );
    let steps = value["steps"].as_array().expect("steps");
    assert!((1..).zip(steps).all(|(number, step)| step["step_id"] == number), "{steps:?}");
    let calls: Vec<(&str, Value)> = steps
        .iter()
        .filter_map(|step| {
            let call = &step["tool_calls"][0];
            let answer = step["observation"]["results"][0]["content"].as_str()?;
            Some((call["function_name"].as_str()?, serde_json::from_str(answer).ok()?))
        })
        .collect();
    let named = |name: &str| {
        calls.iter().filter(|(tool, _)| *tool == name).map(|(_, answer)| answer).collect::<Vec<_>>()
    };
    let prices: Vec<bool> = named("set_prices").iter().map(|answer| answer["success"] == true).collect();
    assert_eq!(prices, [true, false]);
    // The record does not contain the rows of queries. The export queries the rows as of the time of the query.
    assert_eq!(named("query")[0]["rows"][0]["cash"].as_f64(), Some(1e6));
    assert_eq!(named("query")[1]["code"], "sql_error");
    let weeks = named("next_week");
    assert_eq!(
        weeks.iter().map(|week| week["day"].as_u64()).collect::<Vec<_>>(),
        [Some(7), Some(14), Some(21)]
    );
    assert!(weeks.iter().all(|week| week["dashboard"].as_str().is_some_and(|text| text.contains("Cash"))));
    let text = value.to_string();
    assert!(text.contains("If prices fall, wait.") && !text.contains("hidden."), "{text}");
}

#[test]
fn exports_contain_calls_to_unknown_tools() {
    let home = Home::new();
    let lines = "set_wages {\"sales\": 3}\nhlep\nhlep me\nset_prices A=12\nnext naive\n";
    home.play(&["--seed", "11", "--days", "28"], lines);
    let folder = home.only_run();
    let run = run_id(&folder);
    let text = fs::read_to_string(folder.join("trajectory.jsonl")).expect("a trajectory");
    let refused = |line: &Value| line["kind"] == "call" && line["ok"] == false;
    let calls: Vec<Value> =
        text.lines().map(|line| serde_json::from_str(line).expect("JSON")).filter(refused).collect();
    // An unknown word without arguments is a typing error and not a tool call.
    assert_eq!(calls.len(), 1, "{calls:?}");
    assert_eq!((&calls[0]["tool"], &calls[0]["args"]), (&json!("set_wages"), &json!({ "sales": 3 })));
    assert_eq!(calls[0]["refusal"]["code"], "unknown_tool");
    for format in ["atif", "inspect"] {
        let exported = export(&home, &run, format).to_string();
        assert!(exported.contains("set_wages") && exported.contains("unknown_tool"), "{format}");
    }
    let out = |name: &str| home.0.path().join(name).to_string_lossy().into_owned();
    let done = |words: &[&str]| {
        let program_output = home.run(words);
        assert_eq!(
            program_output.exit_code, 0,
            "{words:?}: {}{}",
            program_output.stdout, program_output.stderr
        );
        program_output.stdout
    };
    done(&["runs", "export", &run, "--format", "script", "--out", &out("script")]);
    for file in ["play.txt", "play.py"] {
        let script = fs::read_to_string(Path::new(&out("script")).join(file)).expect("a script");
        assert!(script.contains("# refused (unknown_tool): \"set_wages\" {\"sales\":3}\n"), "{script}");
    }
    done(&["runs", "export", "--all", "--out", &out("tables")]);
    let events = fs::read_to_string(Path::new(&out("tables")).join("events.csv")).expect("a table");
    assert!(events.lines().any(|row| row.contains("set_wages") && row.contains("unknown_tool")), "{events}");
    done(&["replay", &run, "--verify"]);
    done(&["report", &run]);
    done(&["lab", "behaviour", &run, "--json"]);
    done(&["runs", "show", &run, "--json"]);
}

#[test]
fn evaluation_log_has_a_sample_with_every_message() {
    let home = Home::new();
    let (run, _) = played_run(&home);
    let log = export(&home, &run, "inspect");
    let sample = &log["samples"][0];
    assert_eq!((&log["version"], &sample["id"]), (&json!(2), &json!(run)));
    let messages = sample["messages"].as_array().expect("messages");
    let roles = |role: &str| messages.iter().filter(|message| message["role"] == role).count();
    assert_eq!((roles("system"), roles("user")), (1, 1));
    let called = messages.iter().filter(|message| message["tool_calls"].is_array()).count();
    assert!(called > 8 && roles("tool") == called, "{called}");
    // Inspect builds message tables from the model events, so each message must be in one model event.
    let events = sample["events"].as_array().expect("events");
    let model_events = events.iter().filter(|event| event["event"] == "model");
    let event_messages: Vec<&Value> = model_events
        .flat_map(|event| {
            let choices = event["output"]["choices"].as_array().expect("choices");
            event["input"]
                .as_array()
                .expect("input")
                .iter()
                .chain(choices.iter().map(|choice| &choice["message"]))
        })
        .collect();
    assert_eq!(event_messages, messages.iter().collect::<Vec<_>>());
    let ids: std::collections::BTreeSet<&str> =
        messages.iter().filter_map(|message| message["id"].as_str()).collect();
    assert!(ids.len() == messages.len() && ids.iter().all(|id| id.starts_with(&run)), "{ids:?}");
}

/// Returns the output of `runs show` and the Inspect log of an unfinished, an abandoned, a finished and a bankrupt run.
fn shown_runs_and_inspect_logs(home: &Home) -> Vec<(Value, Value)> {
    played_run(home);
    assert_eq!(home.play(&["--seed", "12", "--days", "28"], "next naive\n").exit_code, 0);
    assert_eq!(home.run(&["runs", "end", "latest"]).exit_code, 0);
    for options in [&["--days", "14"][..], &["--days", "14", "--cash", "500"]] {
        let program_output =
            home.run(&[&["run", "--policy", "P0", "--seed", "3", "--save"], options].concat());
        assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    }
    let list: Value = serde_json::from_str(&home.run(&["runs", "list", "--json"]).stdout).expect("JSON");
    let logs = home.0.path().join("logs");
    let of_run = |run: &Value| {
        let id = run["id"].as_str().expect("a name");
        let output = home.run(&["runs", "show", id, "--json"]);
        let exported =
            home.run(&["runs", "export", id, "--format", "inspect", "--out", &logs.to_string_lossy()]);
        assert_eq!((output.exit_code, exported.exit_code), (0, 0), "{}{}", output.stderr, exported.stderr);
        let moment = run["created"].as_str().expect("a moment")[..19].replace(':', "-");
        let file = logs.join(format!("{moment}-00-00_novamind_{id}.json"));
        let log = fs::read_to_string(file).expect("a log");
        let parsed = [output.stdout, log].map(|text| serde_json::from_str(&text).expect("JSON"));
        parsed.into()
    };
    list.as_array().expect("runs").iter().map(of_run).collect()
}

#[test]
fn score_is_consistent_everywhere() {
    let home = Home::new();
    let mut seen = Vec::new();
    for (shown, log) in shown_runs_and_inspect_logs(&home) {
        let cash = shown["cash"].clone();
        let (status, score) = match shown["ended"].as_str() {
            None => ("started", None),
            Some("horizon") => ("success", Some(cash)),
            Some("bankruptcy") => ("success", Some(json!(0.0))),
            Some("abandoned") => ("cancelled", None),
            Some(other) => panic!("{other}"),
        };
        seen.push(shown["ended"].clone());
        let folder = home.runs().join(shown["id"].as_str().expect("a name"));
        assert_eq!(
            (&shown["score"], &shown["state_hash"]),
            (&json!(score), &json!(last_state_hash(&folder)))
        );
        let sample = log["samples"][0]["scores"]["cash"]["value"].clone();
        let result = log["results"]["scores"][0]["metrics"]["value"]["value"].clone();
        assert_eq!((&log["status"], &sample, &result), (&json!(status), &json!(score), &json!(score)));
    }
    seen.sort_by_key(Value::to_string);
    assert_eq!(seen, [json!("abandoned"), json!("bankruptcy"), json!("horizon"), Value::Null]);
}

#[test]
fn inspect_export_rejects_eval_file() {
    let home = Home::new();
    let (run, _) = played_run(&home);
    let out = home.0.path().join("log.eval").to_string_lossy().into_owned();
    home.run(&["runs", "export", &run, "--format", "inspect", "--out", &out])
        .assert_fails(2, &["log.eval", ".json", "folder"]);
}

#[test]
fn imported_evaluation_log_reaches_the_same_state() {
    let home = Home::new();
    let (run, hash) = played_run(&home);
    export(&home, &run, "inspect");
    let file = home.0.path().join("inspect.json");
    let other = Home::new();
    let program_output = other.run(&["runs", "import", "--transcript", &file.to_string_lossy()]);
    assert_eq!(program_output.exit_code, 0, "{}{}", program_output.stdout, program_output.stderr);
    assert!(program_output.stdout.contains(&hash), "{}", program_output.stdout);
}

/// `tests/data/inspect.eval` was written by Inspect 0.3.285. It contains four calls of NovaMind tools, one of which
/// was rejected, and a call to an unrelated tool.
#[test]
fn inspect_archive_is_imported() {
    let home = Home::new();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/inspect.eval");
    let program_output =
        home.run(&["runs", "import", "--transcript", &file.to_string_lossy(), "--days", "28"]);
    assert_eq!(program_output.exit_code, 0, "{}{}", program_output.stdout, program_output.stderr);
    assert!(program_output.stdout.contains(": 4 calls, day 7,"), "{}", program_output.stdout);
    let manifest = fs::read_to_string(home.only_run().join("run.toml")).expect("a manifest");
    assert!(
        manifest.contains("seed = 9") && manifest.contains("participant = \"mockllm/model\""),
        "{manifest}"
    );
    home.run(&["runs", "import", &file.to_string_lossy()]).assert_fails(2, &["inspect.eval", "--transcript"]);
    let baseline = ["--mode", "baseline", "--participant", "P01"];
    let file = file.to_string_lossy();
    home.run(&[&["runs", "import", "--transcript", &*file], &baseline[..]].concat())
        .assert_fails(2, &["not a baseline run", "Nothing was imported"]);
    let bytes = fs::read(&*file).expect("an archive");
    let cut = home.0.path().join("cut.eval");
    fs::write(&cut, &bytes[..bytes.len() - 30]).expect("a file");
    home.run(&["runs", "import", "--transcript", &cut.to_string_lossy(), "--seed", "3"])
        .assert_fails(1, &["truncated"]);
}

#[test]
fn imported_atif_trajectory_reaches_the_same_state() {
    let home = Home::new();
    let (run, hash) = played_run(&home);
    export(&home, &run, "atif");
    let file = home.0.path().join("atif.json");
    let other = Home::new();
    let program_output = other.run(&["runs", "import", "--transcript", &file.to_string_lossy()]);
    assert_eq!(program_output.exit_code, 0, "{}{}", program_output.stdout, program_output.stderr);
    assert!(program_output.stdout.contains(&hash), "{}", program_output.stdout);
    let folder = other.only_run();
    assert_eq!(last_state_hash(&folder), hash);
    let manifest = fs::read_to_string(folder.join("run.toml")).expect("a manifest");
    assert!(
        manifest.contains("participant = \"P01\"") && manifest.contains("mode = \"sandbox\""),
        "{manifest}"
    );
    assert_eq!(other.run(&["replay", "latest", "--verify"]).exit_code, 0);
    // With a different seed, the results differ from the imported log, and the import reports the difference.
    let output = other.run(&["runs", "import", "--transcript", &file.to_string_lossy(), "--seed", "12"]);
    output.assert_fails(1, &["the final state differs"]);
    let lines = other.0.path().join("calls.jsonl");
    fs::write(&lines, "{\"tool\": \"set_prices\", \"args\": {\"A\": 12}, \"success\": false}\n")
        .expect("a file");
    let lines = lines.to_string_lossy().into_owned();
    other.run(&["runs", "import", "--transcript", &lines]).assert_fails(2, &["--seed"]);
    other
        .run(&["runs", "import", "--transcript", &lines, "--seed", "3"])
        .assert_fails(1, &["differs from the transcript"]);
    other.run(&["runs", "import", "--transcript", "nothing.json"]).assert_fails(1, &["nothing.json"]);
    if cfg!(unix) {
        // A device without an end: reading it would use all memory.
        let import = ["runs", "import", "--transcript", "/dev/zero", "--seed", "3"];
        other.run(&import).assert_fails(1, &["not a regular file"]);
    }
    other.run(&["runs", "import", "--seed", "3", "run.nmrun"]).assert_fails(2, &["--transcript"]);
}

#[test]
fn terminal_recording_of_a_replay_contains_every_week() {
    let home = Home::new();
    let (run, _) = played_run(&home);
    let file = home.0.path().join("talk.cast");
    let file = file.to_string_lossy().into_owned();
    let program_output =
        home.run(&["replay", &run, "--cast", &file, "--week", "2..3", "--speed", "2", "--size", "80x24"]);
    assert_eq!(program_output.exit_code, 0, "{}{}", program_output.stdout, program_output.stderr);
    let lines: Vec<Value> = fs::read_to_string(&file)
        .expect("a recording")
        .lines()
        .map(|line| serde_json::from_str(line).expect("JSON"))
        .collect();
    assert_eq!(
        (&lines[0]["version"], &lines[0]["width"], &lines[0]["height"]),
        (&json!(2), &json!(80), &json!(24))
    );
    let times: Vec<f64> = lines[1..].iter().map(|line| line[0].as_f64().expect("a time")).collect();
    assert!(times.is_sorted() && times.len() > 6, "{times:?}");
    let side = |length| std::num::NonZero::new(length).expect("a side");
    let mut screen = vt100::Parser::new(side(24), side(80), 0);
    let mut seen = Vec::new();
    for line in &lines[1..] {
        screen.process(line[2].as_str().expect("output").as_bytes());
        seen.push(screen.screen().contents());
    }
    let at = |part: &str| seen.iter().position(|text| text.contains(part));
    let [first, last] =
        ["day 7", "day 21"].map(|part| at(part).unwrap_or_else(|| panic!("{part}: {seen:#?}")));
    assert!(first < last && last + 3 >= seen.len(), "{first} {last} of {}", seen.len());
    home.run(&["replay", &run, "--cast", &file, "--week", "9"])
        .assert_fails(2, &["week 9 is not in the record"]);
    let rejection = home.run(&["replay", &run, "--cast", &file, "--week", "3..2"]);
    assert!(rejection.exit_code == 2 && rejection.stderr.contains("20..24"), "{}", rejection.stderr);
    home.run(&["replay", &run, "--cast", "/nowhere/talk.cast"]).assert_fails(1, &["/nowhere/talk.cast"]);
}
