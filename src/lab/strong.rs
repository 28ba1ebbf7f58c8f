//! Strong handwritten policies, for comparison with other runs (docs/interfaces/policies.md#strong-policies).

/// Names of the strong policies. They use the scenario's demand surges, as players do.
pub const STRONG: [&str; 4] = ["ads-first", "enterprise-led", "harvest-late", "price-experimenting"];

#[cfg(test)]
mod tests {
    use rayon::prelude::*;

    use super::STRONG;
    use crate::{Collector, Policy, RunEnd, RunSpec, play};
    use novamind_record::folder::configuration::Configuration;

    /// Seeds on which no strong policy was tuned; the second has a surge while enterprises sign.
    const SEEDS: [u64; 2] = [113, 114];

    /// Plays until day 70 of 500 and returns the cash in dollars.
    fn early_cash(name: &str, seed: u64) -> f64 {
        let configuration = Configuration::shipped();
        let policy = Policy::find(name, &configuration).expect(name);
        let spec = RunSpec { until: Some(70), ..RunSpec::of_seed(seed) };
        let outcome = play(&policy, &spec, &configuration, &mut Collector::idle()).expect(name);
        assert_eq!(outcome.ended, RunEnd::Until, "{name} on seed {seed}");
        outcome.cash
    }

    #[test]
    fn each_leaves_the_baseline_behind_before_the_hundredth_day() {
        for seed in SEEDS {
            let baseline = early_cash("baseline", seed);
            let cash: Vec<f64> = STRONG.par_iter().map(|name| early_cash(name, seed)).collect();
            for (name, cash) in STRONG.iter().zip(cash) {
                assert!(cash > 2.0 * baseline, "{name} on seed {seed}: {cash}, baseline {baseline}");
            }
        }
    }

    #[test]
    fn each_is_shipped_and_shares_no_name_with_another() {
        let mut names: Vec<&str> = novamind_assets::policies().into_iter().map(|(name, _)| name).collect();
        assert!(STRONG.iter().all(|strong| names.contains(strong)), "{names:?}");
        names.sort_unstable();
        assert!(names.windows(2).all(|two| !two[0].eq_ignore_ascii_case(two[1])), "{names:?}");
    }
}
