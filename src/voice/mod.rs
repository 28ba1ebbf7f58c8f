//! Words for facts: posts, notices, readings of the economy, letters of companies, addresses; and the judge of the
//! player's posts. Facts go in, text comes out (or text in, scores out); nothing here touches a number of the world.

pub mod address;
pub mod grammar;
pub mod judge;
pub mod negotiation;
pub mod notices;
pub mod posts;
pub mod readings;

pub use address::address;
pub use negotiation::message;
pub use notices::notice;
pub use readings::reading;
