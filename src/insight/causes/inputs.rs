//! World inputs that differ between two weeks, and values at which a re-simulation fixes them.

use super::cause::{Cause, CauseDetail, InputDetail};
use crate::counterfactual::branch::BranchOutcome;
use crate::counterfactual::memory_snapshot::MemorySnapshot;
use novamind_world::events::DayFigures;
use novamind_world::fixed_inputs::FixedInputs;
use novamind_world::market::surges::surge_factor;
use novamind_world::product::service::FixedService;

/// Two consecutive recorded weeks: the state between the weeks and the results of each week.
pub(super) struct WeekPair<'a> {
    pub start: &'a MemorySnapshot,
    pub before: &'a BranchOutcome,
    pub after: &'a BranchOutcome,
}

impl WeekPair<'_> {
    fn days(&self) -> impl Iterator<Item = u32> + use<> {
        self.start.world.day + 1..=self.after.final_state.world.day
    }

    /// Returns the demand surge factors on the days of the explained week and of the previous week.
    fn surge_factors(&self) -> (Vec<f64>, Vec<f64>) {
        let start = self.start.params.fidelity.surge_start;
        let factor = |day, moment: &MemorySnapshot| surge_factor(day, &moment.world.market.surges, start);
        let week = self.start.params.run.days_per_week;
        let now = self.days().map(|day| factor(day, &self.after.final_state)).collect();
        (now, self.days().map(|day| factor(day - week, self.start)).collect())
    }

    /// Returns the day-of-month factors on the days of the explained week and of the previous week.
    fn month_day_factors(&self) -> (Vec<f64>, Vec<f64>) {
        let calendar = &self.start.params.calendar.monthly;
        let factor = |day: u32| calendar[day as usize % calendar.len()];
        let week = self.start.params.run.days_per_week;
        (self.days().map(factor).collect(), self.days().map(|day| factor(day - week)).collect())
    }

    pub(super) fn differing_inputs(&self) -> Vec<(Cause, Vec<CauseDetail>)> {
        let (eve, end) = (&self.start.world.market, &self.after.final_state.world.market);
        let mut found = Vec::new();
        let mut add_if_different = |cause, differs: bool, details: Vec<CauseDetail>| {
            if differs {
                found.push((cause, details));
            }
        };
        let input = |name, old, new| CauseDetail::Input(InputDetail { name, old, new, is_share: false });
        let share = |name, old, new| CauseDetail::Input(InputDetail { name, old, new, is_share: true });
        let moves = end.competitors.len() - eve.competitors.len();
        add_if_different(Cause::Competitors, moves > 0, vec![CauseDetail::Occurrences(moves, "move")]);
        let drift_params = &self.start.params.drift;
        let drift = self.days().any(|day| novamind_world::customers::drift::is_drift_day(day, drift_params));
        add_if_different(Cause::Drift, drift, vec![CauseDetail::Occurrences(1, "step")]);
        add_if_different(Cause::Yields, end.yields != eve.yields, Vec::new());
        let index = input("index", eve.economy.pmi, end.economy.pmi);
        add_if_different(Cause::Economy, eve.economy.pmi != end.economy.pmi, vec![index]);
        let (now, before) = self.surge_factors();
        add_if_different(Cause::Surges, now != before, vec![input("mean factor", mean(&before), mean(&now))]);
        let (now, before) = self.month_day_factors();
        add_if_different(
            Cause::Calendar,
            now != before,
            vec![input("mean factor", mean(&before), mean(&now))],
        );
        let service =
            |of: &BranchOutcome, read: fn(&DayFigures) -> f64| of.days.iter().map(read).fold(0.0, f64::max);
        let both = |read| (service(self.before, read), service(self.after, read));
        let (overload, outage) = (both(|day| day.overload), both(|day| f64::from(day.downtime_minutes)));
        let details = vec![
            share("peak overload", overload.0, overload.1),
            input("longest outage, minutes", outage.0, outage.1),
        ];
        add_if_different(Cause::Service, true, details);
        found
    }

    /// Returns the world inputs of `causes`, fixed at their values of the previous week. `undone` contains the days of
    /// the explained week, simulated without the player's calls. The fixed utilization follows from the usage on these
    /// days.
    pub(super) fn fix_inputs(
        &self,
        causes: impl Iterator<Item = Cause>,
        undone: &[DayFigures],
    ) -> FixedInputs {
        let mut fixed_inputs = FixedInputs { from: self.start.world.day + 1, ..FixedInputs::default() };
        for cause in causes {
            match cause {
                Cause::Competitors => fixed_inputs.competitors = true,
                Cause::Drift => fixed_inputs.drift = true,
                Cause::Yields => fixed_inputs.yields = true,
                Cause::Economy => fixed_inputs.economy = true,
                Cause::Surges => fixed_inputs.surges = self.surge_factors().1,
                Cause::Calendar => fixed_inputs.month_days = self.month_day_factors().1,
                Cause::Service => fixed_inputs.service = self.fix_service(undone),
                _ => {}
            }
        }
        fixed_inputs
    }

    /// Returns, for each day of the explained week, the factor that scales the load to the usage of the same weekday
    /// of the previous week. The random draws also come from that earlier day.
    fn fix_service(&self, undone: &[DayFigures]) -> Vec<FixedService> {
        let week = self.start.params.run.days_per_week;
        let used = |days: &[DayFigures], wanted: u32| {
            days.iter().find(|day| day.day == wanted).map_or(0, |day| day.total_usage)
        };
        let on = |day: u32| {
            let (before, now) = (used(&self.before.days, day - week), used(undone, day));
            let load = if now == 0 { 1.0 } else { before as f64 / now as f64 };
            FixedService { load_factor: load, draw_day: day - week }
        };
        self.days().map(on).collect()
    }
}

fn mean(factors: &[f64]) -> f64 {
    factors.iter().sum::<f64>() / factors.len().max(1) as f64
}
