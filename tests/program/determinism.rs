//! A run reaches the same states in another process, with another number of threads, after it is closed and continued,
//! and after a kill.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use novamind::lab::{MetricsCollector, Policy, RunSpec, play_policy};
use novamind::record::folder::configuration::Configuration;
use novamind::record::mode::Mode;
use novamind::record::trajectory::Trajectory;
use novamind::record::trajectory::record::Via;
use novamind::session::{Access, NewRun, Session, Storage};
use serde_json::{Value, json};

fn program(runs: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_novamind"));
    command.env("NOVAMIND_RUNS", runs).env("NOVAMIND_CONFIG", runs.join("configuration"));
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Runs a policy with the built program. Returns one object per seed, without the duration.
fn run(command: &mut Command) -> Vec<Value> {
    let output = command.arg("--json").output().expect("the program starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    let parse = |line: &str| {
        let mut object: Value = serde_json::from_str(line).expect("an object");
        object.as_object_mut().expect("an object").remove("seconds");
        object
    };
    text.lines().map(parse).collect()
}

/// Options for a market that fills so fast that all threads are used after a few weeks.
const SATURATED_MARKET: [&str; 4] = ["--cash", "1e9", "--set", "leads.saturation_base=14.5"];

#[test]
fn program_and_library_reach_the_same_state() {
    let runs = tempfile::tempdir().expect("a folder");
    let configuration = Configuration::bundled();
    for (name, until, extra) in [("P6", 60, &[][..]), ("P1a", 32, &SATURATED_MARKET)] {
        let mut command = program(runs.path());
        command.args(["run", "--policy", name, "--seed", "3", "--until", &until.to_string()]).args(extra);
        let built = run(&mut command).remove(0);
        let policy = Policy::find(name, &configuration).expect("a bundled policy");
        let mut spec = RunSpec { stop_after_day: Some(until), ..RunSpec::for_seed(3) };
        if !extra.is_empty() {
            spec.cash = Some(1e9);
            spec.overrides = vec![("leads.saturation_base".to_owned(), "14.5".to_owned())];
        }
        let run_outcome =
            play_policy(&policy, &spec, &configuration, &mut MetricsCollector::disabled()).expect("it plays");
        assert_eq!(built["state_hash"], run_outcome.state_hash, "{name}");
        assert_eq!(built["cash"].as_f64().map(f64::to_bits), Some(run_outcome.cash.to_bits()), "{name}");
        assert_eq!((built["day"].as_u64(), run_outcome.day), (Some(u64::from(until)), until));
    }
}

#[test]
fn figures_and_states_do_not_depend_on_threads() {
    let runs = tempfile::tempdir().expect("a folder");
    let with = |jobs: Option<&str>, threads: &str, seeds: &str| {
        let mut command = program(runs.path());
        command.args(["run", "--policy", "P1a", "--seed", seeds, "--until", "32"]).args(SATURATED_MARKET);
        command.env("RAYON_NUM_THREADS", threads);
        if let Some(jobs) = jobs {
            command.args(["--jobs", jobs]);
        }
        run(&mut command)
    };
    let first = with(Some("1"), "1", "1..3");
    assert!(first.iter().all(|run| run["subscribers"].as_u64().is_some_and(|count| count > 20_000)));
    for (jobs, threads) in [(Some("2"), "1"), (Some("1"), "2"), (None, "2"), (Some("3"), "5")] {
        assert_eq!(with(jobs, threads, "1..3"), first, "--jobs {jobs:?}, {threads} threads");
    }
    assert_eq!(with(None, "2", "2"), first[1..2], "a seed alone");
}

#[test]
fn saved_run_has_the_reported_state() {
    let runs = tempfile::tempdir().expect("a folder");
    // Spending has fractions of dollars, which the trajectory must preserve bit for bit.
    let mut command = program(runs.path());
    command.args(["run", "--policy", "P1a", "--seed", "5", "--until", "84", "--save"]);
    let value = run(&mut command).remove(0);
    let id = value["run"].as_str().expect("a run").to_owned();
    let verified = program(runs.path()).args(["replay", &id, "--verify"]).output().expect("it runs");
    let text = String::from_utf8_lossy(&verified.stdout).into_owned();
    assert!(verified.status.success(), "{}", String::from_utf8_lossy(&verified.stderr));
    assert!(text.contains("12 states verified, day 84"), "{text}");
    let hash = value["state_hash"].as_str().expect("a hash");
    assert!(text.contains(hash), "{text} instead of {hash}");
    let opened = Session::open(&runs.path().join(&id), Access::Write, true).expect("it opens");
    assert_eq!(opened.state_hash().0, hash);
}

const WEEKS: u32 = 6;

/// Plays a week with typical actions.
fn play_week(session: &mut Session, week: u32) {
    let mut call = |tool: &str, arguments: Value| {
        session.call(tool, &arguments, Via::Script).unwrap_or_else(|refusal| panic!("{tool}: {refusal}"));
    };
    if week == 0 {
        call("set_prices", json!({"A": 12, "B": 25, "C": 55}));
        call("set_model_tiers", json!({"B": 2, "C": 4}));
        call("set_usage_quotas", json!({"A": 60000, "B": 250000, "C": 1200000}));
        call("set_targeted_ad_spend", json!({"content_marketing": {"S1": 750}, "linkedin": {"E1": 3000}}));
    }
    call("set_daily_spend", json!({"operations": 100.1 + f64::from(week) / 3.0, "development": 200}));
    call("set_capacity_tier", json!({"tier": week.min(3)}));
    if week == 2 {
        call("start_research_project", json!({"tier": 1}));
    }
    let forecasts = session.company().naive_forecasts();
    session.advance("as planned", &forecasts, Via::Script, &mut |_| {}).expect("a week");
}

#[test]
fn reopening_at_any_week_keeps_the_state() {
    let folder = tempfile::tempdir().expect("a folder");
    let new = |storage| NewRun { seed: Some(11), days: Some(42), storage, ..NewRun::default() };
    let create = |storage| Session::create(new(storage), &Configuration::bundled()).expect("it begins");
    let mut uninterrupted_session = create(Storage::Memory);
    (0..WEEKS).for_each(|week| play_week(&mut uninterrupted_session, week));
    // The run is closed after one of the weeks, or after every week.
    for left_after in (0..WEEKS).map(Some).chain([None]) {
        let mut session = create(Storage::Runs(folder.path().to_owned()));
        let place = session.folder().expect("a folder").to_owned();
        for week in 0..WEEKS {
            play_week(&mut session, week);
            if left_after.is_none_or(|chosen| chosen == week) {
                drop(session);
                session = Session::open(&place, Access::Write, true).expect("it opens");
            }
        }
        assert_eq!(session.state_hash(), uninterrupted_session.state_hash(), "left after {left_after:?}");
        assert_eq!(
            session.company().observe().dashboard,
            uninterrupted_session.company().observe().dashboard
        );
        assert_eq!(session.cash_by_day(), uninterrupted_session.cash_by_day());
        assert_eq!(session.weeks(), uninterrupted_session.weeks());
    }
}

#[test]
fn state_does_not_depend_on_the_mode() {
    let hash = |mode| {
        let new = NewRun { seed: Some(11), days: Some(42), mode, ..NewRun::default() };
        let mut session = Session::create(new, &Configuration::bundled()).expect("it begins");
        (0..3).for_each(|week| play_week(&mut session, week));
        session.state_hash()
    };
    let debug = hash(Mode::Debug);
    assert_eq!(hash(Mode::Sandbox), debug);
    assert_eq!(hash(Mode::Baseline), debug);
}

/// Returns the day and the state hash of each week of a run.
fn week_states(folder: &Path) -> Vec<(u32, String)> {
    let read = Trajectory::read(&folder.join("trajectory.jsonl")).expect("it reads");
    let closed = read.lines.iter().filter_map(|line| Some((line.day, line.record.closed_days()?)));
    closed.map(|(day, closing)| (day, closing.state_hash.clone())).collect()
}

fn only_run(runs: &Path) -> PathBuf {
    let entries = fs::read_dir(runs).expect("a folder").flatten().map(|entry| entry.path());
    let folders: Vec<_> = entries.filter(|path| path.is_dir()).collect();
    assert_eq!(folders.len(), 1);
    folders[0].clone()
}

const OPENING: &str = "set_prices A=12 B=25 C=55\nset_usage_quotas A=60000 B=250000 C=1200000\n\
    set_targeted_ad_spend {\"content_marketing\": {\"S1\": 3000}}\nset_capacity_tier 6\n";

fn start(runs: &Path, options: &[&str]) -> Child {
    program(runs).args(["play", "--plain", "--json"]).args(options).spawn().expect("the program starts")
}

fn new_run_options() -> Vec<&'static str> {
    [&["--seed", "9", "--days", "56", "--mode", "debug"][..], &SATURATED_MARKET].concat()
}

/// Returns the number of complete weeks on disk, or `None` unless the last line is an advance, which means that the
/// next week is in progress. Reads only the kinds of lines, because the check must be much faster than a week.
fn complete_weeks_while_simulating(folder: &Path) -> Option<usize> {
    let text = fs::read_to_string(folder.join("trajectory.jsonl")).ok()?;
    let last = text.strip_suffix('\n')?.lines().last()?;
    let complete = text.matches(r#""kind":"week""#).count();
    last.contains(r#""kind":"advance""#).then_some(complete)
}

/// Waits until at least `complete` weeks are complete and the next week is running, then kills the program.
fn kill_during_a_week(mut child: Child, runs: &Path, complete: usize) {
    let deadline = Instant::now() + Duration::from_secs(60);
    let is_there = || {
        let mut entries = fs::read_dir(runs).expect("a folder").flatten().map(|entry| entry.path());
        entries
            .find(|path| path.is_dir())
            .and_then(|folder| complete_weeks_while_simulating(&folder))
            .is_some_and(|weeks| weeks >= complete)
    };
    while !is_there() {
        let ended = child.try_wait().expect("a state");
        assert!(
            ended.is_none() && Instant::now() < deadline,
            "it was never in a week after week {complete}: {ended:?}"
        );
        std::thread::sleep(Duration::from_micros(200));
    }
    child.kill().expect("it is killed");
    child.wait().expect("it ends");
}

#[test]
fn program_killed_during_a_week_loses_no_confirmed_week() {
    let next = "next naive\n";
    let tell = |child: &mut Child, lines: &str| {
        child.stdin.as_mut().expect("a pipe").write_all(lines.as_bytes()).expect("written");
    };
    let whole = tempfile::tempdir().expect("a folder");
    let mut child = start(whole.path(), &new_run_options());
    tell(&mut child, &format!("{OPENING}{}", next.repeat(8)));
    assert!(child.wait_with_output().expect("it ends").status.success());
    let expected = week_states(&only_run(whole.path()));
    assert_eq!(expected.len(), 8);

    let broken = tempfile::tempdir().expect("a folder");
    let mut child = start(broken.path(), &new_run_options());
    tell(&mut child, &format!("{OPENING}{}", next.repeat(8)));
    let mut interrupted = 0;
    for complete in 2..5 {
        kill_during_a_week(child, broken.path(), complete);
        interrupted += usize::from(complete_weeks_while_simulating(&only_run(broken.path())).is_some());
        // Any number of complete weeks is accepted, because the check can miss a week.
        child = start(broken.path(), &["--run", "latest"]);
        tell(&mut child, &next.repeat(8));
    }
    // A week can end between the check and the kill, but it is very unlikely that this happens three times.
    assert!(interrupted > 0, "no week was ever interrupted");
    let folder = only_run(broken.path());
    let output = child.wait_with_output().expect("it ends");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(week_states(&folder), expected);

    // The database must equal the database of the uninterrupted run.
    let mut uninterrupted_session =
        Session::open(&only_run(whole.path()), Access::Write, true).expect("it opens");
    let mut session = Session::open(&folder, Access::Write, true).expect("it opens");
    assert_eq!(session.state_hash(), uninterrupted_session.state_hash());
    for sql in [
        "SELECT COUNT(*), SUM(amount), SUM(id * amount) FROM ledger",
        "SELECT COUNT(*), SUM(customer_id * start_day) FROM subscriptions WHERE status = 'subscribed'",
        "SELECT SUM(usage_units * customer_id) FROM daily_usage",
        "SELECT COUNT(*), SUM(issue_id * days_open) FROM issues",
        "SELECT COUNT(*), SUM(predicted_value) FROM predictions",
    ] {
        assert_eq!(
            session.query(sql).expect("rows").rows,
            uninterrupted_session.query(sql).expect("rows").rows,
            "{sql}"
        );
    }
}
