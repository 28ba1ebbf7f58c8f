//! Diagnoses of expiring threads and of churn.

use std::collections::{BTreeMap, BTreeSet};

use super::offer_changes::OfferChange;
use super::{ActionItem, ActionTarget, DAYS_PER_MONTH, DiagnosisContext, MAX_CHANCE, Problem, RISK_DAYS};
use crate::fit::{Fit, fits};
use crate::formatting::{format_money, format_whole, pluralize};
use novamind_session::WaitingThread;
use novamind_session::identifiers::{Group, Plan};
use novamind_tools::ToolId;

/// Minimum number of cancellations in the week of a churn wave.
const MIN_WAVE_CANCELLATIONS: f64 = 20.0;
/// Number of weeks after which all customers who signed up in the first week have been billed.
const BILLING_CYCLE_WEEKS: usize = 5;
/// Number of earlier weeks that a week is compared with.
const COMPARED_WEEKS: usize = 4;
/// Minimum number of earlier weeks for a comparison.
const MIN_COMPARED_WEEKS: usize = 2;
/// Minimum ratio of the cancellations of a churn wave to the usual cancellations. It is high because the number of
/// bills is only an estimate: a healthy company in its tenth week has 1.9 times the usual cancellations.
const MIN_CHURN_WAVE_RATIO: f64 = 2.0;
/// Number of days between two bills of a subscriber. Subscribers decide on billing days whether to stay.
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
    let prices = ThreadPrices::new(situation);
    let value = |thread: &WaitingThread| {
        prices.price(thread).map_or(0.0, |(price, _)| f64::from(thread.seats) * price)
    };
    // The thread with the highest payments or, among equal payments, the most seats.
    let first = waiting
        .iter()
        .max_by(|left, right| value(left).total_cmp(&value(right)).then(left.seats.cmp(&right.seats)))?;
    let (who, consequence) = match waiting.len() {
        1 => (
            format!(
                "{} waits",
                situation.session.company().enterprise_names().name_with_number(first.customer)
            ),
            "the thread ends",
        ),
        more => (format!("{} wait", pluralize(more as u32, "enterprise")), "their threads end"),
    };
    Some(ActionItem {
        problem: Problem::Threads,
        text: format!(
            "{who} for an answer ({}). Without an answer, {consequence} {by}.",
            prices.describe(waiting)
        ),
        proposal: None,
        target: ActionTarget::Thread(first.thread),
        at_risk: prices.monthly_payments(waiting) * RISK_DAYS / DAYS_PER_MONTH,
        is_urgent: true,
    })
}

/// Prices for estimating the payments of waiting enterprises.
struct ThreadPrices {
    fits: Vec<Fit>,
    /// Estimated usage of each known group, units per seat per day.
    usage: BTreeMap<Group, f64>,
    /// Lowest list price, for estimating the money at risk if no price is known.
    lowest_list_price: f64,
}

impl ThreadPrices {
    fn new(situation: &DiagnosisContext<'_>) -> ThreadPrices {
        let on_sale =
            Plan::ALL.into_iter().map(|plan| situation.settings.prices[plan]).filter(|price| *price > 0.0);
        let estimates = situation.session.company().estimates().into_iter();
        ThreadPrices {
            fits: fits(situation.session),
            usage: estimates.map(|estimates| (estimates.group, estimates.usage)).collect(),
            lowest_list_price: on_sale.reduce(f64::min).unwrap_or(1.0),
        }
    }

    /// Returns the price that an enterprise asked for, otherwise the list price of the cheapest plan that can suit it,
    /// together with this plan. Returns `None` if neither exists.
    fn price(&self, thread: &WaitingThread) -> Option<(f64, Option<Plan>)> {
        if let Some(asked) = thread.asked {
            return Some((asked, None));
        }
        let group = Group::parse(thread.group)?;
        let fit = self.fits.iter().find(|fit| fit.group == group)?;
        let usage = self.usage.get(&group).map(|units| units * f64::from(thread.seats));
        let plan = fit.cheapest_suitable_plan(usage)?;
        Some((fit.plans[plan].list_price, Some(plan)))
    }

    /// Returns the estimated monthly payments of the enterprises with a known price. If no price is known, returns the
    /// payments of all enterprises at the lowest list price.
    fn monthly_payments(&self, waiting: &[WaitingThread]) -> f64 {
        let payment = |thread: &WaitingThread| Some(self.price(thread)?.0 * f64::from(thread.seats));
        let known: f64 = waiting.iter().filter_map(payment).sum();
        let seats: u32 = waiting.iter().map(|thread| thread.seats).sum();
        if known > 0.0 { known } else { self.lowest_list_price * f64::from(seats) }
    }

    /// Describes the seats, the estimated payments, and the prices on which the estimate is based.
    fn describe(&self, waiting: &[WaitingThread]) -> String {
        let seats = pluralize(waiting.iter().map(|thread| thread.seats).sum(), "seat");
        let prices: Vec<(f64, Option<Plan>)> =
            waiting.iter().filter_map(|thread| self.price(thread)).collect();
        let plans: BTreeSet<&str> = prices.iter().filter_map(|(_, plan)| Some(plan.as_ref()?.id())).collect();
        let plans = match plans.into_iter().collect::<Vec<_>>().as_slice() {
            [] => String::new(),
            [plan] => format!("the list price of plan {plan}"),
            more => format!("the list prices of plans {}", more.join(", ")),
        };
        let basis = match (prices.iter().any(|(_, plan)| plan.is_none()), plans.is_empty()) {
            (true, true) => "requested prices".to_owned(),
            (true, false) => format!("requested prices, otherwise {plans}"),
            (false, false) => plans,
            (false, true) => return format!("{seats}; no price requested, and no plan on sale suits them"),
        };
        let others = match waiting.len() - prices.len() {
            0 => String::new(),
            others => format!("; {others} named no price, and no plan on sale suits them"),
        };
        format!("{seats}, {} a month at {basis}{others}", format_money(self.monthly_payments(waiting)))
    }
}

/// Finds groups with more cancellations than chance can explain.
pub(super) fn churn_waves(situation: &DiagnosisContext<'_>) -> Vec<ActionItem> {
    let people = Group::all().filter(|group| !group.is_enterprise());
    people.filter_map(|group| churn_wave(situation, group)).collect()
}

fn churn_wave(situation: &DiagnosisContext<'_>, group: Group) -> Option<ActionItem> {
    let weeks = situation.groups;
    let gone = |at: usize| f64::from(weeks[at][group].left);
    let last = weeks.len().checked_sub(1)?;
    // Subscribers cancel on billing days, so cancellations are compared with the number of bills.
    let signups = |at: usize| f64::from(weeks[at][group].chosen.0.iter().sum::<u32>());
    let exposed = |at: usize| expected_bills(at, &signups);
    let before = last.saturating_sub(COMPARED_WEEKS).max(BILLING_CYCLE_WEEKS)..last;
    if before.len() < MIN_COMPARED_WEEKS {
        return None;
    }
    let sum = |of: &dyn Fn(usize) -> f64| before.clone().map(of).sum::<f64>();
    let (gone_before, exposed_before) = (sum(&gone), sum(&exposed));
    let (gone, expected) = (gone(last), exposed(last) * gone_before / exposed_before.max(1.0));
    let chance = chance_of_count(expected, exposed(last), exposed_before);
    if gone <= MIN_WAVE_CANCELLATIONS || gone < MIN_CHURN_WAVE_RATIO * expected || gone - expected <= chance {
        return None;
    }
    let mean_price = weeks[last][group].revenue_per_subscriber();
    // Decisions before this day cannot explain the cancellations, because all subscribers were billed between those
    // decisions and the last week.
    let since = situation.observation.day.saturating_sub(BILLING_DAYS + 7);
    let change = OfferChange::find_last(situation, &SETTINGS_JUDGED_AT_BILLING, since);
    let change_text = change.as_ref().map_or(String::new(), |change| format!(" {}", change.describe()));
    Some(ActionItem {
        problem: Problem::Churn(group),
        text: format!(
            "{group}: {} cancelled last week. At the rate per bill of the {} weeks before, it would have been {}.{change_text}",
            pluralize(gone as u32, "subscriber"),
            before.len(),
            format_whole(expected)
        ),
        proposal: None,
        target: change.map_or(ActionTarget::Group(group), |change| change.restore_target(situation, group)),
        at_risk: (gone - expected) * mean_price * RISK_DAYS / 7.0,
        is_urgent: true,
    })
}

/// Returns the approximate number of subscribers who are billed for another month in a week: those who signed up one or
/// more billing periods earlier. Does not subtract earlier cancellations.
fn expected_bills(week: usize, signups: &dyn Fn(usize) -> f64) -> f64 {
    let weeks_per_period = f64::from(BILLING_DAYS) / 7.0;
    let mut bills = 0.0;
    let mut back = weeks_per_period;
    while back <= week as f64 {
        // A week that begins `back` weeks earlier overlaps two recorded weeks.
        let (whole, part) = (back.floor() as usize, back.fract());
        bills += (1.0 - part) * signups(week - whole);
        if let Some(earlier) = week.checked_sub(whole + 1) {
            bills += part * signups(earlier);
        }
        back += weeks_per_period;
    }
    bills
}

/// Returns the largest excess of a count over its expectation that is attributed to chance: [`MAX_CHANCE`] standard
/// errors of a Poisson count. The expectation is estimated from a rate, and the exposures are the numbers of bills in
/// both periods.
fn chance_of_count(expected: f64, exposure: f64, exposure_before: f64) -> f64 {
    MAX_CHANCE * (expected * (1.0 + exposure / exposure_before.max(1.0))).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn expected_bills_counts_signups_one_and_more_periods_earlier() {
        // 30 days are 4 weeks and 2 days, so two sevenths of the customers signed up a week earlier.
        let signups = |at: usize| [70.0, 140.0, 0.0, 0.0, 0.0, 7.0][at.min(5)];
        assert_eq!(expected_bills(4, &signups), 0.0);
        assert!((expected_bills(5, &signups) - (140.0 * 5.0 / 7.0 + 70.0 * 2.0 / 7.0)).abs() < 1e-9);
        assert!(
            (expected_bills(9, &signups) - (7.0 * 5.0 / 7.0 + 140.0 * 3.0 / 7.0 + 70.0 * 4.0 / 7.0)).abs()
                < 1e-9
        );
    }
}
