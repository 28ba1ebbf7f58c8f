//! The figures of simulated days, for conditions.

use std::sync::{Mutex, MutexGuard, PoisonError};

use novamind_record::figures::MeasuredGroup;
use novamind_session::GroupWeek;
use novamind_session::engine::{count_groups, measured_group};
use novamind_world::customers::drift::is_drift_day;
use novamind_world::day::watch::DayWatch;
use novamind_world::events::{DayFigures, Facts};
use novamind_world::identifiers::{ByGroup, Group};
use novamind_world::market::surges::surge_factor;
use novamind_world::params::Params;
use novamind_world::state::World;

#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct MeasuredDay {
    pub(crate) figures: DayFigures,
    pub(crate) groups: ByGroup<MeasuredGroup>,
    pub(crate) rival: bool,
    /// Whether drift was applied.
    pub(crate) drift: bool,
    /// Whether a demand surge is active.
    pub(crate) surge: bool,
}

impl MeasuredDay {
    fn of(world: &World, params: &Params, facts: &Facts, figures: &DayFigures) -> MeasuredDay {
        let mut counted = ByGroup::<GroupWeek>::default();
        count_groups(&mut counted, figures, facts, world);
        let surge = surge_factor(world.day, &world.market.surges, params.fidelity.surge_start);
        MeasuredDay {
            figures: *figures,
            groups: ByGroup::from_fn(|group| measured_group(group, &counted[group], world)),
            rival: world.market.competitors.last().is_some_and(|event| event.day == world.day),
            drift: is_drift_day(world.day, &params.drift),
            surge: surge > 1.0,
        }
    }

    /// Number of active subscribers with an open issue.
    pub(crate) fn open_issues(&self) -> u32 {
        Group::all().map(|group| self.groups[group].open_issues).sum()
    }
}

/// Records the figures of consecutive days from day 1.
#[derive(Debug, Default)]
pub(crate) struct Series {
    pages: Mutex<SeriesPages>,
}

#[derive(Debug, Default)]
struct SeriesPages {
    days: Vec<MeasuredDay>,
    today: DayFigures,
}

impl Series {
    /// Calls a function with the days from day 1.
    pub(crate) fn read<R>(&self, work: impl FnOnce(&[MeasuredDay]) -> R) -> R {
        work(&self.pages().days)
    }

    /// Returns the last recorded day, or 0.
    pub(crate) fn last_day(&self) -> u32 {
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
        // Days without an observer leave a gap, which is re-simulated before the figures are used.
        if pages.days.len() as u32 + 1 == world.day {
            let today = MeasuredDay::of(world, params, facts, &pages.today);
            pages.days.push(today);
        }
    }
}
