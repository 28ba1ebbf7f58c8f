//! Figures of the run in the texts of the tour.

use novamind_base::formatting::{dollars, pluralize};
use novamind_report::fit::Fit;
use novamind_session::identifiers::{Group, Plan};
use novamind_tools::ToolId;
use novamind_worker::company::DisplayedCompany;

/// Returns the group that the tour uses as its example.
pub(super) fn example_group(company: &DisplayedCompany) -> Option<Group> {
    company.observation.known_groups.first().copied()
}

/// Replaces names in square brackets with figures of the run.
pub(super) fn insert_figures(text: &str, company: &DisplayedCompany) -> String {
    let mut filled = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('[') {
        filled.push_str(before);
        let (name, after) = after.split_once(']').unwrap_or((after, ""));
        filled.push_str(&figure(name, company).unwrap_or_else(|| "–".to_owned()));
        rest = after;
    }
    filled + rest
}

fn figure(name: &str, company: &DisplayedCompany) -> Option<String> {
    let fit = || example_group(company).and_then(|group| company.fit(group));
    let week = company.weeks.last();
    let count = |value: u32, noun: &str| pluralize(value, noun);
    Some(match name {
        "last_day" => company.observation.last_day.to_string(),
        "week" => company.weeks.len().to_string(),
        "group" => example_group(company)?.to_string(),
        "quality" => qualities(fit()?),
        "priced" => prices(company),
        "budget" => fit()?.budget.format_money(),
        "usage" => fit()?.usage.format_units(),
        "leads" => week?.new_individual_leads.to_string(),
        "signed" => week?.new_individual_subscribers.to_string(),
        "cancelled" => count(week?.cancellations, "subscriber"),
        "issues" => week?.open_issues.to_string(),
        "subscribers" => week?.individual_subscribers.to_string(),
        "operations" => match company.current_setting(ToolId::SetDailySpend, "operations") {
            amount if amount > 0.0 => format!("{} a day", dollars(amount)),
            _ => "nothing on them".to_owned(),
        },
        _ => return None,
    })
}

/// Returns the delivered quality of each plan, or a single value if the quality is the same for all plans.
fn qualities(fit: &Fit) -> String {
    let [first, others @ ..] = Plan::ALL.map(|plan| format!("{:.2}", fit.plans[plan].quality));
    match others.iter().all(|other| *other == first) {
        true => first,
        false => format!("{first}, {}", others.join(", ")),
    }
}

fn prices(company: &DisplayedCompany) -> String {
    let price = |plan: Plan| company.current_setting(ToolId::SetPrices, plan.id());
    let priced: Vec<String> = Plan::ALL
        .into_iter()
        .filter(|plan| price(*plan) > 0.0)
        .map(|plan| format!("{plan} {}", dollars(price(plan))))
        .collect();
    if priced.is_empty() { "no price yet".to_owned() } else { priced.join(", ") }
}
