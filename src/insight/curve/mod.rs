//! The curve explorer shows the quality that a group requires at a price, and the expected results of other prices and
//! qualities (docs/mechanics/customers/curve-explorer.md).
//!
//! In debug runs and finished runs, the explorer uses the true traits of the group, and each inspection is recorded.
//! In all other runs, the explorer uses the estimates of market studies, so that no hidden state is revealed.

pub(crate) mod access;
pub(crate) mod assumed;
pub(crate) mod example;
pub(crate) mod explorer;

#[cfg(test)]
mod tests;
