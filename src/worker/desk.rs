//! The desk of a study: who has come, and what comes next for them.

use novamind_session::{Agreed, RunError};
use novamind_study::{DueQuestion, NextStep, Study, Visit};

/// A study that is being visited.
pub(super) struct Desk {
    pub(super) study: Study,
    /// The participant who has come.
    pub(super) visit: Option<Visit>,
    /// How the participant has agreed, before a run records it.
    pub(super) agreed: Option<Agreed>,
    /// What is due, as it was told last.
    pub(super) due: Vec<DueQuestion>,
}

impl Desk {
    /// Before anybody has come.
    pub(super) fn of(study: Study) -> Desk {
        Desk { study, visit: None, agreed: None, due: Vec::new() }
    }

    /// What comes next for the participant; none before one has come.
    pub(super) fn next(&self) -> Result<Option<NextStep>, RunError> {
        let Some(visit) = &self.visit else { return Ok(None) };
        let step = match visit.next()? {
            // Agreement stands in the first run.
            NextStep::Consent(_) if self.agreed.is_some() => visit.after_consent()?,
            step => step,
        };
        if step == NextStep::Thanks {
            visit.finish();
        }
        Ok(Some(step))
    }
}
