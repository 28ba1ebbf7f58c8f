//! Words for facts: notices, readings of the economy, addresses. Facts go in, text comes out; nothing here
//! draws, remembers, or touches a number of the world.

pub mod address;
pub mod grammar;
pub mod judge;
pub mod notices;
pub mod readings;

pub use address::address;
pub use notices::notice;
pub use readings::reading;
