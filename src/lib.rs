//! NovaMind console.
pub mod world;
