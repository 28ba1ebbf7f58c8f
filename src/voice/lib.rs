//! Text for facts: posts, notices, readings of the economy, messages of enterprises, addresses; and the judge
//! of the player's posts. This crate converts facts to text and text to scores; it never changes the world.

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
