//! The hidden state of an enterprise: its evaluation of offers on each day with an open thread.

use std::sync::{Arc, Mutex, PoisonError};

use super::enterprise_thread_day::{EnterpriseThreadDay, evaluate_enterprise_thread};
use novamind_session::{InspectionPermit, Session};
use novamind_tools::Rejection;
use novamind_world::customers::Customers;
use novamind_world::day::observer::DayObserver;
use novamind_world::enterprise::{Enterprise, NegotiationContext};
use novamind_world::identifiers::Group;

/// The hidden state of an enterprise up to the shown day.
#[derive(Debug, Clone, PartialEq)]
pub struct EnterpriseView {
    /// Customer number of the enterprise.
    pub customer: u32,
    /// Group of the enterprise.
    pub group: Group,
    /// Last day of the view.
    pub day: u32,
    /// Evaluations of the enterprise's threads, one per thread and day, in ascending order of day.
    pub days: Vec<EnterpriseThreadDay>,
}

impl EnterpriseView {
    /// Returns the threads that were open on the shown day.
    pub fn threads_on_shown_day(&self) -> impl Iterator<Item = &EnterpriseThreadDay> {
        self.days.iter().filter(|thread_day| thread_day.day == self.day)
    }
}

impl EnterpriseView {
    /// Creates the view of an enterprise on a simulated day.
    pub(super) fn new(
        run: &Session,
        permit: &InspectionPermit,
        customer: u32,
        group: Group,
    ) -> Result<EnterpriseView, Rejection> {
        let day = permit.day();
        let recorder = Arc::new(EnterpriseRecorder { customer, days: Mutex::default() });
        permit.replay_until(run, day, recorder.clone())?;
        let days = std::mem::take(&mut *recorder.days.lock().unwrap_or_else(PoisonError::into_inner));
        let days = days.into_iter().filter(|thread_day| thread_day.day <= day).collect();
        Ok(EnterpriseView { customer, group, day, days })
    }
}

/// A recorder of one enterprise's open threads on each day.
struct EnterpriseRecorder {
    customer: u32,
    days: Mutex<Vec<EnterpriseThreadDay>>,
}

impl DayObserver for EnterpriseRecorder {
    fn before_negotiations(
        &self,
        enterprise: &Enterprise,
        customers: &Customers,
        talks: &NegotiationContext<'_>,
    ) {
        let threads = enterprise.threads.iter().filter(|thread| thread.customer == self.customer);
        let seen =
            threads.filter_map(|thread| evaluate_enterprise_thread(thread, enterprise, customers, talks));
        self.days.lock().unwrap_or_else(PoisonError::into_inner).extend(seen);
    }
}
