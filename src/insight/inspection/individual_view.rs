//! The hidden state of an individual: the decision as a lead, and the evaluated decision of each later day.

use std::sync::Arc;

use super::individual_recorder::{IndividualDay, IndividualRecorder, SignupDecision};
use novamind_session::{InspectionPermit, Session};
use novamind_tools::Rejection;
use novamind_world::identifiers::Group;

/// The hidden state of an individual up to the shown day.
#[derive(Debug, Clone)]
pub struct IndividualView {
    /// Customer number of the individual.
    pub customer: u32,
    /// Group of the individual.
    pub group: Group,
    /// Last day of the view.
    pub day: u32,
    /// The individual's decision as a lead.
    pub signup: SignupDecision,
    /// State on each day as a subscriber, from the day after signup.
    pub days: Vec<IndividualDay>,
}

impl IndividualView {
    /// Returns the individual's state on the shown day, or on the last earlier day with a subscription.
    pub fn shown_state(&self) -> Option<&IndividualDay> {
        self.days.last()
    }

    /// Returns the day on which the currently open issue was opened.
    pub fn issue_opened_on(&self) -> Option<u32> {
        let individual_day = self.shown_state().filter(|day| day.open_issue_days > 0)?;
        let days = self.days.iter().rev();
        let mut later = u32::MAX;
        // While an issue is open, its age increases daily. If the age does not increase, a new issue was opened.
        let same = days.take_while(|day| {
            let is_same = day.open_issue_days > 0 && day.open_issue_days < later;
            later = day.open_issue_days;
            is_same
        });
        same.last().map_or(Some(individual_day.day), |day| Some(day.day))
    }

    /// Returns the state on the last billing day before the shown day.
    pub fn last_bill(&self) -> Option<&IndividualDay> {
        let shown = self.shown_state()?.day;
        self.days.iter().rev().find(|individual_day| individual_day.is_due && individual_day.day < shown)
    }
}

impl IndividualView {
    /// Creates the view of an individual on a simulated day.
    pub(super) fn new(
        run: &Session,
        permit: &InspectionPermit,
        customer: u32,
        found: (Group, u32),
        arrival: u32,
    ) -> Result<IndividualView, Rejection> {
        let day = permit.day();
        let recorder = Arc::new(IndividualRecorder::new(customer, found, arrival));
        permit.replay_until(run, day, recorder.clone())?;
        let pages = recorder.take_record();
        let Some(first) = pages.signup else {
            return Err(Rejection::new(
                "not_readable",
                format!("the first day of customer {customer} could not be re-simulated"),
            ));
        };
        let days = pages.days.into_iter().filter(|individual_day| individual_day.day <= day).collect();
        Ok(IndividualView { customer, group: found.0, day, signup: first, days })
    }
}
