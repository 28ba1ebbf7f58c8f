//! Tests with companies that have one problem each: this problem must be the first action item. A healthy company must
//! have no action items.

use serde_json::{Value, json};

use super::*;
use crate::test_kit::advance_weeks;
use novamind_record::folder::configuration::Configuration;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Via;
use novamind_session::identifiers::Plan;
use novamind_session::{NewRun, Storage};
use novamind_tools::ToolId;

/// Settings of a healthy company with sales, leads and spare capacity.
fn healthy_calls() -> Vec<(&'static str, Value)> {
    vec![
        ("set_prices", json!({"A": 11, "B": 24, "C": 52})),
        ("set_model_tiers", json!({"A": 1, "B": 2, "C": 3})),
        ("set_usage_quotas", json!({"A": 2_000, "B": 4_000, "C": 9_000})),
        ("set_daily_spend", json!({"operations": 900, "development": 100})),
        ("set_targeted_dev_spend", json!({"targeted_spend": {"S1": 5_000}})),
        ("set_targeted_ad_spend", json!({"targeted_spend": {"content_marketing": {"S1": 600}}})),
        ("set_capacity_tier", json!({"tier": 4})),
    ]
}

fn healthy_calls_with(changed: &[(&'static str, Value)]) -> Vec<(&'static str, Value)> {
    let mut calls = healthy_calls();
    for (tool, arguments) in changed {
        calls.retain(|(text, _)| text != tool);
        calls.push((tool, arguments.clone()));
    }
    calls
}

fn play_company(seed: u64, cash: f64, calls: &[(&str, Value)], weeks: usize) -> Session {
    let new = NewRun { seed: Some(seed), cash: Some(cash), storage: Storage::Memory, ..NewRun::default() };
    let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
    for (tool, arguments) in calls {
        session.call(tool, arguments, Via::Script).unwrap_or_else(|refusal| panic!("{tool}: {refusal}"));
    }
    advance_weeks(&mut session, weeks);
    session
}

/// Returns the first action item. Also checks that the tools accept the proposed arguments of all items.
#[track_caller]
fn first_action_item(session: &Session) -> ActionItem {
    let all = action_items(session);
    let first = all.first().unwrap_or_else(|| panic!("no need was found")).clone();
    for need in &all {
        assert!(need.at_risk.is_finite() && need.at_risk > 0.0, "{need:?}");
        if let ActionTarget::Call(tool, arguments) = &need.target {
            let preview =
                session.preview_call(tool, arguments).unwrap_or_else(|refusal| panic!("{need:?}: {refusal}"));
            assert!(!preview.changes.is_empty(), "the proposal changes something: {need:?}");
        }
    }
    first
}

#[track_caller]
fn assert_first_problem(session: &Session, problem: Problem, words: &[&str]) -> ActionItem {
    let need = first_action_item(session);
    assert_eq!(need.problem, problem, "{:#?}", action_items(session));
    for word in words {
        assert!(need.describe().contains(word), "{word} is missing: {}", need.describe());
    }
    need
}

fn group(id: &str) -> Group {
    Group::parse(id).expect("a group")
}

#[test]
fn missing_prices_are_found() {
    let need = assert_first_problem(
        &play_company(3, 1e6, &[], 0),
        Problem::NoPrice,
        &["No plan has a price", "Mean monthly budgets: S1 $", "Half of each estimate: A $"],
    );
    let ActionTarget::Call(ToolId::SetPrices, arguments) = &need.target else { panic!("{need:?}") };
    let proposal = need.proposal.as_deref().unwrap_or_default();
    let estimates: Vec<f64> = proposal
        .split("(estimate $")
        .skip(1)
        .filter_map(|rest| rest.split(')').next()?.replace(',', "").parse().ok())
        .collect();
    let prices: Vec<f64> = ["A", "B", "C"].iter().filter_map(|plan| arguments[plan].as_f64()).collect();
    let halves: Vec<f64> = estimates.iter().take(3).map(|estimate| (estimate / 2.0).round()).collect();
    assert_eq!(prices, halves, "{proposal}");
}

#[test]
fn zero_quotas_are_found() {
    let calls = healthy_calls_with(&[("set_usage_quotas", json!({"A": 0, "B": 0, "C": 0}))]);
    for weeks in [0, 2] {
        let session = play_company(3, 1e6, &calls, weeks);
        assert_first_problem(
            &session,
            Problem::NoQuota,
            &["Plans A, B, C have a price and a quota of 0", "units a day cover"],
        );
    }
    let one = play_company(
        3,
        1e6,
        &healthy_calls_with(&[("set_usage_quotas", json!({"A": 2_000, "B": 0, "C": 9_000}))]),
        0,
    );
    let need = assert_first_problem(&one, Problem::NoQuota, &["Plan B has a price and a quota of 0"]);
    let ActionTarget::Call(ToolId::SetUsageQuotas, arguments) = &need.target else { panic!("{need:?}") };
    assert_eq!(
        (&arguments["A"], &arguments["C"]),
        (&json!(2_000), &json!(9_000)),
        "the others are unchanged"
    );
}

#[test]
fn missing_leads_are_found() {
    let calls = healthy_calls_with(&[("set_targeted_ad_spend", json!({"targeted_spend": {}}))]);
    for weeks in [0, 1] {
        assert_first_problem(
            &play_company(3, 1e6, &calls, weeks),
            Problem::NoLeads,
            &["No leads arrive", "$50 a day per channel"],
        );
    }
}

#[test]
fn prices_above_every_budget_are_found() {
    let session = play_company(
        3,
        1e6,
        &healthy_calls_with(&[("set_prices", json!({"A": 900, "B": 950, "C": 990}))]),
        2,
    );
    let need = assert_first_problem(
        &session,
        Problem::NoSales(group("S1")),
        &["none signed", "The lowest price is $900 for A."],
    );
    let ActionTarget::Call(ToolId::SetPrices, arguments) = &need.target else { panic!("{need:?}") };
    let budget = session.params().group(group("S1")).c_max_mean;
    let price = arguments["A"].as_f64().expect("a price");
    assert!(price > 0.0 && price <= budget, "{price} is within the true budget {budget}");
}

#[test]
fn quality_below_the_requirement_is_found() {
    let calls = healthy_calls_with(&[
        ("set_targeted_ad_spend", json!({"targeted_spend": {"search_ads": {"S2": 900}}})),
        ("set_targeted_dev_spend", json!({"targeted_spend": {}})),
        ("set_prices", json!({"A": 20, "B": 30, "C": 40})),
    ]);
    let session = play_company(7, 1e6, &calls, 2);
    let need = assert_first_problem(
        &session,
        Problem::NoSales(group("S2")),
        &["The best quality within the estimated budget of $"],
    );
    let ActionTarget::Call(ToolId::SetTargetedDevSpend, arguments) = &need.target else { panic!("{need:?}") };
    assert_eq!(arguments["targeted_spend"]["S2"], 5_000.0);
    let mut session = session;
    session.call("set_targeted_dev_spend", arguments, Via::Script).expect("the proposal");
    assert!(
        action_items(&session).iter().all(|need| need.problem != Problem::NoSales(group("S2"))),
        "it is on its way"
    );
}

#[test]
fn plan_with_higher_quality_but_too_small_quota_is_named() {
    let calls = healthy_calls_with(&[
        ("set_targeted_ad_spend", json!({"targeted_spend": {"search_ads": {"S2": 900}}})),
        ("set_targeted_dev_spend", json!({"targeted_spend": {}})),
        ("set_prices", json!({"A": 20, "B": 30, "C": 40})),
        ("set_usage_quotas", json!({"A": 2_000, "B": 4_000, "C": 4})),
    ]);
    let session = play_company(7, 1e6, &calls, 2);
    let quality = session.company().delivered_quality();
    let delivered_quality =
        quality.iter().find(|group_quality| group_quality.group == group("S2")).expect("S2 is known");
    assert!(
        delivered_quality.by_plan[Plan::C] > delivered_quality.by_plan[Plan::B],
        "C has the better model"
    );
    let named = format!(
        "B delivers quality {:.3}. C delivers {:.3} within the estimated budget of $",
        delivered_quality.by_plan[Plan::B],
        delivered_quality.by_plan[Plan::C]
    );
    assert_first_problem(
        &session,
        Problem::NoSales(group("S2")),
        &[named.as_str(), "but its quota is too small"],
    );
}

#[test]
fn offers_changed_today_are_not_diagnosed() {
    let plain = healthy_calls_with(&[
        ("set_prices", json!({"A": 12, "B": 25, "C": 55})),
        ("set_model_tiers", json!({"A": 1, "B": 1, "C": 1})),
        ("set_targeted_dev_spend", json!({"targeted_spend": {}})),
        ("set_targeted_ad_spend", json!({"targeted_spend": {"content_marketing": {"S1": 750}}})),
    ]);
    let mut session = play_company(42, 1e6, &plain, 1);
    let about_s1 = |session: &Session| {
        action_items(session).into_iter().find(|need| need.problem == Problem::NoSales(group("S1")))
    };
    let need = about_s1(&session).expect("few sign");
    assert!(
        need.text.contains("The best quality within the estimated budget of $")
            && need.text.contains(" on A."),
        "{}",
        need.text
    );
    let ActionTarget::Call(ToolId::SetModelTiers, arguments) = &need.target else { panic!("{need:?}") };
    session.call("set_model_tiers", arguments, Via::Script).expect("the proposal");
    assert_eq!(about_s1(&session), None, "no customer has seen it yet");
}

#[test]
fn too_small_quota_is_named_if_quality_suffices() {
    let calls = healthy_calls_with(&[("set_usage_quotas", json!({"A": 4, "B": 4, "C": 4}))]);
    let session = play_company(7, 1e6, &calls, 3);
    assert_first_problem(&session, Problem::NoSales(group("S1")), &["is 4 units a day."]);
}

#[test]
fn unprofitable_plan_is_found() {
    let calls = healthy_calls_with(&[
        ("set_prices", json!({"A": 4, "B": 90, "C": 95})),
        ("set_model_tiers", json!({"A": 5, "B": 1, "C": 1})),
    ]);
    let session = play_company(3, 3e6, &calls, 8);
    let need = assert_first_problem(&session, Problem::Margin, &["Plan A loses money.", "odel tier"]);
    let ActionTarget::Call(ToolId::SetModelTiers, arguments) = &need.target else { panic!("{need:?}") };
    assert!(arguments["A"].as_u64().is_some_and(|tier| tier < 5));
}

#[test]
fn overload_item_names_a_sufficient_tier_and_its_price() {
    let session = play_company(3, 2e6, &healthy_calls_with(&[("set_capacity_tier", json!({"tier": 0}))]), 5);
    let need = assert_first_problem(
        &session,
        Problem::Overload,
        &["above the 50,000 units of capacity tier 0", " a day, $"],
    );
    let busiest = session.weeks().last().expect("a week").busiest_day as f64;
    let ActionTarget::Call(ToolId::SetCapacityTier, arguments) = &need.target else { panic!("{need:?}") };
    let tier = arguments["tier"].as_u64().expect("a tier");
    let tiers = session.company().tool_limits().capacities;
    let units = |tier: u64| tiers[tier as usize].units;
    assert!(units(tier) >= busiest && units(tier - 1) < busiest, "the smallest sufficient tier");
}

#[test]
fn outages_are_reported_with_the_operations_spend_that_reduces_them() {
    // Targeted operations resolve issues but do not change the frequency of outages.
    let calls = healthy_calls_with(&[
        ("set_daily_spend", json!({"operations": 0, "development": 100})),
        ("set_targeted_ops_spend", json!({"by_group": {"S1": 900}})),
    ]);
    let mut session = play_company(5, 3e6, &calls, 12);
    for _ in 0..30 {
        if session.weeks().last().is_some_and(|week| week.outage) {
            break;
        }
        advance_weeks(&mut session, 1);
    }
    let words = "With operations at $0 a day, 3.0% of days have an outage";
    let need = assert_first_problem(
        &session,
        Problem::Outages,
        &["Outages took", words, "$350 a day reduce the share to 1.5%"],
    );
    let ActionTarget::Call(ToolId::SetDailySpend, arguments) = &need.target else { panic!("{need:?}") };
    let dollars = arguments["operations"].as_f64().expect("dollars");
    let share = session.company().outage_share(dollars);
    assert!(
        share <= 0.015 && session.company().outage_share(dollars - 50.0) > 0.015,
        "half as often, and no more than that"
    );
    let mut small = play_company(5, 3e6, &calls, 1);
    for _ in 0..30 {
        advance_weeks(&mut small, 1);
        if small.weeks().last().is_some_and(|week| week.outage) {
            break;
        }
    }
    for need in action_items(&small).iter().filter(|need| need.problem == Problem::Outages) {
        assert!(need.at_risk >= 350.0 * 28.0, "proposals cost no more than is at risk: {need:?}");
    }
}

#[test]
fn backlog_item_names_the_operations_spend_that_clears_it_in_a_week() {
    let calls = healthy_calls_with(&[("set_daily_spend", json!({"operations": 0, "development": 100}))]);
    let mut session = play_company(3, 3e6, &calls, 9);
    for _ in 0..6 {
        if session.weeks().last().is_some_and(|week| !week.outage) {
            break;
        }
        advance_weeks(&mut session, 1);
    }
    let need = assert_first_problem(
        &session,
        Problem::Backlog,
        &[" wait for support.", "expected when no one waits, and the backlog in "],
    );
    // The proposed number of days must follow from the numbers in the two sentences.
    let numbers: Vec<f64> = format!("{} {}", need.text, need.proposal.as_deref().unwrap_or_default())
        .replace(',', "")
        .split(|sign: char| !sign.is_ascii_digit())
        .filter_map(|word| word.parse().ok())
        .collect();
    let [waiting, _, _, _, _, solved, inflow, days] = numbers[..] else { panic!("{need:?}") };
    assert_eq!((waiting / (solved - inflow)).ceil(), days, "{need:?}");
    assert!((6.0..=7.0).contains(&days), "{need:?}");
    let ActionTarget::Call(ToolId::SetDailySpend, arguments) = &need.target else { panic!("{need:?}") };
    session.call("set_daily_spend", arguments, Via::Script).expect("it is set");
    assert!(
        action_items(&session).iter().all(|need| need.problem != Problem::Backlog),
        "a solved problem is not reported"
    );
    advance_weeks(&mut session, 2);
    assert!(
        action_items(&session).iter().all(|need| need.problem != Problem::Backlog),
        "the amount is sufficient"
    );
}

#[test]
fn churn_wave_and_falling_conversion_name_the_preceding_change() {
    let mut session = play_company(3, 3e6, &healthy_calls(), 14);
    let higher = json!({"A": 45, "B": 70, "C": 120});
    session.call("set_prices", &higher, Via::Script).expect("higher prices");
    advance_weeks(&mut session, 1);
    let words = "you changed price A: 11 → 45";
    assert_first_problem(
        &session,
        Problem::ConversionFall(group("S1")),
        &["leads signed up last week", words],
    );
    let all = action_items(&session);
    let need = all.iter().find(|need| need.problem == Problem::Churn(group("S1"))).expect("a churn wave");
    assert!(need.text.contains("cancelled last week") && need.text.contains(words), "{}", need.text);
    let ActionTarget::Call(ToolId::SetPrices, arguments) = &need.target else { panic!("{need:?}") };
    assert_eq!(arguments, &json!({"A": 11, "B": 24, "C": 52}), "the form contains the earlier values");
}

#[test]
fn expiring_threads_item_links_to_the_most_valuable_thread() {
    let mut session = play_company(
        11,
        3e7,
        &healthy_calls_with(&[
            ("set_model_tiers", json!({"A": 4, "B": 4, "C": 4})),
            ("set_usage_quotas", json!({"A": 300, "B": 30_000, "C": 1_000_000})),
            ("set_targeted_dev_spend", json!({"targeted_spend": {"E1": 4_000, "E2": 5_000, "E3": 5_000}})),
            (
                "set_targeted_ad_spend",
                json!({"targeted_spend": {"linkedin": {"E1": 4_000, "E2": 4_000}, "social_media": {"E3": 4_000}}}),
            ),
        ]),
        2,
    );
    for _ in 0..20 {
        if session.company().observe().waiting.len() > 1 {
            break;
        }
        advance_weeks(&mut session, 1);
    }
    let waiting = session.company().observe().waiting;
    let need = assert_first_problem(
        &session,
        Problem::Threads,
        &["enterprises wait for an answer", "Without an answer, their threads end by day"],
    );
    // The payments are computed from the list price of a plan that the text names. It is not plan A, whose quota is too
    // small.
    let text = need.describe();
    assert!(text.contains(" a month at ") && !text.contains("plan A"), "{text}");
    let ActionTarget::Thread(first) = need.target else { panic!("{need:?}") };
    assert!(waiting.iter().any(|thread| thread.thread == first), "{need:?}");
}

#[test]
fn short_runway_is_the_first_action_item() {
    let session = play_company(3, 400_000.0, &healthy_calls(), 1);
    let seen = session.company().observe();
    assert!(seen.runway_weeks.is_some_and(|weeks| (2.0..6.0).contains(&weeks)), "{:?}", seen.runway_weeks);
    let need = assert_first_problem(
        &session,
        Problem::Runway,
        &["Cash is expected to last", "The largest budget is targeted development"],
    );
    let ActionTarget::Call(ToolId::SetTargetedDevSpend, arguments) = &need.target else { panic!("{need:?}") };
    let proposed = arguments["targeted_spend"]["S1"].as_f64().expect("an amount");
    let text = format!(
        "At {} a day and with the same income, cash lasts 8 weeks",
        crate::formatting::format_money(proposed)
    );
    assert!(need.describe().contains(&text), "{}: {text}", need.describe());
    let mut fixed = session;
    fixed.call("set_targeted_dev_spend", arguments, Via::Script).expect("it is set");
    assert!(
        fixed.company().observe().runway_weeks.is_none_or(|weeks| weeks >= 7.99),
        "{:?}",
        fixed.company().observe().runway_weeks
    );
}

#[test]
fn runway_after_a_raise_of_ads_names_its_premise() {
    let mut session = play_company(3, 3e6, &healthy_calls(), 10);
    let budget = session.company().observe().cash / 40.0;
    let ads = json!({ "targeted_spend": { "search_ads": { "S1": budget.floor() } } });
    session.call("set_targeted_ad_spend", &ads, Via::Script).expect("it is set");
    let need = assert_first_problem(
        &session,
        Problem::Runway,
        &["You raised ads from ", "If they add no signups, cash"],
    );
    assert!(!need.is_urgent, "{need:?}");
    let seen = session.company().observe();
    let coverage = seen.describe_ranges().expect("a premise");
    assert!(coverage.starts_with("You changed advertising from ") && !coverage.contains('%'), "{coverage}");
    let lines = crate::cost_review::income_and_cost_lines(&seen);
    assert!(lines.iter().any(|line| line.contains("without the effect of the changed ads")), "{lines:?}");
    assert!(lines.iter().any(|line| line.ends_with("if the added ads bring no signups")), "{lines:?}");
}

#[test]
fn healthy_company_has_no_action_items() {
    let session = play_company(3, 3e6, &healthy_calls(), 10);
    let week = session.weeks().last().expect("a week");
    assert!(week.individual_subscribers > 1_000 && week.new_individual_subscribers > week.cancellations);
    assert_eq!(action_items(&session), []);
}

#[test]
fn enterprises_without_suitable_plan_are_found() {
    let ads =
        json!({"targeted_spend": {"linkedin": {"E1": 6_000, "E2": 6_000}, "content_marketing": {"S1": 600}}});
    let session = play_company(11, 9e6, &healthy_calls_with(&[("set_targeted_ad_spend", ads)]), 4);
    let found: Vec<ActionItem> = action_items(&session)
        .into_iter()
        .filter(|need| matches!(need.problem, Problem::NoRequests(_)))
        .collect();
    assert!(!found.is_empty(), "{:#?}", action_items(&session));
    assert!(found.iter().all(|need| need.text.contains("none requested an offer")), "{found:#?}");
    // All seats of an enterprise share one quota.
    assert!(
        found.iter().any(|need| need.text.contains("Mean usage of the smallest enterprises")),
        "{found:#?}"
    );
}

#[test]
fn budgets_in_texts_match_the_form() {
    let each = json!({"S1": 99, "S2": 99, "S3": 99, "E1": 2_999, "E2": 2_999});
    let ads = json!({"targeted_spend": {"linkedin": each, "social_media": each}});
    let session = play_company(3, 400_000.0, &healthy_calls_with(&[("set_targeted_ad_spend", ads)]), 1);
    let need = assert_first_problem(&session, Problem::Runway, &["The largest budget is advertising"]);
    let ActionTarget::Call(ToolId::SetTargetedAdSpend, arguments) = &need.target else { panic!("{need:?}") };
    let mut fixed = session;
    fixed.call("set_targeted_ad_spend", arguments, Via::Script).expect("it is set");
    let kept = fixed.settings().targeted_ads.total();
    let text = format!("At {} a day", crate::formatting::format_money(kept));
    assert!(need.describe().contains(&text), "{}: {text}", need.describe());
}

#[test]
fn advertising_to_enterprises_without_requests_is_found() {
    let people = json!({"S1": 200, "S2": 200, "S3": 200, "E1": 1_000, "E2": 1_000});
    let spend = json!({"social_media": people, "linkedin": {"E1": 1_500, "E2": 1_500, "E3": 500}});
    let calls = healthy_calls_with(&[
        ("set_prices", json!({"A": 14, "B": 32, "C": 55})),
        ("set_model_tiers", json!({"A": 2, "B": 3, "C": 4})),
        ("set_usage_quotas", json!({"A": 3_000, "B": 30_000, "C": 1_000_000})),
        ("set_targeted_dev_spend", json!({"targeted_spend": {"E1": 3_000, "E2": 3_000}})),
        ("set_targeted_ad_spend", json!({ "targeted_spend": spend })),
        ("set_daily_spend", json!({"operations": 300, "development": 400})),
        ("set_capacity_tier", json!({"tier": 1})),
    ]);
    let session = play_company(23, 1e6, &calls, 7);
    let all = action_items(&session);
    let is_ad_removal = |need: &&ActionItem| {
        let ads = matches!(need.target, ActionTarget::Call(ToolId::SetTargetedAdSpend, _));
        ads && matches!(need.problem, Problem::NoRequests(_))
    };
    let need = all.iter().find(is_ad_removal).unwrap_or_else(|| panic!("{all:#?}"));
    let Problem::NoRequests(group) = need.problem else { panic!("{need:?}") };
    let ActionTarget::Call(_, arguments) = &need.target else { panic!("{need:?}") };
    let before = session.settings().targeted_ads.clone();
    let mut fixed = session;
    fixed.call("set_targeted_ad_spend", arguments, Via::Script).expect("it is set");
    let after = &fixed.settings().targeted_ads;
    let saved = before.total() - after.total();
    assert!(
        saved > 0.0
            && after.targeted_spend.values().all(|groups| groups.get(&group).is_none_or(|it| *it == 0.0))
    );
    let text = format!("Removing these ads saves {} a day", crate::formatting::format_money(saved));
    assert!(need.describe().contains(&text), "{}: {text}", need.describe());
}

#[test]
fn ads_without_any_lead_are_found_after_four_weeks() {
    let channels = Channel::ALL.map(|channel| (channel.id().to_owned(), json!({"E1": 200, "S1": 100})));
    let ads = json!({"targeted_spend": Value::Object(channels.into_iter().collect())});
    let mut session = play_company(404, 1e6, &healthy_calls_with(&[("set_targeted_ad_spend", ads)]), 3);
    let find = |session: &Session| {
        let is_wanted = |item: &ActionItem| matches!(item.problem, Problem::NoAdResults(_));
        action_items(session).into_iter().find(is_wanted)
    };
    assert_eq!(find(&session), None, "three weeks are too few");
    advance_weeks(&mut session, 1);
    let item = find(&session).unwrap_or_else(|| panic!("{:#?}", action_items(&session)));
    let text = item.describe();
    assert!(
        text.starts_with(
            "E1: ads for the group cost $28,000 in the last 4 weeks and brought no lead. After 4 weeks"
        ),
        "{text}"
    );
    assert!(text.ends_with(" Removing these ads saves $1,000 a day."), "{text}");
    let ActionTarget::Call(_, arguments) = &item.target else { panic!("{item:?}") };
    session.call("set_targeted_ad_spend", arguments, Via::Script).expect("it is set");
    assert_eq!(find(&session), None, "no ads for the group are running");
}

#[test]
fn expensive_leads_item_names_the_earlier_cost() {
    // A small market is soon saturated, so the same budget brings fewer leads.
    let ads = json!({"targeted_spend": {"content_marketing": {"S1": 6_000}, "social_media": {"S2": 100}}});
    let new = NewRun {
        seed: Some(3),
        cash: Some(9e6),
        mode: Mode::Debug,
        storage: Storage::Memory,
        overrides: vec![("leads.saturation_base".to_owned(), "0.001".to_owned())],
        ..NewRun::default()
    };
    let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
    for (tool, arguments) in healthy_calls_with(&[("set_targeted_ad_spend", ads)]) {
        session.call(tool, &arguments, Via::Script).unwrap_or_else(|refusal| panic!("{tool}: {refusal}"));
    }
    let find_lead_cost_item = |session: &Session| {
        action_items(session).into_iter().find(|need| matches!(need.problem, Problem::LeadCost(..)))
    };
    let week = (1..20).find(|_| {
        advance_weeks(&mut session, 1);
        find_lead_cost_item(&session).is_some()
    });
    let need = find_lead_cost_item(&session).unwrap_or_else(|| panic!("{week:?}"));
    let cost = |from: u32, upto: u32, session: &mut Session| {
        let sql = format!(
            "SELECT sum(spend) / sum(leads_generated) FROM ad_channel_leads WHERE channel_id = 'content_marketing' AND \
             group_id = 'S1' AND (day + 6) / 7 BETWEEN {from} AND {upto}"
        );
        novamind_database::number_at(&session.query(&sql).expect("rows").rows[0], 0)
    };
    let last = session.weeks().len() as u32;
    let now = cost(last - 3, last, &mut session);
    let before = (1..=last - 7).map(|from| cost(from, from + 3, &mut session)).fold(f64::INFINITY, f64::min);
    assert!(now >= 2.0 * before, "{now} {before}");
    let cost_text = |each: f64| {
        if each < 100.0 {
            novamind_base::formatting::dollars_and_cents(each)
        } else {
            crate::formatting::format_money(each)
        }
    };
    for words in
        ["content_marketing × S1: in the last 4 weeks", &cost_text(now), &cost_text(before), "a first bill"]
    {
        assert!(need.text.contains(words), "{words} in {}", need.text);
    }
    let ActionTarget::Call(ToolId::SetTargetedAdSpend, arguments) = &need.target else { panic!("{need:?}") };
    let spend = &arguments["targeted_spend"];
    assert_eq!((&spend["content_marketing"]["S1"], &spend["social_media"]["S2"]), (&json!(0), &json!(100)));
    let lost = 6_000.0 * 28.0 * (1.0 - before / now);
    assert!((need.at_risk - lost).abs() < 1.0, "{} {lost}", need.at_risk);
}

#[test]
fn baseline_run_receives_no_proposals() {
    let new = NewRun {
        mode: Mode::Baseline,
        participant: Some("P1".to_owned()),
        storage: Storage::Memory,
        ..NewRun::default()
    };
    let session = Session::create(new, &Configuration::bundled()).expect("a run");
    let all = action_items(&session);
    assert_eq!(all.len(), 1 + all.iter().skip(1).count());
    for need in all {
        assert_eq!(need.proposal, None);
        assert!(!matches!(need.target, ActionTarget::Call(_, arguments) if !arguments.is_null()));
    }
}

#[test]
fn quality_item_names_the_best_plan_and_keeps_other_development() {
    let calls = healthy_calls_with(&[
        ("set_usage_quotas", json!({"A": 10, "B": 90_000_000, "C": 90_000_000})),
        ("set_targeted_ad_spend", json!({"targeted_spend": {"search_ads": {"S2": 900}}})),
        ("set_targeted_dev_spend", json!({"targeted_spend": {"S1": 700}})),
        ("set_prices", json!({"A": 20, "B": 30, "C": 40})),
    ]);
    let session = play_company(7, 1e6, &calls, 2);
    let all = action_items(&session);
    let need = all.iter().find(|need| need.problem == Problem::NoSales(group("S2"))).expect("none signs");
    assert!(
        need.text.contains("The best quality within the estimated budget of $"),
        "A also has too small a quota: {}",
        need.text
    );
    let ActionTarget::Call(ToolId::SetTargetedDevSpend, arguments) = &need.target else { panic!("{need:?}") };
    assert_eq!(arguments["targeted_spend"], json!({"S1": 700, "S2": 5_000}));
}

#[test]
fn outdated_estimate_proposes_a_study_if_worthwhile() {
    let with_ads = |dollars: u32| {
        healthy_calls_with(&[
            ("set_targeted_ad_spend", json!({"targeted_spend": {"search_ads": {"S2": dollars}}})),
            ("set_targeted_dev_spend", json!({"targeted_spend": {}})),
            ("set_prices", json!({"A": 20, "B": 30, "C": 40})),
        ])
    };
    let place = |dollars: u32, weeks: usize| {
        let all = action_items(&play_company(7, 1e7, &with_ads(dollars), weeks));
        all.into_iter().find(|need| need.problem == Problem::NoSales(group("S2"))).expect("none signs").target
    };
    let study = ActionTarget::Call(ToolId::ResearchGroup, json!({"group_id": "S2", "target_level": 2}));
    assert_ne!(place(9_000, 2), study, "the estimate is two weeks old");
    assert_eq!(place(9_000, 5), study);
    assert_ne!(place(200, 5), study, "the study costs more than is at risk");
}

#[test]
fn empty_list_states_the_loss_of_the_week() {
    use super::describe_no_items;
    use novamind_record::figures::WeekFigures;
    let week =
        WeekFigures { cash_change: -19_001.0, payments: 198.0, costs: 19_199.0, ..WeekFigures::default() };
    assert_eq!(
        describe_no_items(Some(&week), Some(44.6)),
        "No rule found a problem. Cash fell by $19,001 last week: payments $198, running costs $19,199. Cash is \
         expected to last 44 weeks."
    );
    let gain = WeekFigures { cash_change: 5.0, ..week };
    assert_eq!(describe_no_items(Some(&gain), None), "No rule found a problem.");
    assert_eq!(describe_no_items(None, None), "No rule found a problem.");
}
