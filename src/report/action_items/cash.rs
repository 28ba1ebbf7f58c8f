//! Diagnoses of cash and margins.

use serde_json::{Map, Value, json};

use super::{ActionItem, ActionTarget, DAYS_PER_MONTH, DiagnosisContext, Problem, RISK_DAYS};
use crate::formatting::{format_money, format_whole, pluralize};
use novamind_base::formatting::json_number;
use novamind_session::identifiers::{Group, Plan};
use novamind_session::{MAX_RUNWAY_DAYS, ModelTier, PlanRevenue};
use novamind_tools::ToolId;

/// Low cash is reported if the runway is below this number of weeks.
const MIN_RUNWAY_WEEKS: f64 = 8.0;

/// Minimum number of subscriptions of a plan for a report on its margin. Usage rates have a standard deviation of about
/// 40 % of their mean, so the mean of ten subscriptions has a standard error of about 13 %. With fewer subscriptions, a
/// single one can cause the loss.
const MIN_SUBSCRIPTIONS_FOR_MARGIN: u32 = 10;
/// Largest assumed ratio of the cancellations on the last day to the mean daily cancellations of the week. The usage of
/// the last day includes customers who cancelled on that day, but the revenue does not.
const MAX_LAST_DAY_RATIO: f64 = 3.0;
/// Mean usage of the days of a week as a share of the usage of its last day, because less is used at weekends
/// (`docs/mechanics/day.md`). The last day of a week has the weekday factor of day 0.
const MEAN_DAY_SHARE: f64 = 0.936;

/// Reports a problem if cash is expected to last for less than eight weeks.
pub(super) fn diagnose_runway(situation: &DiagnosisContext<'_>) -> Option<ActionItem> {
    let seen = &situation.observation;
    let weeks = seen.runway_weeks.filter(|weeks| *weeks < MIN_RUNWAY_WEEKS)?;
    if let Some(item) = diagnose_added_ads(situation, weeks) {
        return Some(item);
    }
    let flows = seen.expected_flows();
    let out = seen.committed * 7.0 + flows.variable;
    let SpendingBudget { name, dollars, reduced_dollars: kept, target: place } = largest_budget(situation);
    let proposal = (dollars > 0.0).then(|| {
        let lasts = match seen.outlook.runway_with_saving(dollars - kept, seen.days_left()) {
            Some(weeks) => pluralize(weeks.round() as u32, "week"),
            None => format!("more than {}", pluralize(seen.days_left().min(MAX_RUNWAY_DAYS) / 7, "week")),
        };
        format!(
            "The largest budget is {name}, {} a day. At {} a day and with the same income, cash lasts {lasts}.",
            format_money(dollars),
            format_money(kept)
        )
    });
    Some(ActionItem {
        problem: Problem::Runway,
        text: format!(
            "Cash is expected to last {}. In the next {}, income should be {} a week and costs {}.",
            pluralize(weeks as u32, "week"),
            pluralize(seen.expected_days().div_ceil(7), "week"),
            format_money(flows.income),
            format_money(out)
        ),
        proposal,
        target: place,
        at_risk: seen.cash.max(0.0) + situation.upcoming_revenue(),
        is_urgent: true,
    })
}

/// Reports the time for which cash lasts if a raised advertising budget adds no signups. Returns `None` if the company
/// has not raised the budget, or if cash would be low without the raise.
fn diagnose_added_ads(situation: &DiagnosisContext<'_>, weeks: f64) -> Option<ActionItem> {
    let seen = &situation.observation;
    let change = seen.outlook.advertising_change.filter(|change| change.added() > 0.0)?;
    let without = seen.outlook.runway_with_saving(change.added(), seen.days_left());
    if without.is_some_and(|weeks| weeks < MIN_RUNWAY_WEEKS) {
        return None;
    }
    Some(ActionItem {
        problem: Problem::Runway,
        text: format!(
            "You raised ads from {} to {} a day. If they add no signups, cash is expected to last {}.",
            format_money(change.before),
            format_money(change.now),
            pluralize(weeks as u32, "week")
        ),
        proposal: Some("Check after the next week whether signups have risen enough.".to_owned()),
        target: ActionTarget::Ledger,
        at_risk: seen.cash.max(0.0),
        is_urgent: false,
    })
}

struct SpendingBudget {
    name: &'static str,
    /// Current budget, dollars per day.
    dollars: f64,
    /// Reduced budget that lets cash last for eight weeks, dollars per day.
    reduced_dollars: f64,
    /// Form that sets the budget, filled with the reduced amounts.
    target: ActionTarget,
}

fn largest_budget(situation: &DiagnosisContext<'_>) -> SpendingBudget {
    let settings = situation.session.settings();
    let (core, development) = (&settings.core, &settings.targeted_development);
    let saving = situation.observation.outlook.required_saving((MIN_RUNWAY_WEEKS * 7.0) as u32);
    let kept = |dollars: f64| (dollars - saving).max(0.0).floor();
    let scaled = |dollars: f64, total: f64| json_number((dollars * kept(total) / total.max(1e-9)).floor());
    let ads: Map<String, Value> = settings
        .targeted_ads
        .targeted_spend
        .iter()
        .map(|(channel, groups)| {
            let groups: Map<String, Value> = groups
                .iter()
                .map(|(group, dollars)| (group.id().to_owned(), scaled(*dollars, situation.daily_ad_spend)))
                .collect();
            (channel.id().to_owned(), Value::Object(groups))
        })
        .collect();
    let targeted: Map<String, Value> = development
        .targeted_spend
        .iter()
        .map(|(group, dollars)| (group.id().to_owned(), scaled(*dollars, development.total())))
        .collect();
    let budgets = [
        (
            "targeted development",
            development.total(),
            ActionTarget::Call(ToolId::SetTargetedDevSpend, json!({ "targeted_spend": targeted })),
        ),
        (
            "advertising",
            situation.daily_ad_spend,
            ActionTarget::Call(ToolId::SetTargetedAdSpend, json!({ "targeted_spend": ads })),
        ),
        (
            "development",
            core.development,
            ActionTarget::Call(ToolId::SetDailySpend, json!({ "development": kept(core.development) })),
        ),
        (
            "operations",
            core.operations,
            ActionTarget::Call(ToolId::SetDailySpend, json!({ "operations": kept(core.operations) })),
        ),
    ];
    let largest = budgets.into_iter().max_by(|left, right| left.1.total_cmp(&right.1));
    let (name, dollars, place) =
        largest.filter(|budget| budget.1 > 0.0).unwrap_or(("", 0.0, ActionTarget::Ledger));
    // The reduced budget is the sum of the amounts in the form, because each of them is rounded down.
    let kept = if let ActionTarget::Call(_, arguments) = &place { sum_numbers(arguments) } else { 0.0 };
    SpendingBudget { name, dollars, reduced_dollars: kept, target: place }
}

fn sum_numbers(arguments: &Value) -> f64 {
    match arguments {
        Value::Object(fields) => fields.values().map(sum_numbers).sum(),
        other => other.as_f64().unwrap_or(0.0),
    }
}

/// Finds plans whose subscribers cost more in compute than they pay. Compares the revenue of the subscriptions that
/// could use the product on the last day with 30 times the compute cost of that day's usage. Every reported plan has a
/// negative gross margin.
pub(super) fn unprofitable_plans(situation: &DiagnosisContext<'_>) -> Vec<ActionItem> {
    let Some(groups) = situation.last_group_week() else { return Vec::new() };
    let revenue_by_plan = situation.session.company().plan_revenue();
    let total: u32 = revenue_by_plan.iter().map(|revenue| revenue.subscriptions).sum();
    let left: u32 = Group::all().map(|group| groups[group].left).sum();
    let left_on_last_day = MAX_LAST_DAY_RATIO * f64::from(left) / 7.0;
    // Lower bound of the share of the last day's customers who are still subscribed.
    let remaining_share = 1.0 - left_on_last_day / (f64::from(total) + left_on_last_day).max(1.0);
    let diagnose_plan = |plan: Plan| {
        let revenue = revenue_by_plan[plan];
        let PlanRevenue { subscriptions, seats, monthly } = revenue;
        let units: u64 = Group::all().map(|group| groups[group].last_usage[plan]).sum();
        let a_month = units as f64 * DAYS_PER_MONTH;
        let now = situation.terms.models.iter().find(|model| model.tier == situation.settings.tiers[plan])?;
        let cost = a_month * now.unit_cost;
        if subscriptions < MIN_SUBSCRIPTIONS_FOR_MARGIN || cost * remaining_share * MEAN_DAY_SHARE <= monthly
        {
            return None;
        }
        let (proposal, place) = propose_cheaper_setting(situation, plan, now, a_month, revenue)?;
        Some(ActionItem {
            problem: Problem::Margin,
            text: format!(
                "Plan {plan} loses money. Revenue from {} that could use it on the last day is {} a month, and compute costs {} a month at that day's usage.",
                match f64::from(subscriptions) == seats {
                    true => pluralize(subscriptions, "subscription"),
                    false => pluralize(seats as u32, "seat"),
                },
                format_money(monthly),
                format_money(cost)
            ),
            proposal: Some(proposal),
            target: place,
            at_risk: (cost - monthly) * RISK_DAYS / DAYS_PER_MONTH,
            is_urgent: true,
        })
    };
    Plan::ALL.into_iter().filter_map(diagnose_plan).collect()
}

/// Proposes the best model tier whose compute cost the plan's revenue covers at the same usage. If no tier qualifies,
/// proposes a quota that keeps the compute cost below the revenue. Returns `None` if the current quota already ensures
/// this.
fn propose_cheaper_setting(
    situation: &DiagnosisContext<'_>,
    plan: Plan,
    now: &ModelTier,
    units: f64,
    PlanRevenue { subscriptions, monthly: revenue, .. }: PlanRevenue,
) -> Option<(String, ActionTarget)> {
    let held = situation.settings.quotas[plan].units();
    let compute_at = |quota: f64| f64::from(subscriptions) * quota * DAYS_PER_MONTH * now.unit_cost;
    // The quota may have been lowered after the last day.
    if compute_at(held) <= revenue {
        return None;
    }
    let mut lower = situation.terms.models.iter().rev().filter(|model| model.tier < now.tier);
    if let Some(model) = lower.find(|model| units * model.unit_cost < revenue) {
        let cost = format_money(units * model.unit_cost);
        let text =
            format!("Model tier {} costs {cost} at the same usage and delivers lower quality.", model.tier);
        return Some((text, ActionTarget::Call(ToolId::SetModelTiers, json!({ plan.id(): model.tier }))));
    }
    let quota = (revenue / compute_at(1.0)).floor();
    let quotas: Map<String, Value> = Plan::ALL
        .into_iter()
        .map(|of| {
            let kept = situation.settings.quotas[of].units();
            (of.id().to_owned(), json_number(if of == plan { quota } else { kept }))
        })
        .collect();
    let text = format!(
        "A quota of {} units a day limits compute to {} a month. The quota is {} now.",
        format_whole(quota),
        format_money(compute_at(quota)),
        format_whole(held)
    );
    Some((text, ActionTarget::Call(ToolId::SetUsageQuotas, Value::Object(quotas))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_world::params::Params;

    #[test]
    fn mean_day_share_follows_the_weekday_factors() {
        let weekly = &Params::bundled().calendar.weekly;
        let share = weekly.iter().sum::<f64>() / weekly.len() as f64 / weekly[0];
        assert!((MEAN_DAY_SHARE - share).abs() < 5e-4, "{share}");
    }
}
