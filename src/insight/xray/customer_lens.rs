//! The hidden state of an individual: its first decision, and its evaluated decision of each day.

use std::sync::Arc;

use super::customer_diary::{CustomerDay, CustomerDiary, FirstDecision};
use novamind_session::{Look, Session};
use novamind_tools::Refusal;
use novamind_world::identifiers::Group;

/// An individual, up to the shown day.
#[derive(Debug, Clone)]
pub struct CustomerLens {
    /// Customer number.
    pub customer: u32,
    /// Group of the individual.
    pub group: Group,
    /// The shown day.
    pub day: u32,
    /// Decision as a lead.
    pub first: FirstDecision,
    /// Days as a subscriber, from the day after sign-up.
    pub days: Vec<CustomerDay>,
}

impl CustomerLens {
    /// Returns the shown day, or the last earlier day as a subscriber.
    pub fn shown(&self) -> Option<&CustomerDay> {
        self.days.last()
    }

    /// Returns the day on which the currently open issue was opened.
    pub fn issue_since(&self) -> Option<u32> {
        let shown = self.shown().filter(|own| own.open_issue_days > 0)?;
        let days = self.days.iter().rev();
        let mut later = u32::MAX;
        // The count increases while an issue is open; otherwise a new issue was opened.
        let same = days.take_while(|own| {
            let is_same = own.open_issue_days > 0 && own.open_issue_days < later;
            later = own.open_issue_days;
            is_same
        });
        same.last().map_or(Some(shown.day), |own| Some(own.day))
    }

    /// Returns the last bill before that day.
    pub fn last_bill(&self) -> Option<&CustomerDay> {
        let shown = self.shown()?.day;
        self.days.iter().rev().find(|own| own.is_due && own.day < shown)
    }
}

impl CustomerLens {
    /// Returns an individual on a simulated day.
    pub(super) fn of(
        run: &Session,
        look: &Look,
        customer: u32,
        found: (Group, u32),
        arrival: u32,
    ) -> Result<CustomerLens, Refusal> {
        let day = look.day();
        let diary = Arc::new(CustomerDiary::of(customer, found, arrival));
        look.watch_up_to(run, day, diary.clone())?;
        let pages = diary.take();
        let Some(first) = pages.first else {
            return Err(Refusal::new(
                "not_readable",
                format!("the first day of customer {customer} could not be re-simulated"),
            ));
        };
        let days = pages.days.into_iter().filter(|own| own.day <= day).collect();
        Ok(CustomerLens { customer, group: found.0, day, first, days })
    }
}
