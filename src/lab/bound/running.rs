//! Running costs: compute, capacity, operations.

use super::premises::Premises;
use novamind_world::params::Params;

/// Returns the cost of compute over the account's days, dollars.
pub fn compute(daily_usage: f64, premises: &Premises, params: &Params) -> f64 {
    params.model(premises.model_tier).unit_cost * daily_usage * f64::from(premises.days)
}

/// Returns the cost of capacity, dollars.
pub fn capacity(premises: &Premises, params: &Params) -> f64 {
    f64::from(params.capacity(premises.capacity_tier).cost_per_day) * f64::from(premises.days)
}

/// Returns the cost of operations for a number of customers and seats, dollars.
pub fn operations(customers: f64, premises: &Premises) -> f64 {
    (premises.operations + premises.operations_each * customers) * f64::from(premises.days)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_usage_costs_what_was_published() {
        let (premises, params) = (Premises::of_the_paper(3.0), Params::shipped());
        assert!((compute(521e6, &premises, &params) / 1e6 - 1553.622).abs() < 1e-9);
        assert!((capacity(&premises, &params) / 1e6 - 37.275).abs() < 1e-9);
        assert!((operations(4_591_250.0, &premises) / 1e6 - 2.530_351_25).abs() < 1e-9);
    }
}
