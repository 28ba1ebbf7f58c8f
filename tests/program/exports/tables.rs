//! The tables of a study: their texts are escaped, and an independent script computes the same figures.

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use novamind::record::folder::configuration::Configuration;
use novamind::record::trajectory::record::{
    Activity, Clock, ClockEvent, DetachCause, DialogOutcome, DialogStep, DialogUse, HelpRequest, LimitScope,
    ObjectSelection, PresenceEvent, QuestionAnswer, QuestionShown, TextEdit, TextEditOutcome, Via,
};
use novamind::session::{Access, Interface, NewRun, Session, Storage};

use super::{played_run, read_table, run_folders, text};
use crate::support::home::{Home, run_id};
use crate::support::python::recompute_measures;

/// Commands that play a run of four weeks to its end, with many events that the measures count.
const FOUR_WEEKS: &str = "set_prices A=12 B=25 C=55
set_usage_quotas A=60000 B=250000 C=1200000
set_model_tiers B=2 C=4
set_daily_spend development=1000
set_targeted_dev_spend {\"S1\": 500}
set_targeted_ad_spend {\"content_marketing\": {\"S1\": 750, \"S2\": 200}, \"linkedin\": {\"S1\": 100}}
get_cost_info
memo If leads are dear, we plan to stop
next \"If it goes well, we wait; otherwise we should stop\" naive
set_daily_spend development=0
undo
redo
sql SELECT count(*) FROM ledger
sql SELECT nothing FROM nowhere
set_prices A=-1
next \"as planned\" 900000 800000 1000000 800000 700000 1000000 700000 1 2000000 1 0 2
next \"likely fine\" naive
memo =HYPERLINK(\"http://x\")
next \"because\" naive
";

/// Texts that a spreadsheet or a terminal would interpret as a formula or a control sequence.
const HOSTILE: &[&str] = &["=1+1", "+1+cmd", "-1+cmd", "@SUM(A1)", "\u{1b}[31mred", "\u{202e}evil", "\t=1"];

fn export(home: &Home) -> std::path::PathBuf {
    let out = home.0.path().join("study");
    let program_output = home.run(&["runs", "export", "--all", "--out", &text(&out)]);
    assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    out
}

/// Plays a run with every kind of activity line. The player leaves and returns.
fn play_run_with_all_activity_lines(home: &Home) {
    let storage = Storage::Runs(home.runs());
    let new = NewRun {
        days: Some(14),
        seed: Some(9),
        storage,
        participant: Some("P 3".to_owned()),
        ..NewRun::default()
    };
    let mut run = Session::create(new, &Configuration::bundled()).expect("a run");
    let folder = run.folder().expect("a folder").to_owned();
    let wait = || std::thread::sleep(Duration::from_millis(12));
    let console = Interface { name: "console", window: Some((120, 40)) };
    for week in 0..2 {
        run.activity().attach(console);
        wait();
        run.activity().record_view("overview", "", 11);
        run.activity().record(Activity::Question(QuestionShown {
            questionnaire: "mood".to_owned(),
            occasion: format!("week {week}"),
            id: "q1".to_owned(),
            text: "How are you?".to_owned(),
            form: "choice".to_owned(),
            options: vec!["well".to_owned(), "=badly".to_owned()],
        }));
        wait();
        if week == 1 {
            run.activity().record(Activity::Answer(QuestionAnswer {
                questionnaire: "mood".to_owned(),
                occasion: format!("week {week}"),
                id: "q1".to_owned(),
                value: serde_json::json!(["well", "=badly"]),
                as_expected: Some(true),
                for_ms: 12,
                changes: 1,
            }));
        }
        run.activity().record_presence(PresenceEvent::FocusLost, None, None);
        wait();
        run.activity().record_presence(PresenceEvent::FocusGained, None, None);
        let select = ObjectSelection {
            screen: "customers".to_owned(),
            what: "group".to_owned(),
            which: "S2".to_owned(),
        };
        run.activity().record(Activity::Select(select));
        run.activity()
            .record(Activity::Help(HelpRequest { term: "churn".to_owned(), place: "customers".to_owned() }));
        wait();
        run.activity().record_presence(PresenceEvent::Idle, Some(9), None);
        wait();
        run.activity().record_presence(PresenceEvent::Active, None, None);
        for event in [ClockEvent::Stopped, ClockEvent::Started] {
            run.activity().record(Activity::Clock(Clock { event, reason: None, stood_ms: None }));
            wait();
        }
        for outcome in [TextEditOutcome::Sent, TextEditOutcome::Left] {
            run.activity().record(Activity::Draft(TextEdit {
                place: "rationale".to_owned(),
                outcome,
                length: 20,
                typed: 11,
                deleted: 2,
                pasted: 11,
                pauses: 1,
                for_ms: 900,
                text: None,
            }));
        }
        for outcome in [DialogOutcome::Confirmed, DialogOutcome::Cancelled] {
            let steps = vec![DialogStep { step: "review".to_owned(), for_ms: 5 }];
            run.activity().record(Activity::Dialog(DialogUse {
                what: "next week".to_owned(),
                outcome,
                for_ms: 9,
                steps,
            }));
        }
        let spent = run.log().time_spent(LimitScope::Week);
        assert!(spent.active_ms() >= 12 && spent.idle_seconds() > 0.009, "{spent:?}");
        run.set_notes("if S2 grows,\nwe should follow").expect("notes");
        run.activity().record_view("cash", "overview", 40);
        let forecasts = run.company().naive_forecasts();
        run.advance("until then", &forecasts, Via::Form, &mut |_| {}).expect("a week");
        run.activity().detach(DetachCause::Quit);
        drop(run);
        run = Session::open(&folder, Access::Write, true).expect("it opens");
    }
    // The player views the final page and closes the run.
    run.activity().attach(console);
    wait();
    run.activity().record_view("cash", "overview", 11);
    run.activity().record_presence(PresenceEvent::FocusLost, None, None);
    wait();
    run.set_notes("afterwards").expect("notes");
}

#[test]
fn independent_script_reproduces_every_measure() {
    let home = Home::new();
    let program_output = home.play(&["--days", "28", "--seed", "7"], FOUR_WEEKS);
    assert_eq!(program_output.exit_code, 0, "{}{}", program_output.stdout, program_output.stderr);
    played_run(&home, "P01");
    play_run_with_all_activity_lines(&home);
    let out = export(&home);
    let runs = read_table(&out.join("runs.csv"));
    let over = runs.iter().find(|row| row["ended"] == "horizon").expect("a run that is over");
    let person = runs.iter().find(|row| row["participant"] == "P 3").expect("a run that was watched");
    for (column, value) in [
        ("sittings", "2"),
        ("sittings_not_closed", "0"),
        ("clock_stopped", "2"),
        ("pasted_characters", "44"),
        ("selects", "2"),
        ("dialogs_cancelled", "2"),
        ("note_versions", "2"),
        ("note_if_words", "1"),
    ] {
        assert_eq!(person[column], value, "{column}");
    }
    for column in
        ["idle_seconds", "away_seconds", "paused_seconds", "active_seconds", "active_seconds_after_end"]
    {
        assert!(person[column].parse::<f64>().expect("a number") > 0.0, "{column}");
    }
    let answers = read_table(&out.join("answers.csv"));
    assert_eq!([&*answers[0]["answered"], &*answers[1]["value"]], ["0", "well\n=badly"]);
    for column in
        ["truly_best_channel_share", "channels_tried", "targeted_development_share", "tool_evenness"]
    {
        assert!(!over[column].is_empty(), "{column}");
    }
    let Some((output, code)) = recompute_measures(&out) else { return };
    assert!(code == Some(0) && output.contains("3 runs") && output.contains(" 0 differences"), "{output}");
    // A changed figure in the exported table must be detected by the comparison.
    let weeks = out.join("weeks.csv");
    let changed =
        std::fs::read_to_string(&weeks).expect("a table").replacen("set_prices=1", "set_prices=2", 1);
    std::fs::write(&weeks, changed).expect("a change");
    let (output, code) = recompute_measures(&out).expect("it ran before");
    assert!(code == Some(1) && output.contains(" 1 differences"), "{output}");
}

#[test]
fn exported_texts_are_escaped() {
    let home = Home::new();
    let mut lines = String::from("set_prices A=12\n");
    for hostile in HOSTILE {
        lines += &format!("sql {hostile}\nmemo {hostile}\nnext {:?} naive\n", hostile.replace('\t', " "));
    }
    lines += "post_social_media \"=1+1 \u{1b}[31m\u{202e}\"\n";
    let program_output = home.play(&["--days", "70", "--participant", "=cmd|' /C calc'!A0"], &lines);
    let acts = |text: &str| text.contains(['\u{1b}', '\u{202e}']);
    assert!(!acts(&program_output.stdout) && !acts(&program_output.stderr), "{}", program_output.stdout);
    let out = export(&home);
    for name in ["runs", "weeks", "forecasts", "queries", "events", "answers", "notes"] {
        let path = out.join(format!("{name}.csv"));
        assert!(!acts(&std::fs::read_to_string(&path).expect("a table")), "{name}");
        for row in read_table(&path) {
            for (column, cell) in row {
                let begins = cell.trim_start().starts_with(['=', '+', '-', '@']);
                assert!(!begins || cell.parse::<f64>().is_ok(), "{name} {column}: {cell:?}");
            }
        }
    }
    let notes = read_table(&out.join("notes.csv"));
    assert_eq!(notes[0]["text"].trim_end(), "'=1+1");
    assert!(notes.iter().any(|row| row["text"].contains("\\u{1b}[31mred")), "{notes:?}");
    let run = run_id(&run_folders(&home.runs())[0]);
    for arguments in [
        vec!["report", &run],
        vec!["report", &run, "--format", "html"],
        vec!["report", &run, "--session"],
        vec!["report", &run, "--session", "--format", "html"],
        vec!["runs", "list"],
        vec!["runs", "show", &run],
        vec!["replay", &run],
        vec!["lab", "compare", &run],
        vec!["lab", "compare", &run, "--csv"],
        vec!["query", &run, "SELECT content FROM agent_social_media_posts"],
        vec!["query", &run, "SELECT content FROM agent_social_media_posts", "--format", "csv"],
        vec!["query", &run, "SELECT content FROM agent_social_media_posts", "--format", "md"],
    ] {
        let output = home.run(&arguments);
        assert!(!acts(&output.stdout) && !acts(&output.stderr), "{arguments:?}: {}", output.stdout);
        if arguments.contains(&"csv") || arguments.contains(&"--csv") {
            let formula = |line: &str| line.starts_with(['=', '@', '+']) || line.contains(",=");
            assert!(!output.stdout.lines().any(formula), "{arguments:?}: {}", output.stdout);
        }
    }
}

#[test]
fn anonymized_tables_can_be_linked_only_with_the_secret() {
    let home = Home::new();
    play_run_with_all_activity_lines(&home);
    played_run(&home, "Ada Lovelace");
    let out = export(&home);
    let place = |name: &str| text(&home.0.path().join(name));
    let (anonymous, secret) = (place("anonymous"), place("study.secret"));
    let anonymise = |out: &str, more: &[&str]| {
        home.run(
            &[&["study", "anonymise", &place("study"), "--out", out, "--secret", &secret], more].concat(),
        )
    };
    let program_output = anonymise(&anonymous, &[]);
    assert_eq!(program_output.exit_code, 0, "{}{}", program_output.stdout, program_output.stderr);
    let links = read_table(&home.0.path().join("study.links.csv"));
    let runs = read_table(&Path::new(&anonymous).join("runs.csv"));
    let original = read_table(&out.join("runs.csv"));
    assert_eq!((links.len(), runs.len()), (2, 2));
    for (link, row) in links.iter().zip(&runs) {
        assert_eq!(
            [&link["new_run"], &link["new_participant"], &link["original"]],
            [&row["run"], &row["participant"], &row["original"]]
        );
        let sealed =
            original.iter().find(|sealed_row| sealed_row["run"] == link["run"]).expect("a sealed run");
        assert_eq!(sealed["last_hash"], link["last_hash"]);
        assert_eq!(row["cash"], sealed["cash"], "figures stay");
        assert_eq!(row["created"], "0");
    }
    let machine = {
        let events = read_table(&out.join("events.csv"));
        let detail = events.iter().find(|row| row["kind"] == "session").expect("a line")["detail"].clone();
        detail.split(';').next().and_then(|part| part.strip_prefix("machine=")).expect("a machine").to_owned()
    };
    let year = &original[0]["created"][..4];
    for name in ["runs", "weeks", "forecasts", "queries", "events", "answers", "notes", "columns"] {
        let given =
            std::fs::read_to_string(Path::new(&anonymous).join(format!("{name}.csv"))).expect("a table");
        let mut secrets =
            vec!["Lovelace", "P 3", "watch the costs", "should follow", "If it goes well", &machine];
        secrets.extend(original.iter().map(|row| row["run"].as_str()));
        secrets.extend(original.iter().map(|row| row["last_hash"].as_str()));
        let at = format!("{year}-");
        secrets.push(&at);
        for secret in secrets {
            assert!(!given.contains(secret), "{name} contains {secret:?}");
        }
        assert_eq!(given.lines().count() > 1, name != "answers" || given.contains("mood"), "{name}");
    }
    // Rows are ordered by the new labels, unique combinations are reported, and columns can be left out.
    for name in ["runs", "weeks", "events"] {
        let rows = read_table(&Path::new(&anonymous).join(format!("{name}.csv")));
        assert!(rows.iter().map(|row| &row["participant"]).is_sorted(), "{name}");
    }
    assert!(
        program_output
            .stdout
            .contains("the smallest group of sessions with the same seed and condition has "),
        "{}",
        program_output.stdout
    );
    let fewer = place("fewer");
    let output = anonymise(&fewer, &["--without", "seed,condition"]);
    assert!(
        output.exit_code == 0 && !output.stdout.contains("smallest group"),
        "{}{}",
        output.stdout,
        output.stderr
    );
    let without = read_table(&Path::new(&fewer).join("runs.csv"));
    assert!(!without[0].contains_key("seed") && !without[0].contains_key("condition"));
    assert_eq!(without[0]["cash"], runs[0]["cash"]);
    let events = read_table(&Path::new(&fewer).join("events.csv"));
    assert!(events.iter().filter(|row| row["kind"] == "start").all(|row| row["value"].is_empty()));
    anonymise(&place("none"), &["--without", "run"]).assert_fails(2, &["run cannot be left out"]);
    anonymise(&place("none"), &["--without", "sead"]).assert_fails(2, &["no table has a column sead"]);
    // The same secret gives the same names, masked texts keep their lengths, and existing files are not overwritten.
    anonymise(&anonymous, &[]).assert_fails(1, &["already exists"]);
    let masked = place("masked");
    assert_eq!(anonymise(&masked, &["--mask"]).exit_code, 0);
    let again = read_table(&Path::new(&masked).join("runs.csv"));
    assert_eq!(again[0]["participant"], runs[0]["participant"]);
    let notes = read_table(&Path::new(&masked).join("notes.csv"));
    assert!(notes.iter().any(|row| row["text"] == "[16 characters]"), "{notes:?}");
    std::fs::write(home.0.path().join("study.secret"), "guess").expect("a file");
    anonymise(&place("third"), &[]).assert_fails(2, &["64 hexadecimal digits"]);
}

#[test]
fn loading_scripts_read_the_tables() {
    let home = Home::new();
    play_run_with_all_activity_lines(&home);
    played_run(&home, "=P01");
    let out = export(&home);
    let runs = read_table(&out.join("runs.csv"));
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/studies/examples");
    for (program, script, check) in [("python3", "load.py", "-V"), ("Rscript", "load.R", "--version")] {
        if Command::new(program).arg(check).output().is_err() {
            continue;
        }
        let done = Command::new(program).arg(examples.join(script)).arg(&out).output().expect("it runs");
        let output = String::from_utf8(done.stdout).expect("text");
        assert!(done.status.success(), "{output}{}", String::from_utf8_lossy(&done.stderr));
        assert_eq!(output.lines().count(), 2, "{output}");
        for (line, row) in output.lines().zip(&runs) {
            let cells: Vec<&str> = line.split('\t').collect();
            assert_eq!((cells[0], cells[1]), (&*row["run"], row["participant"].trim_start_matches('\'')));
            for (cell, column) in cells[2..].iter().zip(["day", "cash", "active_seconds", "calls"]) {
                let [read, expected] =
                    [cell, &*row[column]].map(|text| text.parse::<f64>().expect("a number"));
                assert!(
                    (read - expected).abs() <= 1e-6 * expected.abs(),
                    "{column}: {read} is not {expected}"
                );
            }
        }
    }
    if let Ok(done) = Command::new("python3")
        .args(["-c", "import sys; sys.path.insert(0, sys.argv[1]); import load; print(len(load.tables(sys.argv[2])['events']))"])
        .args([&examples, &out])
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .output()
    {
        let output = String::from_utf8_lossy(&done.stdout).trim().to_owned();
        let events = read_table(&out.join("events.csv")).len().to_string();
        assert_eq!(output, events, "{}", String::from_utf8_lossy(&done.stderr));
    }
}
