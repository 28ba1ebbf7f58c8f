//! Known changes are found with the effect of a branch without them; contributions add up; hidden state stays hidden.

use std::ops::ControlFlow;

use serde_json::json;

use super::*;
use crate::counterfactual::test_kit::{WEEKS, played};
use novamind_record::figures::{GroupOfWeek, MeasuredGroup, SimulatedWeek, WeekFigure};
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Via;
use novamind_tools::ToolId;
use novamind_world::identifiers::{ByGroup, Group};

fn on(_: WhyProgress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn company(figure: WeekFigure) -> WeekQuantity {
    WeekQuantity::of_company(figure).expect("a figure of the company")
}

fn group(figure: WeekFigure, id: &str) -> WeekQuantity {
    let group = Group::parse(id).expect("a group");
    WeekQuantity::of_group(figure, group).expect("a figure of a group")
}

fn causes_of(session: &Session) -> Causes {
    Causes::read(&folder_of_causes(session).expect("a folder")).expect("causes")
}

fn why(session: &Session, quantity: WeekQuantity) -> Why {
    let asked = WeekQuestion { quantity, week: None };
    causes_of(session).why(asked, &on).expect("an answer").expect("it is not stopped")
}

/// Returns a week of a session, counted from 0, for comparison with re-simulations.
fn week_of(session: &Session, at: usize) -> SimulatedWeek {
    let subscribers =
        |at: usize, group| session.company().group_weeks()[at][group].subscribers.0.iter().sum();
    SimulatedWeek {
        figures: session.weeks()[at],
        satisfaction: f64::NAN,
        groups: ByGroup::from_fn(|group| {
            let counted = &session.company().group_weeks()[at][group];
            GroupOfWeek {
                measured: MeasuredGroup {
                    leads: counted.leads,
                    signed: counted.signed,
                    left: counted.left,
                    usage: counted.usage.0.iter().sum(),
                    subscribers: subscribers(at, group),
                    ..MeasuredGroup::default()
                },
                subscribers_before: at.checked_sub(1).map_or(0, |before| subscribers(before, group)),
            }
        }),
    }
}

fn last(session: &Session, quantity: WeekQuantity) -> f64 {
    quantity.of(&week_of(session, session.weeks().len() - 1))
}

/// Returns every figure of the company and of some groups.
fn all_quantities() -> Vec<WeekQuantity> {
    let of_company = WeekFigure::ALL.iter().filter(|figure| figure.is_of_company()).copied().map(company);
    let of_group = WeekFigure::ALL.iter().filter(|figure| figure.is_of_group());
    let of_groups = of_group.flat_map(|figure| ["S1", "S2", "E1"].map(|id| group(*figure, id)));
    of_company.chain(of_groups).collect()
}

/// Asserts that contributions and residual add up to the change.
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
        let quantity = company(figure);
        let why = why(&session, quantity);
        assert_whole(&why);
        let before = quantity.of(&week_of(&session, WEEKS as usize - 1));
        assert_eq!((why.before, why.after), (before, last(&session, quantity)));
        let paired = last(&session, quantity) - last(&control, quantity);
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
fn a_figure_of_a_group_is_worth_what_the_branch_without_a_change_lacks_in_that_group() {
    let runs = tempfile::tempdir().expect("a folder");
    let control = played(runs.path(), Mode::Debug, 3, None);
    let prices = || json!({"A": 24, "B": 50, "C": 110});
    let session = played(runs.path(), Mode::Debug, 3, Some(("set_prices", prices())));
    let mut causes = causes_of(&session);
    for figure in [
        WeekFigure::Cancellations,
        WeekFigure::Churn,
        WeekFigure::NewSubscribers,
        WeekFigure::Conversion,
        WeekFigure::Subscribers,
        WeekFigure::Usage,
    ] {
        for id in ["S1", "S2"] {
            let quantity = group(figure, id);
            let asked = WeekQuestion { quantity, week: None };
            let why = causes.why(asked, &on).expect("an answer").expect("it is not stopped");
            assert_whole(&why);
            assert_eq!(why.after, last(&session, quantity), "{quantity}");
            let paired = last(&session, quantity) - last(&control, quantity);
            let price = why.parts.iter().find(|part| part.cause == Cause::Calls(ToolId::SetPrices));
            let amount = price.expect("the price is a cause").amount;
            assert!((amount - paired).abs() < 1e-9, "{quantity}: {amount} of {paired}");
        }
    }
    let churn = why(&session, group(WeekFigure::Churn, "S1"));
    assert_eq!(churn.parts[0].cause, Cause::Calls(ToolId::SetPrices), "{churn:#?}");
    assert!(churn.parts[0].amount > 0.0);
}

#[test]
fn cancellations_of_the_groups_add_up_to_those_of_the_company_cause_by_cause() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = played(runs.path(), Mode::Sandbox, 3, Some(("set_prices", json!({"A": 24, "B": 50}))));
    let mut causes = causes_of(&session);
    let mut why = |quantity| {
        let asked = WeekQuestion { quantity, week: None };
        causes.why(asked, &on).expect("an answer").expect("it is not stopped")
    };
    for figure in [WeekFigure::Cancellations, WeekFigure::NewSubscribers, WeekFigure::Subscribers] {
        let whole = why(company(figure));
        let mut sums = vec![0.0; whole.parts.len() + 1];
        for id in ["S1", "S2", "S3"] {
            let own = why(group(figure, id));
            for part in &own.parts {
                let at = whole.parts.iter().position(|whole| whole.cause == part.cause);
                sums[at.expect("a cause of the company")] += part.amount;
            }
            sums[whole.parts.len()] += own.rest;
        }
        let amounts = whole.parts.iter().map(|part| part.amount).chain([whole.rest]);
        for (sum, amount) in sums.iter().zip(amounts) {
            assert!((sum - amount).abs() < 1e-9, "{figure:?}: {sums:?} of {whole:#?}");
        }
        assert!(whole.parts[0].amount != 0.0, "{whole:#?}");
    }
}

#[test]
fn all_figures_of_a_week_share_its_simulations() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = played(runs.path(), Mode::Sandbox, 3, Some(("set_prices", json!({"A": 24}))));
    let mut causes = causes_of(&session);
    let mut simulations = Vec::new();
    for quantity in [company(WeekFigure::Churn), group(WeekFigure::Leads, "S1"), company(WeekFigure::Costs)] {
        let asked = WeekQuestion { quantity, week: None };
        let why = causes.why(asked, &on).expect("an answer").expect("it is not stopped");
        simulations.push(why.simulations);
    }
    assert!(simulations[0] > 0 && simulations.iter().all(|own| *own == simulations[0]), "{simulations:?}");
}

#[test]
fn without_a_change_no_decision_is_a_cause_and_every_figure_adds_up() {
    let runs = tempfile::tempdir().expect("a folder");
    // Setting the current value is not a change.
    let session = played(runs.path(), Mode::Debug, 5, Some(("set_prices", json!({"A": 12}))));
    let mut causes = causes_of(&session);
    let mut last_values = Vec::new();
    for week in 2..=WEEKS + 1 {
        let mut values = Vec::new();
        for quantity in all_quantities() {
            let why = match causes.why(WeekQuestion { quantity, week: Some(week) }, &on) {
                Ok(why) => why.expect("it is not stopped"),
                Err(refusal) => {
                    assert_eq!(refusal.code, "no_value", "{quantity}, week {week}");
                    values.push((quantity, f64::NAN));
                    continue;
                }
            };
            assert_whole(&why);
            let at = week as usize - 1;
            // Satisfaction, reputation, issues and enterprises of a group have values only in consecutive weeks.
            let is_told = quantity
                .group()
                .is_none_or(|group| !group.is_enterprise() && quantity.figure() != WeekFigure::OpenIssues);
            if is_told && !quantity.is_hidden() {
                assert_eq!(why.before, quantity.of(&week_of(&session, at - 1)), "{quantity}, week {week}");
                assert_eq!(why.after, quantity.of(&week_of(&session, at)), "{quantity}, week {week}");
            }
            if let Some((_, before)) =
                last_values.iter().find(|(own, value): &&(_, f64)| *own == quantity && !value.is_nan())
            {
                assert_eq!(why.before, *before, "{quantity}, week {week}");
            }
            values.push((quantity, why.after));
            assert!(why.parts.iter().all(|part| !part.cause.is_own()), "{quantity}, week {week}: {why:?}");
        }
        last_values = values;
    }
    let value = |quantity| last_values.iter().find(|(own, _)| *own == quantity).expect("it was asked").1;
    let s1 = Group::parse("S1").expect("a group");
    assert_eq!(
        value(group(WeekFigure::Reputation, "S1")),
        session.xray().expect("a debug run").world().market.reputation.of(s1)
    );
    let leads: f64 =
        Group::all().map(|own| f64::from(session.company().group_weeks()[WEEKS as usize][own].leads)).sum();
    assert_eq!(value(company(WeekFigure::Leads)), leads);
    let mood = session.xray().expect("a debug run").mood(s1).expect("subscribers");
    assert_eq!(value(group(WeekFigure::Satisfaction, "S1")), mood.0);
}

#[test]
fn what_no_screen_shows_is_asked_in_debug_runs_and_ended_ones_only_and_is_a_look() {
    let runs = tempfile::tempdir().expect("a folder");
    let hidden = [
        company(WeekFigure::Satisfaction),
        group(WeekFigure::Satisfaction, "S1"),
        group(WeekFigure::Reputation, "S1"),
    ];
    let looks = |session: &Session| {
        let folder = session.folder().expect("a folder").to_owned();
        let lines =
            ["trajectory.jsonl", "afterwards.jsonl"].map(|name| std::fs::read_to_string(folder.join(name)));
        lines
            .iter()
            .flatten()
            .flat_map(|text| text.lines())
            .filter(|line| line.contains("\"kind\":\"xray\""))
            .count()
    };
    for mode in [Mode::Sandbox, Mode::Lesson] {
        let mut session = played(runs.path(), mode, 3, None);
        for quantity in hidden {
            let asked = WeekQuestion { quantity, week: None };
            let refused = causes_of(&session).why(asked, &on).expect_err("hidden");
            assert_eq!(
                (refused.code, begin_why(&mut session, &asked).map_err(|own| own.code)),
                ("not_in_this_mode", Err("not_in_this_mode"))
            );
        }
        // A group that is not discovered has no figures.
        let unknown = Group::all().find(|own| !own.initially_known()).expect("a group to find");
        let quantity = WeekQuantity::of_group(WeekFigure::Leads, unknown).expect("a figure");
        let refused =
            causes_of(&session).why(WeekQuestion { quantity, week: None }, &on).expect_err("unknown");
        assert_eq!(refused.code, "unknown_group");
        assert_eq!(looks(&session), 0);
        session.end().expect("it ends");
        for (seen, quantity) in hidden.into_iter().enumerate() {
            begin_why(&mut session, &WeekQuestion { quantity, week: None }).expect("a folder");
            assert_eq!(looks(&session), seen + 1);
            assert_whole(&why(&session, quantity));
        }
        begin_why(&mut session, &WeekQuestion { quantity: company(WeekFigure::Churn), week: None })
            .expect("a folder");
        assert_eq!(looks(&session), hidden.len(), "visible figures need no inspection");
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
    let forecasts = session.company().naive_forecasts();
    session.advance("on", &forecasts, Via::Script, &mut |_| {}).expect("a week");
    for figure in [WeekFigure::Payments, WeekFigure::CashChange, WeekFigure::Cancellations] {
        let why = why(&session, company(figure));
        assert_whole(&why);
        assert!(why.parts.len() <= 6, "{why:#?}");
        assert!(why.parts.iter().any(|part| part.cause == Cause::OtherCalls));
        assert!(why.simulations <= 64, "{}", why.simulations);
    }
    let cash = why(&session, company(WeekFigure::CashChange));
    assert_eq!(cash.parts[0].cause, Cause::Calls(ToolId::StartResearchProject), "{cash:#?}");
}

#[test]
fn a_player_is_told_of_the_market_as_one_and_of_nothing_in_a_baseline() {
    let runs = tempfile::tempdir().expect("a folder");
    let change = || Some(("set_prices", json!({"A": 24})));
    let mut sandbox = played(runs.path(), Mode::Sandbox, 3, change());
    let causes = |why: &Why| why.parts.iter().map(|part| part.cause).collect::<Vec<_>>();
    let seen = causes(&why(&sandbox, company(WeekFigure::Cancellations)));
    let allowed = [Cause::Calls(ToolId::SetPrices), Cause::Market, Cause::Service];
    assert!(seen.iter().all(|cause| allowed.contains(cause)) && seen.len() == 3, "{seen:?}");
    sandbox.end().expect("it ends");
    let ended = causes(&why(&sandbox, company(WeekFigure::Cancellations)));
    assert!(ended.contains(&Cause::Economy) && !ended.contains(&Cause::Market), "{ended:?}");

    let mut baseline = played(runs.path(), Mode::Baseline, 3, change());
    let folder = baseline.folder().expect("a folder").to_owned();
    let code = |refusal: Refusal| refusal.code;
    assert_eq!(folder_of_causes(&baseline).map_err(code), Err("not_in_this_mode"));
    assert_eq!(Causes::read(&folder).map(drop).map_err(code), Err("not_in_this_mode"));
    let trajectory = folder.join("trajectory.jsonl");
    assert_eq!(Causes::read(&trajectory).map(drop).map_err(code), Err("not_in_this_mode"));
    baseline.end().expect("it ends");
    assert_whole(&why(&baseline, company(WeekFigure::Cancellations)));
}

#[test]
fn weeks_that_cannot_be_compared_are_refused_and_work_can_be_stopped() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = played(runs.path(), Mode::Debug, 3, None);
    let mut causes = causes_of(&session);
    let usage = WeekQuestion { quantity: company(WeekFigure::Usage), week: None };
    for week in [0, 1, WEEKS + 2, u32::MAX] {
        let asked = WeekQuestion { week: Some(week), ..usage };
        let refusal = causes.why(asked, &on).expect_err("no such week");
        assert_eq!(refusal.code, "week_unknown");
    }
    for stop in [WhyProgress::Reaching(20, 56), WhyProgress::Simulated(2, 0)] {
        let mut causes = causes_of(&session);
        let stopping = |progress| match (progress, stop) {
            (WhyProgress::Reaching(day, _), WhyProgress::Reaching(last, _)) if day == last => {
                ControlFlow::Break(())
            }
            (WhyProgress::Simulated(..), WhyProgress::Simulated(..)) => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        };
        assert_eq!(causes.why(usage, &stopping), Ok(None), "{stop:?}");
        // A stopped question can be repeated.
        assert!(causes.why(usage, &on).expect("an answer").is_some());
    }
}

#[test]
fn asking_leaves_the_run_as_it_is() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = played(runs.path(), Mode::Sandbox, 3, None);
    let folder = session.folder().expect("a folder").to_owned();
    let bytes = || std::fs::read(folder.join("trajectory.jsonl")).expect("a trajectory");
    let (before, hash) = (bytes(), session.state_hash());
    why(&session, company(WeekFigure::Payments));
    assert_eq!((bytes(), session.state_hash()), (before, hash));
}

#[test]
fn what_was_paid_once_the_week_before_is_a_cause_and_no_luck() {
    let runs = tempfile::tempdir().expect("a folder");
    let project = Some(("start_research_project", json!({"tier": 1})));
    let mut session = played(runs.path(), Mode::Sandbox, 3, project);
    let forecasts = session.company().naive_forecasts();
    session.advance("on", &forecasts, Via::Script, &mut |_| {}).expect("a week");
    let paid = -session.weeks()[WEEKS as usize].booked.of(novamind_world::events::Category::ResearchProject);
    assert!(paid > 0.0);
    let earlier = |why: &Why| {
        let part = why.parts.iter().find(|part| part.cause == Cause::EarlierPurchases);
        part.map(|part| part.amount)
    };
    let of_research = why(&session, company(WeekFigure::Research));
    assert_eq!((earlier(&of_research), of_research.rest), (Some(-paid), 0.0), "{of_research:?}");
    let of_cash = why(&session, company(WeekFigure::CashChange));
    assert_whole(&of_cash);
    let found = earlier(&of_cash).expect("a cause");
    assert!((found - paid).abs() < 1e-6 * paid, "{of_cash:?}");
    assert_eq!(earlier(&why(&session, company(WeekFigure::Leads))), None);
}
