//! Words for facts: posts, notices, readings of the economy, letters of companies, addresses; and the judge of the
//! player's posts. Facts go in, text comes out (or text in, scores out); nothing here touches a number of the world.

pub mod address;
mod company_names;
mod grammar;
pub mod judge;
pub mod model;
mod negotiation;
pub mod notices;
pub mod posts;
mod readings;

pub use address::address;
pub use company_names::CompanyNames;
pub use negotiation::message;
#[cfg(any(test, feature = "test-kit"))]
pub use notices::notice;
pub use readings::reading;
