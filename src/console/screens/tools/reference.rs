//! Reference figures for a form: tier prices, available projects, waiting threads and current settings.

use indexmap::IndexMap;
use unicode_width::UnicodeWidthStr;

use novamind_base::formatting::{QUALITY_DECIMALS, dollars, dollars_and_cents, grouped_number};
use novamind_report::research::{format_mean_days, format_mean_gain};
use novamind_session::ResearchMeans;
use novamind_tools::{ResearchTierFacts, ToolId};
use novamind_tui::text::format_number;
use novamind_worker::company::DisplayedCompany;

/// Returns the reference lines of a form, with the heading first. Returns no lines for tools without reference figures.
pub fn reference_lines(tool: ToolId, company: &DisplayedCompany) -> Vec<String> {
    match tool {
        ToolId::SetModelTiers | ToolId::SetUsageQuotas => model_tier_lines(company),
        ToolId::SetCapacityTier => capacity_tier_lines(company),
        ToolId::StartResearchProject => project_lines(company),
        ToolId::SetPrices => price_lines(company),
        ToolId::SendEnterpriseDeal | ToolId::RejectEnterpriseDeal => thread_lines(company),
        _ => Vec::new(),
    }
}

/// Returns the tiers in the order of their numbers.
fn sorted_tiers<T>(costs: &IndexMap<u8, T>) -> Vec<(u8, &T)> {
    let mut tiers: Vec<(u8, &T)> = costs.iter().map(|(tier, facts)| (*tier, facts)).collect();
    tiers.sort_by_key(|(tier, _)| *tier);
    tiers
}

fn model_tier_lines(company: &DisplayedCompany) -> Vec<String> {
    let mut lines = vec!["tier  quality ×   $ per 1,000 units".to_owned()];
    lines.extend(sorted_tiers(&company.price_list.model_tiers).into_iter().map(|(tier, facts)| {
        let cost = facts.cost_per_usage_unit * 1000.0;
        format!("{tier:>4}  {:>9.2}   {cost:>17.4}", facts.quality_multiplier)
    }));
    lines
}

fn capacity_tier_lines(company: &DisplayedCompany) -> Vec<String> {
    let now = company.current_setting(ToolId::SetCapacityTier, "tier") as u8;
    let mut lines = vec!["tier     units a day     $ a day".to_owned()];
    lines.extend(sorted_tiers(&company.price_list.capacity_tiers).into_iter().map(|(tier, facts)| {
        let mark = if tier == now { "  now" } else { "" };
        let (units, cost) = (f64::from(facts.capacity_units), f64::from(facts.cost_per_day));
        format!("{tier:>4}  {:>14}  {:>10}{mark}", grouped_number(units, 0), dollars(cost))
    }));
    if let Some(week) = company.observation.last_week.filter(|week| week.days_run > 0) {
        let mean = week.usage as f64 / f64::from(week.days_run);
        lines.push(format!("used  {:>14}  a day last week", grouped_number(mean, 0)));
    }
    lines
}

fn project_lines(company: &DisplayedCompany) -> Vec<String> {
    let row = |(tier, means): (&ResearchTierFacts, &ResearchMeans)| {
        let running = if tier.in_progress > 0 { "running" } else { "" };
        [
            tier.tier.to_string(),
            tier.name.clone(),
            dollars(f64::from(tier.cost)),
            format_mean_days(means),
            format_mean_gain(means, QUALITY_DECIMALS),
            running.to_owned(),
        ]
    };
    let now = if company.projects.tiers.iter().any(|tier| tier.in_progress > 0) { "now" } else { "" };
    let head = ["tier", "name", "cost", "mean days", "mean gain", now].map(str::to_owned);
    let rows: Vec<[String; 6]> = std::iter::once(head)
        .chain(company.projects.tiers.iter().zip(&company.research_means).map(row))
        .collect();
    let width = |column: usize| rows.iter().map(|row| row[column].width()).max().unwrap_or(0);
    let widths: [usize; 6] = std::array::from_fn(width);
    let line = |row: &[String; 6]| {
        let cell = |(column, text): (usize, &String)| match column {
            1 | 5 => format!("{text:<width$}", width = widths[column]),
            _ => format!("{text:>width$}", width = widths[column]),
        };
        row.iter().enumerate().map(cell).collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    rows.iter().map(line).collect()
}

fn thread_lines(company: &DisplayedCompany) -> Vec<String> {
    if company.observation.waiting.is_empty() {
        return Vec::new();
    }
    let mut lines =
        vec!["customer  group   seats  thread            asks         days left  enterprise".to_owned()];
    lines.extend(company.observation.waiting.iter().map(|thread| {
        let asks = thread.asked.map_or("–".to_owned(), dollars_and_cents);
        format!(
            "{:>8}  {:<6} {:>6}  {:<16} {asks:>8}   {:>14}  {}",
            thread.customer,
            thread.group,
            thread.seats,
            thread.kind,
            thread.days_left,
            company.enterprise_names.name(thread.customer)
        )
    }));
    lines
}

fn price_lines(company: &DisplayedCompany) -> Vec<String> {
    let mut lines = vec!["plan  tier  quota a day  full quota/month".to_owned()];
    lines.extend(["A", "B", "C"].into_iter().map(|plan| {
        let (tier, quota) =
            (company.current_setting(ToolId::SetModelTiers, plan), company.current_setting(ToolId::SetUsageQuotas, plan));
        let unit =
            company.price_list.model_tiers.get(&(tier as u8)).map_or(0.0, |facts| facts.cost_per_usage_unit);
        format!(
            "{plan:<4}  {:>4}  {:>11}  {:>16}",
            format_number(tier),
            grouped_number(quota, 0),
            dollars(quota * unit * 30.0)
        )
    }));
    lines
}
