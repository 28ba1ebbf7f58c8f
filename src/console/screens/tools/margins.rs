//! Margins that would result from a draft of prices, model tiers or quotas.

use super::form::ToolForm;
use novamind_report::plan_margins::{MarginSetting, DraftPlanTerms, PlanSales, margin_lines, margin_summary};
use novamind_session::identifiers::ByPlan;
use novamind_tools::ToolId;
use novamind_worker::company::DisplayedCompany;

/// Returns the margin lines for a form, with the heading first. The lines cover every model tier, or only the tier
/// that is set if `brief` is true. Returns no lines for tools that do not affect margins.
pub fn form_margin_lines(form: &ToolForm, sales: &PlanSales, company: &DisplayedCompany, brief: bool) -> Vec<String> {
    let Some(setting) = MarginSetting::from_tool(form.spec.id) else { return Vec::new() };
    let now = ByPlan::from_fn(|plan| DraftPlanTerms {
        price: company.current_setting(ToolId::SetPrices, plan.id()),
        tier: company.current_setting(ToolId::SetModelTiers, plan.id()) as u8,
        quota: company.current_setting(ToolId::SetUsageQuotas, plan.id()),
    });
    let terms = form.sheet.arguments().map_or(now, |arguments| setting.apply(now, &arguments));
    let mut models: Vec<(u8, f64)> =
        company.price_list.model_tiers.iter().map(|(tier, model)| (*tier, model.cost_per_usage_unit)).collect();
    models.sort_by_key(|(tier, _)| *tier);
    let lines = if brief { margin_summary } else { margin_lines };
    lines(sales, &terms, setting, &models, company.observation.day)
}
