//! Breakpoints stop on exactly the days that a scan of all recorded days finds. The writes to a figure add up to its changes.

use std::collections::BTreeMap;
use std::path::Path;

use novamind::insight::{BreakpointHit, Condition, Inspect, WriteSource, WriteTarget};
use novamind::record::folder::configuration::Configuration;
use novamind::record::mode::Mode;
use novamind::record::trajectory::record::{Activity, Via};
use novamind::record::trajectory::{Record, Trajectory};
use novamind::session::{Access, NewRun, ReputationCause, Session, Storage, read_afterwards, verify};
use novamind::world::identifiers::{ByGroup, Group};
use proptest::prelude::*;
use serde_json::json;

use crate::support::company::{
    advance_week, advance_weeks, apply_opening_decisions, call_tool, query_column,
};
use crate::xray::debug_run_with_offers;

const DAYS: u32 = 126;

fn run_in(folder: &Path, mode: Mode, days: u32) -> Session {
    run_with_overrides(folder, mode, days, 1_000_000.0)
}

fn run_with_overrides(folder: &Path, mode: Mode, days: u32, cash: f64) -> Session {
    let new = NewRun {
        cash: (mode == Mode::Debug).then_some(cash),
        seed: Some(7),
        days: Some(days),
        mode,
        participant: (mode == Mode::Baseline).then(|| "P01".to_owned()),
        storage: Storage::Runs(folder.to_owned()),
        ..NewRun::default()
    };
    let mut session = Session::create(new, &Configuration::bundled()).expect("the run begins");
    apply_opening_decisions(&mut session);
    let spend = json!({"targeted_spend": {"content_marketing": {"S1": 900, "S2": 400, "S3": 400}}});
    call_tool(&mut session, "set_targeted_ad_spend", spend);
    session
}

fn group(id: &str) -> Group {
    Group::parse(id).expect("a group")
}

fn condition(text: &str) -> Condition {
    text.parse().unwrap_or_else(|problem| panic!("{text}: {problem:?}"))
}

/// Recorded values of a day, read directly from state and facts.
#[derive(Clone, Copy, Default)]
struct DayRecord {
    cash: f64,
    overload: f64,
    outage: bool,
    rival: bool,
    leads: ByGroup<u32>,
    signed: ByGroup<u32>,
    left: ByGroup<u32>,
    subscribers: ByGroup<u32>,
    satisfaction: ByGroup<f64>,
    reputation: ByGroup<f64>,
}

/// Simulates days without breakpoints, from day 1.
fn record_days(session: &mut Session) -> Vec<DayRecord> {
    let mut all = Vec::new();
    while session.day() < DAYS {
        let mut keep = |report: &novamind::session::DayReport<'_>| {
            let xray = report.xray.expect("a debug run");
            let facts = xray.facts();
            let mut seen = DayRecord {
                cash: report.figures.cash,
                overload: report.figures.overload,
                outage: report.figures.outage,
                rival: xray.world().market.competitors.iter().any(|event| event.day == report.figures.day),
                ..DayRecord::default()
            };
            let groups: BTreeMap<u32, Group> =
                facts.arrivals.iter().map(|arrival| (arrival.customer, arrival.group)).collect();
            groups.values().for_each(|group| seen.leads[*group] += 1);
            for opening in facts
                .openings
                .iter()
                .filter(|subscription_opened| format!("{:?}", subscription_opened.status) == "Subscribed")
            {
                seen.signed[groups[&opening.customer]] += 1;
            }
            for ending in facts
                .endings
                .iter()
                .filter(|subscription_ended| format!("{:?}", subscription_ended.status) == "Cancelled")
            {
                seen.left[ending.group] += 1;
            }
            for group in Group::all() {
                let satisfactions: Vec<f64> =
                    xray.blocks(group).flat_map(|block| block.satisfaction.iter().copied()).collect();
                seen.subscribers[group] = satisfactions.len() as u32;
                seen.satisfaction[group] = satisfactions.iter().sum::<f64>() / satisfactions.len() as f64;
                seen.reputation[group] = xray.reputation(group);
            }
            all.push(seen);
        };
        session.step(7, &mut keep).expect("days");
    }
    all
}

/// An independent implementation of a condition: returns whether the condition is true on a day, counted from 1, of
/// the recorded days.
type ReferenceCondition = fn(&[DayRecord], usize) -> bool;

fn churn_over_7_days(days: &[DayRecord], day: usize) -> Option<f64> {
    let (last, s1) = (day - 1, group("S1"));
    let beginning = last.checked_sub(7)?;
    let left: u32 = days[beginning + 1..=last].iter().map(|seen| seen.left[s1]).sum();
    (days[beginning].subscribers[s1] > 0)
        .then(|| f64::from(left) / f64::from(days[beginning].subscribers[s1]))
}

fn leads_over_7_days(days: &[DayRecord], day: usize) -> Option<u32> {
    let first = day.checked_sub(7)?;
    Some(days[first..day].iter().map(|seen| seen.leads[group("S2")]).sum())
}

const CONDITIONS: [(&str, ReferenceCondition); 12] = [
    ("churn(S1) > 0.05 over 7", |days, day| churn_over_7_days(days, day).is_some_and(|churn| churn > 0.05)),
    ("churn(S1) over 7 > 5%", |days, day| churn_over_7_days(days, day).is_some_and(|churn| churn > 0.05)),
    ("reputation(S3) falls", |days, day| {
        day > 1 && days[day - 1].reputation[group("S3")] < days[day - 2].reputation[group("S3")]
    }),
    ("reputation(S1) > 0.52", |days, day| days[day - 1].reputation[group("S1")] > 0.52),
    ("event rival", |days, day| days[day - 1].rival),
    ("event outage", |days, day| days[day - 1].outage),
    ("cash < 800000", |days, day| days[day - 1].cash < 800_000.0),
    ("subscribers(S1) >= 200", |days, day| days[day - 1].subscribers[group("S1")] >= 200),
    ("satisfaction(S1) < 0.1", |days, day| days[day - 1].satisfaction[group("S1")] < 0.1),
    ("leads(S2) rises over 7", |days, day| {
        leads_over_7_days(days, day)
            .zip(leads_over_7_days(days, day - 1))
            .is_some_and(|(now, before)| now > before)
    }),
    ("overload > 0", |days, day| days[day - 1].overload > 0.0),
    ("conversion(S1) <= 0.3 over 14", |days, day| {
        day >= 14 && {
            let sum = |of: fn(&DayRecord) -> u32| days[day - 14..day].iter().map(of).sum::<u32>();
            let leads = sum(|seen| seen.leads[group("S1")]);
            leads > 0 && f64::from(sum(|seen| seen.signed[group("S1")])) / f64::from(leads) <= 0.3
        }
    }),
];

/// Returns every day on which each condition becomes true, found by a loop over the recorded days.
fn scan_conditions(days: &[DayRecord]) -> Vec<(u32, String)> {
    let mut found = Vec::new();
    for day in 1..=days.len() {
        for (text, is_true_on) in CONDITIONS {
            if is_true_on(days, day) && !(day > 1 && is_true_on(days, day - 1)) {
                found.push((day as u32, condition(text).to_string()));
            }
        }
    }
    found
}

#[test]
fn breakpoints_match_a_full_scan() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut alone = run_in(folder.path(), Mode::Debug, DAYS);
    let days = record_days(&mut alone);
    let mut expected = scan_conditions(&days);
    expected.dedup();
    let mut session_with_breakpoints = run_in(folder.path(), Mode::Debug, DAYS);
    for (text, _) in CONDITIONS {
        session_with_breakpoints.inspect().set_breakpoint(condition(text)).expect("a breakpoint");
    }
    assert_eq!(
        session_with_breakpoints.inspect().breakpoints().expect("a result").len(),
        CONDITIONS.len() - 1,
        "two are the same"
    );
    let mut stops: Vec<(u32, String)> = Vec::new();
    while session_with_breakpoints.day() < DAYS {
        let from = session_with_breakpoints.day();
        let run = session_with_breakpoints.inspect().run_until_breakpoint(1000, &mut |_| {}).expect("days");
        assert_eq!(run.from, from);
        assert!(
            !run.hits.is_empty() || session_with_breakpoints.day() == DAYS,
            "it stops without a hit on day {}",
            session_with_breakpoints.day()
        );
        for BreakpointHit { breakpoint, state: hit_state } in run.hits {
            assert_eq!(hit_state.day, session_with_breakpoints.day());
            stops.push((hit_state.day, breakpoint.condition.to_string()));
            if breakpoint.condition.to_string() == "churn(S1) > 0.05 over 7" {
                let [now, before] =
                    [hit_state.day, hit_state.day - 1].map(|day| churn_over_7_days(&days, day as usize));
                assert_eq!((hit_state.value, hit_state.before), (now, before));
            }
        }
    }
    assert_eq!(stops, expected);
    let kinds: std::collections::BTreeSet<&str> = stops.iter().map(|(_, text)| text.as_str()).collect();
    assert!(kinds.len() >= 9 && stops.len() > 30, "{kinds:?} {}", stops.len());
    // The hash of the facts is excluded: the hash restarts with each line, and a stop at a breakpoint ends a line.
    let parts = |session: &Session| {
        let (_, mut parts) = session.state_hash();
        parts.remove("facts").expect("a part");
        parts
    };
    assert_eq!(parts(&session_with_breakpoints), parts(&alone), "breakpoints change nothing");
    // A search in the finished run, which does not use breakpoints, finds the same days.
    for (text, is_true_on) in CONDITIONS {
        let parsed = condition(text);
        let found: Vec<u32> = alone
            .inspect()
            .find_condition_days(parsed)
            .expect("a result")
            .iter()
            .map(|condition_state| condition_state.day)
            .collect();
        let expected_hits = expected.iter().filter(|(_, text)| *text == parsed.to_string());
        assert_eq!(found, expected_hits.map(|(day, _)| *day).collect::<Vec<_>>(), "{text}");
        let back = alone.inspect().condition_history(parsed).expect("a result");
        let last = |is_true: bool| (1..=days.len()).rev().find(|day| is_true_on(&days, *day) == is_true);
        assert_eq!(back.last_true.map(|state| state.day as usize), last(true), "{text}");
        assert_eq!(back.last_false.map(|state| state.day as usize), last(false), "{text}");
        let since = if back.today.is_true { last(false) } else { last(true) };
        assert_eq!(back.unchanged_since() as usize, since.map_or(1, |day| day + 1), "{text}");
    }
}

#[test]
fn breakpoint_within_a_week_writes_a_step_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = run_in(folder.path(), Mode::Debug, 60);
    advance_week(&mut session);
    let mut other = run_in(folder.path(), Mode::Debug, 60);
    advance_week(&mut other);
    other.step(7, &mut |_| {}).expect("days");
    other.step(3, &mut |_| {}).expect("days");
    // The days that ran without breakpoints are simulated again first.
    session.inspect().set_breakpoint(condition("subscribers(S1) < 0")).expect("a breakpoint");
    let run = session.inspect().run_until_breakpoint(10, &mut |_| {}).expect("days");
    assert_eq!((run.from, session.day(), run.hits.len()), (7, 17, 0));
    assert_eq!(session.state_hash(), other.state_hash());
    let leads = session.inspect().find_condition_days(condition("leads > 0")).expect("a result");
    assert!(!leads.is_empty());
    let removed = session.inspect().clear_breakpoints(Some(1)).expect("it is set");
    assert_eq!(removed[0].condition.to_string(), "subscribers(S1) < 0");
    assert_eq!(
        session.inspect().clear_breakpoints(Some(1)).expect_err("it is gone").to_string(),
        "breakpoint_unknown (number): there is no breakpoint 1; no breakpoint is set"
    );
    session.inspect().run_until_breakpoint(2, &mut |_| {}).expect("days without breakpoints");
    let place = session.folder().expect("a folder").to_owned();
    drop(session);
    let lines = Trajectory::read(&place.join("trajectory.jsonl")).expect("lines");
    let kinds: Vec<String> = lines
        .lines
        .iter()
        .filter_map(|line| match &line.record {
            Record::Step(closing) => Some(format!("step {}", closing.days_run)),
            Record::Activity(Activity::Inspection(inspection)) => {
                Some(format!("{} {} {}", inspection.what, inspection.which, inspection.shown_day))
            }
            _ => None,
        })
        .collect();
    let expected = ["step 7", "step 3", "breakpoint subscribers(S1) < 0 17", "find leads > 0 17", "step 2"];
    assert_eq!(kinds, expected);
    assert_eq!(verify(&place).expect("it verifies").day, 19);
    Session::open(&place, Access::Write, false).expect("it opens");
}

#[test]
fn thirty_day_churn_uses_initial_subscribers() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = run_in(folder.path(), Mode::Debug, DAYS);
    session.inspect().run_until_breakpoint(90, &mut |_| {}).expect("days");
    let churn = session
        .inspect()
        .condition_history(condition("churn(S1) >= 0"))
        .expect("a result")
        .today
        .value
        .expect("a share");
    let now = session.day();
    let sql = format!(
        "SELECT 1.0 * sum(status = 'cancelled' AND end_day <= {now}) / count(*) FROM subscriptions \
         JOIN customers USING (customer_id) WHERE group_id = 'S1' AND start_day <= {now} - 30 \
         AND status IN ('subscribed', 'cancelled') AND (status = 'subscribed' OR end_day > {now} - 30)"
    );
    let churn_from_tables = query_column(&mut session, &sql)[0];
    assert!(churn > 0.0 && (churn - churn_from_tables).abs() < 1e-12, "{churn} {churn_from_tables}");
}

/// Returns a reputation after changes, by the rule of the simulator: the value after each change is clamped to 0..=1
/// and is at least `floor`.
fn apply_changes(from: f64, changes: &[f64], floor: f64) -> f64 {
    changes.iter().fold(from, |value, change| (value + change).clamp(0.0, 1.0).max(floor))
}

/// Counts the writes of each mechanism. Checks that the writes of a day, applied to the recorded value of the previous
/// day, give exactly the recorded value of the day.
fn check_write_chain(
    session: &mut Session,
    targets: &[WriteTarget],
    days: &[u32],
    recorded: &dyn Fn(WriteTarget, u32) -> Option<f64>,
) -> BTreeMap<String, u32> {
    let floor = session.params().reputation.reputation_floor;
    let mut causes: BTreeMap<String, u32> = BTreeMap::new();
    for (target, day) in targets.iter().flat_map(|target| days.iter().map(move |day| (*target, *day))) {
        let figure_writes = session.inspect().figure_writes(target, Some(day)).expect("a result");
        for (value, day) in [(figure_writes.opening_value, day - 1), (figure_writes.closing_value, day)] {
            assert!(
                recorded(target, day).is_none_or(|known| known == value),
                "{target} on day {day}: {value}"
            );
        }
        let mut now = figure_writes.opening_value;
        for write in &figure_writes.writes {
            assert_eq!(write.before.to_bits(), now.to_bits(), "{target} on day {day}: {write:?}");
            now = match target {
                WriteTarget::Reputation(_) => apply_changes(now, &write.changes, floor),
                _ => write.changes.iter().fold(now, |value, change| value + change),
            };
            assert_eq!(write.after.to_bits(), now.to_bits(), "{target} on day {day}: {write:?}");
            let cause = format!("{:?}", write.source);
            let cause = cause.split(['{', ' ']).next().unwrap_or_default().to_owned();
            *causes.entry(cause).or_default() += 1;
        }
        assert_eq!(
            now.to_bits(),
            figure_writes.closing_value.to_bits(),
            "{target} on day {day}: {:?}",
            figure_writes.writes
        );
    }
    causes
}

fn group_targets(groups: &[&str]) -> Vec<WriteTarget> {
    let of = |id: &&str| [WriteTarget::Reputation(group(id)), WriteTarget::Subscribers(group(id))];
    groups.iter().flat_map(of).collect()
}

fn assert_causes_occurred(causes: &BTreeMap<String, u32>, expected: &[&str]) {
    for cause in expected {
        assert!(causes.contains_key(*cause), "{cause}: {causes:?}");
    }
}

#[test]
fn writes_sum_to_the_change_exactly() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = run_with_overrides(folder.path(), Mode::Debug, DAYS, 5_000_000.0);
    let spend =
        json!({"targeted_spend": {"linkedin": {"E1": 6000}, "content_marketing": {"S1": 900, "S3": 900}}});
    call_tool(&mut session, "set_targeted_ad_spend", spend);
    let mut days = record_days_up_to(&mut session, 70);
    call_tool(&mut session, "set_prices", json!({"A": 19, "B": 60}));
    call_tool(&mut session, "research_group", json!({"group_id": "S2"}));
    days.extend(record_days_up_to(&mut session, DAYS));
    let recorded = |target: WriteTarget, day: u32| {
        let seen = day.checked_sub(1).map(|at| days[at as usize]);
        Some(match (target, seen) {
            (WriteTarget::Reputation(group), Some(seen)) => seen.reputation[group],
            (WriteTarget::Reputation(_), None) => 0.5,
            (WriteTarget::Cash, Some(seen)) => seen.cash,
            (WriteTarget::Cash, None) => 5_000_000.0,
            (WriteTarget::Subscribers(group), Some(seen)) => seen.subscribers[group].into(),
            (WriteTarget::Subscribers(_), None) => 0.0,
        })
    };
    let targets = [group_targets(&["S1", "S3", "E1"]), vec![WriteTarget::Cash]].concat();
    let causes = check_write_chain(&mut session, &targets, &[1, 2, 40, 71, 86, 101, 126], &recorded);
    let expected = [
        "Reputation(Cancellations)",
        "Reputation(Contributions(ReputationContribution",
        "Reputation(Spillover(Spillover",
        "LedgerEntries(GroupResearch)",
        "LedgerEntries(Compute)",
        "Cancellations(Quality)",
        "Signups(ContentMarketing)",
    ];
    assert_causes_occurred(&causes, &expected);
}

#[test]
fn writes_cover_signed_and_lost_enterprises() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = debug_run_with_offers(folder.path(), 6);
    // The player does not reply to enterprises from this day on.
    advance_weeks(&mut session, 6);
    let sql = |what: &str| {
        format!(
            "SELECT DISTINCT {what} AS day FROM subscriptions JOIN customers USING (customer_id) \
                 WHERE group_id IN ('E1', 'E2', 'E3') AND status IN ('subscribed', 'cancelled') AND day > 1 \
                 AND day <= 84 ORDER BY day"
        )
    };
    let began = query_column(&mut session, &sql("start_day"));
    let ended = query_column(&mut session, &sql("end_day"));
    let days: Vec<u32> = began.iter().take(2).chain(ended.iter().take(3)).map(|day| *day as u32).collect();
    let causes = check_write_chain(&mut session, &group_targets(&["E1", "E2", "E3"]), &days, &|_, _| None);
    assert_causes_occurred(&causes, &["Reputation(LostEnterprise)", "FirstDeals"]);
}

fn record_days_up_to(session: &mut Session, day: u32) -> Vec<DayRecord> {
    let mut all = Vec::new();
    while session.day() < day {
        let mut keep = |report: &novamind::session::DayReport<'_>| {
            let xray = report.xray.expect("a debug run");
            let mut seen = DayRecord { cash: report.figures.cash, ..DayRecord::default() };
            for group in Group::all() {
                seen.subscribers[group] = xray.subscribers(group);
                seen.reputation[group] = xray.reputation(group);
            }
            all.push(seen);
        };
        let days = day - session.day();
        session.step(days, &mut keep).expect("days");
    }
    all
}

#[test]
fn spillover_has_the_sign_of_its_source() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = run_in(folder.path(), Mode::Debug, DAYS);
    record_days_up_to(&mut session, 60);
    call_tool(&mut session, "set_model_tiers", json!({"A": 1, "B": 1, "C": 1}));
    call_tool(&mut session, "set_prices", json!({"A": 28, "B": 45}));
    record_days_up_to(&mut session, 110);
    let mut spilled = 0;
    for day in (61..=110).step_by(3) {
        let source_writes = session
            .inspect()
            .figure_writes(WriteTarget::Reputation(group("S1")), Some(day))
            .expect("a result");
        let source_change = source_writes.writes.iter().find_map(|write| match write.source {
            WriteSource::Reputation(ReputationCause::Contributions(_)) => Some(write.changes[0]),
            _ => None,
        });
        let figure_writes = session
            .inspect()
            .figure_writes(WriteTarget::Reputation(group("S3")), Some(day))
            .expect("a result");
        for write in figure_writes.writes {
            let WriteSource::Reputation(ReputationCause::Spillover(spill)) = write.source else { continue };
            if spill.source == group("S1") {
                assert_eq!(Some(spill.change), source_change);
                assert_eq!(write.changes, [spill.change * spill.weight * spill.factor]);
                assert_eq!(write.requested_change() < 0.0, spill.change < 0.0);
                assert!(
                    write.requested_change() < 0.0 && write.after <= write.before
                        || write.requested_change() > 0.0 && write.after >= write.before
                );
                spilled += 1;
            }
        }
    }
    assert!(spilled > 3, "{spilled}");
}

#[test]
fn hidden_figures_cannot_stop_unfinished_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    for mode in [Mode::Baseline, Mode::Sandbox, Mode::Lesson] {
        let mut session = run_in(folder.path(), mode, 28);
        advance_week(&mut session);
        let place = session.folder().expect("a folder").to_owned();
        let lines = || Trajectory::read(&place.join("trajectory.jsonl")).expect("lines").lines.len();
        let (before, hidden_condition) = (lines(), condition("reputation(S3) falls"));
        let reputation = WriteTarget::Reputation(group("S3"));
        let mut inspector = session.inspect();
        let rejections = [
            inspector.set_breakpoint(hidden_condition).expect_err("hidden"),
            inspector.breakpoints().expect_err("hidden"),
            inspector.clear_breakpoints(None).expect_err("hidden"),
            inspector.clear_breakpoints(Some(99)).expect_err("hidden"),
            inspector.run_until_breakpoint(3, &mut |_| {}).expect_err("hidden"),
            inspector.condition_history(hidden_condition).expect_err("hidden"),
            inspector.breakpoint_histories(Some(99)).expect_err("hidden"),
            inspector.find_condition_days(hidden_condition).expect_err("hidden"),
            inspector.figure_writes(reputation, None).expect_err("hidden"),
            inspector.figure_writes(WriteTarget::Cash, Some(9000)).expect_err("hidden"),
        ];
        drop(inspector);
        for refusal in rejections {
            assert_eq!(
                refusal.to_string(),
                "not_in_this_mode: the x-ray is available in debug runs and in runs that have ended"
            );
        }
        assert_eq!((lines(), session.day()), (before, 7), "no line is recorded and no day is simulated");
        // After the run is abandoned, the user can search its days but cannot continue it.
        session.abandon().expect("it ends");
        let number = session.inspect().set_breakpoint(hidden_condition).expect("a breakpoint").number;
        assert_eq!(session.inspect().breakpoint_histories(Some(number)).expect("a result").len(), 1);
        assert!(session.inspect().figure_writes(reputation, Some(3)).expect("a result").day == 3);
        assert_eq!(
            session.inspect().run_until_breakpoint(3, &mut |_| {}).expect_err("over").code,
            "not_in_this_mode"
        );
        drop(session);
        let trajectory = Trajectory::read(&place.join("trajectory.jsonl")).expect("lines");
        let after = read_afterwards(&place, &trajectory).expect("lines");
        let looks = after
            .lines
            .iter()
            .filter(|line| matches!(line.record, Record::Activity(Activity::Inspection(_))));
        assert_eq!(looks.count(), 2);
    }
}

#[test]
fn in_memory_run_supports_breakpoints_if_every_day_was_observed() {
    let new = NewRun { seed: Some(7), days: Some(40), mode: Mode::Debug, ..NewRun::default() };
    let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
    apply_opening_decisions(&mut session);
    session.inspect().set_breakpoint(condition("new_subscribers >= 1")).expect("a breakpoint");
    let run = session.inspect().run_until_breakpoint(30, &mut |_| {}).expect("days");
    assert_eq!(run.hits.len(), 1);
    let forecasts = session.company().naive_forecasts();
    session.advance("wait", &forecasts, Via::Script, &mut |_| {}).expect("a week");
    assert_eq!(
        session.inspect().run_until_breakpoint(3, &mut |_| {}).expect_err("a gap").code,
        "not_possible"
    );
}

#[test]
fn condition_errors_name_column_and_similar_words() {
    for (text, column, expected) in [
        ("", 1, "a figure is missing: cash, recurring_revenue"),
        ("chrun(S1) > 0.05", 1, "chrun is not a figure; did you mean churn"),
        ("churn(S11) > 0.05", 7, "S11 is not a group; did you mean S1"),
        ("churn(S1 > 0.05", 10, "a closing bracket is missing"),
        ("churn(S1)", 10, "one of > >= < <= rises falls is expected"),
        ("churn(S1) = 0.05", 11, "one of > >= < <= rises falls is expected, not ="),
        ("churn(S1) > many", 13, "a number is expected, not many"),
        ("churn(S1) > 1e400", 13, "a number is expected, not 1e400"),
        ("churn(S1) > 0.05 over", 22, "\"over\" needs a number of days"),
        ("churn(S1) > 0.05 over 0", 18, "\"over\" needs 1 to 1000 days"),
        ("churn(S1) > 0.05 over 1.5", 23, "a whole number is expected, not 1.5"),
        ("cash(S1) < 5", 1, "cash is a figure of the whole company"),
        ("reputation falls", 1, "reputation is a figure of a group"),
        ("reputation(S1) falls over 7", 22, "reputation is a value of one day"),
        ("event comet", 7, "comet is not an event; "),
        ("event rival tomorrow", 13, "unexpected tomorrow at the end"),
    ] {
        let problem = text.parse::<Condition>().expect_err(text);
        assert!(problem.message.contains(expected), "{text}: {}", problem.message);
        assert_eq!(problem.column, column, "{text}: {}", problem.message);
    }
    for (text, written) in [
        ("Churn(s1)>5%  # a comment", "churn(S1) > 0.05 over 30"),
        ("new-subscribers over 7 days falls", "new_subscribers falls over 7"),
        ("cash < 1_000_000", "cash < 1000000"),
        ("leads(D_S01) rises over 1 day", "leads(D_S01) rises"),
    ] {
        assert_eq!(condition(text).to_string(), written);
        assert_eq!(condition(&condition(text).to_string()), condition(text), "{text}");
    }
    let error_message = |text: &str| WriteTarget::parse_with_day(text).expect_err(text).message;
    assert!(error_message("reputatoin(S1)").contains("did you mean reputation?"));
    assert!(error_message("reputation").starts_with("reputation is a figure of a group"));
    assert!(error_message("cash(S1)").starts_with("cash is a figure of the whole company"));
    assert!(error_message("cash yesterday").contains("a whole number is expected"));
    assert_eq!(
        WriteTarget::parse_with_day("subscribers(s2) 84"),
        Ok((WriteTarget::Subscribers(group("S2")), Some(84)))
    );
}

proptest! {
    #[test]
    fn parsing_a_condition_never_panics(text in "\\PC{0,60}", wild in "[a-z(S1)<>=0-9.%_ #-]{0,40}") {
        for text in [text, wild] {
            if let Ok(condition) = text.parse::<Condition>() {
                prop_assert_eq!(condition.to_string().parse(), Ok(condition));
            }
            let _ = WriteTarget::parse_with_day(&text);
        }
    }
}

#[test]
fn breakpoint_search_distinguishes_always_true_from_never_true() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = run_in(folder.path(), Mode::Debug, 56);
    advance_weeks(&mut session, 2);
    for text in ["cash > 1", "cash < 1"] {
        session.inspect().set_breakpoint(condition(text)).expect("it is set");
    }
    let run = session.inspect().run_until_breakpoint(5, &mut |_| {}).expect("days");
    assert_eq!(run.hits, []);
    let still_true: Vec<_> = run
        .still_true
        .iter()
        .map(|true_breakpoint| (true_breakpoint.hit.breakpoint.number, true_breakpoint.last_true_day))
        .collect();
    assert_eq!(still_true, [(1, 19)]);
    assert_eq!(session.company().observe().cash_change_days, 5);
}

/// The first subscribers sign up in the third week. 30 days later, the churn over 30 days has its first value, for the
/// subscribers of the first day only.
#[test]
fn change_conditions_start_at_the_second_value() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = run_in(folder.path(), Mode::Debug, 70);
    session.inspect().set_breakpoint(condition("churn(S1) >= 0")).expect("it is set");
    let run = session.inspect().run_until_breakpoint(69, &mut |_| {}).expect("days");
    assert_eq!(run.hits, [], "it is true from the start, which is not a change");
    let numbers: Vec<_> =
        run.still_true.iter().map(|true_breakpoint| true_breakpoint.first_value_day).collect();
    let began = numbers[0].expect("it became true on one of the days");
    assert!(began > 30, "{began}");
    let found = session.inspect().find_condition_days(condition("churn(S1) >= 0")).expect("days");
    let states: Vec<_> = found
        .iter()
        .map(|condition_state| {
            (condition_state.day, condition_state.is_first_value, condition_state.becomes_true())
        })
        .collect();
    assert_eq!(states, [(began, true, false)], "a condition that is true from the start is reported as such");
    // Conditions on daily values are checked from the first day on.
    assert_eq!(
        session.inspect().find_condition_days(condition("subscribers(S1) >= 0")).expect("days").len(),
        1
    );
}
