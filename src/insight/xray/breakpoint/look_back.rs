//! The history of a condition over the completed days of a run.

use super::condition::{Condition, Judged};
use crate::xray::inspector::Inspector;
use novamind_session::Look;
use novamind_tools::Refusal;

/// The current state of a condition, and the last days in each state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LookBack {
    /// The condition.
    pub condition: Condition,
    /// State on the last day.
    pub today: Judged,
    /// Last day on which the condition was true.
    pub last_true: Option<Judged>,
    /// Last day on which the condition was false.
    pub last_false: Option<Judged>,
}

impl LookBack {
    /// Returns the first day of the current state.
    pub fn since(&self) -> u32 {
        let other = if self.today.is_true { self.last_false } else { self.last_true };
        other.map_or(1, |other| other.day + 1)
    }
}

impl Inspector<'_> {
    /// Returns since when a condition is true or false. Records the inspection.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`.
    pub fn look_back(&mut self, condition: Condition) -> Result<LookBack, Refusal> {
        let all = self.judged_days("back", condition)?;
        let last = |is_true: bool| all.iter().rev().find(|own| own.is_true == is_true).copied();
        let today =
            *all.last().ok_or_else(|| Refusal::new("not_readable", "no day could be re-simulated"))?;
        Ok(LookBack { condition, today, last_true: last(true), last_false: last(false) })
    }

    /// Calls [`Inspector::look_back`] for each breakpoint, or for the one with a number.
    ///
    /// # Errors
    /// As [`Inspector::look_back`], and `breakpoint_unknown`.
    pub fn look_back_from(&mut self, number: Option<u32>) -> Result<Vec<LookBack>, Refusal> {
        let set = self.breakpoints()?;
        let chosen: Vec<Condition> = set
            .iter()
            .filter(|own| number.is_none_or(|number| own.number == number))
            .map(|own| own.condition)
            .collect();
        if let Some(number) = number.filter(|_| chosen.is_empty()) {
            return Err(self.unknown_breakpoint(number));
        }
        chosen.into_iter().map(|condition| self.look_back(condition)).collect()
    }

    /// Returns the days on which a condition became true, and those on which the first value of its figure made it true. Records
    /// the inspection.
    ///
    /// # Errors
    /// As [`Inspector::look_back`].
    pub fn find_days(&mut self, condition: Condition) -> Result<Vec<Judged>, Refusal> {
        let all = self.judged_days("find", condition)?;
        Ok(all.into_iter().filter(|own| own.is_true && !own.was_true).collect())
    }

    fn judged_days(&mut self, what: &str, condition: Condition) -> Result<Vec<Judged>, Refusal> {
        let look = Look::begin(self.run, what, &condition.to_string(), None)?;
        let today = look.day();
        let series = self.measured_up_to(&look)?;
        Ok(series.read(|days| (1..=today).map(|day| condition.judged(days, day)).collect()))
    }
}
