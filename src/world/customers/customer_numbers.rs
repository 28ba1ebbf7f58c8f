//! Mapping between customer numbers and groups.
//!
//! Customers of all groups are numbered in order of arrival. Random draws depend on the group and the sequence number
//! within the group. If two runs with the same seed have different numbers of leads, they therefore contain the same
//! customers under different customer numbers.

use crate::canonical::canonical;
use crate::identifiers::Group;

/// The customer numbers that have been assigned, in order of arrival.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct CustomerNumbers {
    arrival_runs: Vec<ArrivalRun>,
}

/// Customers of one group who arrived on one day and have consecutive numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ArrivalRun {
    /// Day on which the customers arrived.
    pub day: u32,
    /// Group of the customers.
    pub group: Group,
    /// Lowest customer number in the arrival run.
    pub first_customer: u32,
    /// Lowest sequence number, within the group, in the arrival run.
    pub first_n: u32,
    /// Number of customers in the arrival run.
    pub count: u32,
}

canonical! {
    CustomerNumbers { arrival_runs }
    ArrivalRun { day, group, first_customer, first_n, count }
}

impl ArrivalRun {
    /// Returns the sequence number and the customer number of each customer in the arrival run.
    pub fn numbers(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        (self.first_n..self.first_n + self.count).zip(self.first_customer..)
    }

    /// Splits the arrival run into parts of at most `most` customers.
    pub fn split(self, most: u32) -> impl Iterator<Item = ArrivalRun> {
        (0..self.count).step_by(most as usize).map(move |from| ArrivalRun {
            first_customer: self.first_customer + from,
            first_n: self.first_n + from,
            count: most.min(self.count - from),
            ..self
        })
    }
}

impl CustomerNumbers {
    /// Appends an arrival run with the next customer numbers.
    pub(super) fn add(&mut self, run: ArrivalRun) {
        if run.count > 0 {
            self.arrival_runs.push(run);
        }
    }

    /// Returns the group and the sequence number of a customer, or `None` if the number was never assigned.
    pub fn find(&self, customer: u32) -> Option<(Group, u32)> {
        let (run, offset) = self.locate(customer)?;
        Some((run.group, run.first_n + offset))
    }

    /// Returns the day on which a customer arrived, or `None` if the number was never assigned.
    pub fn arrival_day(&self, customer: u32) -> Option<u32> {
        self.locate(customer).map(|(run, _)| run.day)
    }

    /// Returns the number of the customer with sequence number `n` in a group, or `None` if the customer has not
    /// arrived.
    pub fn customer_number(&self, group: Group, n: u32) -> Option<u32> {
        let contains_customer =
            |run: &&ArrivalRun| run.group == group && run.first_n <= n && n - run.first_n < run.count;
        let run = self.arrival_runs.iter().rev().find(contains_customer)?;
        Some(run.first_customer + (n - run.first_n))
    }

    fn locate(&self, customer: u32) -> Option<(&ArrivalRun, u32)> {
        let after = self.arrival_runs.partition_point(|run| run.first_customer <= customer);
        let run = self.arrival_runs[..after].last()?;
        let offset = customer - run.first_customer;
        (offset < run.count).then_some((run, offset))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Customers, FIRST_CUSTOMER};
    use crate::identifiers::Group;

    #[test]
    fn customer_numbers_map_both_ways() {
        let [one, other] = [Group::all().next(), Group::all().nth(3)].map(|group| group.expect("a group"));
        let mut customers = Customers::default();
        for (day, group, count) in [(1, one, 3), (1, other, 2), (2, one, 0), (3, one, 4)] {
            customers.record_arrival(day, group, count);
        }
        let numbers = &customers.numbers;
        let named = |number| numbers.find(FIRST_CUSTOMER + number);
        assert_eq!([named(2), named(4), named(5)], [Some((one, 3)), Some((other, 2)), Some((one, 4))]);
        assert_eq!([named(9), numbers.find(FIRST_CUSTOMER - 1)], [None, None]);
        assert_eq!(numbers.arrival_day(FIRST_CUSTOMER + 8), Some(3));
        for number in 0..9 {
            let (group, n) = named(number).expect("a customer");
            assert_eq!(numbers.customer_number(group, n), Some(FIRST_CUSTOMER + number));
        }
        assert_eq!(
            [
                numbers.customer_number(one, 8),
                numbers.customer_number(other, 3),
                numbers.customer_number(one, 0)
            ],
            [None; 3]
        );
    }
}
