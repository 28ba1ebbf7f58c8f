//! A group according to its market studies. They give means within an error, but neither the spread of the group nor the rise of its
//! curve. These are assumed to be equal for every group and do not depend on the run.

use novamind_session::Estimates;
use novamind_world::params::Params;

/// Standard deviation of budgets, as a share of the mean.
const BUDGET_SPREAD: f64 = 0.4;
/// Standard deviation of the quality floor.
const FLOOR_SPREAD: f64 = 0.07;
/// Difference between the quality floor and the required quality at the budget.
const RISE: f64 = 0.5;
/// Standard deviation of that difference.
const RISE_SPREAD: f64 = 0.08;
/// Standard deviation of usage, as a share of the mean.
const USAGE_SPREAD: f64 = 0.4;
/// Multiple of the estimate that replaces the upper limit if an error of 100 % or more leaves none.
const ENDLESS: f64 = 10.0;

/// A group that is consistent with the estimates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Reading {
    /// The estimates are exact.
    Likely,
    /// Budgets are as small, and floors and usage as large, as the error allows.
    Strict,
    /// Budgets are as large, and floors and usage as small, as the error allows.
    Generous,
}

/// Returns parameters of a market in which the group matches its estimates. Everything else has bundled values, except the curve forms
/// of the run's scenario, which players can see.
pub(super) fn market_of(own: &Estimates, reading: Reading, run: &Params) -> Params {
    let end = |value: f64, is_most: bool| {
        let (least, most) = own.range(value);
        match is_most {
            true if most.is_finite() => most,
            true => ENDLESS * value,
            false => least,
        }
    };
    let (budget, floor, usage) = match reading {
        Reading::Likely => (own.budget, own.floor, own.usage),
        Reading::Strict => (end(own.budget, false), end(own.floor, true), end(own.usage, true)),
        Reading::Generous => (end(own.budget, true), end(own.floor, false), end(own.usage, false)),
    };
    let mut params = Params::shipped();
    params.fidelity = run.fidelity;
    let widened = params.customer_generation.c_max_std_multiplier;
    let group = &mut params.group[own.group.index()];
    group.c_max_mean = budget;
    group.c_max_std = BUDGET_SPREAD * budget / widened;
    group.q_min_mean = floor;
    group.q_min_std = FLOOR_SPREAD;
    group.q_range_mean = RISE;
    group.q_range_std = RISE_SPREAD;
    group.usage_demand_mean = usage;
    group.usage_demand_std = USAGE_SPREAD * usage;
    if group.seat_count_min.is_some() {
        let seats = |count: f64| count.max(1.0) as u32;
        group.seat_count_min = Some(seats(own.seats.0));
        group.seat_count_max = Some(seats(own.seats.1).max(seats(own.seats.0)));
    }
    params
}
