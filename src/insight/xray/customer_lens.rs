//! An individual from within: how it came, and each day what it weighed.

use std::sync::Arc;

use super::customer_diary::{CustomerDay, CustomerDiary, FirstDecision};
use novamind_session::{Look, Session};
use novamind_tools::Refusal;
use novamind_world::identifiers::Group;

/// An individual, up to the day that is shown.
#[derive(Debug, Clone)]
pub struct CustomerLens {
    /// Customer number.
    pub customer: u32,
    /// Its group.
    pub group: Group,
    /// The day that is shown.
    pub day: u32,
    /// How it decided when it came.
    pub first: FirstDecision,
    /// Its days as a subscriber, from the one after it signed up.
    pub days: Vec<CustomerDay>,
}

impl CustomerLens {
    /// The day that is shown, or the last one before it on which it was a subscriber.
    pub fn shown(&self) -> Option<&CustomerDay> {
        self.days.last()
    }

    /// Day on which the issue was opened that is open on the day that is shown.
    pub fn issue_since(&self) -> Option<u32> {
        let shown = self.shown().filter(|own| own.open_issue_days > 0)?;
        let days = self.days.iter().rev();
        let mut later = u32::MAX;
        // Days count up while an issue is open: where they do not, another one was.
        let same = days.take_while(|own| {
            let is_same = own.open_issue_days > 0 && own.open_issue_days < later;
            later = own.open_issue_days;
            is_same
        });
        same.last().map_or(Some(shown.day), |own| Some(own.day))
    }

    /// The last bill before that day.
    pub fn last_bill(&self) -> Option<&CustomerDay> {
        let shown = self.shown()?.day;
        self.days.iter().rev().find(|own| own.is_due && own.day < shown)
    }
}

impl CustomerLens {
    /// An individual on a day that it has reached.
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
                format!("customer {customer} could not be seen coming"),
            ));
        };
        let days = pages.days.into_iter().filter(|own| own.day <= day).collect();
        Ok(CustomerLens { customer, group: found.0, day, first, days })
    }
}
