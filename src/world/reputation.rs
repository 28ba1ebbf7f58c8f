//! Reputation: daily contributions of subscribers, spillover, and damage from cancellations
//! (docs/mechanics/market/reputation.md).

use std::ops::AddAssign;

use serde::Serialize;

use crate::canonical::canonical;
use crate::fault::Fault;
use crate::identifiers::{ByGroup, Group};
use crate::params::{Params, Reputation};

/// Today's contributions of several subscribers to the reputation in their group.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ReputationContribution {
    /// Sum of the subscribers' contributions (`docs/mechanics/market/reputation.md`).
    pub sum: f64,
    /// Number of contributing subscribers.
    pub count: u32,
}

impl AddAssign for ReputationContribution {
    fn add_assign(&mut self, other: ReputationContribution) {
        self.sum += other.sum;
        self.count += other.count;
    }
}

/// Reputation in each group, 0.001..=1 after the first change.
#[derive(Debug, Clone, PartialEq)]
pub struct Reputations {
    values: ByGroup<f64>,
}

canonical! { Reputations { values } }

/// The cause of a reputation change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ReputationCause {
    /// Cancellations of individuals who found no acceptable plan.
    Cancellations,
    /// Loss of an enterprise.
    LostEnterprise,
    /// Today's contributions of the group's own subscribers.
    Contributions(ReputationContribution),
    /// Spillover of a reputation change in another group.
    Spillover(Spillover),
}

/// The effect of one group's reputation change on another group: change × weight × factor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spillover {
    /// The source group, whose reputation changed.
    pub source: Group,
    /// Change in the source group's reputation that its subscribers caused.
    pub change: f64,
    /// Weight of the source group for the affected group.
    pub weight: f64,
    /// Factor that applies to every spillover.
    pub factor: f64,
}

/// Consecutive changes that one mechanism made to a reputation, and the resulting reputation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReputationWrite<'a> {
    /// Group whose reputation changed.
    pub group: Group,
    /// Mechanism that changed the reputation.
    pub cause: ReputationCause,
    /// Changes that the mechanism made, before clamping.
    pub changes: &'a [f64],
    /// Reputation before the first of the changes.
    pub before: f64,
    /// Reputation after the last of the changes.
    pub after: f64,
}

/// A callback for reputation changes.
pub type OnReputationWrite<'a> = dyn FnMut(&ReputationWrite<'_>) + 'a;

impl Reputations {
    /// Returns the reputations on day 0, which are equal for all groups.
    pub fn initial(params: &Params) -> Reputations {
        Reputations { values: ByGroup::from_fn(|_| params.initial.initial_reputation) }
    }

    /// Returns the reputation in a group.
    pub fn get(&self, group: Group) -> f64 {
        self.values[group]
    }

    /// Sets a reputation without clamping, for tests and constructed states.
    pub fn set(&mut self, group: Group, value: f64) {
        self.values[group] = value;
    }

    /// Adds a change to a reputation, clamps the result to 0..=1 and applies the minimum.
    pub fn add(&mut self, group: Group, change: f64, params: &Params) {
        let reputation = &params.reputation;
        let moved = (self.values[group] + change)
            .clamp(reputation.reputation_clamp_min, reputation.reputation_clamp_max);
        let has_floor = !params.has_fault(Fault::ReputationWithoutFloor);
        self.values[group] = if has_floor { moved.max(reputation.reputation_floor) } else { moved };
    }

    /// Adds changes to a reputation in order and calls `on_write` with the result.
    pub fn add_all(
        &mut self,
        (group, cause): (Group, ReputationCause),
        changes: &[f64],
        params: &Params,
        on_write: &mut OnReputationWrite<'_>,
    ) {
        let before = self.get(group);
        changes.iter().for_each(|change| self.add(group, *change, params));
        on_write(&ReputationWrite { group, cause, changes, before, after: self.get(group) });
    }
}

/// Returns the daily contribution of one subscriber to reputation: 0.0005 S, doubled if S is negative.
#[inline]
pub fn contribution(satisfaction: f64, reputation: &Reputation) -> f64 {
    let weight = if satisfaction < 0.0 { reputation.negative_satisfaction_multiplier } else { 1.0 };
    reputation.base_rep_per_customer * weight * satisfaction
}

/// Returns the change in a group's reputation from today's contributions, before the threshold is applied: (sum / m)
/// log2(m), where m = max(count, 2).
pub fn daily_change_before_threshold(contribution: &ReputationContribution, reputation: &Reputation) -> f64 {
    let size = f64::from(contribution.count.max(reputation.min_group_size));
    contribution.sum / size * libm::log2(size)
}

/// Returns the daily change in a group's reputation, or `None` if the change is below the threshold.
pub fn daily_change(contribution: &ReputationContribution, reputation: &Reputation) -> Option<f64> {
    let change = daily_change_before_threshold(contribution, reputation);
    (change.abs() >= reputation.daily_delta_min_abs).then_some(change)
}

/// The spillover of a group's reputation change to another known group.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SpilloverEffect {
    /// The source group, whose reputation changed.
    pub from: Group,
    /// The group to which the change spills over.
    pub to: Group,
    /// Change in the source group's reputation from which the spillover is computed.
    pub source_change: f64,
    /// Weight of the source group for the affected group.
    pub weight: f64,
    /// Factor that applies to every spillover.
    pub factor: f64,
    /// Change in the affected group's reputation, which is applied if `counts` is true.
    pub change: f64,
    /// Whether the spillover is applied: the weight is positive and the change is large enough.
    pub counts: bool,
}

/// Returns the spillover of a group's reputation change to another group.
pub fn spillover_effect(change: f64, from: Group, to: Group, params: &Params) -> SpilloverEffect {
    let reputation = &params.reputation;
    let weight = params.reputation_weight(from, to);
    let (source_change, factor) = (change, reputation.cross_group_spillover_factor);
    let change = change * weight * factor;
    let change = if params.has_fault(Fault::SpillOverReversed) { -change } else { change };
    let counts = weight > 0.0 && change.abs() > reputation.cross_delta_min_abs;
    SpilloverEffect { from, to, source_change, weight, factor, change, counts }
}

/// Returns the factor of a single event's reputation damage: log2(k) / k, where k = max(subscribers, 2).
pub fn event_scale(subscribers: u32, reputation: &Reputation) -> f64 {
    let size = f64::from(subscribers.max(reputation.event_scale_min_group_size));
    libm::log2(size) / size
}

/// Returns the reputation damage of an individual's cancellation: 0.000375 (0.5 + U) (1 + 20 min(S, 0)^2) log2(k) / k.
pub fn cancel_damage(satisfaction: f64, subscribers: u32, u: f64, reputation: &Reputation) -> f64 {
    let bad = satisfaction.min(0.0);
    event_damage(subscribers, u, reputation)
        * (1.0 + reputation.cancel_negative_satisfaction_coef * bad * bad)
}

/// Returns the reputation damage of a lost enterprise, which has no satisfaction term.
pub fn event_damage(subscribers: u32, u: f64, reputation: &Reputation) -> f64 {
    reputation.reputation_quality_cancel_damage
        * (reputation.cancel_damage_noise_offset + u)
        * event_scale(subscribers, reputation)
}

/// Applies today's contributions to all reputations, and the spillover of each change to the other known groups.
pub fn apply_contributions(
    reputations: &mut Reputations,
    contributions: &ByGroup<ReputationContribution>,
    is_known: impl Fn(Group) -> bool,
    params: &Params,
    on_write: &mut OnReputationWrite<'_>,
) {
    let reputation = &params.reputation;
    for group in Group::all().filter(|group| contributions[*group].count > 0) {
        let Some(change) = daily_change(&contributions[group], reputation) else { continue };
        reputations.add_all(
            (group, ReputationCause::Contributions(contributions[group])),
            &[change],
            params,
            on_write,
        );
        if !is_known(group) {
            continue;
        }
        for other in Group::all().filter(|other| *other != group && is_known(*other)) {
            let spill = spillover_effect(change, group, other, params);
            if spill.counts {
                let (weight, factor) = (spill.weight, reputation.cross_group_spillover_factor);
                let cause = ReputationCause::Spillover(Spillover { source: group, change, weight, factor });
                reputations.add_all((other, cause), &[spill.change], params, on_write);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn group(id: &str) -> Group {
        Group::parse(id).expect("a group")
    }

    /// Returns the reputations after a day with the given `contributions`: group, number of subscribers, satisfaction.
    fn reputation_after(contributions: &[(&str, u32, f64)], start: f64, discovered: &[&str]) -> Reputations {
        let params = Params::bundled();
        let mut reputations = Reputations::initial(&params);
        let mut by_group = ByGroup::<ReputationContribution>::default();
        for &(id, count, satisfaction) in contributions {
            reputations.set(group(id), start);
            let total = &mut by_group[group(id)];
            total.count += count;
            for _ in 0..count {
                total.sum += contribution(satisfaction, &params.reputation);
            }
        }
        let known = |group: Group| group.is_initially_known() || discovered.contains(&group.id());
        apply_contributions(&mut reputations, &by_group, known, &params, &mut |_| {});
        reputations
    }

    fn assert_reputations(reputations: &Reputations, expected: &[(&str, f64)]) {
        for &(id, value) in expected {
            let actual = reputations.get(group(id));
            assert!((actual / value - 1.0).abs() < 1e-9, "{id}: got {actual}, expected {value}");
        }
    }

    #[test]
    fn contributions_change_a_group_and_spill_over() {
        assert_reputations(
            &reputation_after(&[("S1", 1000, 0.3)], 0.5, &[]),
            &[("S1", 0.501494867643), ("S3", 0.5), ("E1", 0.5)],
        );
        let unhappy = reputation_after(&[("S1", 1000, -0.3)], 0.5, &[]);
        assert_reputations(
            &unhappy,
            &[("S1", 0.497010264715), ("S3", 0.499865461912), ("S2", 0.5), ("E1", 0.5)],
        );
        let small = reputation_after(&[("S1", 1, 0.5), ("S2", 100, 0.001)], 0.5, &[]);
        assert_reputations(&small, &[("S1", 0.500125), ("S2", 0.5)]);
        assert_reputations(
            &reputation_after(&[("S1", 600, 0.2), ("S1", 400, -0.1)], 0.5, &[]),
            &[("S1", 0.500199315686)],
        );
        let crowd = reputation_after(&[("S1", 50_000, -1.2)], 0.5, &[]);
        assert_reputations(&crowd, &[("S1", 0.481268431431), ("S2", 0.499719026471), ("S3", 0.499157079414)]);
    }

    #[test]
    fn spillover_reaches_known_groups_only() {
        let reputations = reputation_after(&[("S3", 2000, -0.4)], 0.5, &["D_S07", "D_S05"]);
        let expected = [
            ("S3", 0.495613686286),
            ("S1", 0.499473642354),
            ("S2", 0.499684185413),
            ("E1", 0.49953943706),
            ("E2", 0.49953943706),
            ("E3", 0.499631549648),
            ("D_S05", 0.499526278119),
            ("D_S07", 0.499605231766),
            ("D_S06", 0.5),
        ];
        assert_reputations(&reputations, &expected);
    }

    #[test]
    fn reputation_is_clamped_with_a_minimum() {
        assert_reputations(&reputation_after(&[("S1", 1000, -3.0)], 0.002, &[]), &[("S1", 0.001)]);
        assert_reputations(&reputation_after(&[("S1", 1000, 3.0)], 0.9999, &[]), &[("S1", 1.0)]);
    }

    #[test]
    fn cancellation_damage_is_larger_in_small_groups() {
        let params = Params::bundled();
        let reputation = &params.reputation;
        for (count, scale) in [
            (0, 0.5),
            (1, 0.5),
            (2, 0.5),
            (10, 0.332192809489),
            (100, 0.066438561898),
            (1000, 0.009965784285),
            (5000, 0.00245754248),
            (100_000, 0.000166096405),
        ] {
            assert!((event_scale(count, reputation) - scale).abs() < 1e-11, "{count}");
        }
        for (satisfaction, count, u, damage) in [
            (-0.3, 1000, 0.5, 1.046407350e-5),
            (0.2, 1000, 0.5, 3.737169107e-6),
            (-1.0, 50, 0.0, 4.444536749e-4),
        ] {
            assert!((cancel_damage(satisfaction, count, u, reputation) / damage - 1.0).abs() < 1e-9);
        }
        let mut reputations = Reputations::initial(&params);
        reputations.add(group("S1"), -cancel_damage(-0.3, 10, 0.25, reputation), &params);
        assert_reputations(&reputations, &[("S1", 0.499738398)]);
    }

    #[test]
    fn lost_enterprise_damage_ignores_satisfaction() {
        let reputation = Params::bundled().reputation;
        for (count, low, middle) in [
            (1, 9.375e-5, 1.875e-4),
            (2, 9.375e-5, 1.875e-4),
            (10, 6.228615178e-5, 1.245723036e-4),
            (100, 1.245723036e-5, 2.491446071e-5),
        ] {
            assert!((event_damage(count, 0.0, &reputation) / low - 1.0).abs() < 1e-9);
            assert!((event_damage(count, 0.5, &reputation) / middle - 1.0).abs() < 1e-9);
        }
    }
}
