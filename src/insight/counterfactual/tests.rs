//! Re-simulations reproduce recorded states; unedited mechanisms keep their random draws.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::analysis_cache::RecordAnalysis;
use super::branch::*;
use super::edits::{AddedCall, Edits};
use super::memory_snapshot::MemorySnapshot;
use super::recorded_run::RecordedRun;
use super::recorded_steps::{RecordedStep, steps_from_lines};
use novamind_record::folder::configuration::Configuration;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Via;
use novamind_session::{NewRun, Origin, Session, Storage, read_origin};
use novamind_tools::ToolId;
use novamind_world::fixed_inputs::FixedInputs;

fn recorded_run_path(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/recorded").join(name)
}

fn continue_progress(_: u32) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

#[test]
fn resimulation_without_edits_reproduces_recorded_states() {
    for name in ["everything", "development", "release"] {
        let (Origin { manifest, params, .. }, trajectory) =
            read_origin(&recorded_run_path(name)).expect("a run");
        let script = steps_from_lines(&trajectory.lines);
        let start = MemorySnapshot::at_day_0(&manifest, params);
        let outcome = simulate_branch_with_hashes(&start, &script, &Edits::default(), manifest.days);
        let outcome = outcome.expect("it is not stopped");
        let reached: BTreeMap<u32, String> =
            outcome.states.into_iter().map(|(day, (hash, _))| (day, hash)).collect();
        let recorded: BTreeMap<u32, String> = script
            .iter()
            .filter_map(|step| match step {
                RecordedStep::Days(days) => Some((days.until, days.state_hash.clone())),
                RecordedStep::Call(_) | RecordedStep::Parameter(_) => None,
            })
            .collect();
        assert!(recorded.len() > 3, "{name}");
        assert!(outcome.rejected.is_empty(), "{name}: {:?}", outcome.rejected);
        assert_eq!(reached, recorded, "{name}");
    }
}

#[test]
fn every_snapshot_leads_to_the_recorded_state() {
    let mut past = RecordedRun::open(&recorded_run_path("everything")).expect("a run");
    let days: Vec<u32> =
        (0..=past.last_day()).step_by(7).filter(|day| past.has_recorded_state_on(*day)).collect();
    // Requests states in ascending order, in descending order and across several weeks. Each state is compared with
    // the record.
    for day in days.iter().chain(days.iter().rev()).chain(days.last()) {
        let moment = past
            .snapshot_at(*day, &mut continue_progress)
            .expect("the recorded state")
            .expect("it is not stopped");
        assert_eq!(moment.world.day, *day);
    }
}

fn simulate_week_with(edits: Edits) -> BranchOutcome {
    let mut past = RecordedRun::open(&recorded_run_path("development")).expect("a run");
    let eve =
        past.snapshot_at(35, &mut continue_progress).expect("the recorded state").expect("it is not stopped");
    simulate_branch(&eve, past.steps_between(35, 42), &edits, 42, &mut continue_progress)
        .expect("it is not stopped")
}

#[test]
fn due_bills_contain_all_cancellations_and_no_first_bills_of_individuals() {
    let week = simulate_week_with(Edits { counts_due_bills: true, ..Edits::default() });
    let bills =
        || week.due_bills[0].pairs().flat_map(|(group, ages)| ages.iter().map(move |due| (group, due)));
    let renewals = || bills().filter(|(group, _)| !group.is_enterprise()).map(|(_, due)| due);
    let cancelled: u32 = renewals().map(|due| due.cancelled).sum();
    assert!(cancelled > 0 && cancelled == week.weeks[0].cancellations);
    assert!(
        renewals().all(|due| due.cancelled <= due.bills && (due.bills > due.cancelled || due.paid == 0.0))
    );
    let paid: f64 = bills().map(|(_, due)| due.paid).sum();
    assert!(paid > 0.0 && paid < week.weeks[0].payments, "{paid} of {}", week.weeks[0].payments);
}

#[test]
fn unedited_mechanisms_keep_their_random_draws() {
    let free = simulate_week_with(Edits::default());
    let call = AddedCall { day: 35, tool: ToolId::SetPrices, args: json!({"A": 400, "B": 500, "C": 900}) };
    let dear = simulate_week_with(Edits { added_calls: vec![call], ..Edits::default() });
    assert!(dear.rejected.is_empty());
    assert_ne!(dear.weeks, free.weeks);
    let (one, other) = (&free.final_state.world.market, &dear.final_state.world.market);
    assert_eq!(
        (&one.economy, &one.competitors, &one.surges),
        (&other.economy, &other.competitors, &other.surges)
    );
    assert_eq!((&one.drift, &one.yields), (&other.drift, &other.yields));
    let service = |outcome: &BranchOutcome| outcome.days.iter().map(|day| day.outage).collect::<Vec<_>>();
    assert_eq!(service(&free), service(&dear));
    // A setting that applies from the next day changes only the costs of the current day.
    let spend = AddedCall { day: 35, tool: ToolId::SetDailySpend, args: json!({"development": 700}) };
    let developed = simulate_week_with(Edits { added_calls: vec![spend], ..Edits::default() });
    let today = |outcome: &BranchOutcome| (outcome.days[0].new_leads, outcome.days[0].cancellations);
    assert_eq!(today(&free), today(&developed));
    assert!(developed.days[0].total_costs > free.days[0].total_costs);
}

#[test]
fn rejected_call_is_reported_and_other_calls_are_kept() {
    let call = AddedCall { day: 35, tool: ToolId::SetPrices, args: json!({"A": -1}) };
    let outcome = simulate_week_with(Edits { added_calls: vec![call], ..Edits::default() });
    let [RejectedCall { seq: None, day: 35, tool: ToolId::SetPrices, rejection: refusal }] =
        &outcome.rejected[..]
    else {
        panic!("{:?}", outcome.rejected)
    };
    assert_eq!(refusal.code, "price_not_positive");
    assert_eq!(outcome.weeks, simulate_week_with(Edits::default()).weeks);
}

#[test]
fn fixed_inputs_apply_and_simulation_can_be_stopped() {
    let fixed_inputs = FixedInputs { from: 36, economy: true, ..FixedInputs::default() };
    let outcome = simulate_week_with(Edits { fixed_inputs, ..Edits::default() });
    let mut past = RecordedRun::open(&recorded_run_path("development")).expect("a run");
    let eve =
        past.snapshot_at(35, &mut continue_progress).expect("the recorded state").expect("it is not stopped");
    assert_eq!(outcome.final_state.world.market.economy.pmi, eve.world.market.economy.pmi);
    let stopped = simulate_branch(&eve, past.steps_between(35, 42), &Edits::default(), 42, &mut |day| {
        if day == 38 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert!(stopped.is_none());
}

/// Plays a debug run of six weeks, optionally with parameter changes.
fn play_with_parameters(folder: &Path, set: bool) -> Session {
    let new = NewRun {
        mode: Mode::Debug,
        seed: Some(7),
        days: Some(140),
        storage: Storage::Runs(folder.to_owned()),
        projection: false,
        ..NewRun::default()
    };
    let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
    for (tool, args) in [
        ("set_prices", json!({"A": 12, "B": 25, "C": 55})),
        ("set_targeted_ad_spend", json!({"targeted_spend": {"content_marketing": {"S1": 750}}})),
        ("set_capacity_tier", json!({"tier": 1})),
    ] {
        session.call(tool, &args, Via::Script).expect(tool);
    }
    for week in 1..=6 {
        let forecasts = session.company().naive_forecasts();
        session.advance("wait", &forecasts, Via::Script, &mut |_| {}).expect("a week");
        let put = |session: &mut Session, key: &str, value: Value, from| {
            session.set_parameter(key, &value, from).expect(key);
        };
        match week {
            2 if set => put(&mut session, "group.S1.c_max_mean", json!(30), Some(18)),
            3 if set => put(&mut session, "leads.lead_acquisition_cost", json!(20), None),
            4 if set => {
                put(&mut session, "calendar.weekly", json!([3, 3, 3, 3, 3, 3, 3]), Some(36));
                put(&mut session, "satisfaction.satisfaction_ema_alpha", json!(0.6), Some(40));
            }
            _ => {}
        }
    }
    session
}

#[test]
fn changed_parameters_are_reproduced_from_every_snapshot() {
    let folder = tempfile::tempdir().expect("a folder");
    let session = play_with_parameters(folder.path(), true);
    let mut past = RecordedRun::open(session.folder().expect("a folder")).expect("a run");
    for day in [42, 35, 14, 21, 28, 0, 7, 42] {
        past.snapshot_at(day, &mut continue_progress)
            .expect("the recorded state")
            .expect("it is not stopped");
    }
    // A stored state includes parameter changes for later days.
    let eve =
        past.snapshot_at(28, &mut continue_progress).expect("the recorded state").expect("it is not stopped");
    assert_eq!(eve.overrides.scheduled_changes().count(), 0, "decisions of a day follow that day");
    let later =
        past.snapshot_at(35, &mut continue_progress).expect("the recorded state").expect("it is not stopped");
    assert_eq!(later.overrides.scheduled_changes().count(), 2);
    let outcome =
        simulate_branch(&later, past.steps_between(35, 42), &Edits::default(), 42, &mut continue_progress);
    assert_eq!(outcome.expect("it is not stopped").final_state.world.part_hashes(), {
        let end = past
            .snapshot_at(42, &mut continue_progress)
            .expect("the recorded state")
            .expect("it is not stopped");
        end.world.part_hashes()
    });
}

#[test]
fn dropping_parameter_changes_equals_a_run_without_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let changed = play_with_parameters(folder.path(), true);
    let plain = play_with_parameters(folder.path(), false);
    let mut past = RecordedRun::open(changed.folder().expect("a folder")).expect("a run");
    let opening =
        past.snapshot_at(0, &mut continue_progress).expect("the state of day 0").expect("it is not stopped");
    let set = |step: &RecordedStep| match step {
        RecordedStep::Parameter(setting) => Some(setting.change.seq),
        RecordedStep::Call(_) | RecordedStep::Days(_) => None,
    };
    let dropped = past.steps_between(0, 42).iter().filter_map(set).collect();
    let edits = Edits { dropped_lines: dropped, ..Edits::default() };
    let outcome = simulate_branch(&opening, past.steps_between(0, 42), &edits, 42, &mut continue_progress)
        .expect("an outcome");
    assert_eq!(outcome.weeks, plain.weeks());
    assert_ne!(outcome.weeks, changed.weeks());
    // Dropping also works for parameter changes that a stored state contains.
    let later =
        past.snapshot_at(35, &mut continue_progress).expect("the recorded state").expect("it is not stopped");
    let dropped = later.overrides.scheduled_changes().map(|change| change.seq).collect();
    let edits = Edits { dropped_lines: dropped, ..Edits::default() };
    let outcome = simulate_branch(&later, past.steps_between(35, 42), &edits, 42, &mut continue_progress)
        .expect("an outcome");
    assert!(
        outcome.weeks[0].new_individual_leads * 2 < changed.weeks()[5].new_individual_leads,
        "the number of leads tripled"
    );
}

#[test]
fn changed_parameter_is_a_cause() {
    let folder = tempfile::tempdir().expect("a folder");
    let session = play_with_parameters(folder.path(), true);
    let mut causes =
        crate::causes::CauseAnalysis::open(session.folder().expect("a folder")).expect("a debug run");
    let asked = |text: &str| text.parse::<crate::WeekQuestion>().expect("a question");
    let why = causes
        .explain(asked("individual leads 6"), &|_| ControlFlow::Continue(()))
        .expect("causes")
        .expect("an answer");
    let part = why.contributions.iter().find(|part| part.cause == crate::Cause::Parameters);
    assert!(part.is_some_and(|part| part.amount > 1_000.0), "{why:?}");
    let plain = causes
        .explain(asked("individual leads 2"), &|_| ControlFlow::Continue(()))
        .expect("causes")
        .expect("an answer");
    assert!(plain.contributions.iter().all(|part| part.cause != crate::Cause::Parameters));
}
