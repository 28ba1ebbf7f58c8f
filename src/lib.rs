//! NovaMind console.
pub mod notation;
pub mod tools;
pub mod world;
