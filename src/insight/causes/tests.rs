//! The contribution of a changed setting equals the difference from a branch without the change. Contributions add up.
//! Hidden state stays hidden.

use std::ops::ControlFlow;
use std::sync::LazyLock;

use serde_json::json;

use super::*;
use crate::SuspendedSetting;
use crate::counterfactual::test_kit::{
    WEEKS_BEFORE_CHANGE, begin_company, change_setting, play_week, play_weeks,
};
use novamind_record::figures::{GroupFigures, SimulatedWeek, WeekFigure, WeekGroupFigures};
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Via;
use novamind_tools::ToolId;
use novamind_world::identifiers::{ByGroup, Group};

fn continue_progress(_: CauseProgress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn company_quantity(figure: WeekFigure) -> WeekQuantity {
    WeekQuantity::for_company(figure).expect("a figure of the company")
}

fn group_quantity(figure: WeekFigure, id: &str) -> WeekQuantity {
    let group = Group::parse(id).expect("a group");
    WeekQuantity::for_group(figure, group).expect("a figure of a group")
}

fn open_causes(session: &Session) -> CauseAnalysis {
    CauseAnalysis::open(&cause_analysis_folder(session).expect("a folder")).expect("causes")
}

fn explain(session: &Session, quantity: WeekQuantity) -> ChangeExplanation {
    let week_question = WeekQuestion { quantity, week: None };
    open_causes(session)
        .explain(week_question, &continue_progress)
        .expect("an answer")
        .expect("it is not stopped")
}

/// Returns the recorded figures of week `at`, counted from 0, for comparison with re-simulations.
fn recorded_week(session: &Session, at: usize) -> SimulatedWeek {
    let subscribers =
        |at: usize, group| session.company().group_weeks()[at][group].subscribers.0.iter().sum();
    SimulatedWeek {
        figures: session.weeks()[at],
        satisfaction: f64::NAN,
        groups: ByGroup::from_fn(|group| {
            let counted = &session.company().group_weeks()[at][group];
            WeekGroupFigures {
                figures: GroupFigures {
                    leads: counted.leads,
                    signed: counted.signed,
                    left: counted.left,
                    usage: counted.usage.0.iter().sum(),
                    subscribers: subscribers(at, group),
                    ..GroupFigures::default()
                },
                subscribers_before: at.checked_sub(1).map_or(0, |before| subscribers(before, group)),
            }
        }),
    }
}

fn last_value(session: &Session, quantity: WeekQuantity) -> f64 {
    quantity.value_in(&recorded_week(session, session.weeks().len() - 1))
}

/// Returns every figure of the company and the figures of some groups.
fn all_quantities() -> Vec<WeekQuantity> {
    let of_company =
        WeekFigure::ALL.iter().filter(|figure| figure.has_company_value()).copied().map(company_quantity);
    let of_group = WeekFigure::ALL.iter().filter(|figure| figure.has_group_values());
    let of_groups = of_group.flat_map(|figure| ["S1", "S2", "E1"].map(|id| group_quantity(*figure, id)));
    of_company.chain(of_groups).collect()
}

/// Returns whether a cause also exists if nothing differs from the previous week.
fn is_continuing(part: &CauseContribution) -> bool {
    use Cause::{Continued, EarlierMarket, EnterpriseBillsDue, IssuesAtRenewal, RenewalsDue, Usage};
    matches!(
        part.cause,
        Continued(_) | EarlierMarket | RenewalsDue | IssuesAtRenewal | EnterpriseBillsDue | Usage
    )
}

/// Asserts that the contributions and the residual add up to the change.
fn assert_contributions_add_up(why: &ChangeExplanation) {
    let sum = why.contributions.iter().map(|part| part.amount).sum::<f64>() + why.residual;
    assert!(
        (sum - why.total_change()).abs() < 1e-9 * why.total_change().abs().max(1.0),
        "{sum} of {}",
        why.total_change()
    );
}

#[test]
fn changed_settings_rank_first_and_equal_branch_differences() {
    let runs = tempfile::tempdir().expect("a folder");
    let control = play_weeks(runs.path(), Mode::Debug, 3, None);
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
        let session = play_weeks(runs.path(), Mode::Debug, 3, Some((tool.name(), arguments)));
        let quantity = company_quantity(figure);
        let why = explain(&session, quantity);
        assert_contributions_add_up(&why);
        let before = quantity.value_in(&recorded_week(&session, WEEKS_BEFORE_CHANGE as usize - 1));
        assert_eq!((why.before, why.after), (before, last_value(&session, quantity)));
        let paired = last_value(&session, quantity) - last_value(&control, quantity);
        let first = why.contributions.iter().find(|part| !is_continuing(part)).expect("a cause");
        assert_eq!(first.cause, Cause::Calls(tool), "{figure:?}: {why:#?}");
        assert!(
            (first.amount - paired).abs() < 1e-9 && paired != 0.0,
            "{figure:?}: {} of {paired}",
            first.amount
        );
        assert!(matches!(first.details[0], CauseDetail::Setting(_)));
    }
}

#[test]
fn group_contribution_equals_branch_difference() {
    let runs = tempfile::tempdir().expect("a folder");
    let control = play_weeks(runs.path(), Mode::Debug, 3, None);
    let prices = || json!({"A": 24, "B": 50, "C": 110});
    let session = play_weeks(runs.path(), Mode::Debug, 3, Some(("set_prices", prices())));
    let mut causes = open_causes(&session);
    for figure in [
        WeekFigure::Cancellations,
        WeekFigure::Churn,
        WeekFigure::NewSubscribers,
        WeekFigure::Conversion,
        WeekFigure::Subscribers,
        WeekFigure::Usage,
    ] {
        for id in ["S1", "S2"] {
            let quantity = group_quantity(figure, id);
            let week_question = WeekQuestion { quantity, week: None };
            let why = causes
                .explain(week_question, &continue_progress)
                .expect("an answer")
                .expect("it is not stopped");
            assert_contributions_add_up(&why);
            assert_eq!(why.after, last_value(&session, quantity), "{quantity}");
            let paired = last_value(&session, quantity) - last_value(&control, quantity);
            let price = why.contributions.iter().find(|part| part.cause == Cause::Calls(ToolId::SetPrices));
            let amount = price.expect("the price is a cause").amount;
            assert!((amount - paired).abs() < 1e-9, "{quantity}: {amount} of {paired}");
        }
    }
    let churn = explain(&session, group_quantity(WeekFigure::Churn, "S1"));
    let first = churn.contributions.iter().find(|part| !is_continuing(part)).expect("a cause");
    assert_eq!(first.cause, Cause::Calls(ToolId::SetPrices), "{churn:#?}");
    assert!(first.amount > 0.0);
}

#[test]
fn group_contributions_add_up_to_the_company_contributions() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = play_weeks(runs.path(), Mode::Sandbox, 3, Some(("set_prices", json!({"A": 24, "B": 50}))));
    let mut causes = open_causes(&session);
    let mut why = |quantity| {
        let week_question = WeekQuestion { quantity, week: None };
        causes.explain(week_question, &continue_progress).expect("an answer").expect("it is not stopped")
    };
    for figure in [WeekFigure::Cancellations, WeekFigure::NewSubscribers, WeekFigure::Subscribers] {
        let whole = why(company_quantity(figure));
        let mut sums = vec![0.0; whole.contributions.len() + 1];
        for id in ["S1", "S2", "S3"] {
            let explanation = why(group_quantity(figure, id));
            for part in &explanation.contributions {
                let at = whole.contributions.iter().position(|whole| whole.cause == part.cause);
                sums[at.expect("a cause of the company")] += part.amount;
            }
            sums[whole.contributions.len()] += explanation.residual;
        }
        let amounts = whole.contributions.iter().map(|part| part.amount).chain([whole.residual]);
        for (sum, amount) in sums.iter().zip(amounts) {
            assert!((sum - amount).abs() < 1e-9, "{figure:?}: {sums:?} of {whole:#?}");
        }
        assert!(whole.contributions[0].amount != 0.0, "{whole:#?}");
    }
}

#[test]
fn questions_about_a_week_share_simulations() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = play_weeks(runs.path(), Mode::Sandbox, 3, Some(("set_prices", json!({"A": 24}))));
    let mut causes = open_causes(&session);
    let mut simulations = Vec::new();
    for quantity in [
        company_quantity(WeekFigure::Churn),
        group_quantity(WeekFigure::Leads, "S1"),
        company_quantity(WeekFigure::Costs),
    ] {
        let week_question = WeekQuestion { quantity, week: None };
        let why =
            causes.explain(week_question, &continue_progress).expect("an answer").expect("it is not stopped");
        simulations.push(why.simulation_count);
    }
    assert!(
        simulations[0] > 0 && simulations.iter().all(|number| *number == simulations[0]),
        "{simulations:?}"
    );
}

#[test]
fn unchanged_settings_are_not_causes_and_contributions_add_up() {
    let runs = tempfile::tempdir().expect("a folder");
    // Setting a price to its current value is not a change.
    let session = play_weeks(runs.path(), Mode::Debug, 5, Some(("set_prices", json!({"A": 12}))));
    let mut causes = open_causes(&session);
    let mut last_values = Vec::new();
    for week in 2..=WEEKS_BEFORE_CHANGE + 1 {
        let mut values = Vec::new();
        for quantity in all_quantities() {
            let why = match causes.explain(WeekQuestion { quantity, week: Some(week) }, &continue_progress) {
                Ok(why) => why.expect("it is not stopped"),
                Err(refusal) => {
                    assert_eq!(refusal.code, "no_value", "{quantity}, week {week}");
                    values.push((quantity, f64::NAN));
                    continue;
                }
            };
            assert_contributions_add_up(&why);
            let at = week as usize - 1;
            // For a group, satisfaction, reputation, issues and enterprises have values only in consecutive weeks.
            let has_value = quantity
                .group()
                .is_none_or(|group| !group.is_enterprise() && quantity.figure() != WeekFigure::OpenIssues);
            if has_value && !quantity.is_hidden() {
                assert_eq!(
                    why.before,
                    quantity.value_in(&recorded_week(&session, at - 1)),
                    "{quantity}, week {week}"
                );
                assert_eq!(
                    why.after,
                    quantity.value_in(&recorded_week(&session, at)),
                    "{quantity}, week {week}"
                );
            }
            if let Some((_, before)) = last_values
                .iter()
                .find(|(week_quantity, value): &&(_, f64)| *week_quantity == quantity && !value.is_nan())
            {
                assert_eq!(why.before, *before, "{quantity}, week {week}");
            }
            values.push((quantity, why.after));
            assert!(
                why.contributions.iter().all(|part| !part.cause.is_player_decision()),
                "{quantity}, week {week}: {why:?}"
            );
        }
        last_values = values;
    }
    let value = |quantity| {
        last_values.iter().find(|(known, _)| *known == quantity).expect("the value was requested").1
    };
    let s1 = Group::parse("S1").expect("a group");
    assert_eq!(
        value(group_quantity(WeekFigure::Reputation, "S1")),
        session.debug_hidden_state().expect("a debug run").world().market.reputation.get(s1)
    );
    let leads: f64 = Group::all()
        .map(|group| f64::from(session.company().group_weeks()[WEEKS_BEFORE_CHANGE as usize][group].leads))
        .sum();
    assert_eq!(value(company_quantity(WeekFigure::Leads)), leads);
    let mood = session.debug_hidden_state().expect("a debug run").mean_satisfaction(s1).expect("subscribers");
    assert_eq!(value(group_quantity(WeekFigure::Satisfaction, "S1")), mood.0);
}

#[test]
fn hidden_figures_need_a_recorded_inspection() {
    let runs = tempfile::tempdir().expect("a folder");
    let hidden = [
        company_quantity(WeekFigure::Satisfaction),
        group_quantity(WeekFigure::Satisfaction, "S1"),
        group_quantity(WeekFigure::Reputation, "S1"),
    ];
    let inspection_count = |session: &Session| {
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
        let mut session = play_weeks(runs.path(), mode, 3, None);
        for quantity in hidden {
            let week_question = WeekQuestion { quantity, week: None };
            let refused =
                open_causes(&session).explain(week_question, &continue_progress).expect_err("hidden");
            assert_eq!(
                (
                    refused.code,
                    begin_cause_analysis(&mut session, &week_question).map_err(|rejection| rejection.code)
                ),
                ("not_in_this_mode", Err("not_in_this_mode"))
            );
        }
        // An undiscovered group has no figures.
        let unknown = Group::all().find(|group| !group.is_initially_known()).expect("a group to find");
        let quantity = WeekQuantity::for_group(WeekFigure::Leads, unknown).expect("a figure");
        let refused = open_causes(&session)
            .explain(WeekQuestion { quantity, week: None }, &continue_progress)
            .expect_err("unknown");
        assert_eq!(refused.code, "unknown_group");
        assert_eq!(inspection_count(&session), 0);
        session.abandon().expect("it ends");
        for (seen, quantity) in hidden.into_iter().enumerate() {
            begin_cause_analysis(&mut session, &WeekQuestion { quantity, week: None }).expect("a folder");
            assert_eq!(inspection_count(&session), seen + 1);
            assert_contributions_add_up(&explain(&session, quantity));
        }
        begin_cause_analysis(
            &mut session,
            &WeekQuestion { quantity: company_quantity(WeekFigure::Churn), week: None },
        )
        .expect("a folder");
        assert_eq!(inspection_count(&session), hidden.len(), "visible figures need no inspection");
    }
}

#[test]
fn interacting_changes_share_their_effect() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut session = play_weeks(runs.path(), Mode::Debug, 3, Some(("set_prices", json!({"A": 24}))));
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
        let why = explain(&session, company_quantity(figure));
        assert_contributions_add_up(&why);
        assert!(why.contributions.iter().filter(|part| !is_continuing(part)).count() <= 6, "{why:#?}");
        assert!(why.contributions.iter().any(|part| part.cause == Cause::OtherCalls));
        assert!(why.simulation_count <= 64 + 3 * 32, "{}", why.simulation_count);
    }
    let cash = explain(&session, company_quantity(WeekFigure::CashChange));
    assert_eq!(cash.contributions[0].cause, Cause::Calls(ToolId::StartResearchProject), "{cash:#?}");
}

#[test]
fn sandbox_run_groups_market_inputs_and_baseline_run_rejects_analysis() {
    let runs = tempfile::tempdir().expect("a folder");
    let change = || Some(("set_prices", json!({"A": 24})));
    let mut sandbox = play_weeks(runs.path(), Mode::Sandbox, 3, change());
    let causes = |why: &ChangeExplanation| {
        let of_week = why.contributions.iter().filter(|part| !is_continuing(part));
        of_week.map(|part| part.cause).collect::<Vec<_>>()
    };
    let seen = causes(&explain(&sandbox, company_quantity(WeekFigure::Cancellations)));
    let allowed = [Cause::Calls(ToolId::SetPrices), Cause::Market, Cause::Service];
    assert!(seen.iter().all(|cause| allowed.contains(cause)) && seen.len() == 3, "{seen:?}");
    sandbox.abandon().expect("it ends");
    let ended = causes(&explain(&sandbox, company_quantity(WeekFigure::Cancellations)));
    assert!(ended.contains(&Cause::Economy) && !ended.contains(&Cause::Market), "{ended:?}");

    let mut baseline = play_weeks(runs.path(), Mode::Baseline, 3, change());
    let folder = baseline.folder().expect("a folder").to_owned();
    let code = |refusal: Rejection| refusal.code;
    assert_eq!(cause_analysis_folder(&baseline).map_err(code), Err("not_in_this_mode"));
    assert_eq!(CauseAnalysis::open(&folder).map(drop).map_err(code), Err("not_in_this_mode"));
    let trajectory = folder.join("trajectory.jsonl");
    assert_eq!(CauseAnalysis::open(&trajectory).map(drop).map_err(code), Err("not_in_this_mode"));
    baseline.abandon().expect("it ends");
    assert_contributions_add_up(&explain(&baseline, company_quantity(WeekFigure::Cancellations)));
}

#[test]
fn incomparable_weeks_are_rejected_and_analysis_can_be_stopped() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = play_weeks(runs.path(), Mode::Debug, 3, None);
    let mut causes = open_causes(&session);
    let usage = WeekQuestion { quantity: company_quantity(WeekFigure::Usage), week: None };
    for week in [0, 1, WEEKS_BEFORE_CHANGE + 2, u32::MAX] {
        let week_question = WeekQuestion { week: Some(week), ..usage };
        let refusal = causes.explain(week_question, &continue_progress).expect_err("no such week");
        assert_eq!(refusal.code, "week_unknown");
    }
    for stop in [CauseProgress::Replaying(20, 56), CauseProgress::Simulated(2, 0)] {
        let mut causes = open_causes(&session);
        let stopping = |progress| match (progress, stop) {
            (CauseProgress::Replaying(day, _), CauseProgress::Replaying(last, _)) if day == last => {
                ControlFlow::Break(())
            }
            (CauseProgress::Simulated(..), CauseProgress::Simulated(..)) => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        };
        assert_eq!(causes.explain(usage, &stopping), Ok(None), "{stop:?}");
        // A stopped analysis can be repeated.
        assert!(causes.explain(usage, &continue_progress).expect("an answer").is_some());
    }
}

#[test]
fn cause_analysis_does_not_change_the_run() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = play_weeks(runs.path(), Mode::Sandbox, 3, None);
    let folder = session.folder().expect("a folder").to_owned();
    let bytes = || std::fs::read(folder.join("trajectory.jsonl")).expect("a trajectory");
    let (before, hash) = (bytes(), session.state_hash());
    explain(&session, company_quantity(WeekFigure::Payments));
    assert_eq!((bytes(), session.state_hash()), (before, hash));
}

#[test]
fn one_time_purchase_of_the_week_before_is_a_cause() {
    let runs = tempfile::tempdir().expect("a folder");
    let project = Some(("start_research_project", json!({"tier": 1})));
    let mut session = play_weeks(runs.path(), Mode::Sandbox, 3, project);
    let forecasts = session.company().naive_forecasts();
    session.advance("on", &forecasts, Via::Script, &mut |_| {}).expect("a week");
    let paid = -session.weeks()[WEEKS_BEFORE_CHANGE as usize]
        .booked
        .category_total(novamind_world::events::Category::ResearchProject);
    assert!(paid > 0.0);
    let earlier = |why: &ChangeExplanation| {
        let part = why.contributions.iter().find(|part| part.cause == Cause::EarlierPurchases);
        part.map(|part| part.amount)
    };
    let of_research = explain(&session, company_quantity(WeekFigure::Research));
    assert_eq!((earlier(&of_research), of_research.residual), (Some(-paid), 0.0), "{of_research:?}");
    let of_cash = explain(&session, company_quantity(WeekFigure::CashChange));
    assert_contributions_add_up(&of_cash);
    let found = earlier(&of_cash).expect("a cause");
    assert!((found - paid).abs() < 1e-6 * paid, "{of_cash:?}");
    assert_eq!(earlier(&explain(&session, company_quantity(WeekFigure::Leads))), None);
}

/// Explanations of three figures in a week without changed settings.
struct UnchangedWeek {
    seed: u64,
    leads: ChangeExplanation,
    conversion: ChangeExplanation,
    new_subscribers: ChangeExplanation,
}

/// Plays the company of the tests with a seed, and explains three of its weeks.
fn explain_unchanged_weeks(seed: u64) -> [UnchangedWeek; 3] {
    let runs = tempfile::tempdir().expect("a folder");
    let session = play_weeks(runs.path(), Mode::Debug, seed, None);
    let mut causes = open_causes(&session);
    // The analysis keeps the re-simulations of a week for the next figure.
    [4, 6, 8].map(|week| {
        let mut explain = |figure| {
            let question = WeekQuestion { quantity: company_quantity(figure), week: Some(week) };
            causes.explain(question, &continue_progress).expect("an answer").expect("it is not stopped")
        };
        UnchangedWeek {
            seed,
            leads: explain(WeekFigure::IndividualLeads),
            conversion: explain(WeekFigure::Conversion),
            new_subscribers: explain(WeekFigure::NewSubscribers),
        }
    })
}

/// Explained weeks of four companies, which two tests share.
static UNCHANGED_WEEKS: LazyLock<[[UnchangedWeek; 3]; 4]> =
    LazyLock::new(|| [3, 4, 5, 6].map(explain_unchanged_weeks));

#[test]
fn continuing_development_explains_rising_conversion() {
    let development = Cause::Continued(SuspendedSetting::Development);
    for UnchangedWeek { seed, leads, conversion: why, .. } in UNCHANGED_WEEKS.as_flattened() {
        assert_contributions_add_up(why);
        assert!(why.total_change() > 0.0, "{why:#?}");
        let first = &why.contributions[0];
        assert_eq!(first.cause, development, "seed {seed}: {why:#?}");
        let days = CauseDetail::Removed { first: (why.week - 2) * 7 + 1, last: why.week * 7 };
        assert_eq!(first.details, [days]);
        // Whether a lead subscribes is random, so the conversion of a week has a binomial error.
        let variance = |share: f64, leads: f64| share * (1.0 - share) / leads;
        let error = (variance(why.before, leads.before) + variance(why.after, leads.after)).sqrt();
        assert!(why.residual.abs() < 2.5 * error, "seed {seed}, error {error}: {why:#?}");
    }
}

#[test]
fn residual_of_new_subscribers_is_small_without_changed_settings() {
    for UnchangedWeek { seed, new_subscribers: why, .. } in UNCHANGED_WEEKS.as_flattened() {
        let explained: f64 = why.contributions.iter().map(|part| part.amount.abs()).sum();
        assert!(why.residual.abs() < 0.2 * explained, "seed {seed}: {why:#?}");
    }
}

/// Plays a company with steady prices and a wave of signups in week 2. These subscribers renew in weeks 6 and 7.
fn play_signup_wave(runs: &std::path::Path, seed: u64) -> Session {
    let mut session = begin_company(runs, Mode::Debug, seed);
    change_setting(&mut session, "set_capacity_tier", &json!({"capacity_tier": 3}));
    change_setting(&mut session, "set_daily_spend", &json!({"operations": 5000, "development": 2000}));
    for week in 1..=8 {
        let budget = if week == 2 { 30_000 } else { 3000 };
        let ads = json!({"search_ads": {"S1": budget, "S2": budget}, "linkedin": {"S3": budget}});
        change_setting(&mut session, "set_targeted_ad_spend", &ads);
        play_week(&mut session);
    }
    session
}

/// Plays a company that offers every enterprise the price that the enterprise asked for.
fn play_enterprise_deals(runs: &std::path::Path, seed: u64) -> Session {
    let mut session = begin_company(runs, Mode::Debug, seed);
    for (tool, arguments) in [
        ("set_model_tiers", json!({"A": 5, "B": 5, "C": 5})),
        ("set_capacity_tier", json!({"capacity_tier": 4})),
        ("set_daily_spend", json!({"operations": 8000, "development": 20_000})),
        ("set_targeted_dev_spend", json!({"E1": 10_000, "E2": 10_000, "E3": 10_000})),
        ("set_targeted_ad_spend", json!({"linkedin": {"E1": 4000, "E2": 4000, "E3": 4000}})),
    ] {
        change_setting(&mut session, tool, &arguments);
    }
    for _ in 1..=10 {
        let waiting = session.company().observe().waiting;
        let offer = |thread: &novamind_session::WaitingThread| {
            json!([thread.customer, [["C", thread.asked.unwrap_or(20.0)]]])
        };
        let deals: Vec<_> = waiting.iter().map(offer).collect();
        if !deals.is_empty() {
            change_setting(&mut session, "send_enterprise_deal", &json!({ "deals": deals }));
        }
        play_week(&mut session);
    }
    session
}

fn explain_week(causes: &mut CauseAnalysis, figure: WeekFigure, week: u32) -> ChangeExplanation {
    let question = WeekQuestion { quantity: company_quantity(figure), week: Some(week) };
    let why = causes.explain(question, &continue_progress).expect("an answer").expect("it is not stopped");
    assert_contributions_add_up(&why);
    why
}

fn detail_of(why: &ChangeExplanation, cause: Cause) -> CauseDetail {
    why.contributions.iter().find(|part| part.cause == cause).expect("a cause").details[0]
}

#[test]
fn first_renewals_explain_cancellations_and_payments() {
    for seed in [3, 4, 5, 6] {
        let runs = tempfile::tempdir().expect("a folder");
        let session = play_weeks(runs.path(), Mode::Debug, seed, None);
        let mut causes = open_causes(&session);
        for figure in [WeekFigure::Cancellations, WeekFigure::Churn] {
            let why = explain_week(&mut causes, figure, 5);
            assert!(why.total_change() > 0.0 && why.residual.abs() < 1e-9, "seed {seed}: {why:#?}");
            let CauseDetail::RenewalsDue { bills: [0, due] } = detail_of(&why, Cause::RenewalsDue) else {
                panic!("{why:#?}")
            };
            // Individuals who signed up on days 1 to 5 renew on days 31 to 35.
            assert!((1..=session.weeks()[0].new_individual_subscribers).contains(&due), "{due}");
        }
        for figure in [WeekFigure::Payments, WeekFigure::CashChange] {
            let why = explain_week(&mut causes, figure, 5);
            assert!(why.residual.abs() < 0.05 * why.total_change().abs(), "seed {seed}: {why:#?}");
        }
        let subscribers = explain_week(&mut causes, WeekFigure::Subscribers, 5);
        let CauseDetail::RenewalsCancelled { bills, cancelled } = detail_of(&subscribers, Cause::RenewalsDue)
        else {
            panic!("{subscribers:#?}")
        };
        assert!(bills > cancelled && cancelled > 0);
        assert!(subscribers.residual.abs() < 0.1 * subscribers.total_change(), "{subscribers:#?}");
    }
}

#[test]
fn renewals_of_a_signup_wave_explain_cancellations_and_payments() {
    for seed in [3, 4, 5] {
        let runs = tempfile::tempdir().expect("a folder");
        let session = play_signup_wave(runs.path(), seed);
        let mut causes = open_causes(&session);
        for week in [6, 7] {
            let why = explain_week(&mut causes, WeekFigure::Cancellations, week);
            let amounts: f64 = why.contributions.iter().map(|part| part.amount.abs()).sum();
            assert!(why.residual.abs() < 0.2 * amounts, "seed {seed}: {why:#?}");
            for figure in [WeekFigure::Payments, WeekFigure::CashChange] {
                let why = explain_week(&mut causes, figure, week);
                assert_eq!(why.contributions[0].cause, Cause::RenewalsDue, "seed {seed}: {why:#?}");
                assert!(why.residual.abs() < 0.15 * why.total_change().abs(), "seed {seed}: {why:#?}");
            }
        }
    }
}

#[test]
fn enterprise_bills_explain_payments() {
    for seed in [3, 4] {
        let runs = tempfile::tempdir().expect("a folder");
        let session = play_enterprise_deals(runs.path(), seed);
        let mut causes = open_causes(&session);
        for week in [6, 7, 8] {
            let why = explain_week(&mut causes, WeekFigure::Payments, week);
            assert_eq!(why.contributions[0].cause, Cause::EnterpriseBillsDue, "seed {seed}: {why:#?}");
            assert!(why.total_change() != 0.0 && why.residual.abs() < 0.01, "seed {seed}: {why:#?}");
            let cash = explain_week(&mut causes, WeekFigure::CashChange, week);
            assert!(cash.residual.abs() < 0.05 * cash.total_change().abs(), "seed {seed}: {cash:#?}");
        }
    }
}
