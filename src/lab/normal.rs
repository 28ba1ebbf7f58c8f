//! The normal distribution function.

/// Returns the probability that a standard normal value is below `z`, 0..=1.
pub fn normal_share(z: f64) -> f64 {
    0.5 * libm::erfc(-z / std::f64::consts::SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_has_its_known_values() {
        for (z, share) in [(0.0, 0.5), (1.959_963_984_540_054, 0.975), (-1.0, 0.158_655_253_931_457)] {
            assert!((normal_share(z) - share).abs() < 1e-12);
        }
        assert_eq!((normal_share(f64::NEG_INFINITY), normal_share(f64::INFINITY)), (0.0, 1.0));
    }
}
