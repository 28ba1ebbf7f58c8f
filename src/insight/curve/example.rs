//! An example curve for explanations, of a fictitious individual.

use novamind_world::customers::curve::{Curve, required_quality};
use novamind_world::params::Params;

/// The customer of the worked example in docs/mechanics/customers/participation.md.
const EXAMPLE: Curve =
    Curve { steepness_left: 1.2, steepness_right: 2.8, c_max: 50.0, q_min: 0.1, q_max: 0.55 };

/// Returns pairs of price and required quality for a customer with a budget of $50, at prices from 0 to the budget.
pub fn example_curve() -> Vec<(f64, f64)> {
    let params = Params::bundled();
    (0..=50).map(f64::from).map(|price| (price, required_quality(price, &EXAMPLE, &params))).collect()
}
