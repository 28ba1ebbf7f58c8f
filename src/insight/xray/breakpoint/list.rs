//! The breakpoints of an open run, and what was seen of its days for their sake.

use std::sync::Arc;

use super::condition::Condition;
use super::series::Series;

/// A condition at which a run stops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Breakpoint {
    /// Its number, from 1; none is given twice.
    pub number: u32,
    /// When it stops.
    pub condition: Condition,
}

/// The breakpoints of a run, as long as it is open.
#[derive(Debug, Default)]
pub(crate) struct Breakpoints {
    set: Vec<Breakpoint>,
    last_number: u32,
    /// Figures of the days.
    pub(crate) series: Arc<Series>,
}

impl Breakpoints {
    /// Those that are set, in the order of their numbers.
    pub(crate) fn all(&self) -> &[Breakpoint] {
        &self.set
    }

    /// Sets one; the one that is there if it is set already.
    pub(crate) fn set(&mut self, condition: Condition) -> Breakpoint {
        if let Some(known) = self.set.iter().find(|own| own.condition == condition) {
            return *known;
        }
        self.last_number += 1;
        let breakpoint = Breakpoint { number: self.last_number, condition };
        self.set.push(breakpoint);
        breakpoint
    }

    /// Removes the one with a number; none if there is none.
    pub(crate) fn clear(&mut self, number: u32) -> Option<Breakpoint> {
        let at = self.set.iter().position(|own| own.number == number)?;
        Some(self.set.remove(at))
    }

    /// Removes all; returns what was set.
    pub(crate) fn clear_all(&mut self) -> Vec<Breakpoint> {
        std::mem::take(&mut self.set)
    }
}
