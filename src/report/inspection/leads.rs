//! Texts for the equation that determines the leads of a group.

use super::clean_up_numbers;
use novamind_insight::{LeadEquation, LeadFactor};

/// Returns the index of the line that describes a factor in the result of [`describe_lead_equation`].
pub fn factor_line_index(factor: LeadFactor) -> usize {
    2 + factor as usize
}

/// Describes the lead equation of the last day, and the range of each factor over all days. Also shows λ, the expected
/// number of leads, if the factors in `held` have the given values.
pub fn describe_lead_equation(days: &[LeadEquation], held: &[(LeadFactor, f64)]) -> Vec<String> {
    let Some(lead_equation) = days.last() else { return Vec::new() };
    let mut lines = vec![format!("leads of {} on day {}", lead_equation.group, lead_equation.day)];
    if !lead_equation.is_known {
        lines.push("not discovered on that day: no leads".to_owned());
        return lines;
    }
    lines.push(format_equation(lead_equation));
    lines.extend(LeadFactor::ALL.map(|factor| factor_range(days, factor)));
    if lead_equation.has_unlimited_market {
        lines.push("  D is always 1: base_market_cap is 0, so the market has no size limit".to_owned());
    }
    let by_group = lead_equation.word_of_mouth.iter().map(|(group, leads)| format!("{group} {leads:.3}"));
    let by_group: Vec<String> = by_group.collect();
    lines.push(match by_group.is_empty() {
        true => "  no word of mouth: there are no subscribers".to_owned(),
        false => format!("  word of mouth from {}", by_group.join(" + ")),
    });
    if !held.is_empty() {
        let held_at: Vec<String> = held.iter().map(|(factor, value)| format!("{factor} {value}")).collect();
        let with = lead_equation.expected_leads_with(held);
        lines.push(format!(
            "with {}: λ {with:.2} rather than {:.2}",
            held_at.join(", "),
            lead_equation.expected_leads()
        ));
    }
    lines.push(format!(
        "  p {:.2}: the share of draws at least as far from λ as {}",
        lead_equation.p_value(),
        lead_equation.actual_leads
    ));
    clean_up_numbers(lines)
}

/// Formats the lead equation of a day: `R 0.50 × … × (search_ads 5.0 + word of mouth 12.4) = λ 98.3, actual 104 (p
/// 0.56)`.
fn format_equation(lead_equation: &LeadEquation) -> String {
    let factors = LeadFactor::ALL.map(|factor| format!("{factor} {:.4}", lead_equation.factor(factor)));
    let mut sources: Vec<String> =
        lead_equation.channels().map(|(channel, leads)| format!("{} {leads:.2}", channel.id())).collect();
    sources.push(format!("word of mouth {:.2}", lead_equation.word_of_mouth_leads()));
    format!(
        "  {} × ({}) = λ {:.2}, actual {} (p {:.2})",
        factors.join(" × "),
        sources.join(" + "),
        lead_equation.expected_leads(),
        lead_equation.actual_leads,
        lead_equation.p_value()
    )
}

fn factor_range(days: &[LeadEquation], factor: LeadFactor) -> String {
    let values = || days.iter().filter(|day| day.is_known).map(|day| day.factor(factor));
    let (least, most) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
    let now = days.last().map_or(0.0, |day| day.factor(factor));
    let (name, count) = (factor.name(), values().count());
    format!("  {factor} {name:<18} {now:>8.4}   last {count} days {least:.4} to {most:.4}")
}
