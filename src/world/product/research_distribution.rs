//! Distributions of the duration and the quality gain of an R&D tier's projects
//! (`docs/mechanics/product/research.md#spread`). The distributions depend only on the tier, not on the seed.

use crate::params::{Development, ResearchTier};
use crate::random::inverse_normal;

/// Returns the share of a tier's projects that take at most `days` days, 0..=1.
pub fn share_done_within(days: u32, tier: &ResearchTier, development: &Development) -> f64 {
    match days < development.rd_min_duration_days {
        true => 0.0,
        // Durations are truncated to whole days, so a duration of `days` includes all draws below `days` + 1.
        false => share_below(f64::from(days) + 1.0, tier.mean_days, tier.std_days),
    }
}

/// Returns the smallest number of days within which a share of the projects is completed, for 0 < share < 1.
pub fn duration_quantile(share: f64, tier: &ResearchTier, development: &Development) -> u32 {
    let drawn = tier.mean_days + tier.std_days * inverse_normal(share);
    let min = development.rd_min_duration_days;
    let days = (drawn - 1.0).ceil().max(f64::from(min)) as u32;
    // Because of rounding, the quantile can be slightly below or above a whole day.
    match share_done_within(days, tier, development) < share {
        true => days + 1,
        false => days,
    }
}

/// Returns the mean duration in days: the minimum duration plus, for each later day, the probability that the project
/// still continues.
pub fn mean_days(tier: &ResearchTier, development: &Development) -> f64 {
    let (min, mean, std) = (development.rd_min_duration_days, tier.mean_days, tier.std_days);
    if std < 1.0 {
        let last = (mean + 9.0 * std).ceil() as u32;
        let lasts_longer = |days| 1.0 - share_done_within(days, tier, development);
        return f64::from(min) + (min..last).map(lasts_longer).sum::<f64>();
    }
    // Approximate the sum over days by an integral. The midpoint rule with its first correction has an error below
    // 0.001 days.
    let floor = f64::from(min);
    mean_with_minimum(floor + 0.5, mean, std)
        - 0.5
        - normal_density((floor + 0.5 - mean) / std) / (24.0 * std)
}

/// Returns the mean quality gain of a tier's projects.
pub fn mean_gain(tier: &ResearchTier, development: &Development) -> f64 {
    mean_with_minimum(development.rd_min_quality_boost, tier.mean_quality_boost, tier.std_quality_boost)
}

/// Returns a quantile of the quality gain, for 0 < share < 1. `share` of the projects have at most this gain.
pub fn gain_quantile(share: f64, tier: &ResearchTier, development: &Development) -> f64 {
    let drawn = tier.mean_quality_boost + tier.std_quality_boost * inverse_normal(share);
    drawn.max(development.rd_min_quality_boost)
}

/// Returns the share of projects with the minimum gain, 0..=1.
pub fn share_at_minimum_gain(tier: &ResearchTier, development: &Development) -> f64 {
    share_below(development.rd_min_quality_boost, tier.mean_quality_boost, tier.std_quality_boost)
}

/// Returns the mean of max(`floor`, X), where X is a normal variate.
fn mean_with_minimum(floor: f64, mean: f64, std: f64) -> f64 {
    match std > 0.0 {
        true => {
            let below = share_below(floor, mean, std);
            floor * below + mean * (1.0 - below) + std * normal_density((floor - mean) / std)
        }
        false => mean.max(floor),
    }
}

fn normal_density(z: f64) -> f64 {
    libm::exp(-z * z / 2.0) / libm::sqrt(2.0 * std::f64::consts::PI)
}

fn share_below(bound: f64, mean: f64, spread: f64) -> f64 {
    match spread > 0.0 {
        true => 0.5 * libm::erfc((mean - bound) / spread * std::f64::consts::FRAC_1_SQRT_2),
        false => f64::from(u8::from(mean < bound)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::Product;
    use super::super::research::draw_project;
    use super::*;
    use crate::params::Params;
    use crate::random::Streams;

    #[test]
    fn minimum_duration_has_the_truncated_share() {
        let params = Params::bundled();
        for (tier, share) in [(1, 0.943327), (5, 0.42479), (10, 0.301909), (20, 0.348532)] {
            let within = |days| share_done_within(days, params.research_tier(tier), &params.development);
            assert!((within(30) - share).abs() < 5e-7, "tier {tier}: {}", within(30));
            assert_eq!(within(29), 0.0);
        }
    }

    #[test]
    fn duration_quantile_is_the_first_day_with_the_share() {
        let params = Params::bundled();
        for tier in &params.research_tier {
            for share in [0.05, 0.25, 0.5, 0.75, 0.975] {
                let days = duration_quantile(share, tier, &params.development);
                assert!(share_done_within(days, tier, &params.development) >= share);
                assert!(days == 30 || share_done_within(days - 1, tier, &params.development) < share);
            }
        }
        let (fifth, development) = (params.research_tier(5), &params.development);
        let days = [0.25, 0.5, 0.75].map(|share| duration_quantile(share, fifth, development));
        assert_eq!(days, [30, 41, 81]);
        let gains = [0.25, 0.75].map(|share| (gain_quantile(share, fifth, development) * 1e6).round());
        assert_eq!(gains, [145_806.0, 294_194.0]);
        assert!((share_at_minimum_gain(params.research_tier(20), development) - 0.105_678).abs() < 5e-7);
        assert_eq!(gain_quantile(0.01, params.research_tier(20), development), 0.001);
    }

    #[test]
    fn projects_match_the_stated_distribution() {
        let params = Params::bundled();
        for tier in [3, 10, 17] {
            let product = Product::initial(&params);
            let research_tier = params.research_tier(tier);
            let drawn: Vec<_> =
                (0..4000).map(|seed| draw_project(&product, 0, tier, &params, &Streams::new(seed))).collect();
            let share = |holds: &dyn Fn(&crate::events::Project) -> bool| {
                drawn.iter().filter(|project| holds(project)).count() as f64 / 4000.0
            };
            for days in [30, 60, 150, 400] {
                let value = share_done_within(days, research_tier, &params.development);
                assert!(
                    (share(&|project| project.due_day <= days) - value).abs() < 0.025,
                    "tier {tier}, {days}"
                );
            }
            for part in [0.25, 0.5, 0.75] {
                let gain = gain_quantile(part, research_tier, &params.development);
                assert!(
                    (share(&|project| project.boost <= gain) - part).abs() < 0.025,
                    "tier {tier}, {part}"
                );
            }
        }
    }

    #[test]
    fn mean_days_matches_the_daily_probabilities() {
        let params = Params::bundled();
        let development = &params.development;
        let rounded_mean_days =
            |tier| (mean_days(params.research_tier(tier), development) * 1e4).round() / 1e4;
        assert_eq!([1, 2, 3, 5, 20].map(rounded_mean_days), [30.3192, 32.9799, 38.5898, 59.3417, 728.5759]);
        let mut tiers = params.research_tier.clone();
        tiers.push(ResearchTier { mean_days: 30.5, std_days: 1.5, ..params.research_tier(1).clone() });
        tiers.push(ResearchTier { mean_days: 30.5, std_days: 0.9, ..params.research_tier(1).clone() });
        for tier in &tiers {
            let last = (tier.mean_days + 10.0 * tier.std_days) as u32;
            let longer = |days| 1.0 - share_done_within(days, tier, development);
            let summed = 30.0 + (30..last).map(longer).sum::<f64>();
            let mean = mean_days(tier, development);
            assert!((mean - summed).abs() < 1e-3, "{tier:?}: got {mean}, expected {summed}");
        }
    }

    #[test]
    fn mean_gain_matches_its_quantiles() {
        let params = Params::bundled();
        for tier in &params.research_tier {
            let parts = 20_000;
            let at =
                |part| gain_quantile((f64::from(part) + 0.5) / f64::from(parts), tier, &params.development);
            let summed = (0..parts).map(at).sum::<f64>() / f64::from(parts);
            let mean = mean_gain(tier, &params.development);
            assert!((mean / summed - 1.0).abs() < 1e-4, "{tier:?}: got {mean}, expected {summed}");
            assert!(mean > tier.mean_quality_boost);
        }
    }

    #[test]
    fn tier_without_variance_is_deterministic() {
        let params = Params::bundled();
        let certain =
            ResearchTier { std_days: 0.0, std_quality_boost: 0.0, ..params.research_tier(9).clone() };
        let within = |days| share_done_within(days, &certain, &params.development);
        assert_eq!([within(102), within(103)], [0.0, 1.0]);
        assert_eq!(duration_quantile(0.5, &certain, &params.development), 103);
        assert_eq!(share_at_minimum_gain(&certain, &params.development), 0.0);
        assert_eq!(mean_days(&certain, &params.development), 103.0);
        assert_eq!(mean_gain(&certain, &params.development), certain.mean_quality_boost);
    }
}
