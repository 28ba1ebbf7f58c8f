//! Texts for the causes of a reputation change.

use super::{clean_up_numbers, describe_recent_days, indented_table};
use novamind_insight::{CancellationEffect, ChangeThresholds, ReputationEquation, SubscriberContribution};
use novamind_session::SpilloverEffect;
use novamind_session::identifiers::Group;

/// Describes how the reputation of a group changed on a day: the value before, every applied term, the value after, and
/// the dropped terms.
pub fn describe_reputation(reputation_equation: &ReputationEquation) -> Vec<String> {
    let ReputationEquation { group, day, before, after, thresholds: least, .. } = reputation_equation;
    let plain = |name: &str, value: f64| vec![name.to_owned(), format!("{value:.8}")];
    let mut rows = vec![plain("before", *before)];
    rows.extend(lost_customers_row("cancellations", &reputation_equation.individual_departures));
    rows.extend(lost_customers_row("lost enterprises", &reputation_equation.enterprise_departures));
    rows.push(term_row(
        &describe_contribution(&reputation_equation.contribution, least),
        reputation_equation.contribution.applied_change(),
    ));
    let counted = reputation_equation.spillovers.iter().filter(|spill| spill.counts);
    rows.extend(counted.map(|spill| term_row(&spillover_product(spill), spill.change)));
    // A smaller difference is a rounding error and does not show that a limit applied.
    if reputation_equation.bounds.abs() > 1e-12 {
        rows.push(term_row("limits", reputation_equation.bounds));
    }
    rows.push(plain("after", *after));
    let mut lines = vec![format!("reputation of {group} on day {day}")];
    lines.extend(indented_table(&["", ""], &rows).into_iter().skip(1));
    lines.extend(describe_recent_days(reputation_equation.recent_days.iter().copied()));
    let dropped: Vec<&SpilloverEffect> =
        reputation_equation.spillovers.iter().filter(|spill| !spill.counts).collect();
    lines.extend(describe_dropped_spillovers(&dropped, least));
    clean_up_numbers(lines)
}

/// Formats the factors of a spillover: `spillover: +0.00476883 of S1 × weight 0.4 × 0.3`.
fn spillover_product(spill: &SpilloverEffect) -> String {
    let SpilloverEffect { from, source_change, weight, factor, .. } = spill;
    format!("spillover: {source_change:+.8} of {from} × weight {weight} × {factor}")
}

fn term_row(name: &str, value: f64) -> Vec<String> {
    vec![name.to_owned(), format!("{value:+.8}")]
}

fn lost_customers_row(name: &str, departure_effect: &CancellationEffect) -> Option<Vec<String>> {
    (departure_effect.count > 0)
        .then(|| term_row(&format!("{} {name}", departure_effect.count), departure_effect.change))
}

fn describe_contribution(
    subscriber_contribution: &SubscriberContribution,
    least: &ChangeThresholds,
) -> String {
    match subscriber_contribution {
        SubscriberContribution { subscribers: 0, .. } => "no subscribers in the group".to_owned(),
        SubscriberContribution { subscribers, is_applied: true, .. } => {
            format!("satisfaction of its {subscribers}")
        }
        SubscriberContribution { subscribers, requested_change: called, .. } => {
            format!(
                "satisfaction of its {subscribers}: {called:+.8}, dropped because it is below {}",
                format_small(least.subscriber_contribution)
            )
        }
    }
}

/// Formats a small number in decimal notation: `0.0001` instead of `1e-4`.
pub(super) fn format_small(value: f64) -> String {
    format!("{value}")
}

/// Lists dropped spillovers, one line per source group.
pub(super) fn describe_dropped_spillovers(
    dropped: &[&SpilloverEffect],
    least: &ChangeThresholds,
) -> Vec<String> {
    let pairs = |from: Group| {
        let from_source = dropped.iter().filter(|spill| spill.from == from);
        from_source.map(|spill| format!("{}→{}", spill.from, spill.to)).collect::<Vec<String>>()
    };
    let named = |pairs: Vec<String>| match pairs.is_empty() {
        true => None,
        false => Some(format!("  {} below {}: dropped", pairs.join(", "), format_small(least.spillover))),
    };
    Group::all().filter_map(|from| named(pairs(from))).collect()
}
