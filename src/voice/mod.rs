//! Words for facts: notices, readings of the economy, letters of companies, addresses. Facts go in, text comes out; nothing here
//! draws, remembers, or touches a number of the world.

pub mod address;
pub mod negotiation;
pub mod notices;
pub mod readings;

pub use address::address;
pub use negotiation::message;
pub use notices::notice;
pub use readings::reading;
