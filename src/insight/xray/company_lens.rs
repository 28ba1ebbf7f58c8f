//! The hidden state of an enterprise: its evaluation of offers on each day with an open thread.

use std::sync::{Arc, Mutex, PoisonError};

use super::company_day::{CompanyDay, company_day};
use novamind_session::{Look, Session};
use novamind_tools::Refusal;
use novamind_world::customers::Customers;
use novamind_world::day::watch::DayWatch;
use novamind_world::enterprise::{Enterprise, Negotiation};
use novamind_world::identifiers::Group;

/// An enterprise, up to the shown day.
#[derive(Debug, Clone, PartialEq)]
pub struct CompanyLens {
    /// Customer number.
    pub customer: u32,
    /// Group of the enterprise.
    pub group: Group,
    /// The shown day.
    pub day: u32,
    /// Threads by day.
    pub days: Vec<CompanyDay>,
}

impl CompanyLens {
    /// Returns the threads that were open on the shown day.
    pub fn shown(&self) -> impl Iterator<Item = &CompanyDay> {
        self.days.iter().filter(|own| own.day == self.day)
    }
}

impl CompanyLens {
    /// Returns an enterprise on a simulated day.
    pub(super) fn of(
        run: &Session,
        look: &Look,
        customer: u32,
        group: Group,
    ) -> Result<CompanyLens, Refusal> {
        let day = look.day();
        let diary = Arc::new(CompanyDiary { customer, days: Mutex::default() });
        look.watch_up_to(run, day, diary.clone())?;
        let days = std::mem::take(&mut *diary.days.lock().unwrap_or_else(PoisonError::into_inner));
        let days = days.into_iter().filter(|own| own.day <= day).collect();
        Ok(CompanyLens { customer, group, day, days })
    }
}

/// Records the open threads of one enterprise.
struct CompanyDiary {
    customer: u32,
    days: Mutex<Vec<CompanyDay>>,
}

impl DayWatch for CompanyDiary {
    fn before_negotiations(&self, enterprise: &Enterprise, customers: &Customers, talks: &Negotiation<'_>) {
        let threads = enterprise.threads.iter().filter(|thread| thread.customer == self.customer);
        let seen = threads.filter_map(|thread| company_day(thread, enterprise, customers, talks));
        self.days.lock().unwrap_or_else(PoisonError::into_inner).extend(seen);
    }
}
