//! The paper's upper-bound account, computed line by line from the current parameters (docs/laboratory/bound.md).

mod account;
mod climate;
mod customers;
mod exhibit;
mod improving;
mod knowing;
#[cfg(test)]
mod page;
mod premises;
mod published;
mod reasons;
mod renewals;
mod requirement;
mod running;
mod targeted;
mod winning;

pub use account::{BoundAccount, SlackRow, sensitivity};
pub use exhibit::bound_exhibit;
pub use premises::Premises;
pub use published::AccountLine;
