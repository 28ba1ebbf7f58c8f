//! Cumulative distribution function of the normal distribution.

/// Returns the probability that a standard normal value is below `z`, 0..=1.
pub fn normal_cdf(z: f64) -> f64 {
    0.5 * libm::erfc(-z / std::f64::consts::SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_cdf_has_known_values() {
        for (z, share) in [(0.0, 0.5), (1.959_963_984_540_054, 0.975), (-1.0, 0.158_655_253_931_457)] {
            assert!((normal_cdf(z) - share).abs() < 1e-12);
        }
        assert_eq!((normal_cdf(f64::NEG_INFINITY), normal_cdf(f64::INFINITY)), (0.0, 1.0));
    }
}
