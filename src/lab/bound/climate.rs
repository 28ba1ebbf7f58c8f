//! q_shared and the competitors' reaction: means over seeds, computed with the simulator's own mechanism.

use super::premises::Premises;
use novamind_world::customers::drift::DriftTotals;
use novamind_world::identifiers::{ByGroup, Group};
use novamind_world::market::competitors::react;
use novamind_world::params::Params;
use novamind_world::product::Product;
use novamind_world::product::development::development_gain;
use novamind_world::random::Streams;

/// Number of seeds that are averaged, starting at 1.
pub const LUCKS: u64 = 64;

/// Shared quality and competitor effects at the start of each day. List positions are days.
#[derive(Debug, Clone, PartialEq)]
pub struct Climate {
    /// Shared quality gained.
    pub shared: Vec<f64>,
    /// Quality that competitors added to all customers' expectations.
    pub raised: Vec<f64>,
    /// Quality that competitors copied from a group's bank, for a targeted gain of 1 a day.
    pub copied: Vec<ByGroup<f64>>,
}

/// Returns the R&D gain on a day: the tiers that finish on it, at mean duration and mean gain.
fn research_gain(day: u32, premises: &Premises, params: &Params) -> f64 {
    let done = |tier: &u8| {
        let law = params.research(*tier);
        let least = f64::from(params.development.rd_min_duration_days);
        premises.research_day + law.mean_days.max(least) as u32 == day
    };
    (1..=premises.research_tiers).filter(done).map(|tier| params.research(tier).mean_quality_boost).sum()
}

/// Returns the market conditions under the plan.
pub fn climate(premises: &Premises, params: &Params) -> Climate {
    let days = premises.run_days as usize + 1;
    let mut mean =
        Climate { shared: vec![0.0; days], raised: vec![0.0; days], copied: vec![ByGroup::default(); days] };
    for seed in 1..=LUCKS {
        add_luck(seed, premises, params, &mut mean);
    }
    mean
}

/// Adds one seed's share to the mean. The order within a day is that of the simulator: R&D, competitors, development.
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
        // Two tiers finish on day 31; development acts a day later.
        let gain = development_gain(40_000.0, &params.development);
        assert!((own.shared[31] - 30.0 * gain).abs() < 1e-9);
        let two: f64 = 0.04 + 0.07 + 0.11;
        assert!((own.shared[32] - 31.0 * gain - two).abs() < 1e-9, "{}", own.shared[32]);
        assert!((own.shared[480] - 479.0 * gain - 3.34).abs() < 1e-9);
        assert!(own.raised[480] > own.shared[480] && own.raised[480] < own.shared[480] + 3.0);
        // At the end, competitors have copied between 50 % and 90 % of a targeted gain of 1 a day.
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
