//! The participation curve: the quality that a customer requires at each price
//! (docs/mechanics/customers/participation.md).

use crate::params::{Params, Participation, RequiredQuality};

/// The parameters of a customer's participation curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curve {
    /// Steepness of the lower half, 0.2..=6.
    pub steepness_left: f64,
    /// Steepness of the upper half, 0.5..=7.
    pub steepness_right: f64,
    /// Budget, dollars per month; for enterprises, per seat.
    pub c_max: f64,
    /// Quality required at a price near 0.
    pub q_min: f64,
    /// Quality required at prices above the budget.
    pub q_max: f64,
}

impl Curve {
    /// Returns the curve after market drift: adds `dq` to both quality bounds and `dc` to the budget, which stays at
    /// least `c_max_floor`.
    pub fn with_drift(self, dq: f64, dc: f64, c_max_floor: f64) -> Curve {
        Curve {
            q_min: self.q_min + dq,
            q_max: self.q_max + dq,
            c_max: (self.c_max + dc).max(c_max_floor),
            ..self
        }
    }

    /// Returns the curve with a different budget.
    pub fn with_budget(self, c_max: f64) -> Curve {
        Curve { c_max, ..self }
    }
}

/// Returns the logistic function of `z`, which is first clamped to the input range of `participation`.
#[inline]
pub fn sigmoid(z: f64, participation: &Participation) -> f64 {
    1.0 / (1.0 + libm::exp(-z.clamp(participation.sigmoid_input_min, participation.sigmoid_input_max)))
}

/// Returns the required quality at a price of at least 0, in dollars per month.
///
/// Above the budget, the required quality is q_max. Below the budget, the formula of the released simulator has two
/// logistic halves with a jump at half the budget. The formula of the paper (`required_quality = "blended"`) blends
/// both halves.
#[inline]
pub fn required_quality(price: f64, curve: &Curve, params: &Params) -> f64 {
    let form = &params.participation;
    if price > curve.c_max {
        return curve.q_max;
    }
    let x = price / curve.c_max;
    let range = curve.q_max - curve.q_min;
    let left = || sigmoid(form.curve_gain * curve.steepness_left * (x - form.curve_left_center), form);
    let right = || sigmoid(form.curve_gain * curve.steepness_right * (x - form.curve_right_center), form);
    match params.fidelity.required_quality {
        RequiredQuality::Piecewise => {
            let half = range / form.curve_half_divisor;
            if x < form.curve_split {
                curve.q_min + half * left()
            } else {
                curve.q_min + half + half * right()
            }
        }
        RequiredQuality::Blended => {
            let blend = form.blend_weight * left() + (1.0 - form.blend_weight) * right();
            curve.q_min + range * blend.clamp(0.0, 1.0)
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Participation curve of the reference customer X, a typical individual.
    pub(crate) const X: Curve =
        Curve { steepness_left: 1.2, steepness_right: 2.8, c_max: 50.0, q_min: 0.1, q_max: 0.55 };

    fn assert_curve(curve: &Curve, expected: &[(f64, f64)], tolerance: f64) {
        let params = Params::bundled();
        for &(price, quality) in expected {
            let required = required_quality(price, curve, &params);
            assert!((required - quality).abs() < tolerance, "at {price}: got {required}, expected {quality}");
        }
    }

    #[test]
    fn required_quality_rises_with_the_price_and_jumps_at_half_the_budget() {
        let expected = [
            (0.0, 0.110670821),
            (10.0, 0.179727331),
            (12.5, 0.2125),
            (20.0, 0.293083510),
            (24.999999, 0.314329176),
            (25.0, 0.325204987),
            (30.0, 0.328324157),
            (37.5, 0.4375),
            (45.0, 0.546675843),
            (50.0, 0.549795013),
            (50.01, 0.55),
        ];
        assert_curve(&X, &expected, 1e-9);
    }

    #[test]
    fn required_quality_matches_ten_decimals() {
        let expected =
            [(0.0, 0.1106708215), (24.999, 0.3143267387), (25.0, 0.3252049865), (50.0, 0.5497950135)];
        assert_curve(&X, &expected, 1e-10);
    }

    #[test]
    fn enterprise_requires_maximum_quality_above_its_budget() {
        let k = Curve { steepness_left: 1.0, steepness_right: 2.0, c_max: 60.0, q_min: 0.5, q_max: 0.95 };
        let expected = [
            (0.0, 0.5170680905),
            (15.0, 0.6125),
            (29.999999, 0.7079319069),
            (30.0, 0.7265058915),
            (45.0, 0.8375),
            (60.0, 0.9484941085),
            (60.01, 0.95),
            (1e6, 0.95),
            (-10.0, 0.5034351096),
        ];
        assert_curve(&k, &expected, 1e-9);
    }

    #[test]
    fn blended_form_is_continuous_between_the_bounds() {
        let mut params = Params::bundled();
        params.fidelity.required_quality = RequiredQuality::Blended;
        let at = |price| required_quality(price, &X, &params);
        assert!((at(25.0 + 1e-9) - at(25.0 - 1e-9)).abs() < 1e-6);
        assert!(at(0.0) > X.q_min && at(50.0) < X.q_max && at(50.01) == X.q_max);
        assert!((0..100).all(|step| at(f64::from(step) * 0.5) <= at(f64::from(step + 1) * 0.5)));
    }
}
