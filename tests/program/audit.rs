//! The audit of a study finds contradictions in the records with their line, and reports no findings for honest sessions.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use novamind::record::clock::{format_timestamp, parse_nanoseconds};
use serde_json::{Map, Value, json};

use crate::support::home::{Home, ProgramOutput, run_with_input};

/// A study and its machines.
struct Study {
    home: Home,
}

const WEEKS: [&str; 5] = [
    "next \"one\" naive\n",
    "next \"two\" naive\n",
    "next \"three\" naive\n",
    "next \"four\" naive\n",
    "next \"five\" naive\n",
];

impl Study {
    fn new() -> Study {
        let study = Study { home: Home::new() };
        assert_eq!(study.home.run(&["study", "new", &study.folder()]).exit_code, 0);
        let path = study.home.0.path().join("pilot/study.toml");
        let text = fs::read_to_string(&path).expect("a protocol");
        let text =
            text.replace("# days = 84 ", "days = 42 #").replace("offer = \"required\"", "offer = \"none\"");
        fs::write(path, text).expect("written");
        for questions in ["1-before", "2-effort", "3-end"] {
            fs::remove_file(study.home.0.path().join(format!("pilot/questions/{questions}.toml")))
                .expect("gone");
        }
        assert_eq!(study.home.run(&["study", "assign", &study.folder(), "--participants", "4"]).exit_code, 0);
        study
    }

    fn folder(&self) -> String {
        self.home.0.path().join("pilot").display().to_string()
    }

    fn machine(&self, name: &str) -> PathBuf {
        self.home.0.path().join(name)
    }

    fn command(&self, machine: &str) -> Command {
        let mut program = self.home.program();
        program.env("NOVAMIND_RUNS", self.machine(machine));
        program
    }

    fn play_session(&self, machine: &str, lines: &str) -> ProgramOutput {
        let program_output = run_with_input(self.command(machine).args(["--study", &self.folder()]), lines);
        assert_eq!(program_output.exit_code, 0, "{}{}", program_output.stdout, program_output.stderr);
        program_output
    }

    fn run(&self, machine: &str, arguments: &[&str]) -> ProgramOutput {
        run_with_input(self.command(machine).args(arguments), "")
    }

    fn only_run(&self, machine: &str, label: &str) -> PathBuf {
        let entries = fs::read_dir(self.machine(machine).join("participants").join(label)).expect("a folder");
        let mut runs: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        runs.retain(|path| path.join("trajectory.jsonl").exists());
        assert_eq!(runs.len(), 1);
        runs.remove(0)
    }

    /// Returns the kind, line and description of each finding.
    fn audit(&self, machines: &[&str]) -> Vec<(String, Option<u64>, String)> {
        let machines: Vec<String> =
            machines.iter().map(|name| self.machine(name).display().to_string()).collect();
        let folder = self.folder();
        let mut arguments = vec!["study", "audit", "--json", &folder];
        arguments.extend(machines.iter().map(String::as_str));
        let program_output = self.home.run(&arguments);
        let audit: Value = serde_json::from_str(&program_output.stdout)
            .unwrap_or_else(|_| panic!("{}{}", program_output.stdout, program_output.stderr));
        let findings = audit["findings"].as_array().expect("findings");
        assert_eq!(program_output.exit_code, i32::from(!findings.is_empty()));
        let of = |finding: &Value| {
            let words = finding["words"].as_str().expect("words").to_owned();
            (finding["kind"].as_str().expect("a kind").to_owned(), finding["line"].as_u64(), words)
        };
        findings.iter().map(of).collect()
    }

    fn finding_kinds(&self, machines: &[&str]) -> Vec<String> {
        self.audit(machines).into_iter().map(|(kind, ..)| kind).collect()
    }
}

fn lines(run: &Path) -> Vec<Map<String, Value>> {
    let text = fs::read_to_string(run.join("trajectory.jsonl")).expect("a trajectory");
    text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
}

fn line_digest(text: &str) -> String {
    blake3::hash(text.as_bytes()).to_hex().to_string()
}

/// Writes lines to a trajectory, with a correct hash chain and correct checksums.
fn write_forged_lines(run: &Path, lines: Vec<Map<String, Value>>) {
    write_forged_lines_with_afterwards(run, lines, Vec::new());
}

/// Writes lines to a trajectory and to `afterwards.jsonl`.
fn write_forged_lines_with_afterwards(
    run: &Path,
    lines: Vec<Map<String, Value>>,
    afterwards: Vec<Map<String, Value>>,
) {
    let (mut text, mut prev) = (String::new(), line_digest(""));
    let (mut after, count) = (String::new(), lines.len());
    for (seq, mut line) in lines.into_iter().chain(afterwards).enumerate() {
        line.insert("seq".to_owned(), json!(seq));
        line.insert("prev".to_owned(), json!(prev));
        line.shift_remove("sum");
        let bare = Value::Object(line.clone()).to_string();
        line.insert("sum".to_owned(), json!(&line_digest(&bare)[..16]));
        let whole = Value::Object(line).to_string();
        prev = line_digest(&whole);
        *(if seq < count { &mut text } else { &mut after }) += &(whole + "\n");
    }
    fs::write(run.join("trajectory.jsonl"), text).expect("written");
    if !after.is_empty() {
        fs::write(run.join("afterwards.jsonl"), after).expect("written");
    }
    for derived in ["world.db", "world.db-wal", "world.db-shm", "snapshot.bin"] {
        let _ = fs::remove_file(run.join(derived));
    }
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder");
    for entry in fs::read_dir(from).expect("a folder").flatten() {
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).expect("copied");
        }
    }
}

#[test]
fn audit_of_honest_sessions_finds_nothing() {
    let study = Study::new();
    study.play_session("one", &format!("P01\nyes\nset_prices A=9 B=19 C=39\n{}quit\n", WEEKS.concat()));
    study.play_session("one", "P01\nnext \"six\" naive\n");
    study.play_session("one", "P99\nP02\nno\n");
    study.play_session("two", &format!("P03\nyes\n{}withdraw\nwithdraw\n", WEEKS[0]));
    study.play_session("two", &format!("P04\nyes\nsql SELECT 1\n{}", WEEKS.concat()));
    study.play_session("two", "P04\nnext \"six\" naive\n");
    // An experimenter may replay finished runs.
    let run = study.only_run("one", "P01").file_name().expect("a name").to_string_lossy().into_owned();
    assert_eq!(study.run("one", &["--as", "P01", "replay", &run, "--verify"]).exit_code, 0);
    assert_eq!(study.audit(&["one", "two"]), []);
}

#[test]
fn records_of_earlier_builds_with_removed_fields_still_verify() {
    let study = Study::new();
    study.play_session("one", &format!("P01\nyes\n{}quit\n", WEEKS[..2].concat()));
    let run = study.only_run("one", "P01");
    let mut old = lines(&run);
    old[0]["rules"]["code_words"] = json!(true);
    for line in old.iter_mut().filter(|line| line["kind"] == "session" && line["event"] == "opened") {
        line.insert("worlds".to_owned(), json!({ "lines": 3, "head": "8899aabbccddeeff" }));
    }
    write_forged_lines(&run, old);
    let manifest = fs::read_to_string(run.join("run.toml")).expect("text");
    assert!(manifest.contains("[rules]\n"), "{manifest}");
    fs::write(run.join("run.toml"), manifest.replace("[rules]\n", "[rules]\ncode_words = true\n"))
        .expect("written");
    fs::write(run.join("witness-queue.jsonl"), "{}\n").expect("written");
    let text = fs::read_to_string(run.join("trajectory.jsonl")).expect("a trajectory");
    let id = run.file_name().expect("a name").to_string_lossy().into_owned();
    let verified = study.run("one", &["--as", "P01", "replay", &id, "--verify"]);
    assert_eq!(verified.exit_code, 0, "{}{}", verified.stdout, verified.stderr);
    assert_eq!(study.audit(&["one"]), []);
    // When the run continues, the bytes of its first lines do not change.
    study.play_session("one", &format!("P01\n{}quit\n", WEEKS[2]));
    let continued = fs::read_to_string(run.join("trajectory.jsonl")).expect("a trajectory");
    assert!(continued.starts_with(&text) && !continued[text.len()..].contains("worlds"));
    assert_eq!(study.audit(&["one"]), []);
}

#[test]
fn audit_finds_changed_truncated_and_removed_records() {
    let study = Study::new();
    study.play_session("one", &format!("P01\nyes\nset_prices A=9\n{}quit\n", WEEKS.concat()));
    let run = study.only_run("one", "P01");
    let good = study.machine("good");
    copy(&study.machine("one"), &good);
    let restore = || {
        fs::remove_dir_all(study.machine("one")).expect("gone");
        copy(&good, &study.machine("one"));
    };
    // A decision is changed, and the hash chain and checksums are recomputed.
    let mut changed = lines(&run);
    let call = changed.iter().position(|line| line["kind"] == "call").expect("a call");
    changed[call]["args"]["A"] = json!(30);
    write_forged_lines(&run, changed);
    let kinds = study.finding_kinds(&["one"]);
    assert!(kinds.contains(&"not_reached".to_owned()), "{kinds:?}");
    restore();
    // The last weeks are removed from the trajectory but not from the database.
    let advance = lines(&run).iter().position(|line| line["kind"] == "advance").expect("a week");
    let text = fs::read_to_string(run.join("trajectory.jsonl")).expect("a trajectory");
    let cut: String = text.lines().take(advance).map(|line| format!("{line}\n")).collect();
    fs::write(run.join("trajectory.jsonl"), cut).expect("written");
    let found = study.audit(&["one"]);
    assert_eq!((found[0].0.as_str(), found[0].1), ("cut", Some(advance as u64 + 1)), "{found:?}");
    restore();
    // First a byte of the trajectory is changed, then the trajectory is removed.
    fs::write(run.join("trajectory.jsonl"), text.replacen("\"A\":9", "\"A\":8", 1)).expect("written");
    assert!(study.finding_kinds(&["one"]).contains(&"damaged".to_owned()));
    fs::remove_file(run.join("trajectory.jsonl")).expect("gone");
    assert!(study.finding_kinds(&["one"]).contains(&"missing".to_owned()));
}

#[test]
fn audit_finds_edited_manifests_and_clocks() {
    let study = Study::new();
    study.play_session("one", &format!("P01\nyes\n{}quit\n", WEEKS[..3].concat()));
    let run = study.only_run("one", "P01");
    let good = fs::read_to_string(run.join("run.toml")).expect("text");
    for (from, to) in
        [("participant = \"P01\"", "participant = \"P02\""), ("earlier_runs = 0", "earlier_runs = 4")]
    {
        assert!(good.contains(from));
        fs::write(run.join("run.toml"), good.replace(from, to)).expect("written");
        let found = study.audit(&["one"]);
        assert!(
            found.iter().any(|(kind, _, words)| kind == "manifest" && words.contains(&to[..8])),
            "{found:?}"
        );
    }
    fs::write(run.join("run.toml"), &good).expect("written");
    assert_eq!(study.audit(&["one"]), []);
    // The label is changed in the first line and in `run.toml`, with a recomputed hash chain.
    let mut record_lines = lines(&run);
    record_lines[0].insert("participant".to_owned(), json!("P02"));
    write_forged_lines(&run, record_lines.clone());
    fs::write(run.join("run.toml"), good.replace("participant = \"P01\"", "participant = \"P02\""))
        .expect("written");
    let kinds = study.finding_kinds(&["one"]);
    assert!(kinds.contains(&"assignment".to_owned()), "{kinds:?}");
    fs::write(run.join("run.toml"), &good).expect("written");
    // The clock was set back between two lines.
    record_lines[0].insert("participant".to_owned(), json!("P01"));
    let at = record_lines.len() - 2;
    record_lines[at].insert("at".to_owned(), json!("2026-01-01T00:00:00Z"));
    write_forged_lines(&run, record_lines);
    let found = study.audit(&["one"]);
    assert!(found.iter().any(|(kind, line, _)| kind == "clock" && *line == Some(at as u64 + 1)), "{found:?}");
}

#[test]
fn audit_reports_missing_runs_and_runs_of_a_different_protocol() {
    let study = Study::new();
    fs::create_dir(study.machine("empty")).expect("a folder");
    let found = study.audit(&["empty"]);
    assert_eq!((found.len(), found[0].0.as_str()), (1, "nothing_examined"), "{found:?}");
    study.play_session("one", &format!("P01\nyes\n{}quit\n", WEEKS[0]));
    assert_eq!(study.audit(&["one"]), []);
    // After the protocol is changed, the run belongs to the old digest.
    let path = study.home.0.path().join("pilot/study.toml");
    let text = fs::read_to_string(&path).expect("a protocol");
    fs::write(&path, format!("{text}\n# changed\n")).expect("written");
    let kinds: Vec<String> = study.finding_kinds(&["one"]);
    assert_eq!(kinds.len(), 2, "{kinds:?}");
    for kind in ["nothing_examined", "other_protocol"] {
        assert!(kinds.contains(&kind.to_owned()), "{kinds:?}");
    }
    let program_output = study.run("one", &["study", "audit", &study.folder()]);
    assert!(
        program_output.exit_code == 1 && !program_output.stdout.contains("No findings"),
        "{}",
        program_output.stdout
    );
    // The collection reports that the label has a run with the old protocol.
    let (one, out) =
        (study.machine("one").display().to_string(), study.machine("data").display().to_string());
    let collected = study.home.run(&["study", "collect", &one, "--out", &out, "--protocol", &study.folder()]);
    assert!(
        collected.stdout.contains("label P01 has no session under this protocol; run "),
        "{}",
        collected.stdout
    );
    assert!(!collected.stdout.contains("label P01 has no session;"), "{}", collected.stdout);
    assert!(collected.stdout.contains("label P02 has no session\n"), "{}", collected.stdout);
    // After the name is changed, the run belongs to a different study: it is counted but is not a finding.
    fs::write(&path, text.replace("name = \"pilot\"", "name = \"other\"")).expect("written");
    let output = study.run("one", &["study", "audit", &study.folder()]);
    assert!(output.stdout.contains("Runs of other studies, not examined: 1."), "{}", output.stdout);
    assert_eq!(study.finding_kinds(&["one"]), ["nothing_examined"]);
}

#[test]
fn audit_finds_a_clock_change_in_the_last_session() {
    let study = Study::new();
    study.play_session("one", &format!("P01\nyes\n{}next \"six\" naive\n", WEEKS.concat()));
    assert_eq!(study.audit(&["one"]), []);
    let run = study.only_run("one", "P01");
    let shift = |text: &str, from: usize, seconds: i64| -> String {
        let mut all: Vec<Map<String, Value>> =
            text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
        for line in all.iter_mut().skip(from) {
            let at = parse_nanoseconds(line["at"].as_str().expect("a moment")) + seconds * 1_000_000_000;
            line.insert("at".to_owned(), json!(format_timestamp(at)));
        }
        all.into_iter().map(|line| Value::Object(line).to_string() + "\n").collect()
    };
    let read = |name: &str| fs::read_to_string(run.join(name)).expect("lines");
    let (text, after) = (read("trajectory.jsonl"), read("afterwards.jsonl"));
    let at = text.lines().count() - 4;
    for (seconds, is_found) in [(1, false), (600, true)] {
        // The wall clock moved forward, but the monotonic clock of the `session` lines did not.
        let moved = |text: &str, from| shift(text, from, seconds);
        let lines = moved(&text, at) + &moved(&after, 0);
        let (text, after): (Vec<_>, Vec<_>) = lines
            .lines()
            .map(|line| serde_json::from_str::<Map<String, Value>>(line).expect("JSON"))
            .partition(|line| line["seq"].as_u64().expect("a number") < text.lines().count() as u64);
        write_forged_lines_with_afterwards(&run, text, after);
        let found = study.audit(&["one"]);
        let is_clock = |(kind, _, words): &(String, Option<u64>, String)| {
            kind == "clock" && words.contains("600 seconds ahead of the monotonic clock")
        };
        assert_eq!(found.iter().any(is_clock), is_found, "{found:?}");
    }
}

#[test]
fn audit_finds_hidden_state_views_of_a_seed_with_unfinished_sessions() {
    let study = Study::new();
    study.play_session("one", &format!("P01\nyes\n{}next \"six\" naive\n", WEEKS.concat()));
    study.play_session("two", &format!("P02\nyes\n{}quit\n", WEEKS[0]));
    assert_eq!(study.audit(&["one", "two"]), []);
    // The finished run of P01 is inspected while P02 still plays the same seed.
    let id = study.only_run("one", "P01").file_name().expect("a name").to_string_lossy().into_owned();
    let viewed = run_with_input(
        study.command("one").args(["--as", "P01", "play", "--plain", "--run", &id]),
        "xray leads S1\nquit\n",
    );
    assert!(viewed.exit_code == 0 && viewed.stdout.contains("S1"), "{}{}", viewed.stdout, viewed.stderr);
    let found = study.audit(&["one", "two"]);
    assert!(
        found.iter().any(|(kind, line, words)| {
            kind == "hidden_state" && line.is_some() && words.ends_with("that had not ended: P02")
        }),
        "{found:?}"
    );
    assert_eq!(study.audit(&["one"]), [], "no other run has the seed there");
    // A debug run of the same seed shows hidden state.
    let debug = ["play", "--plain", "--seed", "2718", "--mode", "debug", "--days", "42"];
    assert_eq!(run_with_input(study.command("two").args(debug), "quit\n").exit_code, 0);
    let found = study.audit(&["two"]);
    assert!(
        found.iter().any(|(kind, _, words)| kind == "hidden_state" && words.contains("debug run")),
        "{found:?}"
    );
}

/// Returns the rows of a table by column names.
fn read_rows(path: &Path) -> Vec<BTreeMap<String, String>> {
    let mut table = csv::Reader::from_path(path).expect("a table");
    let rows = table.deserialize().collect::<Result<Vec<_>, _>>();
    rows.expect("rows")
}

#[test]
fn audit_counts_match_the_tables() {
    let study = Study::new();
    study.play_session("one", &format!("P01\nyes\nset_prices A=-1\n{}quit\n", WEEKS.concat()));
    study.play_session("one", "P01\nnext \"six\" naive\n");
    let text =
        "next \"own\" 990000 980000 999000 960000 940000 980000 900000 800000 990000 800000 700000 990000\n";
    study.play_session("two", &format!("P02\nyes\n{text}{}quit\n", WEEKS[..2].concat()));
    study.play_session("two", &format!("P03\nyes\n{text}{text}"));
    // Forges the record of the second participant: one forecast of a week is not naive, and half a minute passes
    // before the third week.
    let run = study.only_run("two", "P02");
    let mut record_lines = lines(&run);
    let weeks: Vec<usize> =
        (0..record_lines.len()).filter(|at| record_lines[*at]["kind"] == "advance").collect();
    record_lines[weeks[1]]["forecasts"][0]["filled_naively"] = json!(false);
    for line in record_lines.iter_mut().skip(weeks[2]) {
        let at = parse_nanoseconds(line["at"].as_str().expect("a moment")) + 30_000_000_000;
        line.insert("at".to_owned(), json!(format_timestamp(at)));
    }
    write_forged_lines(&run, record_lines);
    let out = study.home.0.path().join("data");
    let [one, two, out] =
        [study.machine("one"), study.machine("two"), out].map(|path| path.display().to_string());
    let collected = study.home.run(&["study", "collect", &one, &two, "--out", &out]);
    assert!(collected.stdout.contains("3 runs verified"), "{}{}", collected.stdout, collected.stderr);
    let program_output = study.home.run(&["study", "audit", "--json", &study.folder(), &one, &two]);
    let audit: Value = serde_json::from_str(&program_output.stdout).expect("JSON");
    let table = read_rows(&Path::new(&out).join("runs.csv"));
    let same = [
        ("weeks", "weeks"),
        ("sittings", "sittings"),
        ("unclosed_sittings", "sittings_not_closed"),
        ("refusals", "refused"),
        ("naive_weeks", "weeks_filled_naively"),
        ("fast_weeks", "implausibly_fast_weeks"),
        ("pasted", "pasted_characters"),
    ];
    let mut seen = BTreeMap::new();
    for facts in audit["runs"].as_array().expect("runs") {
        let row = table.iter().find(|row| facts["run"] == row["run"]).expect("its row");
        for (name, column) in same {
            let fact = if facts[name].is_null() { String::new() } else { facts[name].to_string() };
            assert_eq!(fact, row[column], "{name} of {}", row["participant"]);
        }
        let counts = ["naive_weeks", "fast_weeks", "refusals"].map(|name| facts[name].as_u64());
        seen.insert(row["participant"].clone(), counts);
    }
    let expected = [("P01", [6, 6, 1]), ("P02", [2, 2, 0]), ("P03", [0, 2, 0])];
    let expected = expected.map(|(label, counts)| (label.to_owned(), counts.map(Some)));
    assert_eq!(seen, BTreeMap::from(expected));
}

const END: &str = "title = \"The end\"\nwhen = \"end\"\n[[question]]\nid = \"hard\"\ntext = \"How hard was it?\"\nform = \"likert\"\n\
                   points = 7\nlow = \"easy\"\nhigh = \"hard\"\n";

#[test]
fn audit_finds_damaged_lines_after_the_end() {
    let study = Study::new();
    fs::write(study.home.0.path().join("pilot/questions/9-end.toml"), END).expect("written");
    study.play_session("one", &format!("P01\nyes\n{}quit\n", WEEKS.concat()));
    study.play_session("one", "P01\nnext \"six\" naive\n7\n");
    assert_eq!(study.audit(&["one"]), []);
    let path = study.only_run("one", "P01").join("afterwards.jsonl");
    let good = fs::read_to_string(&path).expect("the actions after the end");
    fs::write(&path, good.replacen("\"value\":7", "\"value\":1", 1)).expect("written");
    assert_eq!(study.finding_kinds(&["one"]), ["damaged"]);
}

#[cfg(unix)]
#[test]
fn audit_counts_copies_once_and_does_not_block_on_pipes() {
    let study = Study::new();
    study.play_session("one", &format!("P01\nyes\n{}", WEEKS[0]));
    let run = study.only_run("one", "P01");
    let id = run.file_name().expect("a name").to_string_lossy().into_owned();
    // A run of the study cannot be played without the study, and cannot be watched while it is unfinished.
    for options in [&["--run", &id][..], &["--run", &id, "--watch"]] {
        let program_output =
            study.run("one", &[&["--as", "P01", "play", "--plain"], options, &["--strict"]].concat());
        assert_eq!(program_output.exit_code, 2, "{}", program_output.stdout);
        assert!(program_output.stderr.contains("belongs to the study"), "{}", program_output.stderr);
    }
    // A copy of a folder of runs does not count as a second session.
    copy(&study.machine("one"), &study.machine("copy"));
    assert_eq!(study.finding_kinds(&["one", "copy"]), [] as [&str; 0]);
    // Named pipes instead of files must not block a command.
    let pipes = [
        study.machine("one").join("participants/P02/11112222/trajectory.jsonl"),
        study.machine("one").join("visits.jsonl"),
    ];
    for pipe in pipes {
        fs::create_dir_all(pipe.parent().expect("a folder")).expect("a folder");
        let _ = fs::remove_file(&pipe);
        assert!(Command::new("mkfifo").arg(&pipe).status().expect("it runs").success());
    }
    assert_eq!(study.finding_kinds(&["one"]), ["damaged"], "the study of that run is unknown");
    assert_eq!(study.run("one", &["study", "watch", &study.folder(), "--once"]).exit_code, 0);
}

#[test]
fn audit_finds_a_missing_run_of_a_finished_participant() {
    let study = Study::new();
    study.play_session("one", &format!("P01\nyes\n{}{}quit\n", WEEKS.concat(), WEEKS[0]));
    study.play_session("one", &format!("P02\nyes\n{}quit\n", WEEKS[0]));
    assert_eq!(study.audit(&["one"]), []);
    fs::remove_dir_all(study.machine("one").join("participants/P01")).expect("gone");
    assert_eq!(study.finding_kinds(&["one"]), ["missing"]);
    let missing = study.home.run(&["study", "audit", &study.folder(), "no-such-folder"]);
    assert_eq!(missing.exit_code, 1);
    assert!(missing.stderr.contains("no-such-folder is not a folder"), "{}", missing.stderr);
}
