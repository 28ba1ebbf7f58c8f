//! A group as described by its market studies. The studies estimate means, but neither the spread of the group nor the
//! slope of its curve. The spread and the slope are assumed to be the same for every group and run.

use novamind_session::Estimates;
use novamind_world::params::Params;

/// Standard deviation of budgets, as a share of the mean.
const BUDGET_STD_SHARE: f64 = 0.4;
/// Standard deviation of the quality floor.
const QUALITY_FLOOR_STD: f64 = 0.07;
/// Difference between the required quality at the budget and the quality floor.
const QUALITY_RISE_TO_BUDGET: f64 = 0.5;
/// Standard deviation of [`QUALITY_RISE_TO_BUDGET`].
const QUALITY_RISE_STD: f64 = 0.08;
/// Standard deviation of usage, as a share of the mean.
const USAGE_STD_SHARE: f64 = 0.4;
/// Multiple of an estimate that serves as its upper limit if the error of the estimate is 100 % or more.
const UNBOUNDED_FACTOR: f64 = 10.0;

/// A choice of true means within the errors of the estimates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum EstimateVariant {
    /// True means that equal the estimates.
    Likely,
    /// The smallest budgets, and the largest quality floors and usage, within the error.
    Strict,
    /// The largest budgets, and the smallest quality floors and usage, within the error.
    Generous,
}

/// Returns parameters of a market in which the group matches its estimates. All other parameters have bundled values,
/// except the curve forms of the run's scenario, which players can see.
pub(super) fn assumed_params(estimates: &Estimates, reading: EstimateVariant, run: &Params) -> Params {
    let end = |value: f64, is_most: bool| {
        let (least, most) = estimates.true_range(value);
        match is_most {
            true if most.is_finite() => most,
            true => UNBOUNDED_FACTOR * value,
            false => least,
        }
    };
    let (budget, floor, usage) = match reading {
        EstimateVariant::Likely => (estimates.budget, estimates.required_quality, estimates.usage),
        EstimateVariant::Strict => {
            (end(estimates.budget, false), end(estimates.required_quality, true), end(estimates.usage, true))
        }
        EstimateVariant::Generous => {
            (end(estimates.budget, true), end(estimates.required_quality, false), end(estimates.usage, false))
        }
    };
    let mut params = Params::bundled();
    params.fidelity = run.fidelity;
    let widened = params.customer_generation.c_max_std_multiplier;
    let group = &mut params.group[estimates.group.index()];
    group.c_max_mean = budget;
    group.c_max_std = BUDGET_STD_SHARE * budget / widened;
    group.q_min_mean = floor;
    group.q_min_std = QUALITY_FLOOR_STD;
    group.q_range_mean = QUALITY_RISE_TO_BUDGET;
    group.q_range_std = QUALITY_RISE_STD;
    group.usage_demand_mean = usage;
    group.usage_demand_std = USAGE_STD_SHARE * usage;
    if group.seat_count_min.is_some() {
        let seats = |count: f64| count.max(1.0) as u32;
        group.seat_count_min = Some(seats(estimates.seats.0));
        group.seat_count_max = Some(seats(estimates.seats.1).max(seats(estimates.seats.0)));
    }
    params
}
