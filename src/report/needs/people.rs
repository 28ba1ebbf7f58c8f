//! Diagnoses of negotiations and churn.

use serde_json::{Map, Value};

use super::{AHEAD, MONTH, Need, Place, Problem, Situation};
use crate::chapters::change_in_words;
use crate::words::{count, money, whole};
use novamind_base::notation::{json_number, percent};
use novamind_session::identifiers::{Group, Plan};
use novamind_session::{Change, Decisions};
use novamind_tools::ToolId;

/// Minimum number of weekly cancellations for a wave.
const FEW: f64 = 20.0;
const CYCLE: usize = 4;
/// Minimum ratio of a wave to the usual churn.
const WAVE: f64 = 2.0;
/// Days in which every subscriber is billed once, and so decides.
const BILLING: u32 = 30;
/// Settings that subscribers judge when they are billed.
const JUDGED: [ToolId; 5] = [
    ToolId::SetPrices,
    ToolId::SetModelTiers,
    ToolId::SetUsageQuotas,
    ToolId::SetPromotion,
    ToolId::SetAdsStrength,
];

/// Finds threads that end within the coming week unless they are answered.
pub(super) fn threads(situation: &Situation<'_>) -> Option<Need> {
    let waiting = &situation.seen.waiting;
    let deadline = |days: u32| situation.seen.day + days;
    let earliest = deadline(waiting.iter().map(|thread| thread.days_left).min()?);
    let last = deadline(waiting.iter().map(|thread| thread.days_left).max()?);
    let by = match earliest == last {
        true => format!("by day {last}"),
        false => format!("by day {last}, the first by day {earliest}"),
    };
    let lowest =
        Plan::ALL.into_iter().map(|plan| situation.settings.prices[plan]).filter(|price| *price > 0.0);
    let lowest = lowest.fold(f64::INFINITY, f64::min);
    let value = |thread: &novamind_session::WaitingThread| {
        let price = thread.asked.unwrap_or(if lowest.is_finite() { lowest } else { 0.0 });
        f64::from(thread.seats) * price
    };
    let a_month: f64 = waiting.iter().map(value).sum();
    let seats: u32 = waiting.iter().map(|thread| thread.seats).sum();
    let first = waiting.iter().max_by(|left, right| value(left).total_cmp(&value(right)))?;
    let (who, fate) = match waiting.len() {
        1 => (
            format!("{} waits", situation.session.company().company_names().with_number(first.customer)),
            "the thread ends",
        ),
        more => (format!("{} wait", count(more as u32, "enterprise")), "their threads end"),
    };
    Some(Need {
        problem: Problem::Threads,
        text: format!(
            "{who} for an answer ({}, {} a month at the requested or lowest list price); without one {fate} {by}",
            count(seats, "seat"),
            money(a_month)
        ),
        proposal: None,
        place: Place::Thread(first.thread),
        at_risk: a_month * AHEAD / MONTH,
        urgent: true,
    })
}

/// Finds groups with far more cancellations than usual.
pub(super) fn churn(situation: &Situation<'_>) -> Vec<Need> {
    let people = Group::all().filter(|group| !group.is_enterprise());
    people.filter_map(|group| wave(situation, group)).collect()
}

fn wave(situation: &Situation<'_>, group: Group) -> Option<Need> {
    let weeks = situation.groups;
    let there = |at: usize| f64::from(weeks[at][group].subscribers.0.iter().sum::<u32>());
    let left = |at: usize| f64::from(weeks[at][group].left);
    // Subscribers cancel when billed, a month after signup at the earliest, so cancellations are compared with the
    // subscribers of four weeks before.
    let share = |at: usize| left(at) / there(at - CYCLE).max(1.0);
    let last = weeks.len().checked_sub(1)?;
    let before = last.saturating_sub(CYCLE).max(CYCLE)..last;
    if before.len() < CYCLE {
        return None;
    }
    let mean = |of: &dyn Fn(usize) -> f64| before.clone().map(of).sum::<f64>() / before.len() as f64;
    let (gone, usual) = (left(last), mean(&left));
    if gone <= FEW || share(last) <= WAVE * mean(&share) {
        return None;
    }
    let (now, had) = (&weeks[last], there(last - 1));
    let mean_price = now[group].revenue.0.iter().sum::<f64>() / there(last).max(1.0);
    let set = judged(situation);
    let told = set.map_or(String::new(), |(day, changes)| {
        let words: Vec<String> = changes.iter().take(2).map(|change| change_in_words(change)).collect();
        let more = match changes.len().saturating_sub(2) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        format!("; on day {day} you changed {}{more}", words.join(", "))
    });
    let place =
        judged(situation).map_or(Place::Group(group), |(_, changes)| restored(situation, &changes, group));
    Some(Need {
        problem: Problem::Churn(group),
        text: format!(
            "{group}: {} of {} cancelled last week ({}); four-week average {}{told}",
            whole(gone),
            whole(had),
            percent(gone / had.max(1.0), 1),
            whole(usual)
        ),
        proposal: None,
        place,
        at_risk: gone * mean_price * AHEAD / 7.0,
        urgent: true,
    })
}

/// Returns the last change of a setting that subscribers judge, while some of them see it on their first bill since.
fn judged<'a>(situation: &'a Situation<'_>) -> Option<(u32, Vec<&'a Change>)> {
    let recent = |decided: &&Decisions| decided.day + BILLING + 7 > situation.seen.day;
    situation.decisions.iter().rev().take_while(recent).find_map(|decided| {
        let changes: Vec<&Change> = decided
            .changes
            .iter()
            .filter(|change| JUDGED.contains(&change.setting.tool()) && change.old != 0.0)
            .collect();
        (!changes.is_empty()).then_some((decided.day, changes))
    })
}

/// Returns the form of the first changed setting with its earlier value, if it is a setting by plan.
fn restored(situation: &Situation<'_>, changes: &[&Change], group: Group) -> Place {
    let Some(first) = changes.first() else { return Place::Group(group) };
    let tool = first.setting.tool();
    let mut arguments = match tool {
        ToolId::SetPrices | ToolId::SetModelTiers => Map::new(),
        ToolId::SetUsageQuotas => situation.session.company().current(ToolId::SetUsageQuotas),
        _ => return Place::Group(group),
    };
    for change in changes.iter().filter(|change| change.setting.tool() == tool) {
        if let Some(plan) = change.setting.plan() {
            arguments.insert(plan.id().to_owned(), json_number(change.old));
        }
    }
    Place::Call(tool, Value::Object(arguments))
}
