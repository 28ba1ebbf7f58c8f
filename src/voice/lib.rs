//! Text for facts: posts, notices, readings of the economy, messages of enterprises, addresses; and the judge
//! of the player's posts. This crate converts facts to text and text to scores; it never changes the world.

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
