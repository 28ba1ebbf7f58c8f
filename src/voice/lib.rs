//! Writes the texts of the simulated world: posts, notices, PMI readings, messages and addresses of enterprises. The
//! crate also judges the player's posts. This crate never changes the world.

pub mod address;
mod enterprise_names;
mod grammar;
pub mod judge;
pub mod model;
mod negotiation;
pub mod notices;
pub mod posts;
mod readings;

pub use address::enterprise_address;
pub use enterprise_names::EnterpriseNames;
pub use negotiation::message;
#[cfg(any(test, feature = "test-kit"))]
pub use notices::notice_text;
pub use readings::reading_text;
