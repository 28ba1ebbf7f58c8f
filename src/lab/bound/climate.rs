//! q_shared and what rivals do about it: the mean of some lucks of the world's own mechanism.

use super::premises::Premises;
use novamind_world::customers::drift::DriftTotals;
use novamind_world::identifiers::{ByGroup, Group};
use novamind_world::market::competitors::react;
use novamind_world::params::Params;
use novamind_world::product::Product;
use novamind_world::product::development::development_gain;
use novamind_world::random::Streams;

/// Lucks whose mean is taken: the seeds from 1 on.
pub const LUCKS: u64 = 64;

/// Shared quality and rivals as a day reads them: as the day before has left them. The place in a list is the day.
#[derive(Debug, Clone, PartialEq)]
pub struct Climate {
    /// Quality gained for everybody.
    pub shared: Vec<f64>,
    /// Quality that rivals have added to everybody's expectations.
    pub raised: Vec<f64>,
    /// Quality that rivals have copied of a group's bank, for a targeted gain of 1 a day.
    pub copied: Vec<ByGroup<f64>>,
}

/// Gain of R&D on a day: the tiers that are done on it, at mean time and mean gain.
fn research_gain(day: u32, premises: &Premises, params: &Params) -> f64 {
    let done = |tier: &u8| {
        let law = params.research(*tier);
        let least = f64::from(params.development.rd_min_duration_days);
        premises.research_day + law.mean_days.max(least) as u32 == day
    };
    (1..=premises.research_tiers).filter(done).map(|tier| params.research(tier).mean_quality_boost).sum()
}

/// The climate of the plan.
pub fn climate(premises: &Premises, params: &Params) -> Climate {
    let days = premises.run_days as usize + 1;
    let mut mean =
        Climate { shared: vec![0.0; days], raised: vec![0.0; days], copied: vec![ByGroup::default(); days] };
    for seed in 1..=LUCKS {
        add_luck(seed, premises, params, &mut mean);
    }
    mean
}

/// One luck, as its share of the mean. Days go as in the world: R&D, rivals, development.
fn add_luck(seed: u64, premises: &Premises, params: &Params, mean: &mut Climate) {
    let (streams, share) = (Streams::new(seed), 1.0 / LUCKS as f64);
    let (mut product, mut drift, mut events) = (Product::opening(params), DriftTotals::default(), Vec::new());
    let gain = development_gain(premises.global_development, &params.development);
    for day in 1..=premises.run_days {
        let at = day as usize;
        mean.shared[at] += share * product.shared_bonus;
        mean.raised[at] += share * drift.global_quality;
        for group in Group::all() {
            let reaction = params.group(group).competitor_reactivity_q_bias * drift.global_quality;
            mean.copied[at][group] += share * (drift.quality[group] - reaction);
        }
        let research = research_gain(day, premises, params);
        product.shared_bonus += research;
        product.shared_bank += research;
        react(day, premises.run_days, &mut events, &mut product, &mut drift, params, &streams);
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
    fn rivals_wait_and_then_copy_nearly_all_that_is_shared() {
        let (premises, params) = (Premises::of_the_paper(3.0), Params::shipped());
        let own = climate(&premises, &params);
        let s1 = Group::parse("S1").expect("a group");
        assert_eq!((own.raised[60], own.copied[60][s1]), (0.0, 0.0));
        // Two tiers are done on day 31, and a day of development is a day late.
        let gain = development_gain(40_000.0, &params.development);
        assert!((own.shared[31] - 30.0 * gain).abs() < 1e-9);
        let two: f64 = 0.04 + 0.07 + 0.11;
        assert!((own.shared[32] - 31.0 * gain - two).abs() < 1e-9, "{}", own.shared[32]);
        assert!((own.shared[480] - 479.0 * gain - 3.34).abs() < 1e-9);
        assert!(own.raised[480] > own.shared[480] && own.raised[480] < own.shared[480] + 3.0);
        // Of a targeted gain of 1 a day, rivals hold between a half and nine tenths at the end.
        assert!((0.5..0.9).contains(&(own.copied[480][s1] / 479.0)));
    }

    #[test]
    fn without_rivals_nothing_is_raised() {
        let mut params = Params::shipped();
        params.competitor.competitor_events_disabled = true;
        let own = climate(&Premises::of_the_paper(3.0), &params);
        assert!(own.raised.iter().all(|raised| *raised == 0.0));
    }
}
