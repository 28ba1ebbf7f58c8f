//! The reputation equation of a group on a day, and the spillover of changes between groups.

use serde::Serialize;

use novamind_world::identifiers::{ByGroup, Group};
use novamind_world::market::Market;
use novamind_world::params::Params;
use novamind_world::reputation::{
    ReputationCause, ReputationContribution, ReputationWrite, Reputations, SpilloverEffect, daily_change,
    daily_change_before_threshold, spillover_effect,
};

/// The cancellations of a day and their effect on reputation.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct CancellationEffect {
    /// Number of cancellations that changed reputation. A lost enterprise counts once for each thread.
    pub count: u32,
    /// Change in reputation; never positive.
    pub change: f64,
}

/// The contribution of a group's subscribers to the reputation in the group.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SubscriberContribution {
    /// Number of contributing subscribers.
    pub subscribers: u32,
    /// Change due to the subscribers' satisfaction, before the threshold is applied.
    pub requested_change: f64,
    /// Whether the change reached the threshold and was therefore applied.
    pub is_applied: bool,
}

impl SubscriberContribution {
    /// Returns the change in reputation, or 0 if the change was below the threshold.
    pub fn applied_change(&self) -> f64 {
        if self.is_applied { self.requested_change } else { 0.0 }
    }
}

/// Thresholds below which changes are dropped.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ChangeThresholds {
    /// Smallest absolute value of a contribution that is applied.
    pub subscriber_contribution: f64,
    /// Largest absolute value of a spillover that is dropped.
    pub spillover: f64,
}

#[derive(Debug, Clone, Default)]
pub(crate) struct ReputationDay {
    before: ByGroup<f64>,
    individual_departures: ByGroup<CancellationEffect>,
    enterprise_departures: ByGroup<CancellationEffect>,
    contributions: ByGroup<SubscriberContribution>,
    /// Spillovers with a positive weight, in the order in which they occurred.
    spillovers: Vec<SpilloverEffect>,
    bounds: ByGroup<f64>,
    after: ByGroup<f64>,
    thresholds: ChangeThresholds,
}

impl ReputationDay {
    pub(crate) fn at_start_of_day(reputations: &Reputations) -> ReputationDay {
        ReputationDay { before: ByGroup::from_fn(|group| reputations.get(group)), ..ReputationDay::default() }
    }

    /// Adds a change in reputation that a mechanism made.
    pub(crate) fn add_change(&mut self, write: &ReputationWrite<'_>) {
        let group = write.group;
        let without_bounds = write.changes.iter().fold(write.before, |value, change| value + change);
        self.bounds[group] += write.after - without_bounds;
        let departures = match write.cause {
            ReputationCause::Cancellations => &mut self.individual_departures[group],
            ReputationCause::LostEnterprise => &mut self.enterprise_departures[group],
            ReputationCause::Contributions(_) | ReputationCause::Spillover(_) => return,
        };
        departures.count += write.changes.len() as u32;
        departures.change += write.changes.iter().sum::<f64>();
    }

    /// Adds the contributions of subscribers, including dropped contributions.
    pub(crate) fn add_subscriber_contributions(
        &mut self,
        contributions: &ByGroup<ReputationContribution>,
        market: &Market,
        params: &Params,
    ) {
        let reputation = &params.reputation;
        self.thresholds = ChangeThresholds {
            subscriber_contribution: reputation.daily_delta_min_abs,
            spillover: reputation.cross_delta_min_abs,
        };
        self.after = ByGroup::from_fn(|group| market.reputation.get(group));
        for group in Group::all().filter(|group| contributions[*group].count > 0) {
            let (contribution, change) =
                (&contributions[group], daily_change(&contributions[group], reputation));
            let called = daily_change_before_threshold(contribution, reputation);
            self.contributions[group] = SubscriberContribution {
                subscribers: contribution.count,
                requested_change: called,
                is_applied: change.is_some(),
            };
            let Some(change) = change.filter(|_| market.is_known(group)) else { continue };
            let others = Group::all().filter(|other| *other != group && market.is_known(*other));
            let spills = others.map(|other| spillover_effect(change, group, other, params));
            self.spillovers.extend(spills.filter(|spill| spill.weight > 0.0));
        }
    }
}

/// The reputation of a group on a day: before + departures + contribution + spillovers + bounds = after.
#[derive(Debug, Clone, PartialEq)]
pub struct ReputationEquation {
    /// Group whose reputation is described.
    pub group: Group,
    /// Day of the equation, from 1.
    pub day: u32,
    /// Reputation at the start of the day.
    pub before: f64,
    /// Effect of cancellations by individuals who had no acceptable plan.
    pub individual_departures: CancellationEffect,
    /// Effect of lost enterprises.
    pub enterprise_departures: CancellationEffect,
    /// Contribution of the group's subscribers.
    pub contribution: SubscriberContribution,
    /// Spillovers from other groups, including dropped spillovers.
    pub spillovers: Vec<SpilloverEffect>,
    /// Change due to the lower and upper limits of reputation.
    pub bounds: f64,
    /// Reputation at the end of the day.
    pub after: f64,
    /// Reputation at the end of each of up to 28 days, earliest day first. The last value belongs to the day of the
    /// equation.
    pub recent_days: Vec<f64>,
    /// Thresholds below which changes are dropped.
    pub thresholds: ChangeThresholds,
}

impl ReputationEquation {
    pub(crate) fn new(
        group: Group,
        day: u32,
        seen: &ReputationDay,
        recent_days: Vec<f64>,
    ) -> ReputationEquation {
        ReputationEquation {
            group,
            day,
            before: seen.before[group],
            individual_departures: seen.individual_departures[group],
            enterprise_departures: seen.enterprise_departures[group],
            contribution: seen.contributions[group],
            spillovers: seen.spillovers.iter().copied().filter(|spill| spill.to == group).collect(),
            bounds: seen.bounds[group],
            after: seen.after[group],
            recent_days,
            thresholds: seen.thresholds,
        }
    }

    /// Returns the sum of the reputation terms.
    pub fn total(&self) -> f64 {
        let spills: f64 = self.spillovers.iter().filter(|spill| spill.counts).map(|spill| spill.change).sum();
        self.before
            + self.individual_departures.change
            + self.enterprise_departures.change
            + self.contribution.applied_change()
            + spills
            + self.bounds
    }
}

/// The spillover of reputation between discovered groups on a day.
#[derive(Debug, Clone, PartialEq)]
pub struct Spillover {
    /// Day of the spillover, from 1.
    pub day: u32,
    /// Groups that are discovered on the day.
    pub known_groups: Vec<Group>,
    /// Contribution of the subscribers of each group.
    pub contributions: ByGroup<SubscriberContribution>,
    /// Spillovers with a positive weight, including dropped spillovers.
    pub spillovers: Vec<SpilloverEffect>,
    /// Thresholds below which changes are dropped.
    pub thresholds: ChangeThresholds,
}

impl Spillover {
    pub(crate) fn new(day: u32, known: &ByGroup<bool>, seen: ReputationDay) -> Spillover {
        let known = Group::all().filter(|group| known[*group]).collect();
        let ReputationDay {
            contributions: subscriber_contributions,
            spillovers: spills,
            thresholds: least,
            ..
        } = seen;
        Spillover {
            day,
            known_groups: known,
            contributions: subscriber_contributions,
            spillovers: spills,
            thresholds: least,
        }
    }

    /// Returns the spillover from one group to another, or `None` if there is no weight or no change.
    pub fn spillover_between(&self, from: Group, to: Group) -> Option<SpilloverEffect> {
        self.spillovers.iter().copied().find(|spill| spill.from == from && spill.to == to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspection::hidden_day::HiddenDayRecorder;
    use novamind_world::day::step_day_observed;
    use novamind_world::events::Facts;
    use novamind_world::fixed_inputs::FixedInputs;
    use novamind_world::random::Streams;
    use novamind_world::state::World;

    #[test]
    fn reputation_floor_is_a_separate_term() {
        let (params, streams) = (Params::bundled(), Streams::new(5));
        let mut facts = Facts::default();
        let mut world = World::new(500, 1e9, &params, &mut facts);
        novamind_world::test_kit::apply_policy_p(&mut world);
        let diary = HiddenDayRecorder::default();
        let mut day = |world: &mut World| {
            step_day_observed(world, &params, &streams, &FixedInputs::default(), &mut facts, &diary);
        };
        (0..80).for_each(|_| day(&mut world));
        // Zero quality and higher prices cause low satisfaction and many cancellations.
        world.settings.core.prices.0 = [90.0, 190.0, 390.0];
        world.settings.core.capacity_tier = 0;
        (0..30).for_each(|_| day(&mut world));
        let s1 = Group::parse("S1").expect("a group");
        world.market.reputation.set(s1, 0.0011);
        day(&mut world);
        let seen = diary.day(world.day).expect("a day").reputation;
        let reputation_equation = ReputationEquation::new(s1, world.day, &seen, Vec::new());
        assert_eq!(
            (reputation_equation.before, reputation_equation.after),
            (0.0011, params.reputation.reputation_floor)
        );
        assert_eq!(reputation_equation.after.to_bits(), world.market.reputation.get(s1).to_bits());
        assert!(
            reputation_equation.contribution.requested_change < 0.0 && reputation_equation.bounds > 1e-6,
            "{reputation_equation:?}"
        );
        assert!(
            (reputation_equation.total() - reputation_equation.after).abs() < 1e-12,
            "{reputation_equation:?}"
        );
    }
}
