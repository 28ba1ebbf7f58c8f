//! Diagnoses of cash and margins.

use serde_json::{Map, Value, json};

use super::{ActionItem, ActionTarget, DAYS_PER_MONTH, DiagnosisContext, Problem, RISK_DAYS};
use crate::formatting::{format_money, format_whole, pluralize};
use novamind_base::formatting::json_number;
use novamind_session::ModelTier;
use novamind_session::identifiers::{Group, Plan};
use novamind_tools::ToolId;

/// Runway in weeks below which low cash is reported.
const MIN_RUNWAY_WEEKS: f64 = 8.0;

/// Reports a problem if cash lasts less than eight weeks at the current rate.
pub(super) fn diagnose_runway(situation: &DiagnosisContext<'_>) -> Option<ActionItem> {
    let seen = &situation.observation;
    let weeks = seen.runway_weeks.filter(|weeks| *weeks < MIN_RUNWAY_WEEKS)?;
    let pace = &seen.pace;
    let out = (pace.committed + pace.variable) * 7.0;
    let SpendingBudget { name, dollars, reduced_dollars: kept, target: place } = largest_budget(situation);
    let proposal = (dollars > 0.0).then(|| {
        let net = pace.net_per_day() + dollars - kept;
        let lasts = match (seen.cash.max(0.0) / -net / 7.0).round() {
            weeks if net < 0.0 => format!("lasts {}", pluralize(weeks as u32, "week")),
            _ => "no longer shrinks".to_owned(),
        };
        format!(
            "The largest budget is {name}, {} a day. At {} a day, cash {lasts}.",
            format_money(dollars),
            format_money(kept)
        )
    });
    Some(ActionItem {
        problem: Problem::Runway,
        text: format!(
            "Cash lasts {} at the current rate. Income is {} a week, costs are {}.",
            pluralize(weeks as u32, "week"),
            format_money(pace.income * 7.0),
            format_money(out)
        ),
        proposal,
        target: place,
        at_risk: seen.cash.max(0.0) + situation.upcoming_revenue(),
        is_urgent: true,
    })
}

struct SpendingBudget {
    name: &'static str,
    /// Current budget, dollars a day.
    dollars: f64,
    /// Reduced budget with which cash lasts eight weeks, dollars a day.
    reduced_dollars: f64,
    /// Form of the budget, filled with the reduced amount.
    target: ActionTarget,
}

fn largest_budget(situation: &DiagnosisContext<'_>) -> SpendingBudget {
    let settings = situation.session.settings();
    let (core, development) = (&settings.core, &settings.targeted_development);
    let missing = situation.observation.cash.max(0.0) / (MIN_RUNWAY_WEEKS * 7.0)
        + situation.observation.pace.net_per_day();
    let kept = |dollars: f64| ((dollars + missing.min(0.0)).max(0.0)).floor();
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
    // Uses the sum of the amounts in the form, because each amount is rounded down.
    let kept = if let ActionTarget::Call(_, arguments) = &place { sum_numbers(arguments) } else { 0.0 };
    SpendingBudget { name, dollars, reduced_dollars: kept, target: place }
}

fn sum_numbers(arguments: &Value) -> f64 {
    match arguments {
        Value::Object(fields) => fields.values().map(sum_numbers).sum(),
        other => other.as_f64().unwrap_or(0.0),
    }
}

/// Finds plans whose individual subscribers cost more in compute than they pay.
pub(super) fn unprofitable_plans(situation: &DiagnosisContext<'_>) -> Vec<ActionItem> {
    let Some(groups) = situation.last_group_week() else { return Vec::new() };
    let models = &situation.terms.models;
    let of_plan = |plan: Plan| {
        let people = || Group::all().filter(|group| !group.is_enterprise());
        let subscribers: u32 = people().map(|group| groups[group].subscribers[plan]).sum();
        let revenue: f64 = people().map(|group| groups[group].revenue[plan]).sum();
        let units: u64 = people().map(|group| groups[group].last_usage[plan]).sum();
        let a_month = units as f64 * DAYS_PER_MONTH;
        let now = models.iter().find(|model| model.tier == situation.settings.tiers[plan])?;
        let cost = a_month * now.unit_cost;
        if subscribers == 0 || cost <= revenue {
            return None;
        }
        let (proposal, place) = propose_cheaper_setting(situation, plan, now, a_month, revenue);
        Some(ActionItem {
            problem: Problem::Margin,
            text: format!(
                "Plan {plan} loses money. Revenue from {} is {} a month, and compute costs {} a month at the last day's usage.",
                pluralize(subscribers, "individual"),
                format_money(revenue),
                format_money(cost)
            ),
            proposal: Some(proposal),
            target: place,
            at_risk: (cost - revenue) * RISK_DAYS / DAYS_PER_MONTH,
            is_urgent: true,
        })
    };
    Plan::ALL.into_iter().filter_map(of_plan).collect()
}

/// Proposes the best model tier whose compute the plan's revenue covers at the same usage, otherwise a smaller quota.
fn propose_cheaper_setting(
    situation: &DiagnosisContext<'_>,
    plan: Plan,
    now: &ModelTier,
    units: f64,
    revenue: f64,
) -> (String, ActionTarget) {
    let lower = situation.terms.models.iter().rev().filter(|model| model.tier < now.tier);
    let covered = lower.filter(|model| units * model.unit_cost < revenue).map(|model| {
        let cost = format_money(units * model.unit_cost);
        let text =
            format!("Model tier {} costs {cost} at the same usage and delivers lower quality.", model.tier);
        (text, ActionTarget::Call(ToolId::SetModelTiers, json!({ plan.id(): model.tier })))
    });
    covered.into_iter().next().unwrap_or_else(|| {
        let held = situation.settings.quotas[plan].units();
        let quota = (held * revenue / (units * now.unit_cost)).floor();
        let quotas: Map<String, Value> = Plan::ALL
            .into_iter()
            .map(|of| {
                let kept = situation.settings.quotas[of].units();
                (of.id().to_owned(), json_number(if of == plan { quota } else { kept }))
            })
            .collect();
        let text = format!(
            "A quota below today's {} units a day limits the usage of these subscribers.",
            format_whole(held)
        );
        (text, ActionTarget::Call(ToolId::SetUsageQuotas, Value::Object(quotas)))
    })
}
