//! The figures of every day that was simulated, as conditions read them.

use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::session::figures::groups::{self, GroupWeek};
use crate::session::xray::mood::mood_of;
use crate::world::customers::columns::Block;
use crate::world::day::watch::DayWatch;
use crate::world::events::{DayFigures, Facts};
use crate::world::identifiers::{ByGroup, Group};
use crate::world::market::drift::is_drift_day;
use crate::world::market::surges::surge_factor;
use crate::world::params::Params;
use crate::world::state::World;

/// Figures of a group on a day.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(in crate::session) struct MeasuredGroup {
    /// Customers who came.
    pub(in crate::session) leads: u32,
    /// Individuals who signed up, or companies whose first deal was accepted.
    pub(in crate::session) signed: u32,
    /// Subscribers who cancelled.
    pub(in crate::session) left: u32,
    /// Units used.
    pub(in crate::session) usage: u64,
    /// Active subscriptions at the end of the day.
    pub(in crate::session) subscribers: u32,
    /// Those of them with an open issue.
    pub(in crate::session) open_issues: u32,
    /// Reputation at the end of the day.
    pub(in crate::session) reputation: f64,
    /// Mean satisfaction of the subscribers; none without any.
    pub(in crate::session) satisfaction: Option<f64>,
    /// Mean relationship of the subscribers, 0..=1; none without any.
    pub(in crate::session) relationship: Option<f64>,
}

/// Figures of a day.
#[derive(Debug, Clone, PartialEq, Default)]
pub(in crate::session) struct MeasuredDay {
    /// Those of the company.
    pub(in crate::session) figures: DayFigures,
    /// Those of the groups.
    pub(in crate::session) groups: ByGroup<MeasuredGroup>,
    /// Whether rivals moved.
    pub(in crate::session) rival: bool,
    /// Whether expectations drifted.
    pub(in crate::session) drift: bool,
    /// Whether a demand surge acts.
    pub(in crate::session) surge: bool,
}

impl MeasuredDay {
    fn of(world: &World, params: &Params, facts: &Facts, figures: &DayFigures) -> MeasuredDay {
        let mut counted = ByGroup::<GroupWeek>::default();
        groups::count(&mut counted, figures, facts, world);
        let surge = surge_factor(world.day, &world.market.surges, params.fidelity.surge_start);
        MeasuredDay {
            figures: *figures,
            groups: ByGroup::from_fn(|group| measured_group(group, &counted[group], world)),
            rival: world.market.competitors.last().is_some_and(|event| event.day == world.day),
            drift: is_drift_day(world.day, &params.drift),
            surge: surge > 1.0,
        }
    }

    /// Active subscribers with an open issue.
    pub(in crate::session) fn open_issues(&self) -> u32 {
        Group::all().map(|group| self.groups[group].open_issues).sum()
    }
}

fn measured_group(group: Group, counted: &GroupWeek, world: &World) -> MeasuredGroup {
    let (satisfaction, relationship) = mood_of(world, group).unzip();
    let own = &world.customers.groups[group];
    MeasuredGroup {
        leads: counted.leads,
        signed: counted.signed,
        left: counted.left,
        usage: counted.usage.0.iter().sum(),
        subscribers: own.active(),
        open_issues: own.blocks.iter().map(Block::open_issues).sum(),
        reputation: world.market.reputation.of(group),
        satisfaction,
        relationship,
    }
}

/// Keeps the figures of days, without a gap from day 1.
#[derive(Debug, Default)]
pub(in crate::session) struct Series {
    pages: Mutex<SeriesPages>,
}

#[derive(Debug, Default)]
struct SeriesPages {
    days: Vec<MeasuredDay>,
    /// Figures of the day that is simulated.
    today: DayFigures,
}

impl Series {
    /// Reads the days, day 1 first.
    pub(in crate::session) fn read<R>(&self, work: impl FnOnce(&[MeasuredDay]) -> R) -> R {
        work(&self.pages().days)
    }

    /// The last day that is there; 0 before the first.
    pub(in crate::session) fn last_day(&self) -> u32 {
        self.pages().days.len() as u32
    }

    fn pages(&self) -> MutexGuard<'_, SeriesPages> {
        self.pages.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl DayWatch for Series {
    fn day_counted(&self, figures: &DayFigures) {
        self.pages().today = *figures;
    }

    fn day_over(&self, world: &World, params: &Params, facts: &Facts) {
        let mut pages = self.pages();
        // After days that nobody watched there is a gap: what lacks is simulated again before anything is read.
        if pages.days.len() as u32 + 1 == world.day {
            let today = MeasuredDay::of(world, params, facts, &pages.today);
            pages.days.push(today);
        }
    }
}
