//! Re-simulations reproduce recorded states; unedited mechanisms keep their random draws.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::branch::*;
use super::edits::{AddedCall, Edits};
use super::kept_state::KeptState;
use super::last_read::OfRecord;
use super::past::Past;
use super::script::{Move, moves};
use novamind_record::folder::configuration::Configuration;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Via;
use novamind_session::{NewRun, Origin, Session, Storage, read_recorded as read};
use novamind_tools::ToolId;
use novamind_world::held::Held;

fn recorded(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/recorded").join(name)
}

fn on(_: u32) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

#[test]
fn without_an_edit_every_recorded_state_is_reached_again() {
    for name in ["everything", "development", "release"] {
        let (Origin { manifest, params, .. }, trajectory) = read(&recorded(name)).expect("a run");
        let script = moves(&trajectory.lines);
        let start = KeptState::opening(&manifest, params);
        let outcome = counterfactual_with_hashes(&start, &script, &Edits::default(), manifest.days);
        let outcome = outcome.expect("it is not stopped");
        let reached: BTreeMap<u32, String> =
            outcome.states.into_iter().map(|(day, (hash, _))| (day, hash)).collect();
        let recorded: BTreeMap<u32, String> = script
            .iter()
            .filter_map(|step| match step {
                Move::Days(days) => Some((days.until, days.state_hash.clone())),
                Move::Call(_) | Move::Parameter(_) => None,
            })
            .collect();
        assert!(recorded.len() > 3, "{name}");
        assert!(outcome.refused.is_empty(), "{name}: {:?}", outcome.refused);
        assert_eq!(reached, recorded, "{name}");
    }
}

#[test]
fn a_moment_leads_to_the_recorded_state_from_wherever_it_is_reached() {
    let mut past = Past::read(&recorded("everything")).expect("a run");
    let days: Vec<u32> = (0..=past.last_day()).step_by(7).filter(|day| past.ends_on(*day)).collect();
    // Forward, backward, and over several weeks; every state is compared with the record.
    for day in days.iter().chain(days.iter().rev()).chain(days.last()) {
        let moment = past.moment(*day, &mut on).expect("the recorded state").expect("it is not stopped");
        assert_eq!(moment.world.day, *day);
    }
}

fn week_under(edits: Edits) -> BranchOutcome {
    let mut past = Past::read(&recorded("development")).expect("a run");
    let eve = past.moment(35, &mut on).expect("the recorded state").expect("it is not stopped");
    counterfactual(&eve, past.between(35, 42), &edits, 42, &mut on).expect("it is not stopped")
}

#[test]
fn what_is_not_edited_keeps_its_luck() {
    let free = week_under(Edits::default());
    let call = AddedCall { day: 35, tool: ToolId::SetPrices, args: json!({"A": 400, "B": 500, "C": 900}) };
    let dear = week_under(Edits { added: vec![call], ..Edits::default() });
    assert!(dear.refused.is_empty());
    assert_ne!(dear.weeks, free.weeks);
    let (one, other) = (&free.end.world.market, &dear.end.world.market);
    assert_eq!(
        (&one.economy, &one.competitors, &one.surges),
        (&other.economy, &other.competitors, &other.surges)
    );
    assert_eq!((&one.drift, &one.yields), (&other.drift, &other.yields));
    let service = |outcome: &BranchOutcome| outcome.days.iter().map(|day| day.outage).collect::<Vec<_>>();
    assert_eq!(service(&free), service(&dear));
    // A setting that applies from the next day changes only the costs of the current day.
    let spend = AddedCall { day: 35, tool: ToolId::SetDailySpend, args: json!({"development": 700}) };
    let developed = week_under(Edits { added: vec![spend], ..Edits::default() });
    let today = |outcome: &BranchOutcome| (outcome.days[0].new_leads, outcome.days[0].cancellations);
    assert_eq!(today(&free), today(&developed));
    assert!(developed.days[0].total_costs > free.days[0].total_costs);
}

#[test]
fn a_call_that_is_no_longer_possible_is_told_and_nothing_else_is_lost() {
    let call = AddedCall { day: 35, tool: ToolId::SetPrices, args: json!({"A": -1}) };
    let outcome = week_under(Edits { added: vec![call], ..Edits::default() });
    let [RefusedCall { seq: None, day: 35, tool: ToolId::SetPrices, refusal }] = &outcome.refused[..] else {
        panic!("{:?}", outcome.refused)
    };
    assert_eq!(refusal.code, "price_not_positive");
    assert_eq!(outcome.weeks, week_under(Edits::default()).weeks);
}

#[test]
fn inputs_are_held_for_the_days_that_are_simulated_and_work_can_be_stopped() {
    let held = Held { from: 36, economy: true, ..Held::default() };
    let outcome = week_under(Edits { held, ..Edits::default() });
    let mut past = Past::read(&recorded("development")).expect("a run");
    let eve = past.moment(35, &mut on).expect("the recorded state").expect("it is not stopped");
    assert_eq!(outcome.end.world.market.economy.pmi, eve.world.market.economy.pmi);
    let stopped = counterfactual(&eve, past.between(35, 42), &Edits::default(), 42, &mut |day| {
        if day == 38 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert!(stopped.is_none());
}

/// Plays a debug run of six weeks, optionally with parameter changes.
fn with_parameters(folder: &Path, set: bool) -> Session {
    let new = NewRun {
        mode: Mode::Debug,
        seed: Some(7),
        days: Some(140),
        storage: Storage::Runs(folder.to_owned()),
        projection: false,
        ..NewRun::default()
    };
    let mut session = Session::create(new, &Configuration::shipped()).expect("a run");
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
fn without_an_edit_a_run_with_set_parameters_reaches_its_states_from_wherever_it_is_begun() {
    let folder = tempfile::tempdir().expect("a folder");
    let session = with_parameters(folder.path(), true);
    let mut past = Past::read(session.folder().expect("a folder")).expect("a run");
    for day in [42, 35, 14, 21, 28, 0, 7, 42] {
        past.moment(day, &mut on).expect("the recorded state").expect("it is not stopped");
    }
    // A stored state includes parameter changes for later days.
    let eve = past.moment(28, &mut on).expect("the recorded state").expect("it is not stopped");
    assert_eq!(eve.overrides.waiting().count(), 0, "decisions of a day follow that day");
    let later = past.moment(35, &mut on).expect("the recorded state").expect("it is not stopped");
    assert_eq!(later.overrides.waiting().count(), 2);
    let outcome = counterfactual(&later, past.between(35, 42), &Edits::default(), 42, &mut on);
    assert_eq!(outcome.expect("it is not stopped").end.world.part_hashes(), {
        let end = past.moment(42, &mut on).expect("the recorded state").expect("it is not stopped");
        end.world.part_hashes()
    });
}

#[test]
fn a_run_whose_settings_of_parameters_are_dropped_is_the_run_without_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let changed = with_parameters(folder.path(), true);
    let plain = with_parameters(folder.path(), false);
    let mut past = Past::read(changed.folder().expect("a folder")).expect("a run");
    let opening = past.moment(0, &mut on).expect("the opening").expect("it is not stopped");
    let set = |step: &Move| match step {
        Move::Parameter(setting) => Some(setting.change.seq),
        Move::Call(_) | Move::Days(_) => None,
    };
    let dropped = past.between(0, 42).iter().filter_map(set).collect();
    let edits = Edits { dropped, ..Edits::default() };
    let outcome = counterfactual(&opening, past.between(0, 42), &edits, 42, &mut on).expect("an outcome");
    assert_eq!(outcome.weeks, plain.weeks());
    assert_ne!(outcome.weeks, changed.weeks());
    // The same applies to changes that a stored state contains.
    let later = past.moment(35, &mut on).expect("the recorded state").expect("it is not stopped");
    let dropped = later.overrides.waiting().map(|change| change.seq).collect();
    let edits = Edits { dropped, ..Edits::default() };
    let outcome = counterfactual(&later, past.between(35, 42), &edits, 42, &mut on).expect("an outcome");
    assert!(
        outcome.weeks[0].new_individual_leads * 2 < changed.weeks()[5].new_individual_leads,
        "three times as many leads came"
    );
}

#[test]
fn a_parameter_that_was_set_is_a_cause_like_others() {
    let folder = tempfile::tempdir().expect("a folder");
    let session = with_parameters(folder.path(), true);
    let mut causes = crate::why::Causes::read(session.folder().expect("a folder")).expect("a debug run");
    let asked = |text: &str| text.parse::<crate::WeekQuestion>().expect("a question");
    let why = causes
        .why(asked("individual leads 6"), &|_| ControlFlow::Continue(()))
        .expect("causes")
        .expect("an answer");
    let part = why.parts.iter().find(|part| part.cause == crate::Cause::Parameters);
    assert!(part.is_some_and(|part| part.amount > 1_000.0), "{why:?}");
    let plain = causes
        .why(asked("individual leads 2"), &|_| ControlFlow::Continue(()))
        .expect("causes")
        .expect("an answer");
    assert!(plain.parts.iter().all(|part| part.cause != crate::Cause::Parameters));
}
