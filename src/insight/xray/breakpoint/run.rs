//! Breakpoints of a debug run, and simulation up to the first that becomes true.

use std::ops::RangeInclusive;
use std::sync::Arc;

use super::condition::{Condition, Judged};
use super::list::Breakpoint;
use super::series::Series;
use crate::xray::inspector::Inspector;
use novamind_session::{DayReport, Look, WatchedDays, Week};
use novamind_tools::Refusal;

/// A breakpoint that became true.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The breakpoint.
    pub breakpoint: Breakpoint,
    /// State of its condition.
    pub judged: Judged,
}

/// Simulated days, and the reason for the stop.
#[derive(Debug, Clone, PartialEq)]
pub struct RunUntil {
    /// First day.
    pub from: u32,
    /// Figures of the last week, and notices of all days.
    pub week: Week,
    /// Breakpoints that became true on the last day; empty if the simulation stopped for another reason.
    pub hits: Vec<Hit>,
    /// Breakpoints that were true on some of the days but became true on none of them.
    pub true_before: Vec<TrueBefore>,
}

/// A breakpoint that was true at the start of the days and became true on none of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrueBefore {
    /// The breakpoint with its state on the last day.
    pub hit: Hit,
    /// Last day on which the condition was true.
    pub until: u32,
    /// Day on which the first value of its figure over several days made it true; `None` if it was true before these days.
    pub began: Option<u32>,
}

impl Inspector<'_> {
    /// Returns all breakpoints.
    ///
    /// # Errors
    /// `not_in_this_mode`.
    pub fn breakpoints(&self) -> Result<Vec<Breakpoint>, Refusal> {
        self.run.refuse_to_look_inside()?;
        Ok(self.own.breakpoints.all().to_vec())
    }

    /// Sets a breakpoint. This reveals no hidden state, so no inspection is recorded.
    ///
    /// # Errors
    /// `not_in_this_mode`.
    pub fn set_breakpoint(&mut self, condition: Condition) -> Result<Breakpoint, Refusal> {
        self.run.refuse_to_look_inside()?;
        Ok(self.own.breakpoints.set(condition))
    }

    /// Removes and returns a breakpoint, or all of them.
    ///
    /// # Errors
    /// `not_in_this_mode`, `breakpoint_unknown`.
    pub fn clear_breakpoints(&mut self, number: Option<u32>) -> Result<Vec<Breakpoint>, Refusal> {
        self.run.refuse_to_look_inside()?;
        let Some(number) = number else { return Ok(self.own.breakpoints.clear_all()) };
        match self.own.breakpoints.clear(number) {
            Some(breakpoint) => Ok(vec![breakpoint]),
            None => Err(self.unknown_breakpoint(number)),
        }
    }

    pub(crate) fn unknown_breakpoint(&self, number: u32) -> Refusal {
        let numbers: Vec<String> =
            self.own.breakpoints.all().iter().map(|own| own.number.to_string()).collect();
        let message = match numbers.is_empty() {
            true => format!("there is no breakpoint {number}; no breakpoint is set"),
            false => format!("there is no breakpoint {number}; there are {}", numbers.join(", ")),
        };
        Refusal::at("number", "breakpoint_unknown", message)
    }

    /// Simulates days of a debug run and stops after the first day on which a breakpoint becomes true. Records an inspection of the
    /// last day for each breakpoint, because a run without a stop reveals hidden state, too.
    ///
    /// # Errors
    /// `not_in_this_mode`, `run_over`, `not_possible`, `not_readable`; after `not_saved`, days may have been simulated.
    pub fn run_until_breakpoint(
        &mut self,
        days: u32,
        progress: &mut dyn FnMut(&DayReport<'_>),
    ) -> Result<RunUntil, Refusal> {
        let from = self.run.day();
        let set = self.own.breakpoints.all().to_vec();
        let known = &self.own.breakpoints.series;
        let shows_past = known.last_day() < from;
        let series = if shows_past { Arc::default() } else { known.clone() };
        let goes_on = |day: u32| hits_on(day, &set, &series).is_empty();
        let looks = ("breakpoint", set.iter().map(|own| own.condition.to_string()).collect());
        let watched = WatchedDays { days, watch: series.clone(), shows_past, goes_on: &goes_on, looks };
        let week = watched.step(self.run, progress)?;
        let (hits, day) = (hits_on(self.run.day(), &set, &series), self.run.day());
        let true_before = true_before(from + 1..=day, &set, &series);
        if !set.is_empty() {
            self.own.breakpoints.series = series;
        }
        Ok(RunUntil { from, week, hits, true_before })
    }

    /// Returns the figures of all days up to the inspected one. Re-simulates days without recorded figures.
    ///
    /// # Errors
    /// `not_possible`, `not_readable`.
    pub(super) fn measured_up_to(&mut self, look: &Look) -> Result<Arc<Series>, Refusal> {
        if self.own.breakpoints.series.last_day() < look.day() {
            let series = Arc::new(Series::default());
            look.watch_up_to(self.run, look.day(), series.clone())?;
            self.own.breakpoints.series = series;
        }
        Ok(self.own.breakpoints.series.clone())
    }
}

/// Returns the breakpoints that became true on a day.
fn hits_on(day: u32, set: &[Breakpoint], series: &Series) -> Vec<Hit> {
    series.read(|days| {
        let judged = set.iter().map(|own| Hit { breakpoint: *own, judged: own.condition.judged(days, day) });
        judged.filter(|hit| hit.judged.becomes_true()).collect()
    })
}

/// Returns the breakpoints that were true on some days and became true on none of them.
fn true_before(days: RangeInclusive<u32>, set: &[Breakpoint], series: &Series) -> Vec<TrueBefore> {
    series.read(|measured| {
        let of = |own: &Breakpoint| {
            let judged: Vec<Judged> = days.clone().map(|day| own.condition.judged(measured, day)).collect();
            let until = judged.iter().rfind(|judged| judged.is_true)?.day;
            let hit = Hit { breakpoint: *own, judged: *judged.last()? };
            let becomes_true = judged.iter().any(Judged::becomes_true);
            let began = judged.iter().find(|judged| judged.begins && judged.is_true).map(|judged| judged.day);
            (!becomes_true).then_some(TrueBefore { hit, until, began })
        };
        set.iter().filter_map(of).collect()
    })
}
