//! NovaMind console.
pub mod database;
pub mod notation;
pub mod tools;
pub mod voice;
pub mod world;
