//! Breakpoints of a debug run, and simulation until the first breakpoint becomes true.

use std::ops::RangeInclusive;
use std::sync::Arc;

use super::condition::{Condition, ConditionState};
use super::list::Breakpoint;
use super::measured_days::MeasuredDays;
use crate::inspection::inspector::Inspector;
use novamind_session::{DayReport, InspectionPermit, ObservedDays, WeekResult};
use novamind_tools::Rejection;

/// A breakpoint whose condition became true.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BreakpointHit {
    /// The breakpoint, with its number and condition.
    pub breakpoint: Breakpoint,
    /// State of the condition on the evaluated day.
    pub state: ConditionState,
}

/// The simulated days and the breakpoints that stopped the simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct BreakpointRun {
    /// Day at the end of which the simulation started; the next day is the first simulated day.
    pub from: u32,
    /// Figures of the last week, and notifications of all days.
    pub week: WeekResult,
    /// Breakpoints that became true on the last day; empty if the simulation stopped for another reason.
    pub hits: Vec<BreakpointHit>,
    /// Breakpoints that were already true when they were first evaluated, and did not become true later.
    pub still_true: Vec<StillTrueBreakpoint>,
}

/// A breakpoint that was already true when it was first evaluated, and did not become true later.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StillTrueBreakpoint {
    /// The breakpoint with its state on the last day.
    pub hit: BreakpointHit,
    /// Last simulated day on which the condition was true.
    pub last_true_day: u32,
    /// Day on which the first value of a figure over several days satisfied the condition; `None` if the condition was
    /// true before the simulated days.
    pub first_value_day: Option<u32>,
}

impl Inspector<'_> {
    /// Returns all breakpoints of the run.
    ///
    /// # Errors
    /// `not_in_this_mode`.
    pub fn breakpoints(&self) -> Result<Vec<Breakpoint>, Rejection> {
        self.run.check_inspection()?;
        Ok(self.cache.breakpoints.all().to_vec())
    }

    /// Sets a breakpoint. A breakpoint reveals no hidden state, so no inspection is recorded.
    ///
    /// # Errors
    /// `not_in_this_mode`.
    pub fn set_breakpoint(&mut self, condition: Condition) -> Result<Breakpoint, Rejection> {
        self.run.check_inspection()?;
        Ok(self.cache.breakpoints.set(condition))
    }

    /// Removes and returns the breakpoint with the given number, or all breakpoints.
    ///
    /// # Errors
    /// `not_in_this_mode`, `breakpoint_unknown`.
    pub fn clear_breakpoints(&mut self, number: Option<u32>) -> Result<Vec<Breakpoint>, Rejection> {
        self.run.check_inspection()?;
        let Some(number) = number else { return Ok(self.cache.breakpoints.clear_all()) };
        match self.cache.breakpoints.clear(number) {
            Some(breakpoint) => Ok(vec![breakpoint]),
            None => Err(self.unknown_breakpoint_rejection(number)),
        }
    }

    pub(crate) fn unknown_breakpoint_rejection(&self, number: u32) -> Rejection {
        let numbers: Vec<String> =
            self.cache.breakpoints.all().iter().map(|breakpoint| breakpoint.number.to_string()).collect();
        let message = match numbers.is_empty() {
            true => format!("there is no breakpoint {number}; no breakpoint is set"),
            false => format!("there is no breakpoint {number}; the breakpoints are {}", numbers.join(", ")),
        };
        Rejection::for_field("number", "breakpoint_unknown", message)
    }

    /// Simulates days of a debug run and stops after the first day on which a breakpoint becomes true. Records an
    /// inspection of the last day for each breakpoint, because the absence of a stop also reveals hidden state.
    ///
    /// # Errors
    /// `not_in_this_mode`, `run_over`, `not_possible`, `not_readable`; after `not_saved`, days may have been simulated.
    pub fn run_until_breakpoint(
        &mut self,
        days: u32,
        progress: &mut dyn FnMut(&DayReport<'_>),
    ) -> Result<BreakpointRun, Rejection> {
        let from = self.run.day();
        let set = self.cache.breakpoints.all().to_vec();
        let known = &self.cache.breakpoints.measured_days;
        let shows_past = known.last_day() < from;
        let series = if shows_past { Arc::default() } else { known.clone() };
        let should_continue = |day: u32| find_hit_breakpoints(day, &set, &series).is_empty();
        let looks = ("breakpoint", set.iter().map(|breakpoint| breakpoint.condition.to_string()).collect());
        let watched = ObservedDays {
            days,
            watch: series.clone(),
            replays_past_days: shows_past,
            should_continue: &should_continue,
            inspections: looks,
        };
        let week = watched.simulate(self.run, progress)?;
        let (hits, day) = (find_hit_breakpoints(self.run.day(), &set, &series), self.run.day());
        let true_before = find_still_true_breakpoints(from + 1..=day, &set, &series);
        if !set.is_empty() {
            self.cache.breakpoints.measured_days = series;
        }
        Ok(BreakpointRun { from, week, hits, still_true: true_before })
    }

    /// Returns the figures of all days up to the inspected day. Re-simulates days without recorded figures.
    ///
    /// # Errors
    /// `not_possible`, `not_readable`.
    pub(super) fn measured_days(
        &mut self,
        permit: &InspectionPermit,
    ) -> Result<Arc<MeasuredDays>, Rejection> {
        if self.cache.breakpoints.measured_days.last_day() < permit.day() {
            let series = Arc::new(MeasuredDays::default());
            permit.replay_until(self.run, permit.day(), series.clone())?;
            self.cache.breakpoints.measured_days = series;
        }
        Ok(self.cache.breakpoints.measured_days.clone())
    }
}

/// Returns the breakpoints that became true on a day.
fn find_hit_breakpoints(day: u32, set: &[Breakpoint], series: &MeasuredDays) -> Vec<BreakpointHit> {
    series.with_days(|days| {
        let judged = set.iter().map(|breakpoint| BreakpointHit {
            breakpoint: *breakpoint,
            state: breakpoint.condition.evaluate(days, day),
        });
        judged.filter(|hit| hit.state.becomes_true()).collect()
    })
}

/// Returns the breakpoints that were already true when they were first evaluated, and did not become true later.
fn find_still_true_breakpoints(
    days: RangeInclusive<u32>,
    set: &[Breakpoint],
    series: &MeasuredDays,
) -> Vec<StillTrueBreakpoint> {
    series.with_days(|measured| {
        let of = |breakpoint: &Breakpoint| {
            let judged: Vec<ConditionState> =
                days.clone().map(|day| breakpoint.condition.evaluate(measured, day)).collect();
            let until = judged.iter().rfind(|judged| judged.is_true)?.day;
            let hit = BreakpointHit { breakpoint: *breakpoint, state: *judged.last()? };
            let becomes_true = judged.iter().any(ConditionState::becomes_true);
            let began =
                judged.iter().find(|judged| judged.is_first_value && judged.is_true).map(|judged| judged.day);
            (!becomes_true).then_some(StillTrueBreakpoint {
                hit,
                last_true_day: until,
                first_value_day: began,
            })
        };
        set.iter().filter_map(of).collect()
    })
}
