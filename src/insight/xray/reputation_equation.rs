//! The reputation equation of a group on a day, and the spillover of changes between groups.

use serde::Serialize;

use novamind_world::identifiers::{ByGroup, Group};
use novamind_world::market::Market;
use novamind_world::params::Params;
use novamind_world::reputation::{
    Mood, ReputationBook, ReputationCause, ReputationWrite, Spill, called_change, daily_change, spill,
};

/// The cancellations of a day and their effect.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Departures {
    /// Number of cancellations with an effect; a lost enterprise counts once for each thread.
    pub count: u32,
    /// Change of the reputation; not positive.
    pub change: f64,
}

/// The contribution of a group's subscribers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OwnChange {
    /// Number of subscribers.
    pub subscribers: u32,
    /// Change by their satisfaction before the threshold.
    pub called: f64,
    /// Whether the change reached the threshold and was applied.
    pub counts: bool,
}

impl OwnChange {
    /// Returns the applied change.
    pub fn made(&self) -> f64 {
        if self.counts { self.called } else { 0.0 }
    }
}

/// Thresholds below which changes are dropped.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LeastChanges {
    /// A contribution is dropped if its absolute value is below this.
    pub own: f64,
    /// A spillover is dropped if its absolute value is not above this.
    pub spill: f64,
}

#[derive(Debug, Clone, Default)]
pub(crate) struct ReputationDay {
    before: ByGroup<f64>,
    gave_up: ByGroup<Departures>,
    lost: ByGroup<Departures>,
    own: ByGroup<OwnChange>,
    /// Spillovers with a weight, in order.
    spills: Vec<Spill>,
    bounds: ByGroup<f64>,
    after: ByGroup<f64>,
    least: LeastChanges,
}

impl ReputationDay {
    pub(crate) fn in_the_morning(book: &ReputationBook) -> ReputationDay {
        ReputationDay { before: ByGroup::from_fn(|group| book.of(group)), ..ReputationDay::default() }
    }

    /// Adds a write of a mechanism.
    pub(crate) fn count(&mut self, write: &ReputationWrite<'_>) {
        let group = write.group;
        let without_bounds = write.changes.iter().fold(write.before, |value, change| value + change);
        self.bounds[group] += write.after - without_bounds;
        let departures = match write.cause {
            ReputationCause::Departures => &mut self.gave_up[group],
            ReputationCause::LostCompany => &mut self.lost[group],
            ReputationCause::Mood(_) | ReputationCause::SpillOver(_) => return,
        };
        departures.count += write.changes.len() as u32;
        departures.change += write.changes.iter().sum::<f64>();
    }

    /// Adds the contributions of subscribers, including dropped ones.
    pub(crate) fn settle(&mut self, moods: &ByGroup<Mood>, market: &Market, params: &Params) {
        let law = &params.reputation;
        self.least = LeastChanges { own: law.daily_delta_min_abs, spill: law.cross_delta_min_abs };
        self.after = ByGroup::from_fn(|group| market.reputation.of(group));
        for group in Group::all().filter(|group| moods[*group].count > 0) {
            let (mood, change) = (&moods[group], daily_change(&moods[group], law));
            let called = called_change(mood, law);
            self.own[group] = OwnChange { subscribers: mood.count, called, counts: change.is_some() };
            let Some(change) = change.filter(|_| market.is_known(group)) else { continue };
            let others = Group::all().filter(|other| *other != group && market.is_known(*other));
            let spills = others.map(|other| spill(change, group, other, params));
            self.spills.extend(spills.filter(|spill| spill.weight > 0.0));
        }
    }
}

/// The reputation of a group on a day: before + departures + own contribution + spills + bounds = after.
#[derive(Debug, Clone, PartialEq)]
pub struct ReputationEquation {
    /// The group.
    pub group: Group,
    /// The day, from 1.
    pub day: u32,
    /// Reputation at the start of the day.
    pub before: f64,
    /// Cancellations of individuals without an acceptable plan.
    pub gave_up: Departures,
    /// Lost enterprises.
    pub lost: Departures,
    /// Contribution of its subscribers.
    pub own: OwnChange,
    /// Spillovers from other groups, including dropped ones.
    pub spills: Vec<Spill>,
    /// Effect of the lower and upper limit.
    pub bounds: f64,
    /// Reputation at the end of the day.
    pub after: f64,
    /// Reputation at the end of up to 28 days, in ascending order; this day is last.
    pub evenings: Vec<f64>,
    /// Thresholds below which changes are dropped.
    pub least: LeastChanges,
}

impl ReputationEquation {
    pub(crate) fn of(group: Group, day: u32, seen: &ReputationDay, evenings: Vec<f64>) -> ReputationEquation {
        ReputationEquation {
            group,
            day,
            before: seen.before[group],
            gave_up: seen.gave_up[group],
            lost: seen.lost[group],
            own: seen.own[group],
            spills: seen.spills.iter().copied().filter(|spill| spill.to == group).collect(),
            bounds: seen.bounds[group],
            after: seen.after[group],
            evenings,
            least: seen.least,
        }
    }

    /// Returns the sum of the terms.
    pub fn sum(&self) -> f64 {
        let spills: f64 = self.spills.iter().filter(|spill| spill.counts).map(|spill| spill.change).sum();
        self.before + self.gave_up.change + self.lost.change + self.own.made() + spills + self.bounds
    }
}

/// The spillover of a day between discovered groups.
#[derive(Debug, Clone, PartialEq)]
pub struct Spillover {
    /// The day, from 1.
    pub day: u32,
    /// Discovered groups.
    pub known: Vec<Group>,
    /// Contribution of each group's subscribers.
    pub own: ByGroup<OwnChange>,
    /// Spillovers with a weight, including dropped ones.
    pub spills: Vec<Spill>,
    /// Thresholds below which changes are dropped.
    pub least: LeastChanges,
}

impl Spillover {
    pub(crate) fn of(day: u32, known: &ByGroup<bool>, seen: ReputationDay) -> Spillover {
        let known = Group::all().filter(|group| known[*group]).collect();
        let ReputationDay { own, spills, least, .. } = seen;
        Spillover { day, known, own, spills, least }
    }

    /// Returns the spillover from one group to another; `None` without a weight or a change.
    pub fn between(&self, from: Group, to: Group) -> Option<Spill> {
        self.spills.iter().copied().find(|spill| spill.from == from && spill.to == to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::xray::hidden_day::Diary;
    use novamind_world::day::step_day_watched;
    use novamind_world::events::Facts;
    use novamind_world::held::Held;
    use novamind_world::random::Streams;
    use novamind_world::state::World;

    #[test]
    fn the_floor_is_a_term_of_its_own() {
        let (params, streams) = (Params::shipped(), Streams::new(5));
        let mut facts = Facts::default();
        let mut world = World::open(500, 1e9, &params, &mut facts);
        novamind_world::test_kit::policy_p(&mut world);
        let diary = Diary::default();
        let mut day = |world: &mut World| {
            step_day_watched(world, &params, &streams, &Held::default(), &mut facts, &diary);
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
        let own = ReputationEquation::of(s1, world.day, &seen, Vec::new());
        assert_eq!((own.before, own.after), (0.0011, params.reputation.reputation_floor));
        assert_eq!(own.after.to_bits(), world.market.reputation.of(s1).to_bits());
        assert!(own.own.called < 0.0 && own.bounds > 1e-6, "{own:?}");
        assert!((own.sum() - own.after).abs() < 1e-12, "{own:?}");
    }
}
