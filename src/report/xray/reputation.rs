//! Text for the causes of a reputation change.

use super::{evenings_in_words, settled, table};
use novamind_insight::{Departures, LeastChanges, OwnChange, ReputationEquation};
use novamind_session::Spill;
use novamind_session::identifiers::Group;

/// Describes the reputation of a group: before, every term, after, and dropped terms.
pub fn reputation_in_words(own: &ReputationEquation) -> Vec<String> {
    let ReputationEquation { group, day, before, after, least, .. } = own;
    let plain = |name: &str, value: f64| vec![name.to_owned(), format!("{value:.8}")];
    let mut rows = vec![plain("before", *before)];
    rows.extend(departures("cancellations", &own.gave_up));
    rows.extend(departures("lost enterprises", &own.lost));
    rows.push(row(&contribution(&own.own, least), own.own.made()));
    let heard = own.spills.iter().filter(|spill| spill.counts);
    rows.extend(heard.map(|spill| row(&product(spill), spill.change)));
    // Rounding errors are not limits.
    if own.bounds.abs() > 1e-12 {
        rows.push(row("limits", own.bounds));
    }
    rows.push(plain("after", *after));
    let mut lines = vec![format!("reputation of {group} on day {day}")];
    lines.extend(table(&["", ""], &rows).into_iter().skip(1));
    lines.extend(evenings_in_words(own.evenings.iter().copied()));
    let dropped: Vec<&Spill> = own.spills.iter().filter(|spill| !spill.counts).collect();
    lines.extend(dropped_in_words(&dropped, least));
    settled(lines)
}

/// Formats `spillover: +0.00476883 of S1 × weight 0.4 × 0.3`.
fn product(spill: &Spill) -> String {
    let Spill { from, source_change, weight, factor, .. } = spill;
    format!("spillover: {source_change:+.8} of {from} × weight {weight} × {factor}")
}

fn row(name: &str, value: f64) -> Vec<String> {
    vec![name.to_owned(), format!("{value:+.8}")]
}

fn departures(name: &str, own: &Departures) -> Option<Vec<String>> {
    (own.count > 0).then(|| row(&format!("{} {name}", own.count), own.change))
}

fn contribution(own: &OwnChange, least: &LeastChanges) -> String {
    match own {
        OwnChange { subscribers: 0, .. } => "no subscribers in the group".to_owned(),
        OwnChange { subscribers, counts: true, .. } => format!("satisfaction of its {subscribers}"),
        OwnChange { subscribers, called, .. } => {
            format!("satisfaction of its {subscribers}: {called:+.8} is below {}: dropped", small(least.own))
        }
    }
}

/// Formats `0.0001`, never `1e-4`.
pub(super) fn small(value: f64) -> String {
    format!("{value}")
}

/// Lists dropped spillovers, a line for each source.
pub(super) fn dropped_in_words(dropped: &[&Spill], least: &LeastChanges) -> Vec<String> {
    let pairs = |from: Group| {
        let own = dropped.iter().filter(|spill| spill.from == from);
        own.map(|spill| format!("{}→{}", spill.from, spill.to)).collect::<Vec<String>>()
    };
    let named = |pairs: Vec<String>| match pairs.is_empty() {
        true => None,
        false => Some(format!("  {} below {}: dropped", pairs.join(", "), small(least.spill))),
    };
    Group::all().filter_map(|from| named(pairs(from))).collect()
}
