//! A customer from within: an individual or a company.

use super::company_lens::CompanyLens;
use super::customer_lens::CustomerLens;
use crate::state::Session;
use novamind_tools::Refusal;
use novamind_world::customers::FIRST_CUSTOMER;
use novamind_world::identifiers::Group;

/// A customer from within.
#[derive(Debug, Clone)]
pub enum Lens {
    /// Who decides alone.
    Individual(Box<CustomerLens>),
    /// Who negotiates.
    Company(CompanyLens),
}

impl Session {
    /// A customer on a day, the last one if none is named. The look is recorded.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `customer_not_found`, `not_possible`, `not_readable`, `not_saved`.
    pub fn lens(&mut self, customer: u32, day: Option<u32>) -> Result<Lens, Refusal> {
        self.refuse_to_look_inside()?;
        let day = self.day_to_show(day)?;
        let found = self.customer_to_show(customer, day)?;
        self.record_look_inside("customer", &customer.to_string(), day)?;
        match found.0.is_enterprise() {
            true => self.company_lens(customer, found.0, day).map(Lens::Company),
            false => self.customer_lens(customer, found, day).map(|lens| Lens::Individual(Box::new(lens))),
        }
    }

    /// Group of a customer and its number in the group.
    ///
    /// # Errors
    /// `customer_not_found`, `day_unknown`: it came later.
    fn customer_to_show(&self, customer: u32, day: u32) -> Result<(Group, u32), Refusal> {
        let customers = &self.simulation.world.customers;
        let Some(found) = customers.find(customer) else {
            let message = match customers.next_customer {
                FIRST_CUSTOMER => "nobody has come yet".to_owned(),
                next => format!(
                    "there is no customer {customer}; choose one from {FIRST_CUSTOMER} to {}",
                    next - 1
                ),
            };
            return Err(Refusal::at("customer_id", "customer_not_found", message));
        };
        let arrival = self.arrival_of(customer);
        if arrival > day {
            let message = format!("customer {customer} came on day {arrival}, after day {day}");
            return Err(Refusal::at("day", "day_unknown", message));
        }
        Ok(found)
    }

    /// Day on which a customer came; 0 if nobody of this number did.
    pub(crate) fn arrival_of(&self, customer: u32) -> u32 {
        self.simulation.world.customers.numbers.arrival_day(customer).unwrap_or(0)
    }
}
