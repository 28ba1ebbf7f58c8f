//! Planted changes are found, worth what a branch without them lacks; parts add up; what is hidden stays hidden.

use std::ops::ControlFlow;

use serde_json::json;

use super::*;
use crate::session::counterfactual::test_kit::{WEEKS, played};
use crate::session::folder::mode::Mode;
use crate::session::trajectory::record::Via;
use crate::tools::ToolId;

fn on(_: WhyProgress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn why(session: &Session, figure: WeekFigure) -> Why {
    let folder = session.folder_of_causes().expect("a folder");
    let mut causes = Causes::read(&folder).expect("causes");
    causes.why(figure, None, &on).expect("an answer").expect("it is not stopped")
}

/// Parts and rest add up to the change.
fn assert_whole(why: &Why) {
    let sum = why.parts.iter().map(|part| part.amount).sum::<f64>() + why.rest;
    assert!((sum - why.change()).abs() < 1e-9 * why.change().abs().max(1.0), "{sum} of {}", why.change());
}

#[test]
fn planted_changes_come_first_and_are_worth_what_a_branch_without_them_lacks() {
    let runs = tempfile::tempdir().expect("a folder");
    let control = played(runs.path(), Mode::Debug, 3, None);
    for (tool, arguments, figure) in [
        (ToolId::SetPrices, json!({"A": 24, "B": 50, "C": 110}), WeekFigure::Cancellations),
        (ToolId::SetModelTiers, json!({"A": 4, "B": 5, "C": 5}), WeekFigure::NewSubscribers),
        (ToolId::SetUsageQuotas, json!({"A": 20, "B": 30, "C": 40}), WeekFigure::Usage),
        (ToolId::SetTargetedAdSpend, json!({"search_ads": {"S1": 40_000}}), WeekFigure::IndividualLeads),
        (ToolId::SetDailySpend, json!({"development": 90_000}), WeekFigure::RunningCosts),
        (ToolId::SetCapacityTier, json!({"capacity_tier": 0}), WeekFigure::OverloadPeak),
        (ToolId::SetDailySpend, json!({"operations": 50_000}), WeekFigure::OpenIssues),
        (ToolId::SetPromotion, json!({"global_promotion": 8}), WeekFigure::Payments),
    ] {
        let session = played(runs.path(), Mode::Debug, 3, Some((tool.name(), arguments)));
        let why = why(&session, figure);
        assert_whole(&why);
        let last = |session: &Session| figure.of(session.weeks().last().expect("a week"));
        assert_eq!(
            (why.before, why.after),
            (figure.of(&session.weeks()[WEEKS as usize - 1]), last(&session))
        );
        let paired = last(&session) - last(&control);
        let first = &why.parts[0];
        assert_eq!(first.cause, Cause::Calls(tool), "{figure:?}: {why:#?}");
        assert!(
            (first.amount - paired).abs() < 1e-9 && paired != 0.0,
            "{figure:?}: {} of {paired}",
            first.amount
        );
        assert!(matches!(first.details[0], Detail::Setting(_)));
    }
}

#[test]
fn without_a_change_no_decision_is_a_cause_and_every_figure_adds_up() {
    let runs = tempfile::tempdir().expect("a folder");
    // What is set to what it was is no change.
    let session = played(runs.path(), Mode::Debug, 5, Some(("set_prices", json!({"A": 12}))));
    let mut causes = Causes::read(&session.folder_of_causes().expect("a folder")).expect("causes");
    for week in 2..=WEEKS + 1 {
        for figure in WeekFigure::ALL {
            let why = match causes.why(*figure, Some(week), &on) {
                Ok(why) => why.expect("it is not stopped"),
                Err(refusal) => {
                    assert_eq!((refusal.code, *figure), ("no_value", WeekFigure::Conversion), "week {week}");
                    continue;
                }
            };
            assert_whole(&why);
            let at = week as usize - 1;
            assert_eq!(why.before, figure.of(&session.weeks()[at - 1]), "{figure:?}, week {week}");
            assert_eq!(why.after, figure.of(&session.weeks()[at]), "{figure:?}, week {week}");
            assert!(why.parts.iter().all(|part| !part.cause.is_own()), "{figure:?}, week {week}: {why:?}");
        }
    }
}

#[test]
fn several_changes_share_what_they_did_together() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut session = played(runs.path(), Mode::Debug, 3, Some(("set_prices", json!({"A": 24}))));
    for (tool, arguments) in [
        ("set_prices", json!({"A": 9, "B": 20})),
        ("set_model_tiers", json!({"A": 4})),
        ("set_usage_quotas", json!({"A": 50, "B": 250_000, "C": 1_200_000})),
        ("set_promotion", json!({"global_promotion": 3})),
        ("set_daily_spend", json!({"operations": 900})),
        ("set_ads_strength", json!({"global_strength": 0.5})),
        ("set_capacity_tier", json!({"capacity_tier": 3})),
        ("start_research_project", json!({"tier": 1})),
    ] {
        session.call(tool, &arguments, Via::Script).unwrap_or_else(|refusal| panic!("{tool}: {refusal}"));
    }
    let forecasts = session.naive_forecasts();
    session.advance("on", &forecasts, Via::Script, &mut |_| {}).expect("a week");
    for figure in [WeekFigure::Payments, WeekFigure::CashChange, WeekFigure::Cancellations] {
        let why = why(&session, figure);
        assert_whole(&why);
        assert!(why.parts.len() <= 6, "{why:#?}");
        assert!(why.parts.iter().any(|part| part.cause == Cause::OtherCalls));
        assert!(why.simulations <= 64, "{}", why.simulations);
    }
    let cash = why(&session, WeekFigure::CashChange);
    assert_eq!(cash.parts[0].cause, Cause::Calls(ToolId::StartResearchProject), "{cash:#?}");
}

#[test]
fn a_player_is_told_of_the_market_as_one_and_of_nothing_in_a_baseline() {
    let runs = tempfile::tempdir().expect("a folder");
    let change = || Some(("set_prices", json!({"A": 24})));
    let mut sandbox = played(runs.path(), Mode::Sandbox, 3, change());
    let causes = |why: &Why| why.parts.iter().map(|part| part.cause).collect::<Vec<_>>();
    let seen = causes(&why(&sandbox, WeekFigure::Cancellations));
    let allowed = [Cause::Calls(ToolId::SetPrices), Cause::Market, Cause::Service];
    assert!(seen.iter().all(|cause| allowed.contains(cause)) && seen.len() == 3, "{seen:?}");
    sandbox.end().expect("it ends");
    let ended = causes(&why(&sandbox, WeekFigure::Cancellations));
    assert!(ended.contains(&Cause::Economy) && !ended.contains(&Cause::Market), "{ended:?}");

    let mut baseline = played(runs.path(), Mode::Baseline, 3, change());
    let folder = baseline.folder().expect("a folder").to_owned();
    let code = |refusal: Refusal| refusal.code;
    assert_eq!(baseline.folder_of_causes().map_err(code), Err("not_in_this_mode"));
    assert_eq!(Causes::read(&folder).map(drop).map_err(code), Err("not_in_this_mode"));
    let trajectory = folder.join("trajectory.jsonl");
    assert_eq!(Causes::read(&trajectory).map(drop).map_err(code), Err("not_in_this_mode"));
    baseline.end().expect("it ends");
    assert_whole(&why(&baseline, WeekFigure::Cancellations));
}

#[test]
fn weeks_that_cannot_be_compared_are_refused_and_work_can_be_stopped() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = played(runs.path(), Mode::Debug, 3, None);
    let mut causes = Causes::read(&session.folder_of_causes().expect("a folder")).expect("causes");
    for week in [0, 1, WEEKS + 2, u32::MAX] {
        let refusal = causes.why(WeekFigure::Usage, Some(week), &on).expect_err("no such week");
        assert_eq!(refusal.code, "week_unknown");
    }
    for stop in [WhyProgress::Reaching(20, 56), WhyProgress::Simulated(2, 0)] {
        let mut causes = Causes::read(&session.folder_of_causes().expect("a folder")).expect("causes");
        let stopping = |progress| match (progress, stop) {
            (WhyProgress::Reaching(day, _), WhyProgress::Reaching(last, _)) if day == last => {
                ControlFlow::Break(())
            }
            (WhyProgress::Simulated(..), WhyProgress::Simulated(..)) => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        };
        assert_eq!(causes.why(WeekFigure::Usage, None, &stopping), Ok(None), "{stop:?}");
        // What was stopped can be asked again.
        assert!(causes.why(WeekFigure::Usage, None, &on).expect("an answer").is_some());
    }
}

#[test]
fn asking_leaves_the_run_as_it_is() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = played(runs.path(), Mode::Sandbox, 3, None);
    let folder = session.folder().expect("a folder").to_owned();
    let bytes = || std::fs::read(folder.join("trajectory.jsonl")).expect("a trajectory");
    let (before, hash) = (bytes(), session.state_hash());
    why(&session, WeekFigure::Payments);
    assert_eq!((bytes(), session.state_hash()), (before, hash));
}
