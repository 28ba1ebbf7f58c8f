//! Who wrote a figure on a day: each mechanism with its amount, in the order of the day (docs/debugging.md#who-writes).

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

/// What wrote.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WrittenBy {
    /// A mechanism of reputation.
    Reputation(ReputationCause),
    /// Movements of cash of a category, by calls before the day or on it.
    Booked(Category),
    /// Subscribers who left, by why.
    Left(EndCause),
    /// Individuals who signed up, by how they came.
    SignedUp(Source),
    /// Companies whose first deal was accepted.
    FirstDeals,
}

/// What one mechanism wrote without another between.
#[derive(Debug, Clone, PartialEq)]
pub struct Write {
    /// The mechanism.
    pub by: WrittenBy,
    /// What it added, one after the other, before limits.
    pub changes: Vec<f64>,
    /// The figure before it.
    pub before: f64,
    /// The figure after it.
    pub after: f64,
}

impl Write {
    /// By how much the figure moved.
    pub fn amount(&self) -> f64 {
        self.after - self.before
    }

    /// By how much it would have moved without limits.
    pub fn asked(&self) -> f64 {
        self.changes.iter().sum()
    }

    /// Whether a limit took away or added something: more than what sums are rounded by.
    pub fn is_limited(&self) -> bool {
        (self.amount() - self.asked()).abs() > 1e-12 * self.before.abs().max(1.0)
    }
}

/// All writes of a figure on a day.
#[derive(Debug, Clone, PartialEq)]
pub struct WhoWrites {
    /// The figure.
    pub target: WriteTarget,
    /// The day.
    pub day: u32,
    /// The figure at the end of the day before.
    pub first: f64,
    /// The figure at the end of the day.
    pub last: f64,
    /// What lies between: each begins where the one before it ended.
    pub writes: Vec<Write>,
}

impl Inspector<'_> {
    /// Who wrote a figure on a day, the last one if none is named. The look is recorded.
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
        diary.take().ok_or_else(|| Refusal::new("not_readable", format!("day {day} could not be seen again")))
    }
}
