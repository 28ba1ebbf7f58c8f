//! The curve explorer: the quality that a group requires at a price, and the results of other prices and qualities
//! (docs/mechanics/customers/curve-explorer.md).
//!
//! In debug runs and finished runs it uses the true traits of the group, and each inspection is recorded. In all other runs it
//! uses the estimates of market studies, so that it reveals no hidden state.

pub(crate) mod access;
pub(crate) mod assumed;
pub(crate) mod example;
pub(crate) mod explorer;

#[cfg(test)]
mod tests;
