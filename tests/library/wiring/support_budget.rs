//! Support budgets: each budget resolves only the issues of its scope.

use novamind::session::{Session, Storage};
use serde_json::{Value, json};

use super::create;
use crate::support::company::{advance_week, advance_weeks, call_tool, query_numbers};

/// Returns a company with several groups and plans, in which issues are resolved only with a budget.
fn company_with_open_issues() -> Session {
    let overrides = [("issues.issue_resolution_base_rate", "0.0")];
    let mut session = create(Storage::Memory, &overrides);
    call_tool(&mut session, "set_prices", json!({"A": 8, "B": 12, "C": 16}));
    call_tool(&mut session, "set_model_tiers", json!({"A": 2, "B": 3, "C": 4}));
    call_tool(&mut session, "set_usage_quotas", json!({"A": 30000, "B": 90000, "C": 1200000}));
    let spend = json!({"content_marketing": {"S1": 3000, "S2": 3000}, "search_ads": {"S3": 3000}});
    call_tool(&mut session, "set_targeted_ad_spend", json!({"targeted_spend": spend}));
    call_tool(
        &mut session,
        "set_targeted_dev_spend",
        json!({"targeted_spend": {"S1": 5000, "S2": 5000, "S3": 5000}}),
    );
    advance_weeks(&mut session, 5);
    session
}

/// SQL condition for customers that are not billed on days 36 to 42. Their plan cannot change, because plans change
/// only on billing days.
const NOT_BILLED_CONDITION: &str = "s.billing_day_mod30 NOT BETWEEN 6 AND 12";

/// Counts the issues that were open on day 35 and the issues that have been resolved since, for customers inside and
/// outside of a condition.
fn count_resolved_issues(session: &mut Session, inside: &str) -> [f64; 4] {
    let sql = format!(
        "SELECT total(({inside})), total(({inside}) AND i.resolved_day > 35), total(NOT ({inside})), \
         total(NOT ({inside}) AND i.resolved_day > 35) \
         FROM issues i JOIN customers c USING (customer_id) JOIN subscriptions s USING (customer_id) \
         WHERE i.open_day < 35 AND s.status = 'subscribed' AND s.start_day < 35 \
           AND (i.resolved_day IS NULL OR i.resolved_day > 35) AND {NOT_BILLED_CONDITION}"
    );
    query_numbers(session, &sql).remove(0).try_into().expect("four numbers")
}

fn check_budget_effect(arguments: Value, inside: &str) {
    let mut session = company_with_open_issues();
    call_tool(&mut session, "set_targeted_ops_spend", arguments.clone());
    advance_week(&mut session);
    let [issues, helped, others, others_helped] = count_resolved_issues(&mut session, inside);
    assert!(issues >= 1.0 && others > 20.0, "{arguments}: {issues} issues inside, {others} outside");
    assert_eq!(others_helped, 0.0, "{arguments} resolves other issues");
    assert!(helped > 0.8 * issues, "{arguments}: {helped} of {issues} are resolved");
}

#[test]
fn budget_for_a_group_resolves_only_its_issues() {
    check_budget_effect(json!({"by_group": {"S3": 20_000}}), "c.group_id = 'S3'");
}

#[test]
fn budget_for_a_plan_resolves_only_its_issues() {
    check_budget_effect(json!({"by_plan": {"B": 20_000}}), "s.plan = 'B'");
}

#[test]
fn budget_for_a_plan_of_a_group_resolves_only_its_issues() {
    check_budget_effect(
        json!({"by_group_plan": {"S1": {"A": 20_000}}}),
        "c.group_id = 'S1' AND s.plan = 'A'",
    );
}

#[test]
fn budget_for_a_customer_resolves_only_the_customers_issue() {
    let mut session = company_with_open_issues();
    let sql = format!(
        "SELECT max(i.customer_id) FROM issues i JOIN subscriptions s USING (customer_id) \
         WHERE i.resolved_day IS NULL AND i.open_day < 35 AND s.status = 'subscribed' AND s.start_day < 35 \
           AND {NOT_BILLED_CONDITION}"
    );
    let customer = query_numbers(&mut session, &sql)[0][0];
    check_budget_effect(
        json!({"by_customer": {(customer.to_string()): 500}}),
        &format!("c.customer_id = {customer}"),
    );
}

#[test]
fn general_budget_resolves_all_issues() {
    let mut session = company_with_open_issues();
    call_tool(&mut session, "set_daily_spend", json!({"operations": 20_000}));
    advance_week(&mut session);
    for group in ["S1", "S2", "S3"] {
        let [issues, helped, ..] = count_resolved_issues(&mut session, &format!("c.group_id = '{group}'"));
        assert!(issues > 5.0 && helped > 0.8 * issues, "{group}: {helped} of {issues}");
    }
}
