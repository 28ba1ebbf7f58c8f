//! Running costs: compute, capacity, operations.

use super::assumptions::BoundAssumptions;
use novamind_world::params::Params;

/// Returns the cost of compute over the account's days, dollars.
pub fn compute_cost(daily_usage: f64, premises: &BoundAssumptions, params: &Params) -> f64 {
    params.model_tier(premises.model_tier).unit_cost * daily_usage * f64::from(premises.days)
}

/// Returns the cost of capacity over the account's days, dollars.
pub fn capacity_cost(premises: &BoundAssumptions, params: &Params) -> f64 {
    f64::from(params.capacity_tier(premises.capacity_tier).cost_per_day) * f64::from(premises.days)
}

/// Returns the cost of operations over the account's days, dollars. `customers` includes seats.
pub fn operations_cost(customers: f64, premises: &BoundAssumptions) -> f64 {
    (premises.operations + premises.operations_each * customers) * f64::from(premises.days)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_usage_has_the_published_cost() {
        let (premises, params) = (BoundAssumptions::from_paper(3.0), Params::bundled());
        assert!((compute_cost(521e6, &premises, &params) / 1e6 - 1553.622).abs() < 1e-9);
        assert!((capacity_cost(&premises, &params) / 1e6 - 37.275).abs() < 1e-9);
        assert!((operations_cost(4_591_250.0, &premises) / 1e6 - 2.530_351_25).abs() < 1e-9);
    }
}
