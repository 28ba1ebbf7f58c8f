//! The history of a condition on the completed days of a run.

use super::condition::{Condition, ConditionState};
use crate::inspection::inspector::Inspector;
use novamind_session::InspectionPermit;
use novamind_tools::Rejection;

/// The current state of a condition, with the last day on which it was true and the last day on which it was false.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConditionHistory {
    /// Condition whose history is described.
    pub condition: Condition,
    /// State of the condition on the last completed day.
    pub today: ConditionState,
    /// State on the last day on which the condition was true; `None` if it was never true.
    pub last_true: Option<ConditionState>,
    /// State on the last day on which the condition was false; `None` if it was never false.
    pub last_false: Option<ConditionState>,
}

impl ConditionHistory {
    /// Returns the first day of the period in which the condition has had its current state.
    pub fn unchanged_since(&self) -> u32 {
        let other = if self.today.is_true { self.last_false } else { self.last_true };
        other.map_or(1, |other| other.day + 1)
    }
}

impl Inspector<'_> {
    /// Returns the history of a condition. Records the inspection in the trajectory.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`.
    pub fn condition_history(&mut self, condition: Condition) -> Result<ConditionHistory, Rejection> {
        let all = self.evaluate_days("back", condition)?;
        let last = |is_true: bool| {
            all.iter().rev().find(|condition_state| condition_state.is_true == is_true).copied()
        };
        let today =
            *all.last().ok_or_else(|| Rejection::new("not_readable", "no day could be re-simulated"))?;
        Ok(ConditionHistory { condition, today, last_true: last(true), last_false: last(false) })
    }

    /// Returns the condition history of every breakpoint, or of the breakpoint with the given number.
    ///
    /// # Errors
    /// Same errors as [`Inspector::condition_history`], and `breakpoint_unknown`.
    pub fn breakpoint_histories(&mut self, number: Option<u32>) -> Result<Vec<ConditionHistory>, Rejection> {
        let set = self.breakpoints()?;
        let chosen: Vec<Condition> = set
            .iter()
            .filter(|breakpoint| number.is_none_or(|number| breakpoint.number == number))
            .map(|breakpoint| breakpoint.condition)
            .collect();
        if let Some(number) = number.filter(|_| chosen.is_empty()) {
            return Err(self.unknown_breakpoint_rejection(number));
        }
        chosen.into_iter().map(|condition| self.condition_history(condition)).collect()
    }

    /// Returns the days on which a condition became true. Includes days on which the first value of the figure
    /// satisfies the condition. Records the inspection in the trajectory.
    ///
    /// # Errors
    /// Same errors as [`Inspector::condition_history`].
    pub fn find_condition_days(&mut self, condition: Condition) -> Result<Vec<ConditionState>, Rejection> {
        let all = self.evaluate_days("find", condition)?;
        Ok(all
            .into_iter()
            .filter(|condition_state| condition_state.is_true && !condition_state.was_true)
            .collect())
    }

    fn evaluate_days(&mut self, what: &str, condition: Condition) -> Result<Vec<ConditionState>, Rejection> {
        let permit = InspectionPermit::start(self.run, what, &condition.to_string(), None)?;
        let today = permit.day();
        let series = self.measured_days(&permit)?;
        Ok(series.with_days(|days| (1..=today).map(|day| condition.evaluate(days, day)).collect()))
    }
}
