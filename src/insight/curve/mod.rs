//! The curve explorer: how much quality a group requires at a price, and what would come of other prices and qualities
//! (docs/mechanics/customers/curve-explorer.md).
//!
//! In debug runs and in runs that are over it is drawn from the traits of the group itself, and each look is recorded; in all
//! others from what studies have told, so that nothing hidden can be read off it.

pub(crate) mod access;
pub(crate) mod assumed;
pub(crate) mod example;
pub(crate) mod explorer;

#[cfg(test)]
mod tests;
