//! The hidden state of a customer: an individual or an enterprise.

use super::company_lens::CompanyLens;
use super::customer_lens::CustomerLens;
use super::inspector::Inspector;
use novamind_session::Look;
use novamind_tools::Refusal;

/// The hidden state of a customer.
#[derive(Debug, Clone)]
pub enum Lens {
    /// An individual.
    Individual(Box<CustomerLens>),
    /// An enterprise.
    Company(CompanyLens),
}

impl Inspector<'_> {
    /// Returns a customer on a day, by default the last one. Records the inspection.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `customer_not_found`, `not_possible`, `not_readable`, `not_saved`.
    pub fn lens(&mut self, customer: u32, day: Option<u32>) -> Result<Lens, Refusal> {
        let (look, found, arrival) = Look::begin_at_customer(self.run, customer, day)?;
        match found.0.is_enterprise() {
            true => CompanyLens::of(self.run, &look, customer, found.0).map(Lens::Company),
            false => CustomerLens::of(self.run, &look, customer, found, arrival)
                .map(|lens| Lens::Individual(Box::new(lens))),
        }
    }
}
