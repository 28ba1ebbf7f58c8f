//! The recorded figures of simulated days, for conditions.

use std::sync::{Mutex, MutexGuard, PoisonError};

use novamind_record::figures::GroupFigures;
use novamind_session::GroupWeek;
use novamind_session::engine::{add_day_to_week, measure_group};
use novamind_world::customers::drift::is_drift_day;
use novamind_world::day::observer::DayObserver;
use novamind_world::events::{DayFigures, Facts};
use novamind_world::identifiers::{ByGroup, Group};
use novamind_world::market::surges::surge_factor;
use novamind_world::params::Params;
use novamind_world::state::World;

#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct MeasuredDay {
    pub(crate) figures: DayFigures,
    pub(crate) groups: ByGroup<GroupFigures>,
    pub(crate) has_competitor_move: bool,
    /// Whether drift was applied on the day.
    pub(crate) has_drift: bool,
    /// Whether a demand surge is active on the day.
    pub(crate) has_surge: bool,
}

impl MeasuredDay {
    fn new(world: &World, params: &Params, facts: &Facts, figures: &DayFigures) -> MeasuredDay {
        let mut counted = ByGroup::<GroupWeek>::default();
        add_day_to_week(&mut counted, figures, facts, world);
        let surge = surge_factor(world.day, &world.market.surges, params.fidelity.surge_start);
        MeasuredDay {
            figures: *figures,
            groups: ByGroup::from_fn(|group| measure_group(group, &counted[group], world)),
            has_competitor_move: world.market.competitors.last().is_some_and(|event| event.day == world.day),
            has_drift: is_drift_day(world.day, &params.drift),
            has_surge: surge > 1.0,
        }
    }

    /// Returns the number of active subscribers with an open issue.
    pub(crate) fn open_issues(&self) -> u32 {
        Group::all().map(|group| self.groups[group].open_issues).sum()
    }
}

/// The recorded figures of consecutive days, from day 1.
#[derive(Debug, Default)]
pub(crate) struct MeasuredDays {
    recorded: Mutex<RecordedMeasurements>,
}

#[derive(Debug, Default)]
struct RecordedMeasurements {
    days: Vec<MeasuredDay>,
    today: DayFigures,
}

impl MeasuredDays {
    /// Calls `work` with the recorded days, which start with day 1.
    pub(crate) fn with_days<R>(&self, work: impl FnOnce(&[MeasuredDay]) -> R) -> R {
        work(&self.lock().days)
    }

    /// Returns the last recorded day, or 0.
    pub(crate) fn last_day(&self) -> u32 {
        self.lock().days.len() as u32
    }

    fn lock(&self) -> MutexGuard<'_, RecordedMeasurements> {
        self.recorded.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl DayObserver for MeasuredDays {
    fn on_day_figures(&self, figures: &DayFigures) {
        self.lock().today = *figures;
    }

    fn on_day_end(&self, world: &World, params: &Params, facts: &Facts) {
        let mut pages = self.lock();
        // Days without an observer leave a gap, which is re-simulated before the figures are used.
        if pages.days.len() as u32 + 1 == world.day {
            let today = MeasuredDay::new(world, params, facts, &pages.today);
            pages.days.push(today);
        }
    }
}
