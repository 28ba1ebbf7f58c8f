//! Reference draws from the same distributions, with `rand_distr` and a separate generator.

use rand::distr::Distribution;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Exp, LogNormal, Normal, Poisson};

use super::distribution::{DrawDistribution, RoundingMode};

const REFERENCE_SEED: u64 = 20_000;

impl DrawDistribution {
    /// Returns `count` reference draws from the distribution.
    pub fn reference_draws(&self, count: u64) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(REFERENCE_SEED);
        let mut many = |draw: &dyn Fn(&mut ChaCha8Rng) -> f64| (0..count).map(|_| draw(&mut rng)).collect();
        match self {
            DrawDistribution::Normal { mean, std, min: least, max: most } => match Normal::new(*mean, *std) {
                Ok(normal) => many(&|rng| normal.sample(rng).clamp(*least, *most)),
                Err(_) => Vec::new(),
            },
            DrawDistribution::RoundedNormal { mean, std, rounding, min: least } => {
                match Normal::new(*mean, *std) {
                    Ok(law) => many(&|rng| {
                        let drawn = law.sample(rng);
                        let whole = match rounding {
                            RoundingMode::Nearest => drawn.round_ties_even(),
                            RoundingMode::Down => drawn.trunc(),
                        };
                        whole.max(*least)
                    }),
                    Err(_) => Vec::new(),
                }
            }
            DrawDistribution::Exponential { mean, offset, min: least, max: most } => {
                match Exp::new(1.0 / mean) {
                    Ok(exp) => many(&|rng| (exp.sample(rng) + offset).clamp(*least, *most)),
                    Err(_) => Vec::new(),
                }
            }
            DrawDistribution::LogNormal { mu, sigma, min: least, max: most, factor } => {
                match LogNormal::new(*mu, *sigma) {
                    Ok(log_normal) => many(&|rng| factor * log_normal.sample(rng).clamp(*least, *most)),
                    Err(_) => Vec::new(),
                }
            }
            DrawDistribution::Uniform { low, high } if low < high => {
                many(&|rng| rng.random_range(*low..*high))
            }
            DrawDistribution::Uniform { low, .. } => many(&|_| *low),
            DrawDistribution::UniformInteger { low, high } => {
                many(&|rng| f64::from(rng.random_range(*low..=*high)))
            }
            DrawDistribution::Bernoulli(p) => many(&|rng| f64::from(u8::from(rng.random::<f64>() < *p))),
            DrawDistribution::Poisson(mean) => match Poisson::new(*mean) {
                Ok(poisson) => many(&|rng| poisson.sample(rng)),
                Err(_) => many(&|_| 0.0),
            },
            DrawDistribution::Discrete(values) => {
                let total: f64 = values.iter().map(|(_, weight)| weight).sum();
                many(&|rng| {
                    let mut left = rng.random::<f64>() * total;
                    let found = values.iter().find(|(_, weight)| {
                        left -= weight;
                        left < 0.0
                    });
                    found.or(values.last()).map_or(f64::NAN, |(value, _)| *value)
                })
            }
        }
    }
}
