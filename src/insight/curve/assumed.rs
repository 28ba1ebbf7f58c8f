//! A group as studies tell of it. They name means within an error and say nothing of how widely a group spreads or how far its
//! curve rises; that is assumed alike for every group, and no number of the run goes into it.

use novamind_session::Estimates;
use novamind_world::params::Params;

/// Spread of budgets, as a share of their mean.
const BUDGET_SPREAD: f64 = 0.4;
/// Spread of the floor of quality.
const FLOOR_SPREAD: f64 = 0.07;
/// From the floor to the quality that is required at the budget.
const RISE: f64 = 0.5;
/// Spread of it.
const RISE_SPREAD: f64 = 0.08;
/// Spread of usage, as a share of its mean.
const USAGE_SPREAD: f64 = 0.4;
/// An error of 100 % or more leaves the truth without an upper end: it is drawn at so many times the estimate.
const ENDLESS: f64 = 10.0;

/// Which of the groups that fit the estimates is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Reading {
    /// The estimates are right.
    Likely,
    /// Budgets as small, floors and use as large as the error allows.
    Strict,
    /// Budgets as large, floors and use as small as the error allows.
    Generous,
}

/// Parameters of a market in which the group is as its estimates say: the shipped ones for everything that is no estimate, and
/// the forms of the run's scenario, which players are told.
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
