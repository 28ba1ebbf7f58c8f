//! The changes of a figure on a day: each mechanism with its amount, in the order of the day (docs/debugging.md#who-writes).

mod diary;
pub(crate) mod target;

use std::sync::Arc;

use diary::WriteDiary;
use target::WriteTarget;

use crate::xray::inspector::Inspector;
use novamind_session::Look;
use novamind_tools::Refusal;
use novamind_world::events::{Category, EndCause, Source};
use novamind_world::reputation::ReputationCause;

/// The source of a change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WrittenBy {
    /// A mechanism of reputation.
    Reputation(ReputationCause),
    /// Ledger entries of a category, by calls before the day or by the day.
    Booked(Category),
    /// Cancellations, by reason.
    Left(EndCause),
    /// New individual subscribers, by source.
    SignedUp(Source),
    /// Enterprises with their first accepted deal.
    FirstDeals,
}

/// Consecutive changes by one mechanism.
#[derive(Debug, Clone, PartialEq)]
pub struct Write {
    /// The mechanism.
    pub by: WrittenBy,
    /// Amounts in order, before limits.
    pub changes: Vec<f64>,
    /// Value before.
    pub before: f64,
    /// Value after.
    pub after: f64,
}

impl Write {
    /// Returns the change of the figure.
    pub fn amount(&self) -> f64 {
        self.after - self.before
    }

    /// Returns the change without limits.
    pub fn asked(&self) -> f64 {
        self.changes.iter().sum()
    }

    /// Whether a limit changed the result by more than rounding errors.
    pub fn is_limited(&self) -> bool {
        (self.amount() - self.asked()).abs() > 1e-12 * self.before.abs().max(1.0)
    }
}

/// All changes of a figure on a day.
#[derive(Debug, Clone, PartialEq)]
pub struct WhoWrites {
    /// The figure.
    pub target: WriteTarget,
    /// The day.
    pub day: u32,
    /// Value at the end of the day before.
    pub first: f64,
    /// Value at the end of the day.
    pub last: f64,
    /// Changes in order; each starts with the result of the previous one.
    pub writes: Vec<Write>,
}

impl Inspector<'_> {
    /// Returns the changes of a figure on a day, by default the last one. Records the inspection.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`.
    pub fn who_writes(&mut self, target: WriteTarget, day: Option<u32>) -> Result<WhoWrites, Refusal> {
        let look = Look::begin(self.run, "who", &target.to_string(), day)?;
        let day = look.day();
        let opening = match target {
            WriteTarget::Reputation(_) => look.inside(self.run).params().initial.initial_reputation,
            WriteTarget::Cash => self.run.manifest().cash,
            WriteTarget::Subscribers(_) => 0.0,
        };
        let diary = Arc::new(WriteDiary::of(target, day, opening));
        look.watch_up_to(self.run, day, diary.clone())?;
        diary
            .take()
            .ok_or_else(|| Refusal::new("not_readable", format!("day {day} could not be re-simulated")))
    }
}
