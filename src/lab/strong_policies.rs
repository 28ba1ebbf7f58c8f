//! Strong handwritten policies, for comparison with other runs (docs/interfaces/policies.md#strong-policies).

/// Names of the strong policies. These policies play with the scenario's demand surges, as players do.
pub const STRONG_POLICIES: [&str; 4] = ["ads-first", "enterprise-led", "harvest-late", "price-experimenting"];

#[cfg(test)]
mod tests {
    use rayon::prelude::*;

    use super::STRONG_POLICIES;
    use crate::{MetricsCollector, Policy, RunEnd, RunSpec, play_policy};
    use novamind_record::folder::configuration::Configuration;

    /// Seeds on which no strong policy was tuned. The second seed has a demand surge while enterprises sign deals.
    const SEEDS: [u64; 2] = [113, 114];

    /// Plays a policy until day 70 of 500 and returns the cash in dollars.
    fn cash_on_day_70(name: &str, seed: u64) -> f64 {
        let configuration = Configuration::bundled();
        let policy = Policy::find(name, &configuration).expect(name);
        let spec = RunSpec { stop_after_day: Some(70), ..RunSpec::for_seed(seed) };
        let outcome =
            play_policy(&policy, &spec, &configuration, &mut MetricsCollector::disabled()).expect(name);
        assert_eq!(outcome.ended, RunEnd::Until, "{name} on seed {seed}");
        outcome.cash
    }

    #[test]
    fn strong_policies_beat_the_baseline_on_day_70() {
        for seed in SEEDS {
            let baseline = cash_on_day_70("baseline", seed);
            let cash: Vec<f64> = STRONG_POLICIES.par_iter().map(|name| cash_on_day_70(name, seed)).collect();
            for (name, cash) in STRONG_POLICIES.iter().zip(cash) {
                assert!(cash > 2.0 * baseline, "{name} on seed {seed}: {cash}, baseline {baseline}");
            }
        }
    }

    #[test]
    fn strong_policies_are_bundled_and_distinct() {
        let mut names: Vec<&str> = novamind_assets::policies().into_iter().map(|(name, _)| name).collect();
        assert!(STRONG_POLICIES.iter().all(|strong| names.contains(strong)), "{names:?}");
        names.sort_unstable();
        assert!(names.windows(2).all(|two| !two[0].eq_ignore_ascii_case(two[1])), "{names:?}");
    }
}
