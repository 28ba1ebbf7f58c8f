//! The hidden state of a customer: an individual or an enterprise.

use super::enterprise_view::EnterpriseView;
use super::individual_view::IndividualView;
use super::inspector::Inspector;
use novamind_session::InspectionPermit;
use novamind_tools::Rejection;

/// The hidden state of a customer, by type of customer.
#[derive(Debug, Clone)]
pub enum CustomerView {
    /// The hidden state of an individual.
    Individual(Box<IndividualView>),
    /// The hidden state of an enterprise.
    Enterprise(EnterpriseView),
}

impl Inspector<'_> {
    /// Returns the hidden state of a customer on a day, by default the last day. Records the inspection in the
    /// trajectory.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `customer_not_found`, `not_possible`, `not_readable`, `not_saved`.
    pub fn customer_view(&mut self, customer: u32, day: Option<u32>) -> Result<CustomerView, Rejection> {
        let (permit, found, arrival) = InspectionPermit::start_for_customer(self.run, customer, day)?;
        match found.0.is_enterprise() {
            true => EnterpriseView::new(self.run, &permit, customer, found.0).map(CustomerView::Enterprise),
            false => IndividualView::new(self.run, &permit, customer, found, arrival)
                .map(|view| CustomerView::Individual(Box::new(view))),
        }
    }
}
