//! The changes in a figure on a day, in the order of the day, each with its mechanism and amount
//! (docs/debugging.md#who-writes).

mod recorder;
pub(crate) mod target;

use std::sync::Arc;

use recorder::WriteRecorder;
use target::WriteTarget;

use crate::inspection::inspector::Inspector;
use novamind_session::InspectionPermit;
use novamind_tools::Rejection;
use novamind_world::events::{Category, EndCause, Source};
use novamind_world::reputation::ReputationCause;

/// The mechanism that changes a figure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WriteSource {
    /// A mechanism that changes reputation.
    Reputation(ReputationCause),
    /// Ledger entries of a category, from calls before the day or from the simulation of the day.
    LedgerEntries(Category),
    /// Cancellations for the given reason.
    Cancellations(EndCause),
    /// New individual subscribers from the given source.
    Signups(Source),
    /// Enterprises that accepted their first deal.
    FirstDeals,
}

/// Consecutive changes that one mechanism makes to a figure.
#[derive(Debug, Clone, PartialEq)]
pub struct FigureWrite {
    /// The mechanism that made the changes.
    pub source: WriteSource,
    /// Amounts in the order of the changes, before limits.
    pub changes: Vec<f64>,
    /// Value of the figure before the changes.
    pub before: f64,
    /// Value of the figure after the changes.
    pub after: f64,
}

impl FigureWrite {
    /// Returns the actual change in the figure.
    pub fn amount(&self) -> f64 {
        self.after - self.before
    }

    /// Returns the sum of the changes before limits.
    pub fn requested_change(&self) -> f64 {
        self.changes.iter().sum()
    }

    /// Returns whether a limit changed the result by more than rounding errors.
    pub fn is_limited(&self) -> bool {
        (self.amount() - self.requested_change()).abs() > 1e-12 * self.before.abs().max(1.0)
    }
}

/// All changes in a figure on a day.
#[derive(Debug, Clone, PartialEq)]
pub struct FigureWrites {
    /// Figure whose changes are listed.
    pub target: WriteTarget,
    /// Day of the changes.
    pub day: u32,
    /// Value of the figure at the end of the previous day.
    pub opening_value: f64,
    /// Value of the figure at the end of the day.
    pub closing_value: f64,
    /// Changes in order. Each change starts with the result of the previous change.
    pub writes: Vec<FigureWrite>,
}

impl Inspector<'_> {
    /// Returns the changes in a figure on a day, by default the last day. Records the inspection in the trajectory.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`.
    pub fn figure_writes(
        &mut self,
        target: WriteTarget,
        day: Option<u32>,
    ) -> Result<FigureWrites, Rejection> {
        let permit = InspectionPermit::start(self.run, "who", &target.to_string(), day)?;
        let day = permit.day();
        let opening = match target {
            WriteTarget::Reputation(_) => permit.hidden_state(self.run).params().initial.initial_reputation,
            WriteTarget::Cash => self.run.manifest().cash,
            WriteTarget::Subscribers(_) => 0.0,
        };
        let diary = Arc::new(WriteRecorder::new(target, day, opening));
        permit.replay_until(self.run, day, diary.clone())?;
        diary
            .take_result()
            .ok_or_else(|| Rejection::new("not_readable", format!("day {day} could not be re-simulated")))
    }
}
