//! Gross margins in sentences, for screen readers. For each plan, the current model tier comes first, and one line
//! describes the other tiers.

use super::{
    DraftPlanTerms, MarginSetting, NO_USAGE_MESSAGE, PlanSales, PlanUsage, differs_by_a_cent, margin,
};
use crate::formatting::format_whole;
use novamind_base::formatting::{dollars_and_cents, grouped_number, percent};
use novamind_session::identifiers::{ByPlan, Plan};

/// Describes the margins of every plan in sentences.
pub fn margin_sentences(
    sales: &PlanSales,
    terms: &ByPlan<DraftPlanTerms>,
    margin_setting: MarginSetting,
    models: &[(u8, f64)],
    day: u32,
) -> Vec<String> {
    if !sales.is_measured() {
        return vec![NO_USAGE_MESSAGE.to_owned()];
    }
    let mut lines =
        vec![format!("gross margins at day-{day} usage: the share of a price left after compute")];
    lines.extend(
        Plan::ALL
            .into_iter()
            .flat_map(|plan| plan_sentences(sales, plan, terms[plan], margin_setting, models, day)),
    );
    lines
}

fn plan_sentences(
    sales: &PlanSales,
    plan: Plan,
    set: DraftPlanTerms,
    margin_setting: MarginSetting,
    models: &[(u8, f64)],
    day: u32,
) -> Vec<String> {
    let plan_usage = sales.usage_of_plan(plan);
    let Some(paid) = plan_usage.measured_revenue_per_seat() else {
        return vec![format!("plan {plan}: no usage on day {day}")];
    };
    let unit_cost = set.unit_cost(models);
    let on_own =
        |at_cost: &dyn Fn(f64) -> Option<f64>, of: &str| describe_margin(unit_cost.and_then(at_cost), of);
    let at_list = |unit_cost: f64| margin(set.price, plan_usage.compute_cost(unit_cost)?);
    let is_at_list = margin_setting == MarginSetting::Price && differs_by_a_cent(set.price, paid);
    let mut line = format!(
        "plan {plan} on model tier {}: {}",
        set.tier,
        on_own(
            &|unit_cost| plan_usage.margin(unit_cost),
            &format!("the price of {} per seat per month paid now", dollars_and_cents(paid))
        )
    );
    if is_at_list {
        line += &format!(
            "; {}",
            on_own(&at_list, &format!("the list price of {}", dollars_and_cents(set.price)))
        );
    }
    if margin_setting == MarginSetting::Quota {
        let full =
            on_own(&|unit_cost| plan_usage.margin_at_full_quota(set.quota, unit_cost), "the price paid");
        line += &format!("; at full quota of {} units, {full}", format_whole(set.quota));
    }
    let mut lines = vec![line];
    lines.extend(group_sentence(sales, plan, unit_cost));
    let margin_at =
        |unit_cost: f64| if is_at_list { at_list(unit_cost) } else { plan_usage.margin(unit_cost) };
    let others = models.iter().filter(|(tier, _)| *tier != set.tier);
    let others: Vec<(u8, f64)> =
        others.filter_map(|(tier, unit_cost)| Some((*tier, margin_at(*unit_cost)?))).collect();
    let basis = if is_at_list { "as a share of that list price" } else { "as a share of the price paid now" };
    lines.extend(
        other_models_sentence(&others)
            .map(|words| format!("margin of plan {plan} on other model tiers, {basis}: {words}")),
    );
    lines
}

fn group_sentence(sales: &PlanSales, plan: Plan, unit_cost: Option<f64>) -> Option<String> {
    let groups = sales.by_group(plan);
    let describe_group = |(group, plan_usage): &(_, PlanUsage)| {
        let paid = plan_usage.revenue_per_seat().map_or("nothing".to_owned(), dollars_and_cents);
        format!(
            "{group} {}",
            describe_margin(unit_cost.and_then(|unit_cost| plan_usage.margin(unit_cost)), &paid)
        )
    };
    (groups.len() > 1).then(|| {
        let texts: Vec<String> = groups.iter().map(describe_group).collect();
        format!("plan {plan} by group: {}", texts.join("; "))
    })
}

/// Lists the margins of profitable tiers one by one, and combines the tiers that make a loss.
fn other_models_sentence(margins: &[(u8, f64)]) -> Option<String> {
    let (earns, loses): (Vec<_>, Vec<_>) = margins.iter().partition(|(_, margin)| *margin >= 0.0);
    let mut parts: Vec<String> =
        earns.iter().map(|(tier, margin)| format!("tier {tier} {}", percent(*margin, 0))).collect();
    let tiers: Vec<String> = loses.iter().map(|(tier, _)| tier.to_string()).collect();
    match tiers.as_slice() {
        [] => {}
        [only] => parts.push(format!("a loss on tier {only}")),
        [most @ .., last] => parts.push(format!("a loss on tiers {} and {last}", most.join(", "))),
    }
    (!parts.is_empty()).then(|| parts.join(", "))
}

/// Describes a positive margin as a share of the price, and a loss as the ratio of the compute cost to the price.
fn describe_margin(margin: Option<f64>, of: &str) -> String {
    match margin {
        None => format!("an unknown share of {of}"),
        Some(margin) if margin < 0.0 => {
            format!("a loss, compute costs {} times {of}", grouped_number(1.0 - margin, 2))
        }
        Some(margin) => format!("{} of {of}", percent(margin, 0)),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::test_kit::play_weeks;

    #[test]
    fn margin_sentences_have_no_columns_or_brackets() {
        let session = play_weeks(6);
        let sales = PlanSales::load(&session).expect("a database");
        let core = &session.settings().core;
        let now = ByPlan::from_fn(|plan| DraftPlanTerms {
            price: core.prices[plan],
            tier: core.tiers[plan],
            quota: core.quotas[plan].units(),
        });
        let models = session.company().tool_limits().unit_costs();
        let plan_usage = sales.usage_of_plan(Plan::B);
        let unit_cost = models.iter().find(|(tier, _)| *tier == now[Plan::B].tier).expect("its model").1;
        let dear = MarginSetting::Price.apply(now, &json!({"B": 250}));
        let lines = margin_sentences(&sales, &dear, MarginSetting::Price, &models, 42);
        let line = lines.iter().find(|line| line.starts_with("plan B on model tier 2: ")).expect("plan B");
        let paid = describe_margin(plan_usage.margin(unit_cost), "the ");
        let list = margin(250.0, plan_usage.compute_cost(unit_cost).expect("compute"));
        let list = describe_margin(list, "the list price of $250.00");
        assert!(line.contains(&format!("tier 2: {paid}")), "{line} without {paid}");
        assert!(line.ends_with(&list), "{line} without {list}");
        let text = lines.join("\n");
        assert!(!text.contains(['[', '<']) && !text.contains("  "), "{text}");
        assert!(
            text.contains("margin of plan B on other model tiers, as a share of that list price: tier 1 "),
            "{text}"
        );
    }

    #[test]
    fn margin_sentences_combine_losses() {
        let text = other_models_sentence(&[(1, 0.5), (3, -0.2), (4, -30.0), (5, -90.0)]);
        assert_eq!(text.as_deref(), Some("tier 1 50%, a loss on tiers 3, 4 and 5"));
        assert_eq!(other_models_sentence(&[]), None);
        assert_eq!(describe_margin(Some(-11.4), "$14.00"), "a loss, compute costs 12.40 times $14.00");
    }
}
