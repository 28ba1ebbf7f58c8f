//! NovaMind console.
pub mod database;
pub mod notation;
pub mod session;
pub mod tools;
pub mod voice;
pub mod world;
