//! The figures of every day that was simulated, as conditions read them.

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

/// Figures of a day.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct MeasuredDay {
    /// Those of the company.
    pub(crate) figures: DayFigures,
    /// Those of the groups.
    pub(crate) groups: ByGroup<MeasuredGroup>,
    /// Whether rivals moved.
    pub(crate) rival: bool,
    /// Whether expectations drifted.
    pub(crate) drift: bool,
    /// Whether a demand surge acts.
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

    /// Active subscribers with an open issue.
    pub(crate) fn open_issues(&self) -> u32 {
        Group::all().map(|group| self.groups[group].open_issues).sum()
    }
}

/// Keeps the figures of days, without a gap from day 1.
#[derive(Debug, Default)]
pub(crate) struct Series {
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
    pub(crate) fn read<R>(&self, work: impl FnOnce(&[MeasuredDay]) -> R) -> R {
        work(&self.pages().days)
    }

    /// The last day that is there; 0 before the first.
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
        // After days that nobody watched there is a gap: what lacks is simulated again before anything is read.
        if pages.days.len() as u32 + 1 == world.day {
            let today = MeasuredDay::of(world, params, facts, &pages.today);
            pages.days.push(today);
        }
    }
}
