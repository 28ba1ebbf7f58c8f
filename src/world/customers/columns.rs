//! Active subscribers in columns, split into blocks by the customers' sequence numbers within their group.
//!
//! A block contains the active customers `first ..= first + CUSTOMERS_PER_BLOCK - 1` of one group, in ascending order
//! of their numbers. A sweep processes each block on one thread. Each customer has a fixed position in the random
//! stream of its block, so the draws of one customer never affect another customer
//! (docs/mechanics/randomness.md#blocks).

use crate::canonical::{Canonical, CanonicalHasher, CanonicalReader, Restore};
use crate::identifiers::Plan;

use super::curve::Curve;

/// Number of consecutive sequence numbers that one block covers.
pub const CUSTOMERS_PER_BLOCK: u32 = 1024;

macro_rules! columns {
    (
        $(#[$block_doc:meta])* block $Block:ident,
        $(#[$row_doc:meta])* row $Row:ident {
            $($(#[$doc:meta])* $column:ident: $kind:ty,)*
        }
    ) => {
        $(#[$row_doc])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $Row { $($(#[$doc])* pub $column: $kind,)* }

        $(#[$block_doc])*
        #[derive(Debug, Clone, Default)]
        pub struct $Block { $($(#[$doc])* pub $column: Vec<$kind>,)* }

        impl $Block {
            /// Creates an empty block with capacity for `rows` rows.
            pub fn with_capacity(rows: usize) -> $Block {
                $Block { $($column: Vec::with_capacity(rows),)* }
            }

            /// Appends a row to the block.
            pub fn push(&mut self, row: $Row) {
                $(self.$column.push(row.$column);)*
            }

            /// Appends rows to the block.
            pub fn extend(&mut self, rows: &[$Row]) {
                $(self.$column.extend(rows.iter().map(|row| row.$column));)*
            }

            /// Inserts a row at a position of the block.
            pub fn insert(&mut self, at: usize, row: $Row) {
                $(self.$column.insert(at, row.$column);)*
            }

            /// Returns the row at a position of the block.
            pub fn row(&self, at: usize) -> $Row {
                $Row { $($column: self.$column[at],)* }
            }

            /// Returns the number of canonical bytes of the block.
            pub fn canonical_length(&self) -> usize {
                // A column value has as many canonical bytes as it occupies in memory.
                0 $(+ size_of::<u64>() + self.$column.len() * size_of::<$kind>())*
            }

            /// Removes the rows at the ascending positions `gone`. The remaining rows keep their order.
            pub fn remove(&mut self, gone: &[usize]) {
                if !gone.is_empty() {
                    $(drop_positions(&mut self.$column, gone);)*
                }
            }
        }

        impl $Row {
            /// Returns the columns in which the rows differ: name, value of `self`, value of `other`.
            pub fn differing(&self, other: &$Row) -> Vec<(&'static str, String, String)> {
                let mut found = Vec::new();
                $(if self.$column != other.$column {
                    let (own, other) = (format!("{:?}", self.$column), format!("{:?}", other.$column));
                    found.push((stringify!($column), own, other));
                })*
                found
            }
        }

        impl Canonical for $Row {
            fn feed(&self, hasher: &mut CanonicalHasher) {
                $(self.$column.feed(hasher);)*
            }
        }

        impl Restore for $Row {
            fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
                $(let $column = reader.read()?;)*
                Some($Row { $($column,)* })
            }
        }

        impl Restore for $Block {
            fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
                $(let $column: Vec<$kind> = reader.read()?;)*
                let block = $Block { $($column,)* };
                let whole = [$(block.$column.len(),)*].iter().all(|length| *length == block.len());
                whole.then_some(block)
            }
        }

        impl Canonical for $Block {
            fn feed(&self, hasher: &mut CanonicalHasher) {
                $(self.$column.feed(hasher);)*
            }
        }
    };
}

columns! {
    /// The active subscribers of a range of customer numbers, one vector per column.
    block Block,
    /// The row of one active subscriber.
    row Subscriber {
        /// Sequence number of the customer within the group, from 1.
        n: u32,
        /// Customer number, which is unique across all groups.
        customer: u32,
        /// Number of the subscription, which is unique across all groups.
        subscription: u32,
        /// Current plan. A renewal or a deal can change it.
        plan: Plan,
        /// Billing day modulo 30: the subscriber is billed on days with this remainder.
        billing_day: u8,
        /// Whether the subscriber has received the first bill.
        billed_once: bool,
        /// Day on which the subscription started.
        start_day: u32,
        /// Steepness of the lower half of the curve, including individual drift.
        steepness_left: f64,
        /// Steepness of the upper half of the curve, which does not drift.
        steepness_right: f64,
        /// Budget including individual drift, dollars per month.
        c_max: f64,
        /// Quality required at a price near 0, including individual drift.
        q_min: f64,
        /// Quality required above the budget, including individual drift.
        q_max: f64,
        /// Mean demand, units per seat per day.
        usage_demand: f64,
        /// Quality loss from in-app advertising at full strength.
        ads_quality_sensitivity: f64,
        /// Ad revenue at full strength, dollars per seat per day.
        ads_return_sensitivity: f64,
        /// Number of seats. The seats of enterprises drift and have a fraction, but only whole seats count.
        seats: f64,
        /// Price before discounts, dollars per seat per month.
        listed_price: f64,
        /// Current discount, dollars per seat per month.
        promotion: f64,
        /// Current effective price, dollars per seat per month.
        effective_price: f64,
        /// Budget that was stored with the last bill, dollars per month.
        effective_c_max: f64,
        /// Usage rate in this billing period, units per day for the whole account.
        usage_rate: f64,
        /// Units used in this billing period.
        period_usage: u64,
        /// Satisfaction of the subscriber; not bounded.
        satisfaction: f64,
        /// Relationship with the company, 0..=1.
        relationship: f64,
        /// Number of days for which the current issue has been open, or 0 if there is none.
        open_issue_days: u32,
        /// Number of the open issue, or 0 if there is none.
        issue: u32,
        /// Required quality at the current price, without the market's expectations.
        required: f64,
    }
}

fn drop_positions<T: Copy>(column: &mut Vec<T>, gone: &[usize]) {
    let mut kept = gone[0];
    for (number, &at) in gone.iter().enumerate() {
        let next = gone.get(number + 1).copied().unwrap_or(column.len());
        column.copy_within(at + 1..next, kept);
        kept += next - at - 1;
    }
    column.truncate(kept);
}

impl Block {
    /// Returns the number of active subscribers in the block.
    #[inline]
    pub fn len(&self) -> usize {
        self.n.len()
    }

    /// Returns whether the block has no active subscribers.
    pub fn is_empty(&self) -> bool {
        self.n.is_empty()
    }

    /// Returns the number of subscribers in the block that have an open issue.
    pub fn open_issues(&self) -> u32 {
        self.open_issue_days.iter().filter(|days| **days > 0).count() as u32
    }

    /// Returns the position of the customer with sequence number `n`.
    pub fn position(&self, n: u32) -> Option<usize> {
        self.n.binary_search(&n).ok()
    }

    /// Returns the participation curve of a row, without the market's expectations.
    #[inline]
    pub fn curve(&self, at: usize) -> Curve {
        Curve {
            steepness_left: self.steepness_left[at],
            steepness_right: self.steepness_right[at],
            c_max: self.c_max[at],
            q_min: self.q_min[at],
            q_max: self.q_max[at],
        }
    }

    /// Returns the positions of subscribers whose billing day modulo 30 is `billing_day`.
    pub fn due_positions(&self, billing_day: u8) -> Vec<usize> {
        // Customers who arrived on the same day are adjacent. Most blocks therefore have no due subscribers, and a
        // search detects such blocks quickly.
        if !self.billing_day.contains(&billing_day) {
            return Vec::new();
        }
        let days = self.billing_day.iter().enumerate();
        days.filter(|(_, day)| **day == billing_day).map(|(at, _)| at).collect()
    }

    /// Returns the position of a row's random word in the stream of its block.
    #[inline]
    pub fn word_position(&self, at: usize) -> usize {
        word_position_in_block(self.n[at])
    }
}

/// Returns the position of a customer's random word in the stream of its block. `n` is the sequence number of the
/// customer.
#[inline]
pub fn word_position_in_block(n: u32) -> usize {
    ((n - 1) % CUSTOMERS_PER_BLOCK) as usize
}

/// Returns the sums of several columns, each added in order. Interleaving the columns hides the latency of the
/// dependent additions.
pub fn sum_columns<const COLUMNS: usize>(columns: [&[f64]; COLUMNS]) -> [f64; COLUMNS] {
    let common = columns.iter().map(|column| column.len()).min().unwrap_or(0);
    let heads = columns.map(|column| &column[..common]);
    let mut sums = [0.0; COLUMNS];
    for at in 0..common {
        for (sum, head) in sums.iter_mut().zip(heads) {
            *sum += head[at];
        }
    }
    for (sum, column) in sums.iter_mut().zip(columns) {
        column[common..].iter().for_each(|value| *sum += value);
    }
    sums
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::test_kit::subscriber;
    use proptest::prelude::*;

    #[test]
    fn sum_columns_handles_different_lengths() {
        let column = |length: usize, seed: f64| -> Vec<f64> {
            (0..length).map(|at| libm::sin(at as f64 * seed) * 1e3 + 0.1).collect()
        };
        let columns = [column(700, 0.3), column(3, 1.7), column(0, 1.0), column(41, 12.9)];
        let one_by_one = columns.each_ref().map(|column| column.iter().fold(0.0, |sum, value| sum + value));
        assert_eq!(sum_columns(columns.each_ref().map(Vec::as_slice)), one_by_one);
        let alike = [&columns[0][..], &columns[0][..]];
        assert_eq!(sum_columns(alike), [one_by_one[0]; 2]);
    }

    proptest! {
        #[test]
        fn remove_keeps_the_order_of_other_rows(
            count in 1u32..60,
            gone in proptest::collection::btree_set(0usize..60, 0..30),
        ) {
            let mut block = Block::default();
            (1..=count).for_each(|n| block.push(subscriber(n)));
            let gone: Vec<usize> = gone.into_iter().filter(|at| *at < count as usize).collect();
            let expected: Vec<u32> = (1..=count).filter(|n| !gone.contains(&(*n as usize - 1))).collect();
            block.remove(&gone);
            prop_assert_eq!(&block.n, &expected);
            let customers: Vec<u32> = expected.iter().map(|n| n + 1).collect();
            prop_assert_eq!(&block.customer, &customers);
        }
    }

    #[test]
    fn row_returns_pushed_values() {
        let mut block = Block::default();
        block.push(subscriber(3));
        block.insert(0, subscriber(1));
        assert_eq!((block.row(0), block.row(1)), (subscriber(1), subscriber(3)));
        assert_eq!((block.position(3), block.position(2)), (Some(1), None));
        assert_eq!(block.word_position(1), 2);
    }
}
