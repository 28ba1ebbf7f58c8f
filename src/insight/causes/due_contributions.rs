//! Bills that were due in the two weeks, and the part of the residual that the bills explain.
//!
//! Individuals decide only on their billing day, every 30 days. The number of renewals in a week therefore follows from
//! signups of earlier weeks, and no cause of the two weeks changes it. Enterprises pay on a billing day that depends on
//! the day on which they opened their first thread. In the two weeks simulated without the listed causes, the change
//! in an outcome of bills, for example cancellations, has three parts:
//!
//! - the change in the number of bills, at the mean outcome of a bill in the two weeks;
//! - the change in the open issues of the individuals who are due: individuals are counted by the age of their issue,
//!   at the mean outcome of each age;
//! - the change in the outcome of a bill at the same age of the issue, which stays in the residual.
//!
//! The parts are computed for each group, so a change in the mix of groups belongs to the number of bills.
//! Cash and costs also depend on the usage of all subscribers, so compute in these weeks is a contribution as well.

use super::attribution::CauseContribution;
use super::cause::{Cause, CauseDetail, InputDetail};
use super::continued::TwoWeeks;
use super::question::WeekQuantity;
use crate::counterfactual::due_bills::{DueBills, ISSUE_BANDS};
use novamind_record::figures::{SimulatedWeek, WeekFigure};
use novamind_world::events::Category;
use novamind_world::identifiers::Group;

/// Returns the contributions of the due bills to the change between two weeks that were simulated without the other
/// causes. The list is empty for figures that do not depend on bills.
pub(super) fn due_contributions(quantity: WeekQuantity, weeks: &TwoWeeks) -> Vec<CauseContribution> {
    let individuals: Vec<Group> = Group::all()
        .filter(|group| !group.is_enterprise() && quantity.group().is_none_or(|only| only == *group))
        .collect();
    let enterprises: Vec<Group> = Group::all().filter(|group| group.is_enterprise()).collect();
    match quantity.figure() {
        WeekFigure::Cancellations => cancellation_contributions(weeks, &individuals, [1.0, 1.0]),
        WeekFigure::Churn => {
            let before = |week: &SimulatedWeek| {
                individuals.iter().map(|group| week.groups[*group].subscribers_before).sum::<u32>()
            };
            cancellation_contributions(
                weeks,
                &individuals,
                weeks.weeks.each_ref().map(|week| before(week).into()),
            )
        }
        WeekFigure::Subscribers => subscriber_contributions(weeks, &individuals),
        WeekFigure::Payments | WeekFigure::Income | WeekFigure::CashChange => {
            let mut parts = payment_contributions(Cause::RenewalsDue, weeks, &individuals);
            parts.extend(payment_contributions(Cause::EnterpriseBillsDue, weeks, &enterprises));
            if quantity.figure() == WeekFigure::CashChange {
                parts.push(compute_contribution(weeks, -1.0));
            }
            parts
        }
        WeekFigure::Costs | WeekFigure::RunningCosts => vec![compute_contribution(weeks, 1.0)],
        _ => Vec::new(),
    }
}

/// Returns the contributions of the due bills to cancellations, or to churn if `denominators` contains the subscribers
/// of each week instead of 1.
fn cancellation_contributions(
    weeks: &TwoWeeks,
    groups: &[Group],
    denominators: [f64; 2],
) -> Vec<CauseContribution> {
    if denominators.contains(&0.0) {
        return Vec::new();
    }
    let read = |week: usize, due: &DueBills| {
        [due.bills, due.cancelled].map(|count| f64::from(count) / denominators[week])
    };
    let bills = sums(weeks, groups, |due| due.bills);
    contributions(weeks, groups, Cause::RenewalsDue, CauseDetail::RenewalsDue { bills }, read)
}

/// Returns the contribution of the explained week's renewals to the number of subscribers.
fn subscriber_contributions(weeks: &TwoWeeks, groups: &[Group]) -> Vec<CauseContribution> {
    let [_, bills] = sums(weeks, groups, |due| due.bills);
    let [_, cancelled] = sums(weeks, groups, |due| due.cancelled);
    let part = CauseContribution {
        cause: Cause::RenewalsDue,
        amount: 0.0 - f64::from(cancelled),
        details: vec![CauseDetail::RenewalsCancelled { bills, cancelled }],
    };
    if bills > 0 { vec![part] } else { Vec::new() }
}

/// Returns the contributions of the due bills to payments, in dollars.
fn payment_contributions(cause: Cause, weeks: &TwoWeeks, groups: &[Group]) -> Vec<CauseContribution> {
    let bills = sums(weeks, groups, |due| due.bills);
    let dollars = weeks
        .due_bills
        .each_ref()
        .map(|due| groups.iter().flat_map(|group| &due[*group]).map(|due| due.dollars).sum());
    contributions(weeks, groups, cause, CauseDetail::BillsDue { bills, dollars }, |_, due| {
        [due.dollars, due.paid]
    })
}

/// Returns the contribution of compute: the change in its cost, times `sign`.
fn compute_contribution(weeks: &TwoWeeks, sign: f64) -> CauseContribution {
    let [before, now] = weeks.weeks.each_ref().map(|week| week.category_costs(Category::Compute));
    let [old, new] = weeks.weeks.each_ref().map(|week| week.figures.usage as f64);
    let usage = InputDetail { name: "units without the other causes", old, new, is_share: false };
    CauseContribution {
        cause: Cause::Usage,
        amount: sign * (now - before),
        details: vec![CauseDetail::Input(usage)],
    }
}

/// Returns the contributions of the number of bills and of the open issues of the individuals who are due. `read`
/// returns the volume and the outcome of the bills in a week.
fn contributions(
    weeks: &TwoWeeks,
    groups: &[Group],
    cause: Cause,
    detail: CauseDetail,
    read: impl Fn(usize, &DueBills) -> [f64; 2],
) -> Vec<CauseContribution> {
    let bills = sums(weeks, groups, |due| due.bills);
    if bills == [0, 0] {
        return Vec::new();
    }
    let (mut number, mut number_and_issues) = (0.0, 0.0);
    for group in groups {
        let due = [0, 1].map(|week| weeks.due_bills[week][*group].each_ref().map(|due| read(week, due)));
        let total = |week: &[[f64; 2]; ISSUE_BANDS], at: usize| week.iter().map(|band| band[at]).sum::<f64>();
        number += volume_effect(
            due.each_ref().map(|week| total(week, 0)),
            due.each_ref().map(|week| total(week, 1)),
        );
        for band in 0..ISSUE_BANDS {
            number_and_issues += volume_effect(due.map(|week| week[band][0]), due.map(|week| week[band][1]));
        }
    }
    let mut parts = vec![CauseContribution { cause, amount: number, details: vec![detail] }];
    if cause == Cause::RenewalsDue && !bills.contains(&0) {
        let without_issue = weeks
            .due_bills
            .each_ref()
            .map(|due| groups.iter().map(|group| due[*group][0].bills).sum::<u32>());
        let shares = [0, 1].map(|week| 1.0 - f64::from(without_issue[week]) / f64::from(bills[week]));
        let details = vec![CauseDetail::IssuesAtRenewal { shares }];
        let amount = number_and_issues - number;
        parts.push(CauseContribution { cause: Cause::IssuesAtRenewal, amount, details });
    }
    parts
}

fn sums(weeks: &TwoWeeks, groups: &[Group], read: fn(&DueBills) -> u32) -> [u32; 2] {
    weeks.due_bills.each_ref().map(|due| groups.iter().flat_map(|group| &due[*group]).map(read).sum())
}

/// Returns the part of the change in `outcomes` that the change in `volumes` explains at the mean outcome per volume of
/// the two weeks. If a week has no volume, the outcome per volume of the other week is used.
fn volume_effect(volumes: [f64; 2], outcomes: [f64; 2]) -> f64 {
    let rates: Vec<f64> = volumes
        .into_iter()
        .zip(outcomes)
        .filter(|(volume, _)| *volume > 0.0)
        .map(|(volume, outcome)| outcome / volume)
        .collect();
    let mean = rates.iter().sum::<f64>() / rates.len().max(1) as f64;
    (volumes[1] - volumes[0]) * mean
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn volume_effect_uses_the_mean_outcome_of_both_weeks() {
        assert_eq!(volume_effect([128.0, 256.0], [16.0, 32.0]), 16.0, "the outcome per bill is constant");
        assert_eq!(volume_effect([128.0, 256.0], [16.0, 64.0]), 24.0);
        assert_eq!(
            volume_effect([0.0, 200.0], [0.0, 40.0]),
            40.0,
            "the first bills explain the whole change"
        );
        assert_eq!(volume_effect([256.0, 0.0], [64.0, 0.0]), -64.0);
        assert_eq!(volume_effect([50.0, 50.0], [5.0, 9.0]), 0.0, "the same number of bills explains nothing");
        assert_eq!(volume_effect([0.0, 0.0], [0.0, 0.0]), 0.0);
    }
}
