//! What moved reputations, in words: of a group, and how changes spilled over between groups.

use super::table;
use crate::session::{Departures, LeastChanges, OwnChange, ReputationEquation, Spill, Spillover};
use crate::world::identifiers::Group;

/// The reputation of a group: before, every term, after; and what was dropped.
pub fn reputation_in_words(own: &ReputationEquation) -> Vec<String> {
    let ReputationEquation { group, day, before, after, least, .. } = own;
    let plain = |name: &str, value: f64| vec![name.to_owned(), format!("{value:.8}")];
    let mut rows = vec![plain("before", *before)];
    rows.extend(departures("cancellations", &own.gave_up));
    rows.extend(departures("lost companies", &own.lost));
    rows.push(row(&contribution(&own.own, least), own.own.made()));
    let heard = own.spills.iter().filter(|spill| spill.counts);
    rows.extend(
        heard.map(|spill| row(&format!("from {}, weight {}", spill.from, spill.weight), spill.change)),
    );
    // Rounding of the additions is no bound.
    if own.bounds.abs() > 1e-12 {
        rows.push(row("floor and ceiling", own.bounds));
    }
    rows.push(plain("after", *after));
    let mut lines = vec![format!("reputation of {group} on day {day}")];
    lines.extend(table(&["", ""], &rows).into_iter().skip(1));
    let dropped: Vec<&Spill> = own.spills.iter().filter(|spill| !spill.counts).collect();
    lines.extend(dropped_in_words(&dropped, least));
    lines
}

fn row(name: &str, value: f64) -> Vec<String> {
    vec![name.to_owned(), format!("{value:+.8}")]
}

fn departures(name: &str, own: &Departures) -> Option<Vec<String>> {
    (own.count > 0).then(|| row(&format!("{} {name}", own.count), own.change))
}

fn contribution(own: &OwnChange, least: &LeastChanges) -> String {
    match own {
        OwnChange { subscribers: 0, .. } => "no subscribers of its own".to_owned(),
        OwnChange { subscribers, counts: true, .. } => format!("satisfaction of its {subscribers}"),
        OwnChange { subscribers, called, .. } => {
            format!("satisfaction of its {subscribers}: {called:+.8} is below {}: dropped", small(least.own))
        }
    }
}

/// `0.0001`, never `1e-4`.
fn small(value: f64) -> String {
    format!("{value}")
}

fn dropped_in_words(dropped: &[&Spill], least: &LeastChanges) -> Vec<String> {
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

/// Marks of a heat table, from the smallest share of the largest spill to the largest.
const HEAT: [&str; 4] = ["░", "▒", "▓", "█"];

/// Spills as a heat table: rows are sources, columns targets.
pub fn spillover_in_words(own: &Spillover) -> Vec<String> {
    let Spillover { day, known, spills, least, .. } = own;
    let mut lines =
        vec![format!("changes of reputation on day {day}: rows are sources, columns are targets")];
    let sources: Vec<Group> = known.iter().copied().filter(|group| own.own[*group].subscribers > 0).collect();
    if sources.is_empty() {
        lines.push("  no group has subscribers".to_owned());
        return lines;
    }
    let heard: Vec<&Spill> = spills.iter().filter(|spill| spill.counts).collect();
    let largest = heard.iter().map(|spill| spill.change.abs()).fold(0.0, f64::max);
    let targets: Vec<Group> =
        known.iter().copied().filter(|target| heard.iter().any(|spill| spill.to == *target)).collect();
    let mut head = vec!["from", "own change"];
    head.extend(targets.iter().map(|group| group.id()));
    let cell = |from: Group, to: Group| match own.between(from, to) {
        Some(spill) if spill.counts => heat(&spill, largest),
        Some(_) => "dropped".to_owned(),
        None => "·".to_owned(),
    };
    let rows: Vec<Vec<String>> = sources
        .iter()
        .map(|from| {
            let change = &own.own[*from];
            let called = match change.counts {
                true => format!("{:+.6}", change.called),
                false => format!("{:+.6} dropped", change.called),
            };
            let cells = targets.iter().map(|to| cell(*from, *to));
            [from.to_string(), called].into_iter().chain(cells).collect()
        })
        .collect();
    lines.extend(table(&head, &rows));
    if heard.is_empty() {
        lines.push("  nothing spilled over".to_owned());
    }
    let small_own: Vec<&str> =
        sources.iter().filter(|group| !own.own[**group].counts).map(|group| group.id()).collect();
    if !small_own.is_empty() {
        lines.push(format!("  own changes of {} below {}: dropped", small_own.join(", "), small(least.own)));
    }
    let dropped: Vec<&Spill> = spills.iter().filter(|spill| !spill.counts).collect();
    lines.extend(dropped_in_words(&dropped, least));
    lines
}

fn heat(spill: &Spill, largest: f64) -> String {
    let share = if largest > 0.0 { spill.change.abs() / largest } else { 0.0 };
    let step = ((share * HEAT.len() as f64).ceil() as usize).clamp(1, HEAT.len());
    format!("{} {:+.6}", HEAT[step - 1], spill.change)
}
