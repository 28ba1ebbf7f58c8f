//! The curve of one customer, as an example in explanations: a made-up individual, and no customer of any run.

use novamind_world::customers::curve::{Curve, required_quality};
use novamind_world::params::Params;

/// The customer of the check values in docs/mechanics/customers/participation.md.
const EXAMPLE: Curve =
    Curve { steepness_left: 1.2, steepness_right: 2.8, c_max: 50.0, q_min: 0.1, q_max: 0.55 };

/// Quality that a customer with a budget of 50 dollars requires at prices from 0 to it: pairs of price and quality.
pub fn example_curve() -> Vec<(f64, f64)> {
    let params = Params::shipped();
    (0..=50).map(f64::from).map(|price| (price, required_quality(price, &EXAMPLE, &params))).collect()
}
