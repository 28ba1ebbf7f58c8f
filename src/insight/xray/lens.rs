//! A customer from within: an individual or a company.

use super::company_lens::CompanyLens;
use super::customer_lens::CustomerLens;
use super::inspector::Inspector;
use novamind_session::Look;
use novamind_tools::Refusal;

/// A customer from within.
#[derive(Debug, Clone)]
pub enum Lens {
    /// Who decides alone.
    Individual(Box<CustomerLens>),
    /// Who negotiates.
    Company(CompanyLens),
}

impl Inspector<'_> {
    /// A customer on a day, the last one if none is named. The look is recorded.
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
