//! The changes of a figure on a day: each mechanism with its amount, in the order of the day (docs/debugging.md#who-writes).

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

/// The source of a change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WriteSource {
    /// A mechanism of reputation.
    Reputation(ReputationCause),
    /// Ledger entries of a category, by calls before the day or by the day.
    LedgerEntries(Category),
    /// Cancellations, by reason.
    Cancellations(EndCause),
    /// New individual subscribers, by source.
    Signups(Source),
    /// Enterprises with their first accepted deal.
    FirstDeals,
}

/// Consecutive changes by one mechanism.
#[derive(Debug, Clone, PartialEq)]
pub struct FigureWrite {
    /// The mechanism.
    pub source: WriteSource,
    /// Amounts in order, before limits.
    pub changes: Vec<f64>,
    /// Value before.
    pub before: f64,
    /// Value after.
    pub after: f64,
}

impl FigureWrite {
    /// Returns the change of the figure.
    pub fn amount(&self) -> f64 {
        self.after - self.before
    }

    /// Returns the change without limits.
    pub fn requested_change(&self) -> f64 {
        self.changes.iter().sum()
    }

    /// Returns whether a limit changed the result by more than rounding errors.
    pub fn is_limited(&self) -> bool {
        (self.amount() - self.requested_change()).abs() > 1e-12 * self.before.abs().max(1.0)
    }
}

/// All changes of a figure on a day.
#[derive(Debug, Clone, PartialEq)]
pub struct FigureWrites {
    /// The figure.
    pub target: WriteTarget,
    /// The day.
    pub day: u32,
    /// Value at the end of the day before.
    pub opening_value: f64,
    /// Value at the end of the day.
    pub closing_value: f64,
    /// Changes in order; each starts with the result of the previous one.
    pub writes: Vec<FigureWrite>,
}

impl Inspector<'_> {
    /// Returns the changes of a figure on a day, by default the last one. Records the inspection.
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
