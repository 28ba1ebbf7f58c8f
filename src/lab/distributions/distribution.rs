//! Distributions of random draws, with their notation and exact moments.

use crate::normal_distribution::normal_cdf;

/// A distribution with its parameters. Values beyond a bound are clamped to the bound.
#[derive(Debug, Clone, PartialEq)]
pub enum DrawDistribution {
    /// Normal distribution, clamped to two bounds.
    Normal {
        /// Mean before clamping.
        mean: f64,
        /// Standard deviation before clamping.
        std: f64,
        /// Lower bound; may be minus infinity.
        min: f64,
        /// Upper bound; may be infinity.
        max: f64,
    },
    /// Normal distribution, rounded to whole numbers.
    RoundedNormal {
        /// Mean before rounding.
        mean: f64,
        /// Standard deviation before rounding.
        std: f64,
        /// How the variate is rounded to a whole number.
        rounding: RoundingMode,
        /// Lower bound to which smaller values are clamped.
        min: f64,
    },
    /// Exponential distribution plus an offset, clamped to two bounds.
    Exponential {
        /// Mean of the exponential variate.
        mean: f64,
        /// Offset that is added to the exponential variate.
        offset: f64,
        /// Lower bound to which smaller values are clamped.
        min: f64,
        /// Upper bound; may be infinity.
        max: f64,
    },
    /// Log-normal distribution, clamped to two bounds, then multiplied by a factor.
    LogNormal {
        /// Mean of the logarithm of the variate.
        mu: f64,
        /// Standard deviation of the logarithm of the variate.
        sigma: f64,
        /// Lower bound before multiplication.
        min: f64,
        /// Upper bound before multiplication; may be infinity.
        max: f64,
        /// Factor that multiplies the clamped value.
        factor: f64,
    },
    /// Uniform distribution, including the lower and excluding the upper bound.
    Uniform {
        /// Lower bound, inclusive.
        low: f64,
        /// Upper bound, exclusive.
        high: f64,
    },
    /// Uniform distribution of whole numbers, including the bounds.
    UniformInteger {
        /// Lowest value.
        low: u32,
        /// Highest value.
        high: u32,
    },
    /// Bernoulli distribution: 1 with the given probability, otherwise 0.
    Bernoulli(f64),
    /// Poisson distribution with the given mean.
    Poisson(f64),
    /// Discrete distribution: values with weights.
    Discrete(Vec<(f64, f64)>),
}

/// A mode of rounding to whole numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RoundingMode {
    /// Round to the nearest whole number.
    Nearest,
    /// Round towards zero.
    Down,
}

/// The mean and standard deviation of a distribution or sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments {
    /// Mean of the values.
    pub mean: f64,
    /// Standard deviation of the values.
    pub std: f64,
}

impl Moments {
    /// Computes the moments from the first two moments about zero.
    fn from_raw_moments(first: f64, second: f64) -> Moments {
        Moments { mean: first, std: (second - first * first).max(0.0).sqrt() }
    }

    /// Computes the moments of values with weights.
    fn from_weighted(values: impl Iterator<Item = (f64, f64)>) -> Moments {
        let (mut total, mut first, mut second) = (0.0, 0.0, 0.0);
        for (value, weight) in values {
            total += weight;
            first += weight * value;
            second += weight * value * value;
        }
        Moments::from_raw_moments(first / total, second / total)
    }
}

impl DrawDistribution {
    /// Returns the name of the distribution.
    pub fn name(&self) -> &'static str {
        match self {
            DrawDistribution::Normal { .. } => "normal",
            DrawDistribution::RoundedNormal { .. } => "whole normal",
            DrawDistribution::Exponential { .. } => "exponential",
            DrawDistribution::LogNormal { .. } => "log-normal",
            DrawDistribution::Uniform { .. } => "uniform",
            DrawDistribution::UniformInteger { .. } => "uniform, whole",
            DrawDistribution::Bernoulli(_) => "chance",
            DrawDistribution::Poisson(_) => "Poisson",
            DrawDistribution::Discrete(_) => "weighted",
        }
    }

    /// Describes the parameters of the distribution.
    pub fn describe_parameters(&self) -> String {
        let number = |value: &f64| ((value * 1e6).round() / 1e6).to_string();
        let ends = |least: &f64, most: &f64| match (least.is_finite(), most.is_finite()) {
            (true, true) => format!(", within {} to {}", number(least), number(most)),
            (true, false) => format!(", at least {}", number(least)),
            (false, true) => format!(", at most {}", number(most)),
            (false, false) => String::new(),
        };
        match self {
            DrawDistribution::Normal { mean, std, min: least, max: most } => {
                format!("mean {}, sd {}{}", number(mean), number(std), ends(least, most))
            }
            DrawDistribution::RoundedNormal { mean, std, rounding, min: least } => {
                let how = if *rounding == RoundingMode::Nearest { "rounded" } else { "cut" };
                format!("mean {}, sd {}, {how}{}", number(mean), number(std), ends(least, &f64::INFINITY))
            }
            DrawDistribution::Exponential { mean, offset, min: least, max: most } => {
                let added = if *offset == 0.0 { String::new() } else { format!(" + {}", number(offset)) };
                format!("mean {}{added}{}", number(mean), ends(least, most))
            }
            DrawDistribution::LogNormal { mu, sigma, min: least, max: most, factor } => {
                let times =
                    if *factor == 1.0 { String::new() } else { format!(", times {}", number(factor)) };
                format!("mu {}, sigma {}{}{times}", number(mu), number(sigma), ends(least, most))
            }
            DrawDistribution::Uniform { low, high } => format!("{} to {}", number(low), number(high)),
            DrawDistribution::UniformInteger { low, high } => format!("{low} to {high}"),
            DrawDistribution::Bernoulli(p) => format!("p {}", number(p)),
            DrawDistribution::Poisson(mean) => format!("mean {}", number(mean)),
            DrawDistribution::Discrete(values) => {
                let total: f64 = values.iter().map(|(_, weight)| weight).sum();
                let one = |(value, weight): &(f64, f64)| {
                    format!("{} {}", number(value), novamind_base::formatting::percent(weight / total, 1))
                };
                values.iter().map(one).collect::<Vec<_>>().join(", ")
            }
        }
    }

    /// Returns the exact moments of the distribution.
    pub fn moments(&self) -> Moments {
        match *self {
            DrawDistribution::Normal { mean, std, min: least, max: most } => {
                clamped_normal_moments(mean, std, least, most)
            }
            DrawDistribution::RoundedNormal { mean, std, rounding, min: least } => {
                rounded_normal_moments(mean, std, rounding, least)
            }
            DrawDistribution::Exponential { mean, offset, min: least, max: most } => {
                clamped_exponential_moments(mean, offset, least, most)
            }
            DrawDistribution::LogNormal { mu, sigma, min: least, max: most, factor } => {
                let raw = |power| clamped_log_normal_moment(power, mu, sigma, least, most);
                let unscaled = Moments::from_raw_moments(raw(1.0), raw(2.0));
                Moments { mean: factor * unscaled.mean, std: factor * unscaled.std }
            }
            DrawDistribution::Uniform { low, high } => {
                Moments { mean: (low + high) / 2.0, std: (high - low) / 12f64.sqrt() }
            }
            DrawDistribution::UniformInteger { low, high } => {
                let count = f64::from(high - low) + 1.0;
                let std = ((count * count - 1.0) / 12.0).sqrt();
                Moments { mean: f64::midpoint(f64::from(low), f64::from(high)), std }
            }
            DrawDistribution::Bernoulli(p) => Moments { mean: p, std: (p * (1.0 - p)).sqrt() },
            DrawDistribution::Poisson(mean) => Moments { mean, std: mean.sqrt() },
            DrawDistribution::Discrete(ref values) => Moments::from_weighted(values.iter().copied()),
        }
    }
}

fn normal_density(z: f64) -> f64 {
    libm::exp(-z * z / 2.0) / (2.0 * std::f64::consts::PI).sqrt()
}

/// Returns the moments of a normal variable that is clamped to two bounds.
fn clamped_normal_moments(mean: f64, std: f64, least: f64, most: f64) -> Moments {
    if std <= 0.0 {
        return Moments { mean: mean.clamp(least, most), std: 0.0 };
    }
    let (low, high) = ((least - mean) / std, (most - mean) / std);
    let (below, above) = (normal_cdf(low), 1.0 - normal_cdf(high));
    let inside = 1.0 - below - above;
    // The product of an infinite bound and the density at this bound is 0.
    let weigh = |z: f64| if z.is_finite() { z * normal_density(z) } else { 0.0 };
    let at_end = |end: f64, share: f64, power: f64| {
        if end.is_finite() { libm::pow(end, power) * share } else { 0.0 }
    };
    let first = mean * inside + std * (normal_density(low) - normal_density(high));
    let second = mean * mean * inside
        + 2.0 * mean * std * (normal_density(low) - normal_density(high))
        + std * std * (inside + weigh(low) - weigh(high));
    Moments::from_raw_moments(
        first + at_end(least, below, 1.0) + at_end(most, above, 1.0),
        second + at_end(least, below, 2.0) + at_end(most, above, 2.0),
    )
}

/// Returns the moments of a rounded normal variable, computed from the probability of each whole number above the
/// lower bound.
fn rounded_normal_moments(mean: f64, std: f64, rounding: RoundingMode, least: f64) -> Moments {
    let edge = if rounding == RoundingMode::Nearest { 0.5 } else { 1.0 };
    let below = |whole: f64| normal_cdf((whole + edge - mean) / std);
    let last = (mean + 9.0 * std).max(least).ceil() as i64;
    let chances = (least as i64..=last).map(|whole| {
        let whole = whole as f64;
        let chance = if whole == least { below(whole) } else { below(whole) - below(whole - 1.0) };
        (whole, chance)
    });
    Moments::from_weighted(chances)
}

fn clamped_exponential_moments(mean: f64, offset: f64, least: f64, most: f64) -> Moments {
    let start = least.max(offset);
    let beyond = libm::exp(-(start - offset) / mean);
    let span = (most - start) / mean;
    let (rest, tail) =
        if span.is_finite() { (libm::exp(-span), span * libm::exp(-span)) } else { (0.0, 0.0) };
    let first = beyond * mean * (1.0 - rest);
    let second = beyond * 2.0 * mean * mean * (1.0 - rest - tail);
    let moments = Moments::from_raw_moments(first, second);
    Moments { mean: start + moments.mean, std: moments.std }
}

/// Returns the moment of order `power` about zero of a log-normal variable that is clamped to two bounds.
fn clamped_log_normal_moment(power: f64, mu: f64, sigma: f64, least: f64, most: f64) -> f64 {
    let below = |value: f64, shift: f64| match value {
        value if value <= 0.0 => 0.0,
        value if value.is_finite() => normal_cdf((libm::log(value) - mu - shift) / sigma),
        _ => 1.0,
    };
    let shift = power * sigma * sigma;
    let inside = libm::exp(power * mu + power * power * sigma * sigma / 2.0)
        * (below(most, shift) - below(least, shift));
    let above = if most.is_finite() { libm::pow(most, power) * (1.0 - below(most, 0.0)) } else { 0.0 };
    inside + libm::pow(least, power) * below(least, 0.0) + above
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Computes the moments numerically, by summing over the quantiles of the underlying normal or uniform variable.
    fn numeric_moments(value: impl Fn(f64) -> f64) -> Moments {
        let steps = 400_000;
        let at = |step: u32| (f64::from(step) + 0.5) / f64::from(steps);
        Moments::from_weighted((0..steps).map(|step| (value(at(step)), 1.0)))
    }

    fn assert_moments(distribution: &DrawDistribution, value: impl Fn(f64) -> f64) {
        let (exact, summed) = (distribution.moments(), numeric_moments(value));
        assert!(
            (exact.mean - summed.mean).abs() < 2e-4 * exact.std.max(1e-6),
            "{distribution:?}: {exact:?} {summed:?}"
        );
        assert!((exact.std / summed.std - 1.0).abs() < 2e-3, "{distribution:?}: {exact:?} {summed:?}");
    }

    #[test]
    fn exact_moments_match_numeric_integration() {
        use novamind_world::random::inverse_normal;
        let infinite = f64::INFINITY;
        for (least, most) in [(-infinite, infinite), (15.0, infinite), (-infinite, 60.0), (30.0, 70.0)] {
            let distribution = DrawDistribution::Normal { mean: 50.0, std: 32.4, min: least, max: most };
            assert_moments(&distribution, |p| (50.0 + 32.4 * inverse_normal(p)).clamp(least, most));
        }
        for (rounding, least) in [(RoundingMode::Nearest, 2.0), (RoundingMode::Down, 30.0)] {
            let draw_distribution =
                DrawDistribution::RoundedNormal { mean: 23.0, std: 30.0, rounding, min: least };
            let whole = |x: f64| if rounding == RoundingMode::Nearest { x.round() } else { x.trunc() };
            assert_moments(&draw_distribution, |p| whole(23.0 + 30.0 * inverse_normal(p)).max(least));
        }
        for (offset, least, most) in [(0.2, 0.2, 6.0), (0.8, 0.5, 7.0), (0.1, 0.9, infinite)] {
            let law = DrawDistribution::Exponential { mean: 2.0, offset, min: least, max: most };
            assert_moments(&law, |p| (-2.0 * libm::log1p(-p) + offset).clamp(least, most));
        }
        for (mu, sigma, least, most, factor) in
            [(0.0, 0.3, 0.0, infinite, 1.0), (-4.5559, 1.2, 0.00197, 0.1727, 2.5)]
        {
            let law = DrawDistribution::LogNormal { mu, sigma, min: least, max: most, factor };
            let raw = |p: f64| libm::exp(mu + sigma * inverse_normal(p));
            assert_moments(&law, |p| factor * raw(p).clamp(least, most));
        }
        assert_moments(&DrawDistribution::Uniform { low: -0.25, high: 0.25 }, |p| 0.5 * p - 0.25);
        assert_moments(&DrawDistribution::UniformInteger { low: 3, high: 10 }, |p| 3.0 + (8.0 * p).floor());
        assert_moments(&DrawDistribution::Bernoulli(0.3), |p| f64::from(u8::from(p < 0.3)));
        let among = DrawDistribution::Discrete(vec![(10.0, 0.5), (30.0, 0.35), (90.0, 0.15)]);
        assert_moments(&among, |p| {
            if p < 0.5 {
                10.0
            } else if p < 0.85 {
                30.0
            } else {
                90.0
            }
        });
    }

    #[test]
    fn described_parameters_include_the_bounds() {
        let distribution = DrawDistribution::Normal { mean: 50.0, std: 32.4, min: 15.0, max: f64::INFINITY };
        assert_eq!(
            (distribution.name(), distribution.describe_parameters().as_str()),
            ("normal", "mean 50, sd 32.4, at least 15")
        );
        let draw_distribution = DrawDistribution::Discrete(vec![(10.0, 1.0), (30.0, 3.0)]);
        assert_eq!(draw_distribution.describe_parameters(), "10 25.0%, 30 75.0%");
    }
}
