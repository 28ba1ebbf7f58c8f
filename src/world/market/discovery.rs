//! Market research: paid attempts to discover a group (docs/mechanics/market/discovery.md).

use super::Market;
use crate::customers::drift::DriftTotals;
use crate::events::{Attempt, Snapshot};
use crate::identifiers::Group;
use crate::params::Params;
use crate::random::{Part, Stream, Streams};

/// Draws the outcome of an attempt. The attempt succeeds with probability `chance` and then discovers each
/// undiscovered group with equal probability.
pub fn draw_attempt(undiscovered: &[Group], chance: f64, stream: &mut Stream) -> Option<Group> {
    if undiscovered.is_empty() || !stream.bernoulli(chance) {
        return None;
    }
    undiscovered.get(stream.index(undiscovered.len())).copied()
}

impl Market {
    /// Returns the undiscovered groups in group order: individuals, then enterprises.
    pub fn undiscovered(&self) -> impl Iterator<Item = Group> + '_ {
        Group::all().filter(|group| !self.is_known(*group))
    }

    /// Returns the outcome of an attempt that is made now. The outcome depends on the seed, the number of earlier
    /// attempts and the undiscovered groups.
    pub fn next_attempt(&self, params: &Params, streams: &Streams) -> Attempt {
        let research = &params.market_research;
        let undiscovered: Vec<Group> = self.undiscovered().collect();
        let drawn = || {
            let mut stream = streams.open(Part::MarketResearch, [u64::from(self.attempts)]);
            draw_attempt(&undiscovered, research.market_research_discover_prob, &mut stream)
        };
        let recorded_outcome = params.replayed_series().and_then(|series| series.attempt(self.attempts));
        let found = recorded_outcome.unwrap_or_else(drawn).filter(|group| undiscovered.contains(group));
        Attempt { earlier: self.attempts, cost: research.discovery_cost_level_1, found }
    }

    /// Counts an attempt and marks the discovered group as known.
    pub fn record_attempt(&mut self, attempt: &Attempt, day: u32, params: &Params) {
        self.attempts += 1;
        if let Some(group) = attempt.found {
            let snapshot = Snapshot::take_snapshot(group, day, &self.drift, params);
            let knowledge = &mut self.knowledge[group];
            knowledge.level = params.initial.initial_group_info_level;
            (knowledge.discovered_day, knowledge.last_research_day) = (Some(day), Some(day));
            knowledge.snapshot = Some(snapshot);
        }
    }
}

/// Returns the day 0 snapshot of a group, or `None` if the group is not known on day 0.
pub(super) fn initial_snapshot(group: Group, params: &Params) -> Option<Snapshot> {
    group.is_initially_known().then(|| Snapshot::take_snapshot(group, 0, &DriftTotals::default(), params))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the groups that consecutive attempts discover, with `pause` days between attempts.
    fn discovered_groups(params: &Params, seed: u64, attempts: u32, pause: u32) -> Vec<Option<Group>> {
        let streams = Streams::new(seed);
        let mut market = Market::initial(params);
        let each = |number: u32| {
            let attempt = market.next_attempt(params, &streams);
            assert_eq!((attempt.earlier, attempt.cost), (number, 25_000.0));
            market.record_attempt(&attempt, number * pause, params);
            attempt.found
        };
        (0..attempts).map(each).collect()
    }

    #[test]
    fn attempts_depend_only_on_seed_and_number() {
        let params = Params::bundled();
        assert_eq!(discovered_groups(&params, 42, 60, 0), discovered_groups(&params, 42, 60, 7));
        assert_ne!(discovered_groups(&params, 42, 60, 0), discovered_groups(&params, 43, 60, 0));
    }

    #[test]
    fn each_group_is_discovered_once() {
        let all: Vec<Group> =
            discovered_groups(&Params::bundled(), 7, 400, 1).into_iter().flatten().collect();
        let mut distinct = all.clone();
        distinct.sort_unstable();
        distinct.dedup();
        assert_eq!((all.len(), distinct.len()), (20, 20));
        assert!(all.iter().all(|group| !group.is_initially_known()));
    }

    #[test]
    fn attempts_succeed_uniformly_at_thirty_percent() {
        let params = Params::bundled();
        let (mut successes, mut first) = (0u32, [0u32; Group::COUNT]);
        for seed in 0..4000 {
            let outcomes = discovered_groups(&params, seed, 5, 0);
            successes += outcomes.iter().flatten().count() as u32;
            if let Some(group) = outcomes[0] {
                first[group.index()] += 1;
            }
        }
        assert!((f64::from(successes) / 20_000.0 - 0.3).abs() < 0.013, "{successes}");
        // 1,200 first discoveries among 20 groups: 60 per group on average, with a standard deviation of 7.6.
        assert!(first[..6].iter().all(|count| *count == 0));
        assert!(first[6..].iter().all(|count| (25..=95).contains(count)), "{first:?}");
    }

    #[test]
    fn discovered_group_has_a_snapshot_of_the_discovery_day() {
        let params = Params::bundled();
        let mut market = Market::initial(&params);
        market.drift.global_quality = 0.12;
        let group = Group::parse("D_S06").expect("a group");
        let attempt = Attempt { earlier: 0, cost: 25_000.0, found: Some(group) };
        market.record_attempt(&attempt, 28, &params);
        let knowledge = market.knowledge[group];
        assert_eq!(
            (knowledge.level, knowledge.discovered_day, knowledge.last_research_day),
            (1, Some(28), Some(28))
        );
        let snapshot = knowledge.snapshot.expect("a snapshot");
        assert_eq!(snapshot.day, 28);
        assert!((snapshot.q_min - (params.group(group).q_min_mean + 0.12)).abs() < 1e-12);
        assert_eq!(market.undiscovered().count(), 19);
    }
}
