//! Distributions of the simulator, their notation and exact moments.

use crate::normal::normal_share;

/// A distribution with its parameters. Values beyond an end are clamped to it.
#[derive(Debug, Clone, PartialEq)]
pub enum Law {
    /// Normal, clamped to two ends.
    Normal {
        /// Mean before clamping.
        mean: f64,
        /// Standard deviation before clamping.
        std: f64,
        /// Lower end; may be minus infinity.
        least: f64,
        /// Upper end; may be infinity.
        most: f64,
    },
    /// Normal, rounded to whole numbers.
    WholeNormal {
        /// Mean before rounding.
        mean: f64,
        /// Standard deviation before rounding.
        std: f64,
        /// Rounding.
        rounding: Rounding,
        /// Lower end.
        least: f64,
    },
    /// Exponential plus an offset, clamped to two ends.
    Exponential {
        /// Mean of the exponential.
        mean: f64,
        /// Offset.
        offset: f64,
        /// Lower end.
        least: f64,
        /// Upper end; may be infinity.
        most: f64,
    },
    /// Log-normal, clamped to two ends, then multiplied by a factor.
    LogNormal {
        /// Mean of the logarithm.
        mu: f64,
        /// Standard deviation of the logarithm.
        sigma: f64,
        /// Lower end.
        least: f64,
        /// Upper end; may be infinity.
        most: f64,
        /// Factor.
        factor: f64,
    },
    /// Uniform from low to below high.
    Uniform {
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// Uniform whole numbers from low to high, inclusive.
    Whole {
        /// Lower end.
        low: u32,
        /// Upper end.
        high: u32,
    },
    /// 1 with a probability, otherwise 0.
    Chance(f64),
    /// Poisson.
    Poisson(f64),
    /// Values with weights.
    Among(Vec<(f64, f64)>),
}

/// Rounding to whole numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rounding {
    /// To the nearest.
    Nearest,
    /// Towards zero.
    Down,
}

/// Mean and standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub std: f64,
}

impl Moments {
    /// Computes them from the first two moments about zero.
    fn of_raw(first: f64, second: f64) -> Moments {
        Moments { mean: first, std: (second - first * first).max(0.0).sqrt() }
    }

    /// Computes them for values with weights.
    fn of_weighted(values: impl Iterator<Item = (f64, f64)>) -> Moments {
        let (mut total, mut first, mut second) = (0.0, 0.0, 0.0);
        for (value, weight) in values {
            total += weight;
            first += weight * value;
            second += weight * value * value;
        }
        Moments::of_raw(first / total, second / total)
    }
}

impl Law {
    /// Returns the name.
    pub fn name(&self) -> &'static str {
        match self {
            Law::Normal { .. } => "normal",
            Law::WholeNormal { .. } => "whole normal",
            Law::Exponential { .. } => "exponential",
            Law::LogNormal { .. } => "log-normal",
            Law::Uniform { .. } => "uniform",
            Law::Whole { .. } => "uniform, whole",
            Law::Chance(_) => "chance",
            Law::Poisson(_) => "Poisson",
            Law::Among(_) => "weighted",
        }
    }

    /// Describes the parameters.
    pub fn parameters(&self) -> String {
        let number = |value: &f64| ((value * 1e6).round() / 1e6).to_string();
        let ends = |least: &f64, most: &f64| match (least.is_finite(), most.is_finite()) {
            (true, true) => format!(", within {} to {}", number(least), number(most)),
            (true, false) => format!(", at least {}", number(least)),
            (false, true) => format!(", at most {}", number(most)),
            (false, false) => String::new(),
        };
        match self {
            Law::Normal { mean, std, least, most } => {
                format!("mean {}, sd {}{}", number(mean), number(std), ends(least, most))
            }
            Law::WholeNormal { mean, std, rounding, least } => {
                let how = if *rounding == Rounding::Nearest { "rounded" } else { "cut" };
                format!("mean {}, sd {}, {how}{}", number(mean), number(std), ends(least, &f64::INFINITY))
            }
            Law::Exponential { mean, offset, least, most } => {
                let added = if *offset == 0.0 { String::new() } else { format!(" + {}", number(offset)) };
                format!("mean {}{added}{}", number(mean), ends(least, most))
            }
            Law::LogNormal { mu, sigma, least, most, factor } => {
                let times =
                    if *factor == 1.0 { String::new() } else { format!(", times {}", number(factor)) };
                format!("mu {}, sigma {}{}{times}", number(mu), number(sigma), ends(least, most))
            }
            Law::Uniform { low, high } => format!("{} to {}", number(low), number(high)),
            Law::Whole { low, high } => format!("{low} to {high}"),
            Law::Chance(p) => format!("p {}", number(p)),
            Law::Poisson(mean) => format!("mean {}", number(mean)),
            Law::Among(values) => {
                let total: f64 = values.iter().map(|(_, weight)| weight).sum();
                let one = |(value, weight): &(f64, f64)| {
                    format!("{} {}", number(value), novamind_base::notation::percent(weight / total, 1))
                };
                values.iter().map(one).collect::<Vec<_>>().join(", ")
            }
        }
    }

    /// Returns the exact moments.
    pub fn moments(&self) -> Moments {
        match *self {
            Law::Normal { mean, std, least, most } => normal_between(mean, std, least, most),
            Law::WholeNormal { mean, std, rounding, least } => whole_normal(mean, std, rounding, least),
            Law::Exponential { mean, offset, least, most } => exponential_between(mean, offset, least, most),
            Law::LogNormal { mu, sigma, least, most, factor } => {
                let raw = |power| log_normal_power(power, mu, sigma, least, most);
                let own = Moments::of_raw(raw(1.0), raw(2.0));
                Moments { mean: factor * own.mean, std: factor * own.std }
            }
            Law::Uniform { low, high } => {
                Moments { mean: (low + high) / 2.0, std: (high - low) / 12f64.sqrt() }
            }
            Law::Whole { low, high } => {
                let count = f64::from(high - low) + 1.0;
                let std = ((count * count - 1.0) / 12.0).sqrt();
                Moments { mean: f64::midpoint(f64::from(low), f64::from(high)), std }
            }
            Law::Chance(p) => Moments { mean: p, std: (p * (1.0 - p)).sqrt() },
            Law::Poisson(mean) => Moments { mean, std: mean.sqrt() },
            Law::Among(ref values) => Moments::of_weighted(values.iter().copied()),
        }
    }
}

fn density(z: f64) -> f64 {
    libm::exp(-z * z / 2.0) / (2.0 * std::f64::consts::PI).sqrt()
}

/// Returns the moments of a normal variable clamped to two ends.
fn normal_between(mean: f64, std: f64, least: f64, most: f64) -> Moments {
    if std <= 0.0 {
        return Moments { mean: mean.clamp(least, most), std: 0.0 };
    }
    let (low, high) = ((least - mean) / std, (most - mean) / std);
    let (below, above) = (normal_share(low), 1.0 - normal_share(high));
    let inside = 1.0 - below - above;
    // A density times an infinite bound is 0.
    let weigh = |z: f64| if z.is_finite() { z * density(z) } else { 0.0 };
    let at_end = |end: f64, share: f64, power: f64| {
        if end.is_finite() { libm::pow(end, power) * share } else { 0.0 }
    };
    let first = mean * inside + std * (density(low) - density(high));
    let second = mean * mean * inside
        + 2.0 * mean * std * (density(low) - density(high))
        + std * std * (inside + weigh(low) - weigh(high));
    Moments::of_raw(
        first + at_end(least, below, 1.0) + at_end(most, above, 1.0),
        second + at_end(least, below, 2.0) + at_end(most, above, 2.0),
    )
}

/// Returns the moments of a rounded normal variable from the probabilities of the whole numbers above the lower end.
fn whole_normal(mean: f64, std: f64, rounding: Rounding, least: f64) -> Moments {
    let edge = if rounding == Rounding::Nearest { 0.5 } else { 1.0 };
    let below = |whole: f64| normal_share((whole + edge - mean) / std);
    let last = (mean + 9.0 * std).max(least).ceil() as i64;
    let chances = (least as i64..=last).map(|whole| {
        let whole = whole as f64;
        let chance = if whole == least { below(whole) } else { below(whole) - below(whole - 1.0) };
        (whole, chance)
    });
    Moments::of_weighted(chances)
}

fn exponential_between(mean: f64, offset: f64, least: f64, most: f64) -> Moments {
    let start = least.max(offset);
    let beyond = libm::exp(-(start - offset) / mean);
    let span = (most - start) / mean;
    let (rest, tail) =
        if span.is_finite() { (libm::exp(-span), span * libm::exp(-span)) } else { (0.0, 0.0) };
    let first = beyond * mean * (1.0 - rest);
    let second = beyond * 2.0 * mean * mean * (1.0 - rest - tail);
    let own = Moments::of_raw(first, second);
    Moments { mean: start + own.mean, std: own.std }
}

/// Returns a moment about zero of a log-normal variable clamped to two ends.
fn log_normal_power(power: f64, mu: f64, sigma: f64, least: f64, most: f64) -> f64 {
    let below = |value: f64, shift: f64| match value {
        value if value <= 0.0 => 0.0,
        value if value.is_finite() => normal_share((libm::log(value) - mu - shift) / sigma),
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

    /// Returns moments by summing over the quantiles of the underlying normal or uniform variable.
    fn summed(value: impl Fn(f64) -> f64) -> Moments {
        let steps = 400_000;
        let at = |step: u32| (f64::from(step) + 0.5) / f64::from(steps);
        Moments::of_weighted((0..steps).map(|step| (value(at(step)), 1.0)))
    }

    fn assert_moments(law: &Law, value: impl Fn(f64) -> f64) {
        let (exact, summed) = (law.moments(), summed(value));
        assert!(
            (exact.mean - summed.mean).abs() < 2e-4 * exact.std.max(1e-6),
            "{law:?}: {exact:?} {summed:?}"
        );
        assert!((exact.std / summed.std - 1.0).abs() < 2e-3, "{law:?}: {exact:?} {summed:?}");
    }

    #[test]
    fn exact_moments_are_those_of_the_quantiles() {
        use novamind_world::random::inverse_normal;
        let infinite = f64::INFINITY;
        for (least, most) in [(-infinite, infinite), (15.0, infinite), (-infinite, 60.0), (30.0, 70.0)] {
            let law = Law::Normal { mean: 50.0, std: 32.4, least, most };
            assert_moments(&law, |p| (50.0 + 32.4 * inverse_normal(p)).clamp(least, most));
        }
        for (rounding, least) in [(Rounding::Nearest, 2.0), (Rounding::Down, 30.0)] {
            let law = Law::WholeNormal { mean: 23.0, std: 30.0, rounding, least };
            let whole = |x: f64| if rounding == Rounding::Nearest { x.round() } else { x.trunc() };
            assert_moments(&law, |p| whole(23.0 + 30.0 * inverse_normal(p)).max(least));
        }
        for (offset, least, most) in [(0.2, 0.2, 6.0), (0.8, 0.5, 7.0), (0.1, 0.9, infinite)] {
            let law = Law::Exponential { mean: 2.0, offset, least, most };
            assert_moments(&law, |p| (-2.0 * libm::log1p(-p) + offset).clamp(least, most));
        }
        for (mu, sigma, least, most, factor) in
            [(0.0, 0.3, 0.0, infinite, 1.0), (-4.5559, 1.2, 0.00197, 0.1727, 2.5)]
        {
            let law = Law::LogNormal { mu, sigma, least, most, factor };
            let raw = |p: f64| libm::exp(mu + sigma * inverse_normal(p));
            assert_moments(&law, |p| factor * raw(p).clamp(least, most));
        }
        assert_moments(&Law::Uniform { low: -0.25, high: 0.25 }, |p| 0.5 * p - 0.25);
        assert_moments(&Law::Whole { low: 3, high: 10 }, |p| 3.0 + (8.0 * p).floor());
        assert_moments(&Law::Chance(0.3), |p| f64::from(u8::from(p < 0.3)));
        let among = Law::Among(vec![(10.0, 0.5), (30.0, 0.35), (90.0, 0.15)]);
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
    fn laws_are_written_with_their_ends() {
        let law = Law::Normal { mean: 50.0, std: 32.4, least: 15.0, most: f64::INFINITY };
        assert_eq!((law.name(), law.parameters().as_str()), ("normal", "mean 50, sd 32.4, at least 15"));
        let law = Law::Among(vec![(10.0, 1.0), (30.0, 3.0)]);
        assert_eq!(law.parameters(), "10 25.0%, 30 75.0%");
    }
}
