//! Reference draws of the same distributions with `rand_distr` and a separate generator.

use rand::distr::Distribution;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Exp, LogNormal, Normal, Poisson};

use super::law::{Law, Rounding};

const SEED: u64 = 20_000;

impl Law {
    /// Returns a number of draws from the distribution.
    pub fn reference(&self, count: u64) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(SEED);
        let mut many = |draw: &dyn Fn(&mut ChaCha8Rng) -> f64| (0..count).map(|_| draw(&mut rng)).collect();
        match self {
            Law::Normal { mean, std, least, most } => match Normal::new(*mean, *std) {
                Ok(law) => many(&|rng| law.sample(rng).clamp(*least, *most)),
                Err(_) => Vec::new(),
            },
            Law::WholeNormal { mean, std, rounding, least } => match Normal::new(*mean, *std) {
                Ok(law) => many(&|rng| {
                    let drawn = law.sample(rng);
                    let whole = match rounding {
                        Rounding::Nearest => drawn.round_ties_even(),
                        Rounding::Down => drawn.trunc(),
                    };
                    whole.max(*least)
                }),
                Err(_) => Vec::new(),
            },
            Law::Exponential { mean, offset, least, most } => match Exp::new(1.0 / mean) {
                Ok(law) => many(&|rng| (law.sample(rng) + offset).clamp(*least, *most)),
                Err(_) => Vec::new(),
            },
            Law::LogNormal { mu, sigma, least, most, factor } => match LogNormal::new(*mu, *sigma) {
                Ok(law) => many(&|rng| factor * law.sample(rng).clamp(*least, *most)),
                Err(_) => Vec::new(),
            },
            Law::Uniform { low, high } if low < high => many(&|rng| rng.random_range(*low..*high)),
            Law::Uniform { low, .. } => many(&|_| *low),
            Law::Whole { low, high } => many(&|rng| f64::from(rng.random_range(*low..=*high))),
            Law::Chance(p) => many(&|rng| f64::from(u8::from(rng.random::<f64>() < *p))),
            Law::Poisson(mean) => match Poisson::new(*mean) {
                Ok(law) => many(&|rng| law.sample(rng)),
                Err(_) => many(&|_| 0.0),
            },
            Law::Among(values) => {
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
