//! The past leads to where it led; what is not edited keeps its luck.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::PathBuf;

use serde_json::json;

use super::branch::*;
use super::edits::{AddedCall, Edits};
use super::kept_state::KeptState;
use super::past::Past;
use super::script::{Move, moves};
use crate::session::playback::{Origin, read};
use crate::tools::ToolId;
use crate::world::held::Held;

fn recorded(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/recorded").join(name)
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
    // Forward, back, and over several weeks at once; every moment is compared with the record.
    for day in days.iter().chain(days.iter().rev()).chain(days.last()) {
        let moment = past.moment(*day, &mut on).expect("the recorded state").expect("it is not stopped");
        assert_eq!(moment.world.day, *day);
    }
}

/// A week of a run, and what comes of it under some edits.
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
    // What acts from tomorrow on changes nothing of today but what it costs.
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
    let [(None, ToolId::SetPrices, refusal)] = &outcome.refused[..] else { panic!("{:?}", outcome.refused) };
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
