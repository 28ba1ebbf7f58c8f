//! The shared quality `q_shared` and the reaction of competitors, as means over seeds. Both are computed with the
//! functions of the simulator.

use super::assumptions::BoundAssumptions;
use novamind_world::customers::drift::DriftTotals;
use novamind_world::identifiers::{ByGroup, Group};
use novamind_world::market::competitors::apply_move;
use novamind_world::params::Params;
use novamind_world::product::Product;
use novamind_world::product::development::development_gain;
use novamind_world::random::Streams;

/// Number of seeds over which the means are taken. The first seed is 1.
pub const SEED_COUNT: u64 = 64;

/// Shared quality and competitor effects at the start of each day. The index in each list is the day.
#[derive(Debug, Clone, PartialEq)]
pub struct SharedQualityPath {
    /// Quality gain for all groups.
    pub shared: Vec<f64>,
    /// Increase in all customers' expectations due to competitors.
    pub raised_expectations: Vec<f64>,
    /// Quality that competitors have copied from a group's quality bank, for a targeted gain of 1 per day.
    pub copied_quality: Vec<ByGroup<f64>>,
}

/// Returns the quality gain from the R&D projects that finish on a day, if each project has the mean duration
/// and mean gain of its tier.
fn research_gain_on(day: u32, premises: &BoundAssumptions, params: &Params) -> f64 {
    let done = |tier: &u8| {
        let research_tier = params.research_tier(*tier);
        let min = f64::from(params.development.rd_min_duration_days);
        premises.research_day + research_tier.mean_days.max(min) as u32 == day
    };
    (1..=premises.research_tiers).filter(done).map(|tier| params.research_tier(tier).mean_quality_boost).sum()
}

/// Simulates shared quality and competitor effects under the plan, averaged over seeds.
pub fn shared_quality_path(premises: &BoundAssumptions, params: &Params) -> SharedQualityPath {
    let days = premises.run_days as usize + 1;
    let mut mean = SharedQualityPath {
        shared: vec![0.0; days],
        raised_expectations: vec![0.0; days],
        copied_quality: vec![ByGroup::default(); days],
    };
    for seed in 1..=SEED_COUNT {
        add_seed(seed, premises, params, &mut mean);
    }
    mean
}

/// Adds the contribution of one seed to the means. Within a day, the steps have the same order as in the
/// simulator: R&D, competitors, development.
fn add_seed(seed: u64, premises: &BoundAssumptions, params: &Params, mean: &mut SharedQualityPath) {
    let (streams, share) = (Streams::new(seed), 1.0 / SEED_COUNT as f64);
    let (mut product, mut drift, mut events) = (Product::initial(params), DriftTotals::default(), Vec::new());
    let gain = development_gain(premises.global_development, &params.development);
    for day in 1..=premises.run_days {
        let at = day as usize;
        mean.shared[at] += share * product.shared_bonus;
        mean.raised_expectations[at] += share * drift.global_quality;
        for group in Group::all() {
            let reaction = params.group(group).competitor_reactivity_q_bias * drift.global_quality;
            mean.copied_quality[at][group] += share * (drift.quality[group] - reaction);
        }
        let research = research_gain_on(day, premises, params);
        product.shared_bonus += research;
        product.shared_bank += research;
        apply_move(day, premises.run_days, &mut events, &mut product, &mut drift, params, &streams);
        product.shared_bonus += gain;
        product.shared_bank += gain;
        for group in Group::all() {
            product.group_bank[group] += 1.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn competitors_copy_most_shared_quality_after_a_delay() {
        let (premises, params) = (BoundAssumptions::from_paper(3.0), Params::bundled());
        let quality_path = shared_quality_path(&premises, &params);
        let s1 = Group::parse("S1").expect("a group");
        assert_eq!((quality_path.raised_expectations[60], quality_path.copied_quality[60][s1]), (0.0, 0.0));
        // Two tiers finish on day 31. Development takes effect a day later.
        let gain = development_gain(40_000.0, &params.development);
        assert!((quality_path.shared[31] - 30.0 * gain).abs() < 1e-9);
        let two: f64 = 0.04 + 0.07 + 0.11;
        assert!((quality_path.shared[32] - 31.0 * gain - two).abs() < 1e-9, "{}", quality_path.shared[32]);
        assert!((quality_path.shared[480] - 479.0 * gain - 3.34).abs() < 1e-9);
        assert!(
            quality_path.raised_expectations[480] > quality_path.shared[480]
                && quality_path.raised_expectations[480] < quality_path.shared[480] + 3.0
        );
        // At the end, competitors have copied between 50 % and 90 % of a targeted gain of 1 per day.
        assert!((0.5..0.9).contains(&(quality_path.copied_quality[480][s1] / 479.0)));
    }

    #[test]
    fn expectations_are_constant_without_competitors() {
        let mut params = Params::bundled();
        params.competitor.competitor_events_disabled = true;
        let quality_path = shared_quality_path(&BoundAssumptions::from_paper(3.0), &params);
        assert!(quality_path.raised_expectations.iter().all(|raised| *raised == 0.0));
    }
}
