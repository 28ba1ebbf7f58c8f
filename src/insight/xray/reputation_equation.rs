//! What moved the reputation of a group on a day, and how the change of each group spilled over to the others.

use serde::Serialize;

use novamind_world::identifiers::{ByGroup, Group};
use novamind_world::market::Market;
use novamind_world::params::Params;
use novamind_world::reputation::{
    Mood, ReputationBook, ReputationCause, ReputationWrite, Spill, called_change, daily_change, spill,
};

/// Departures of a day and what they took.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Departures {
    /// How many did harm; lost companies count for each of their threads.
    pub count: u32,
    /// What they did to the reputation; not positive.
    pub change: f64,
}

/// What the subscribers of a group contributed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OwnChange {
    /// How many they were.
    pub subscribers: u32,
    /// The change that their satisfaction called for.
    pub called: f64,
    /// Whether it was large enough to be made.
    pub counts: bool,
}

impl OwnChange {
    /// The change that was made.
    pub fn made(&self) -> f64 {
        if self.counts { self.called } else { 0.0 }
    }
}

/// Below what a change is dropped.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LeastChanges {
    /// A contribution below it, in size.
    pub own: f64,
    /// A spill up to it, in size.
    pub spill: f64,
}

/// Reputations of all groups on a day.
#[derive(Debug, Clone, Default)]
pub(crate) struct ReputationDay {
    before: ByGroup<f64>,
    gave_up: ByGroup<Departures>,
    lost: ByGroup<Departures>,
    own: ByGroup<OwnChange>,
    /// Where there is a weight, in the order in which they were made.
    spills: Vec<Spill>,
    bounds: ByGroup<f64>,
    after: ByGroup<f64>,
    least: LeastChanges,
}

impl ReputationDay {
    /// A day that finds these reputations.
    pub(crate) fn in_the_morning(book: &ReputationBook) -> ReputationDay {
        ReputationDay { before: ByGroup::from_fn(|group| book.of(group)), ..ReputationDay::default() }
    }

    /// Counts what a mechanism wrote.
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

    /// Ends with what subscribers contributed, what is dropped of it as well.
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
    /// Reputation in the morning.
    pub before: f64,
    /// Individuals who found nothing acceptable.
    pub gave_up: Departures,
    /// Companies that were lost.
    pub lost: Departures,
    /// What its subscribers contributed.
    pub own: OwnChange,
    /// What changes of other groups did to it, or would have done had they not been dropped.
    pub spills: Vec<Spill>,
    /// What the floor and the ceiling added.
    pub bounds: f64,
    /// Reputation in the evening.
    pub after: f64,
    /// That of the evenings up to this one, at most 28, the first one first.
    pub evenings: Vec<f64>,
    /// Below what changes are dropped.
    pub least: LeastChanges,
}

impl ReputationEquation {
    /// The group on a day, with its reputation of evenings.
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

    /// What the terms come to.
    pub fn sum(&self) -> f64 {
        let spills: f64 = self.spills.iter().filter(|spill| spill.counts).map(|spill| spill.change).sum();
        self.before + self.gave_up.change + self.lost.change + self.own.made() + spills + self.bounds
    }
}

/// How the changes of a day spilled over: from each known group to each other one.
#[derive(Debug, Clone, PartialEq)]
pub struct Spillover {
    /// The day, from 1.
    pub day: u32,
    /// The groups that were known.
    pub known: Vec<Group>,
    /// What the subscribers of each group contributed.
    pub own: ByGroup<OwnChange>,
    /// Spills where there is a weight, those that were dropped too.
    pub spills: Vec<Spill>,
    /// Below what changes are dropped.
    pub least: LeastChanges,
}

impl Spillover {
    /// A day on which some groups were known.
    pub(crate) fn of(day: u32, known: &ByGroup<bool>, seen: ReputationDay) -> Spillover {
        let known = Group::all().filter(|group| known[*group]).collect();
        let ReputationDay { own, spills, least, .. } = seen;
        Spillover { day, known, own, spills, least }
    }

    /// What the change of a group did to another one; none without a weight or a change.
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
        // Nothing is delivered any more, and prices rise: everybody is unhappy, and many leave.
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
