//! Diagnoses of expiring threads and of churn.

use serde_json::{Map, Value};

use super::{ActionItem, ActionTarget, DAYS_PER_MONTH, DiagnosisContext, Problem, RISK_DAYS};
use crate::decision_periods::describe_change;
use crate::formatting::{format_money, format_whole, pluralize};
use novamind_base::formatting::{json_number, percent};
use novamind_session::identifiers::{Group, Plan};
use novamind_session::{Decisions, SettingChange};
use novamind_tools::ToolId;

/// Minimum number of weekly cancellations that count as a churn wave.
const MIN_WAVE_CANCELLATIONS: f64 = 20.0;
const BILLING_CYCLE_WEEKS: usize = 4;
/// Minimum ratio of a churn wave to the usual churn.
const MIN_WAVE_RATIO: f64 = 2.0;
/// Number of days in which every subscriber is billed once. Subscribers make their decisions on billing days.
const BILLING_DAYS: u32 = 30;
/// Settings that influence whether a subscriber cancels on a billing day.
const SETTINGS_JUDGED_AT_BILLING: [ToolId; 5] = [
    ToolId::SetPrices,
    ToolId::SetModelTiers,
    ToolId::SetUsageQuotas,
    ToolId::SetPromotion,
    ToolId::SetAdsStrength,
];

/// Finds threads that end within the coming week unless the player answers.
pub(super) fn expiring_threads(situation: &DiagnosisContext<'_>) -> Option<ActionItem> {
    let waiting = &situation.observation.waiting;
    let deadline = |days: u32| situation.observation.day + days;
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
            format!("{} waits", situation.session.company().company_names().name_with_number(first.customer)),
            "the thread ends",
        ),
        more => (format!("{} wait", pluralize(more as u32, "enterprise")), "their threads end"),
    };
    Some(ActionItem {
        problem: Problem::Threads,
        text: format!(
            "{who} for an answer ({}, {} a month at the requested or lowest list price). Without an answer, {fate} {by}.",
            pluralize(seats, "seat"),
            format_money(a_month)
        ),
        proposal: None,
        target: ActionTarget::Thread(first.thread),
        at_risk: a_month * RISK_DAYS / DAYS_PER_MONTH,
        is_urgent: true,
    })
}

/// Finds groups with far more cancellations than usual.
pub(super) fn churn_waves(situation: &DiagnosisContext<'_>) -> Vec<ActionItem> {
    let people = Group::all().filter(|group| !group.is_enterprise());
    people.filter_map(|group| churn_wave(situation, group)).collect()
}

fn churn_wave(situation: &DiagnosisContext<'_>, group: Group) -> Option<ActionItem> {
    let weeks = situation.groups;
    let there = |at: usize| f64::from(weeks[at][group].subscribers.0.iter().sum::<u32>());
    let left = |at: usize| f64::from(weeks[at][group].left);
    // Subscribers cancel on billing days, at the earliest a month after signup. Cancellations are therefore divided by
    // the number of subscribers four weeks earlier.
    let share = |at: usize| left(at) / there(at - BILLING_CYCLE_WEEKS).max(1.0);
    let last = weeks.len().checked_sub(1)?;
    let before = last.saturating_sub(BILLING_CYCLE_WEEKS).max(BILLING_CYCLE_WEEKS)..last;
    if before.len() < BILLING_CYCLE_WEEKS {
        return None;
    }
    let mean = |of: &dyn Fn(usize) -> f64| before.clone().map(of).sum::<f64>() / before.len() as f64;
    let (gone, usual) = (left(last), mean(&left));
    if gone <= MIN_WAVE_CANCELLATIONS || share(last) <= MIN_WAVE_RATIO * mean(&share) {
        return None;
    }
    let (now, had) = (&weeks[last], there(last - 1));
    let mean_price = now[group].revenue.0.iter().sum::<f64>() / there(last).max(1.0);
    let set = last_judged_change(situation);
    let change_text = set.map_or(String::new(), |(day, changes)| {
        let words: Vec<String> = changes.iter().take(2).map(|change| describe_change(change)).collect();
        let more = match changes.len().saturating_sub(2) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        format!(" On day {day} you changed {}{more}.", words.join(", "))
    });
    let place = last_judged_change(situation)
        .map_or(ActionTarget::Group(group), |(_, changes)| restore_target(situation, &changes, group));
    Some(ActionItem {
        problem: Problem::Churn(group),
        text: format!(
            "{group}: {} of {} cancelled last week ({}). The four-week average is {}.{change_text}",
            format_whole(gone),
            format_whole(had),
            percent(gone / had.max(1.0), 1),
            format_whole(usual)
        ),
        proposal: None,
        target: place,
        at_risk: gone * mean_price * RISK_DAYS / 7.0,
        is_urgent: true,
    })
}

/// Returns the day and the changes of the last decision that could explain last week's cancellations. Older decisions
/// cannot explain the cancellations, because all subscribers had been billed after these decisions before last week.
fn last_judged_change<'a>(situation: &'a DiagnosisContext<'_>) -> Option<(u32, Vec<&'a SettingChange>)> {
    let recent = |decided: &&Decisions| decided.day + BILLING_DAYS + 7 > situation.observation.day;
    situation.decisions.iter().rev().take_while(recent).find_map(|decided| {
        let changes: Vec<&SettingChange> = decided
            .changes
            .iter()
            .filter(|change| SETTINGS_JUDGED_AT_BILLING.contains(&change.setting.tool()) && change.old != 0.0)
            .collect();
        (!changes.is_empty()).then_some((decided.day, changes))
    })
}

/// Returns the form of the first changed setting that has a value for each plan, filled with the earlier values.
fn restore_target(
    situation: &DiagnosisContext<'_>,
    changes: &[&SettingChange],
    group: Group,
) -> ActionTarget {
    let Some(first) = changes.first() else { return ActionTarget::Group(group) };
    let tool = first.setting.tool();
    let mut arguments = match tool {
        ToolId::SetPrices | ToolId::SetModelTiers => Map::new(),
        ToolId::SetUsageQuotas => situation.session.company().current_arguments(ToolId::SetUsageQuotas),
        _ => return ActionTarget::Group(group),
    };
    for change in changes.iter().filter(|change| change.setting.tool() == tool) {
        if let Some(plan) = change.setting.plan() {
            arguments.insert(plan.id().to_owned(), json_number(change.old));
        }
    }
    ActionTarget::Call(tool, Value::Object(arguments))
}
