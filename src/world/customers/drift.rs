//! Preference drift: changes in the expectations and budgets of groups and individual subscribers
//! (docs/mechanics/market/drift.md).

use crate::canonical::canonical;
use crate::customers::Customers;
use crate::customers::columns::Block;
use crate::fault::Fault;
use crate::identifiers::{ByGroup, Group};
use crate::params::{Drift, IndividualDrift, Params};

/// Accumulated changes in expectations and budgets since day 0.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DriftTotals {
    /// Quality added to the expectations of all groups.
    pub global_quality: f64,
    /// Quality added to the expectations of each group.
    pub quality: ByGroup<f64>,
    /// Dollars per month added to the budgets of each group.
    pub c_max: ByGroup<f64>,
}

canonical! {
    DriftTotals { global_quality, quality, c_max }
    Expectation { quality, c_max }
}

/// The market drift that is added to a customer's curve when the curve is read.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Expectation {
    /// Quality added to both quality bounds of the curve.
    pub quality: f64,
    /// Dollars per month added to the budget.
    pub c_max: f64,
}

impl DriftTotals {
    /// Returns the market drift of a group's curves.
    pub fn expectation(&self, group: Group) -> Expectation {
        Expectation { quality: self.global_quality + self.quality[group], c_max: self.c_max[group] }
    }
}

/// Returns the growth at a daily rate over the 30 days of one drift application: (1 + r)^30 - 1.
pub fn compound_rate(rate: f64, drift: &Drift) -> f64 {
    libm::pow(1.0 + rate, f64::from(drift.days_per_application)) - 1.0
}

/// Returns whether drift is applied on a day: every 30 days after the grace period.
pub fn is_drift_day(day: u32, drift: &Drift) -> bool {
    day.is_multiple_of(drift.interval_days) && day > drift.drift_grace_period_days
}

/// Returns the next day on which drift is applied.
pub fn next_drift_day(after: u32, drift: &Drift) -> u32 {
    let next = |day: u32| (day / drift.interval_days + 1) * drift.interval_days;
    next(after.max(drift.drift_grace_period_days))
}

/// Returns the quality that one drift application adds to the expectations of all groups.
pub fn global_drift_step(drift: &Drift) -> f64 {
    f64::from(drift.days_per_application) * drift.global_q_bias_drift
}

/// Returns the amounts that one drift application adds to a group's expectations and budgets.
pub fn group_drift_step(group: Group, params: &Params) -> Expectation {
    let (group_drift, days) =
        (&params.group(group).group_drift_per_day, f64::from(params.drift.days_per_application));
    Expectation { quality: days * group_drift.q_bias_drift, c_max: days * group_drift.c_max_drift }
}

/// Applies drift to the group totals and to every active subscriber's curve and seats, if today is a drift day.
/// `seat_multiplier` is yesterday's macroeconomic multiplier of seats. Returns whether drift was applied.
pub fn apply_drift(
    day: u32,
    totals: &mut DriftTotals,
    customers: &mut Customers,
    seat_multiplier: &ByGroup<f64>,
    params: &Params,
) -> bool {
    let drift = &params.drift;
    if !is_drift_day(day, drift) {
        return false;
    }
    let times = if params.has_fault(Fault::DriftTwice) { 2 } else { 1 };
    (0..times).for_each(|_| update_totals(totals, params));
    customers.sweep(|group, _, block| {
        drift_block(block, &params.group(group).individual_drift_per_day, seat_multiplier[group], drift);
    });
    true
}

fn update_totals(totals: &mut DriftTotals, params: &Params) {
    totals.global_quality += global_drift_step(&params.drift);
    for group in Group::all() {
        let step = group_drift_step(group, params);
        totals.quality[group] += step.quality;
        totals.c_max[group] += step.c_max;
    }
}

fn drift_block(block: &mut Block, rates: &IndividualDrift, seat_multiplier: f64, drift: &Drift) {
    if let Some(rate) = rates.c_max_drift {
        let factor = 1.0 + compound_rate(rate, drift);
        for c_max in &mut block.c_max {
            *c_max = (*c_max * factor).clamp(drift.individual_c_max_min, drift.individual_c_max_max);
        }
    }
    if let Some(rate) = rates.q_bias_drift {
        let factor = 1.0 + compound_rate(rate, drift);
        block.q_min.iter_mut().for_each(|quality| *quality *= factor);
        block.q_max.iter_mut().for_each(|quality| *quality *= factor);
    }
    if let Some(rate) = rates.steepness_left_drift {
        let factor = 1.0 + compound_rate(rate, drift);
        let (least, most) = (drift.individual_steepness_left_min, drift.individual_steepness_left_max);
        block
            .steepness_left
            .iter_mut()
            .for_each(|steepness| *steepness = (*steepness * factor).clamp(least, most));
    }
    if let Some(rate) = rates.seat_count_drift {
        let factor = 1.0 + compound_rate(rate, drift) * seat_multiplier;
        block
            .seats
            .iter_mut()
            .for_each(|seats| *seats = (*seats * factor).max(drift.individual_seat_count_min));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::customers::columns::Subscriber;
    use crate::customers::curve::Curve;
    use crate::market::economy::Dimension;
    use crate::market::economy::tests::economy_at;
    use crate::test_kit::subscriber;

    fn assert_near(actual: f64, expected: f64) {
        assert!((actual - expected).abs() < 6e-9, "got {actual}, expected {expected}");
    }

    fn drifted(id: &str, row: Subscriber, day: u32, pmi: f64) -> (Subscriber, DriftTotals) {
        let params = Params::bundled();
        let group = Group::parse(id).expect("a group");
        let economy = economy_at(pmi);
        let seats = ByGroup::from_fn(|group| economy.multiplier(group, Dimension::SeatCount, &params));
        let (mut totals, mut customers) = (DriftTotals::default(), Customers::default());
        customers.groups[group].activate(row);
        apply_drift(day, &mut totals, &mut customers, &seats, &params);
        (customers.groups[group].blocks[0].row(0), totals)
    }

    fn row(c_max: f64, q_min: f64, q_max: f64, steepness_left: f64, seats: f64) -> Subscriber {
        Subscriber { c_max, q_min, q_max, steepness_left, seats, ..subscriber(1) }
    }

    #[test]
    fn subscribers_drift_by_group_rates_within_bounds() {
        for (id, before, [c_max, q_min, q_max, steepness, seats]) in [
            ("S1", row(50.0, 0.10, 0.50, 1.0, 1.0), [47.0853976979, 0.1061772923, 0.5308864615, 1.0, 1.0]),
            ("S3", row(120.0, 0.3, 0.8, 5.6, 1.0), [120.5411761459, 0.3185318769, 0.8494183385, 5.0, 1.0]),
            (
                "E1",
                row(55.0, 0.5, 0.9, 1.2, 200.0),
                [52.5780851839, 0.5152195438, 0.9273951788, 1.2, 198.3959882677],
            ),
            (
                "E2",
                row(90.0, 0.6, 1.0, 2.0, 100.0),
                [90.8135333858, 0.6090655555, 1.0151092592, 2.0241397211, 101.1780183890],
            ),
            ("D_S09", row(95.0, 0.2, 0.7, 0.2, 1.0), [95.2854136360, 0.2048560980, 0.7169963430, 0.2, 1.0]),
        ] {
            let (after, _) = drifted(id, before, 90, 45.0);
            assert_near(after.c_max, c_max);
            assert_near(after.q_min, q_min);
            assert_near(after.q_max, q_max);
            assert_near(after.steepness_left, steepness);
            assert_near(after.seats, seats);
        }
        assert_near(drifted("S1", row(10.2, 0.1, 0.5, 1.0, 1.0), 90, 45.0).0.c_max, 10.0);
        let (_, totals) = drifted("S1", subscriber(1), 90, 45.0);
        for (id, quality, c_max) in [
            ("S1", 0.0, 0.03),
            ("S3", 0.01875, 0.0),
            ("E1", 0.0, -0.015),
            ("D_S08", 0.015, 0.0),
            ("D_E08", 0.0075, 0.0),
        ] {
            let group = Group::parse(id).expect("a group");
            assert_near(totals.quality[group], quality);
            assert_near(totals.c_max[group], c_max);
        }
        assert_eq!(totals.global_quality, 0.0);
    }

    #[test]
    fn drift_starts_after_the_grace_period() {
        for day in [30, 60, 89, 91] {
            let (after, totals) = drifted("S1", subscriber(1), day, 45.0);
            assert_eq!((after, totals), (subscriber(1), DriftTotals::default()), "day {day}");
        }
    }

    #[test]
    fn compound_rate_matches_one_application() {
        assert_near(compound_rate(0.002, &Params::bundled().drift), 0.0617729231);
        let (x, _) = drifted("S1", row(50.0, 0.10, 0.55, 1.2, 1.0), 90, 45.0);
        assert_near(x.c_max, 47.0853976979);
        assert_near(x.q_max, 0.583975108);
        let (after, _) = drifted("D_S06", row(60.0, 0.2, 0.6, 2.0, 1.0), 90, 45.0);
        assert_near(after.c_max, 56.84316043);
        assert_near(after.q_min, 0.2188053750);
        assert_near(after.steepness_left, 2.036314961);
        let moved = Curve { c_max: 10.0, ..subscriber_curve() }.with_drift(0.08, 2.0, 15.0);
        assert_eq!((moved.c_max, moved.q_min), (15.0, 0.18));
        let moved = subscriber_curve().with_drift(0.08, 2.0, 15.0);
        assert_eq!((moved.c_max, moved.q_max), (52.0, 0.63));
    }

    fn subscriber_curve() -> Curve {
        Curve { steepness_left: 1.2, steepness_right: 2.8, c_max: 50.0, q_min: 0.1, q_max: 0.55 }
    }

    #[test]
    fn seats_drift_with_the_economy() {
        for (id, first) in [("E1", 99.1039040602), ("E2", 101.2069860543), ("E3", 100.9039259842)] {
            assert_near(drifted(id, row(60.0, 0.5, 0.9, 1.0, 100.0), 90, 50.0).0.seats, first);
        }
        let (e1, _) = drifted("E1", row(60.0, 0.5, 0.9, 1.0, 99.1039040602), 120, 42.0);
        assert!((e1.seats - 98.3650330978).abs() < 1e-8, "{}", e1.seats);
    }
}
