//! The breakpoints of an open run, and the recorded figures of its days.

use std::sync::Arc;

use super::condition::Condition;
use super::measured_days::MeasuredDays;

/// A condition that stops a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Breakpoint {
    /// Number of the breakpoint, from 1; never reused.
    pub number: u32,
    /// The condition that stops the run.
    pub condition: Condition,
}

/// The breakpoints of an open run.
#[derive(Debug, Default)]
pub(crate) struct Breakpoints {
    set: Vec<Breakpoint>,
    last_number: u32,
    /// Recorded figures of the simulated days.
    pub(crate) measured_days: Arc<MeasuredDays>,
}

impl Breakpoints {
    pub(crate) fn all(&self) -> &[Breakpoint] {
        &self.set
    }

    /// Sets a breakpoint, or returns the existing breakpoint with the same condition.
    pub(crate) fn set(&mut self, condition: Condition) -> Breakpoint {
        if let Some(known) = self.set.iter().find(|breakpoint| breakpoint.condition == condition) {
            return *known;
        }
        self.last_number += 1;
        let breakpoint = Breakpoint { number: self.last_number, condition };
        self.set.push(breakpoint);
        breakpoint
    }

    /// Removes and returns a breakpoint. Returns `None` if no breakpoint has the number.
    pub(crate) fn clear(&mut self, number: u32) -> Option<Breakpoint> {
        let at = self.set.iter().position(|breakpoint| breakpoint.number == number)?;
        Some(self.set.remove(at))
    }

    pub(crate) fn clear_all(&mut self) -> Vec<Breakpoint> {
        std::mem::take(&mut self.set)
    }
}
