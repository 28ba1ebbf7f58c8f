//! A company from within: who judges what is offered to it, day by day while a thread is open.

use std::sync::{Arc, Mutex, PoisonError};

use super::company_day::{CompanyDay, company_day};
use novamind_session::{Look, Session};
use novamind_tools::Refusal;
use novamind_world::customers::Customers;
use novamind_world::day::watch::DayWatch;
use novamind_world::enterprise::{Enterprise, Negotiation};
use novamind_world::identifiers::Group;

/// A company, up to the day that is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct CompanyLens {
    /// Customer number.
    pub customer: u32,
    /// Its group.
    pub group: Group,
    /// The day that is shown.
    pub day: u32,
    /// Its threads day by day.
    pub days: Vec<CompanyDay>,
}

impl CompanyLens {
    /// The threads that were open on the day that is shown.
    pub fn shown(&self) -> impl Iterator<Item = &CompanyDay> {
        self.days.iter().filter(|own| own.day == self.day)
    }
}

impl CompanyLens {
    /// A company on a day that it has reached.
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

/// Keeps the open threads of one company.
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
