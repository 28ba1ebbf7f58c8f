//! Prices and costs of the plans from the figures that the player can see.

use novamind_rules::{PlanEconomics, SeatUsage};
use novamind_session::identifiers::Plan;
use novamind_tools::ToolId;
use novamind_worker::company::DisplayedCompany;

/// Returns the prices, quotas, unit costs and usage that rules and offers use.
pub fn plan_economics(company: &DisplayedCompany, usage: &SeatUsage) -> PlanEconomics {
    let per_plan = |tool: ToolId| Plan::ALL.map(|plan| company.current_setting(tool, plan.id()));
    let studied = company
        .insights
        .iter()
        .map(|(group, insights)| (*group, (insights.info_level, insights.estimates.usage_volume)));
    PlanEconomics {
        list_prices: per_plan(ToolId::SetPrices),
        quotas: per_plan(ToolId::SetUsageQuotas),
        unit_costs: Plan::ALL.map(|plan| unit_cost(company, plan).unwrap_or(0.0)),
        usage: usage.clone(),
        estimated_usage: studied.collect(),
    }
}

/// Returns the compute cost of a plan's model, $ per unit.
fn unit_cost(company: &DisplayedCompany, plan: Plan) -> Option<f64> {
    let tier = company.current_setting(ToolId::SetModelTiers, plan.id()) as u8;
    Some(company.price_list.model_tiers.get(&tier)?.cost_per_usage_unit)
}
