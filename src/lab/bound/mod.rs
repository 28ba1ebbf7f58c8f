//! The paper's account of an upper bound, line by line from the parameters in force (docs/laboratory/bound.md).

mod account;
mod climate;
mod customers;
mod improving;
mod knowing;
mod premises;
mod published;
mod reasons;
mod renewals;
mod requirement;
mod running;
mod targeted;
mod winning;

pub use account::{BoundAccount, NEARLY_ALL, SlackRow, sensitivity};
pub use premises::{PUBLISHED_SLACK, Premises};
pub use published::AccountLine;
