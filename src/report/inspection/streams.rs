//! Texts for the next random draws of a part of the simulator.

use super::{clean_up_numbers, indented_table};
use crate::formatting::pluralize;
use novamind_insight::{DrawEffect, KeyedDraws, NextDraws};

const MAX_ROW_DRAWS: usize = 8;
const MAX_LISTED_CUSTOMERS: usize = 12;

/// Lists the random streams that a part of the simulator uses on the next day, the first draws of each stream, and the
/// results of these draws.
pub fn describe_next_draws(next_draws: &NextDraws) -> Vec<String> {
    let NextDraws { part, day, streams, .. } = next_draws;
    let over = if next_draws.is_over { "; the run has ended, so this day is not simulated" } else { "" };
    let mut lines = vec![format!("next draws of {}, day {day}{over}", part.id())];
    if next_draws.is_replayed {
        lines.push("  a recorded series replaces these draws on the days that it covers".to_owned());
    }
    match streams.iter().any(|keyed_draws| keyed_draws.draws.len() > MAX_ROW_DRAWS) {
        true => streams.iter().for_each(|keyed_draws| lines.extend(all_draws(keyed_draws))),
        false => lines.extend(stream_rows(streams)),
    }
    clean_up_numbers(lines)
}

fn stream_rows(streams: &[KeyedDraws]) -> Vec<String> {
    let count = streams.iter().map(|keyed_draws| keyed_draws.draws.len()).max().unwrap_or(0);
    let numbers: Vec<String> = (1..=count).map(|number| format!("draw {number}")).collect();
    let mut head = vec!["stream", "key"];
    head.extend(numbers.iter().map(String::as_str));
    head.push("result");
    let row = |keyed_draws: &KeyedDraws| {
        let draws = keyed_draws.draws.iter().map(|draw| format!("{:.6}", draw.uniform));
        let what = [describe_effect(&keyed_draws.effect)];
        [keyed_draws.stream.to_owned(), format_key(keyed_draws)]
            .into_iter()
            .chain(draws)
            .chain(what)
            .collect()
    };
    indented_table(&head, &streams.iter().map(row).collect::<Vec<_>>())
}

fn format_key(keyed_draws: &KeyedDraws) -> String {
    let parts = keyed_draws.key.iter().map(|(name, value)| match (keyed_draws.group, *name) {
        (Some(group), "group") => group.to_string(),
        _ => format!("{name} {value}"),
    });
    parts.collect::<Vec<String>>().join(", ")
}

fn all_draws(keyed_draws: &KeyedDraws) -> Vec<String> {
    let mut lines = vec![format!(
        "  {} ({}): {}",
        keyed_draws.stream,
        format_key(keyed_draws),
        describe_effect(&keyed_draws.effect)
    )];
    lines.extend(keyed_draws.draws.chunks(MAX_ROW_DRAWS).map(|some| {
        let draws: Vec<String> = some.iter().map(|draw| format!("{:.6}", draw.uniform)).collect();
        format!("    {}", draws.join(" "))
    }));
    lines
}

fn describe_effect(follows: &DrawEffect) -> String {
    match follows {
        DrawEffect::Leads { expected, number } => {
            format!("{} if λ is {expected:.2} as on the last day", pluralize(*number, "lead"))
        }
        DrawEffect::FailedPayments { rate, customers } => describe_failed_payments(*rate, customers),
        DrawEffect::OutageAbove(chance) => {
            format!("an outage if the outage chance exceeds {:.2} %", chance * 100.0)
        }
        DrawEffect::Noise(noise) => format!("noise {noise:+.6} in shared quality"),
        DrawEffect::Project { tier, days, gain } => {
            format!("a project of tier {tier} takes {} and adds {gain:.4}", pluralize(*days, "day"))
        }
        DrawEffect::Found(Some(group)) => format!("discovers {group}"),
        DrawEffect::Found(None) => "discovers no group".to_owned(),
        DrawEffect::Surge(Some(surge)) => {
            format!("a demand surge: {:.2} times the leads until day {}", surge.multiplier, surge.end_day - 1)
        }
        DrawEffect::Surge(None) => "no demand surge".to_owned(),
        DrawEffect::Index { before, after } => format!("the PMI changes from {before:.2} to {after:.2}"),
        DrawEffect::CompetitorMove(Some((sampled, u))) => {
            format!("a competitor move: drawn size {sampled:.4}, or {:.1} % of the shared bank", u * 100.0)
        }
        DrawEffect::CompetitorMove(None) => "no competitor move".to_owned(),
    }
}

fn describe_failed_payments(rate: f64, customers: &[u32]) -> String {
    let named: Vec<String> =
        customers.iter().take(MAX_LISTED_CUSTOMERS).map(|customer| customer.to_string()).collect();
    let more = match customers.len().saturating_sub(MAX_LISTED_CUSTOMERS) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    match customers.is_empty() {
        true => format!("{:.2} % of payments fail; none on this day", rate * 100.0),
        false => format!("{:.2} % of payments fail: customers {}{more}", rate * 100.0, named.join(", ")),
    }
}
