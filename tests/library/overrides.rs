//! Overrides: parameters that are set during a debug run. Reopening the run at any line leads to the same states.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use novamind::insight::Inspect;
use novamind::record::folder::configuration::Configuration;
use novamind::record::folder::runs::list_runs;
use novamind::record::mode::Mode;
use novamind::record::trajectory::record::Via;
use novamind::record::trajectory::{Record, Trajectory};
use novamind::session::{Access, NewRun, Playback, SealKey, SeekTarget, Session, recover, verify};
use novamind::world::identifiers::Group;
use serde_json::{Value, json};

use crate::support::company::{
    advance_week, advance_weeks, apply_opening_decisions, begin_run, call_tool, query_rows,
};
use crate::support::forging::forge_lines;

fn set_parameter(session: &mut Session, key: &str, value: Value, from: Option<u32>) {
    session.set_parameter(key, &value, from).unwrap_or_else(|refusal| panic!("{key}: {refusal}"));
}

/// Plays a run of eight weeks that sets parameters of all types. Changes take effect immediately, within a week, or
/// from a later day on.
fn run_with_overrides(folder: &Path) -> Session {
    let mut session = begin_run(folder, Mode::Debug, 140);
    apply_opening_decisions(&mut session);
    advance_weeks(&mut session, 2);
    set_parameter(&mut session, "group.S1.c_max_mean", json!(90), None);
    set_parameter(&mut session, "capacity_tier.0.capacity_units", json!(1_000), Some(24));
    set_parameter(&mut session, "capacity_tier.0.capacity_units", json!(2_000_000), Some(40));
    advance_week(&mut session);
    set_parameter(&mut session, "reputation_influence.S1.S3", json!(2.5), None);
    set_parameter(&mut session, "leads.lead_acquisition_cost", json!(9.5), Some(26));
    session.step(3, &mut |_| {}).expect("days");
    set_parameter(&mut session, "calendar.weekly", json!([2, 2, 2, 2, 2, 2, 2]), None);
    set_parameter(&mut session, "satisfaction.satisfaction_ema_alpha", json!(0.5), Some(52));
    call_tool(&mut session, "set_prices", json!({"A": 14}));
    advance_weeks(&mut session, 3);
    set_parameter(&mut session, "research_tier.1.cost", json!(10), None);
    call_tool(&mut session, "start_research_project", json!({"tier": 1}));
    advance_weeks(&mut session, 2);
    session
}

fn run_folder(session: &Session) -> PathBuf {
    session.folder().expect("a folder").to_owned()
}

fn recorded_states(folder: &Path) -> Vec<(u32, String)> {
    let trajectory = Trajectory::read(&folder.join("trajectory.jsonl")).expect("lines");
    let state = |line: &novamind::record::trajectory::Line| match &line.record {
        Record::Week(closing) | Record::Step(closing) => Some((line.day, closing.state_hash.clone())),
        _ => None,
    };
    trajectory.lines.iter().filter_map(state).collect()
}

/// Returns aggregate rows of the tables `ledger`, `customers` and `subscriptions` in the database of a run.
fn money_and_customer_rows(session: &mut Session) -> Vec<Vec<novamind::database::Cell>> {
    let mut all = Vec::new();
    for sql in [
        "SELECT day, category, sum(amount), count(*) FROM ledger GROUP BY day, category ORDER BY day, category",
        "SELECT group_id, count(*), max(customer_id) FROM customers GROUP BY group_id ORDER BY group_id",
        "SELECT status, plan, count(*), max(end_day) FROM subscriptions GROUP BY status, plan ORDER BY 1, 2",
    ] {
        all.extend(query_rows(session, sql));
    }
    all
}

#[test]
fn run_with_overrides_resumes_and_verifies() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = run_with_overrides(folder.path());
    let (path, day, hash) = (run_folder(&session), session.day(), session.state_hash());
    let seen = money_and_customer_rows(&mut session);
    let unchanged = {
        let mut other = begin_run(folder.path(), Mode::Debug, 140);
        apply_opening_decisions(&mut other);
        advance_weeks(&mut other, 8);
        other.state_hash()
    };
    assert_ne!(unchanged, hash, "the parameters have an effect");
    session.save().expect("saved");
    let charged = "SELECT DISTINCT amount FROM ledger WHERE category = 'lead_acquisition_cost' ORDER BY 1";
    assert_eq!(query_rows(&mut session, charged).len(), 2, "rows keep the parameters of their day");
    drop(session);
    let kinds = Trajectory::read(&path.join("trajectory.jsonl")).expect("lines").lines;
    assert_eq!(kinds.iter().filter(|line| line.record.kind() == "override").count(), 8);

    // Verifies the run, and opens it with and without the snapshot and the database.
    assert_eq!(verify(&path).expect("it verifies").day, day);
    for gone in [&[][..], &["snapshot.bin"], &["world.db"], &["snapshot.bin", "world.db"]] {
        for name in gone {
            std::fs::remove_file(path.join(name)).expect("removed");
        }
        let mut again = Session::open(&path, Access::Write, true).expect("it opens");
        assert_eq!((again.day(), again.state_hash()), (day, hash.clone()), "{gone:?}");
        assert_eq!(money_and_customer_rows(&mut again), seen, "{gone:?}");
        again.save().expect("saved");
    }

    // Plays the run forward and backward.
    let mut playback = Playback::open(&path).expect("it opens");
    let on = &mut |_| ControlFlow::Continue(());
    for goal in [
        SeekTarget::Last,
        SeekTarget::Week(3),
        SeekTarget::Week(5),
        SeekTarget::First,
        SeekTarget::Week(8),
        SeekTarget::Last,
    ] {
        playback.seek(goal, on).expect("every state is reached");
    }
    assert_eq!(playback.session().state_hash(), hash);

    // The x-ray simulates the days again.
    let mut again = Session::open(&path, Access::Write, false).expect("it opens");
    let s1 = Group::parse("S1").expect("a group");
    assert_eq!(again.inspect().lead_equations(s1, Some(day)).expect("a result").len(), 28);
}

#[test]
fn killed_run_keeps_its_overrides() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = run_with_overrides(folder.path());
    set_parameter(&mut session, "operations.base_outage_prob", json!(0.9), Some(70));
    advance_weeks(&mut session, 4);
    let expected = recorded_states(&run_folder(&session));
    let path = run_folder(&session).join("trajectory.jsonl");
    drop(session);
    let text = std::fs::read_to_string(&path).expect("lines");
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    // The run is killed after each line with an override, before a week, and within a line.
    let kind = |line: &str| {
        ["override", "advance", "week"]
            .into_iter()
            .find(|kind| line.contains(&format!("\"kind\":\"{kind}\"")))
    };
    for (at, _) in lines.iter().enumerate().filter(|(at, line)| *at > 8 && kind(line).is_some()).step_by(3) {
        for name in ["world.db", "snapshot.bin"] {
            let _ = std::fs::remove_file(path.with_file_name(name));
        }
        std::fs::write(&path, lines[..=at].concat() + "{\"seq\"").expect("written");
        let mut again = Session::open(&parent_run_folder(&path), Access::Write, true).expect("it opens");
        let reached = recorded_states(&run_folder(&again));
        assert_eq!(reached, expected[..reached.len()], "cut after line {}", at + 1);
        if again.day() == 56 {
            // Overrides for later days stay pending after a snapshot.
            again.save().expect("saved");
            drop(again);
            let mut again = Session::open(&parent_run_folder(&path), Access::Write, true).expect("it opens");
            let waiting = again
                .company()
                .debug_parameters()
                .and_then(|debug_parameters| debug_parameters.changes())
                .expect("a debug run")
                .waiting;
            let outages = waiting
                .iter()
                .any(|changed_parameter| changed_parameter.key == "operations.base_outage_prob");
            if outages {
                advance_weeks(&mut again, 4);
                assert_eq!(recorded_states(&run_folder(&again)), expected);
            }
        }
    }
}

fn parent_run_folder(path: &Path) -> PathBuf {
    path.parent().expect("a folder").to_owned()
}

#[test]
fn branches_and_recovered_runs_keep_overrides() {
    let folder = tempfile::tempdir().expect("a folder");
    let session = run_with_overrides(folder.path());
    let expected = recorded_states(&run_folder(&session));
    for (week, count) in [(1, 0), (3, 0), (4, 2), (9, 8)] {
        let mut branch = session.branch(week, Mode::Debug).expect("a branch");
        let lines = Trajectory::read(&run_folder(&branch).join("trajectory.jsonl")).expect("lines").lines;
        let set = lines.iter().filter(|line| line.record.kind() == "override").count();
        assert!(set >= count, "week {week}: {set}");
        self::advance_week(&mut branch);
        let run_path = run_folder(&branch);
        drop(branch);
        let reached = recorded_states(&run_path);
        assert_eq!(reached[..reached.len() - 1], expected[..reached.len() - 1], "week {week}");
        verify(&run_path).expect("it verifies");
    }
    let refused = session.branch(9, Mode::Sandbox).err().expect("no sandbox");
    assert_eq!(refused.code, "not_in_this_mode");
    assert!(session.branch(2, Mode::Sandbox).is_ok(), "nothing was set before week 2");
    let run_path = run_folder(&session);
    drop(session);
    let path = run_path.join("trajectory.jsonl");
    let mut bytes = std::fs::read(&path).expect("lines");
    let at = bytes.len() - 40;
    bytes[at] ^= 1;
    std::fs::write(&path, bytes).expect("written");
    let found = recover(&run_path, &SealKey::default()).expect("a branch");
    assert_eq!(found.mode, Mode::Debug);
    verify(&run_path.with_file_name(found.run)).expect("it verifies");
}

#[test]
fn overrides_require_a_debug_run() {
    let folder = tempfile::tempdir().expect("a folder");
    for mode in [Mode::Baseline, Mode::Sandbox, Mode::Lesson] {
        let mut session = begin_run(folder.path(), mode, 140);
        apply_opening_decisions(&mut session);
        let before = recorded_states(&run_folder(&session)).len();
        let tried = |session: &mut Session| {
            let mut texts = Vec::new();
            for (key, value, from) in [
                ("group.S1.c_max_mean", json!(300), None),
                ("no.such.key", json!(null), Some(0)),
                ("", json!({}), Some(u32::MAX)),
            ] {
                texts.push(session.set_parameter(key, &value, from).expect_err("refused").to_string());
                texts.push(
                    session
                        .company()
                        .debug_parameters()
                        .and_then(|debug_parameters| debug_parameters.value(key))
                        .expect_err("refused")
                        .to_string(),
                );
            }
            texts.push(
                session
                    .company()
                    .debug_parameters()
                    .and_then(|parameters| parameters.changes())
                    .expect_err("refused")
                    .to_string(),
            );
            texts
        };
        let rejections = tried(&mut session);
        assert!(
            rejections.iter().all(|one| *one == "not_in_this_mode: parameters can be set in debug runs only")
        );
        session.abandon().expect("it ends");
        assert_eq!(tried(&mut session), rejections, "{mode}");
        assert_eq!(recorded_states(&run_folder(&session)).len(), before);
    }
    let mut session = begin_run(folder.path(), Mode::Debug, 140);
    session.abandon().expect("it ends");
    let refused = session.set_parameter("group.S1.c_max_mean", &json!(300), None).expect_err("it is over");
    assert_eq!(refused.code, "run_over");
    assert!(session.company().debug_parameters().and_then(|parameters| parameters.changes()).is_ok());
}

#[test]
fn invalid_overrides_are_rejected_without_effect() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = begin_run(folder.path(), Mode::Debug, 140);
    advance_week(&mut session);
    let path = run_folder(&session);
    let lines = || Trajectory::read(&path.join("trajectory.jsonl")).expect("lines").lines.len();
    let (before, hash) = (lines(), session.state_hash());
    let mut deep = json!(1);
    for _ in 0..100 {
        deep = json!([deep]);
    }
    for (key, value, from, code, part) in [
        ("group.S9.c_max_mean", json!(1), None, "parameter_unknown", "did you mean group.S"),
        ("c_max_mean", json!(1), None, "parameter_unknown", "group.S"),
        ("", json!(1), None, "parameter_unknown", "no such parameter"),
        ("quality.", json!(1), None, "parameter_unknown", "no such parameter"),
        ("größe.\u{7}", json!(1), None, "parameter_unknown", "no such parameter"),
        ("operations.base_outage_prob", json!(1.5), None, "parameter_not_allowed", "between 0 and 1"),
        ("operations.base_outage_prob", json!(1e308), Some(9), "parameter_not_allowed", "between 0 and 1"),
        ("operations.base_outage_prob", json!("x"), None, "parameter_not_allowed", "a number"),
        ("operations.base_outage_prob", json!(null), None, "parameter_not_allowed", "null"),
        ("operations.base_outage_prob", deep, None, "parameter_not_allowed", ""),
        ("operations", json!({"base_outage_prob": [null]}), None, "parameter_not_allowed", "null"),
        ("operations", json!({"nothing": 1}), None, "parameter_not_allowed", "no such parameter"),
        ("capacity_tier.3.tier", json!(4), None, "parameter_not_allowed", "numbered"),
        ("capacity_tier", json!([]), None, "parameter_not_allowed", "numbered"),
        ("capacity_tier.3.capacity_units", json!(u64::MAX), None, "parameter_not_allowed", ""),
        ("run.seed", json!(1), None, "parameter_not_allowed", "takes effect only at the start of a run"),
        ("operations.base_outage_prob", json!(0.5), Some(7), "day_unknown", "between 8 and 140"),
        ("operations.base_outage_prob", json!(0.5), Some(141), "day_unknown", "between 8 and 140"),
    ] {
        let refused = session.set_parameter(key, &value, from).expect_err(key);
        assert_eq!(refused.code, code, "{key}: {refused}");
        assert!(refused.message.contains(part), "{key}: {refused}");
    }
    assert_eq!(
        session
            .company()
            .debug_parameters()
            .and_then(|debug_parameters| debug_parameters.value("group.S9"))
            .expect_err("an unknown group")
            .code,
        "parameter_unknown"
    );
    assert_eq!((lines(), session.state_hash()), (before, hash));
}

#[test]
fn forged_override_line_is_rejected() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = begin_run(folder.path(), Mode::Debug, 140);
    set_parameter(&mut session, "operations.base_outage_prob", json!(0.9), Some(10));
    advance_weeks(&mut session, 2);
    let run_path = run_folder(&session);
    drop(session);
    let path = run_path.join("trajectory.jsonl");
    let good = std::fs::read(&path).expect("lines");
    let forged_error = |field: &str, value: Value| {
        std::fs::write(&path, &good).expect("written");
        for name in ["world.db", "snapshot.bin"] {
            let _ = std::fs::remove_file(run_path.join(name));
        }
        forge_lines(&run_path, |_, line| {
            if line["kind"] == "override" {
                line[field] = value.clone();
            }
        });
        verify(&run_path).expect_err(field).to_string()
    };
    for (field, value, part) in [
        ("new", json!(0.01), "the state on day 14 differs from the recorded state"),
        ("from_day", json!(12), "the state on day 14 differs from the recorded state"),
        ("from_day", json!(0), "not after day 0"),
        ("old", json!(0.5), "was not 0.5 before this change"),
        ("key", json!("operations.nothing"), "no such parameter"),
        ("new", json!(null), "not valid for a parameter"),
        ("new", json!(7), "between 0 and 1"),
        ("new", json!("often"), "expected a number"),
    ] {
        let words = forged_error(field, value);
        assert!(words.contains(part), "{field}: {words}");
        assert!(Session::open(&run_path, Access::Write, false).is_err(), "{field}");
    }
    // A run that is not a debug run must not contain an override.
    std::fs::write(&path, &good).expect("written");
    forge_lines(&run_path, |_, line| {
        if line["kind"] == "start" {
            line["mode"] = "sandbox".into();
            line["rules"] = Value::Null;
        }
    });
    let words = verify(&run_path).expect_err("a sandbox").to_string();
    assert!(words.contains("only in debug runs and lessons"), "{words}");
}

#[test]
fn run_with_overrides_is_excluded_from_comparisons() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = begin_run(folder.path(), Mode::Debug, 140);
    assert!(!session.company().observe().has_own_parameters);
    let has_own_parameters = |id: &str| {
        let list = list_runs(folder.path()).expect("a list");
        list.into_iter().find(|run| run.id == id).expect("the run").has_own_parameters
    };
    let id = session.manifest().id.clone();
    assert!(!has_own_parameters(&id));
    let before = session
        .company()
        .debug_parameters()
        .and_then(|debug_parameters| debug_parameters.value("operations.base_outage_prob"))
        .expect("a value");
    set_parameter(&mut session, "operations.base_outage_prob", json!(0.9), Some(100));
    assert!(session.company().observe().has_own_parameters && has_own_parameters(&id));
    set_parameter(&mut session, "operations.base_outage_prob", before, None);
    assert!(session.company().observe().has_own_parameters, "the settings stay in the record");
    let changed = session
        .company()
        .debug_parameters()
        .and_then(|parameters| parameters.changes())
        .expect("a debug run");
    assert_eq!(
        (changed.scenario.as_deref(), changed.in_force.len(), changed.waiting.len()),
        (Some("default"), 0, 1)
    );
    advance_week(&mut session);
    drop(session);
    let again = Session::open(&folder.path().join(id), Access::Write, true).expect("it opens");
    assert!(again.company().observe().has_own_parameters);
}

/// Returns one parameter of each kind, for example one `group.*.c_max_mean` instead of all 26.
fn parameter_kinds(params: &Value) -> Vec<String> {
    fn collect_parameter_kinds(
        path: &str,
        value: &Value,
        found: &mut std::collections::BTreeMap<String, String>,
    ) {
        let below = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
        match value {
            Value::Object(fields) => {
                fields.iter().for_each(|(name, member)| collect_parameter_kinds(&below(name), member, found))
            }
            Value::Array(list) => {
                let groups: Vec<&str> = Group::all().map(Group::id).collect();
                let is_by_group = list.len() == groups.len() && list.iter().all(Value::is_number);
                for (at, element) in list.iter().enumerate() {
                    let place = if is_by_group { groups[at].to_owned() } else { at.to_string() };
                    let name =
                        ["id", "tier", "level"].iter().find_map(|field| match element.get(*field)? {
                            Value::String(id) => Some(id.clone()),
                            number => Some(number.to_string()),
                        });
                    collect_parameter_kinds(&below(&name.unwrap_or(place)), element, found);
                }
            }
            Value::Null => {}
            _ => {
                let is_name = |part: &str| Group::parse(part).is_some() || part.parse::<u32>().is_ok();
                let kind = path.split('.').map(|part| if is_name(part) { "*" } else { part });
                let kind: Vec<&str> = kind.collect();
                found.entry(kind.join(".")).or_insert_with(|| path.to_owned());
            }
        }
    }
    let mut found = std::collections::BTreeMap::new();
    collect_parameter_kinds("", params, &mut found);
    found.into_values().collect()
}

#[test]
fn every_parameter_can_be_overridden() {
    let new = NewRun {
        mode: Mode::Debug,
        seed: Some(7),
        days: Some(50_000),
        cash: Some(1e12),
        projection: false,
        ..NewRun::default()
    };
    let configuration = Configuration::bundled();
    let fresh = || {
        let mut session = Session::create(new.clone(), &configuration).expect("the run begins");
        apply_opening_decisions(&mut session);
        advance_weeks(&mut session, 6);
        session
    };
    let mut session = fresh();
    let (mut accepted, mut refused) = (0, 0);
    let all = parameter_kinds(&serde_json::to_value(session.params()).expect("JSON"));
    for (at, key) in all.into_iter().enumerate() {
        let old = session
            .company()
            .debug_parameters()
            .and_then(|debug_parameters| debug_parameters.value(&key))
            .expect("its value");
        let value = [json!(0), json!(8)][at % 2].clone();
        if session.set_parameter(&key, &value, None).is_err() {
            refused += 1;
            continue;
        }
        accepted += 1;
        session.step(2, &mut |_| {}).expect("days");
        if session.ended().is_some() || session.set_parameter(&key, &old, None).is_err() {
            session = fresh();
        }
    }
    assert!(accepted > 150 && refused > 50, "{accepted} {refused}");
}

#[test]
fn excessive_leads_are_rejected_and_the_run_stays_intact() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut session = begin_run(runs.path(), Mode::Debug, 140);
    apply_opening_decisions(&mut session);
    advance_weeks(&mut session, 3);
    let today = session.day();
    let crowded = json!([1e6, 1e6, 1e6, 1e6, 1e6, 1e6, 1e6]);
    let usual = session.set_parameter("calendar.weekly", &crowded, None).expect("in its range").old;
    let refused = session.inspect().run_until_breakpoint(7, &mut |_| {}).expect_err("too many leads");
    assert_eq!((refused.code, session.day()), ("too_many_leads", today));
    let forecasts = session.company().naive_forecasts();
    let refused = session.advance("on", &forecasts, Via::Script, &mut |_| {}).expect_err("too many leads");
    assert_eq!((refused.code, session.day()), ("too_many_leads", today));

    // Sets a parameter from a later day on, after single days and weeks have been simulated.
    session.set_parameter("calendar.weekly", &usual, None).expect("as it was");
    session.set_parameter("calendar.weekly", &crowded, Some(today + 3)).expect("it waits");
    let forecasts = session.company().naive_forecasts();
    let week = session.advance("on", &forecasts, Via::Script, &mut |_| {}).expect("two days");
    assert_eq!(session.day(), today + 2);
    assert!(week.remark.is_some_and(|text| text.contains("1,000,000 leads")), "the reason is reported");
    let folder = session.folder().expect("a folder").to_owned();
    drop(session);
    let mut again = Session::open(&folder, Access::Write, true).expect("it replays");
    assert_eq!(again.day(), today + 2);
    again.set_parameter("calendar.weekly", &usual, Some(today + 3)).expect("a later line counts");
    assert_eq!(
        again.inspect().run_until_breakpoint(7, &mut |_| {}).expect("days").week.figures.day,
        today + 9
    );
    drop(again);
    verify(&folder).expect("it verifies");
}

#[test]
fn overrides_require_existing_keys_and_named_list_entries() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = begin_run(folder.path(), Mode::Debug, 140);
    for (key, value, text) in [
        ("group", json!({}), "the table contains no parameter"),
        ("group", json!({ "S1": {} }), "the table contains no parameter"),
        ("calendar", json!({}), "the table contains no parameter"),
    ] {
        let refused = session.set_parameter(key, &value, None).expect_err("nothing is set");
        assert_eq!(refused.code, "parameter_not_allowed");
        assert!(refused.message.contains(text), "{}", refused.message);
    }
    let refused = session.set_parameter("group.S1.c_max_mean", &json!("much"), None).expect_err("no number");
    assert_eq!(refused.field.as_deref(), Some("group.S1.c_max_mean"), "{refused}");
}
