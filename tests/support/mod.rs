//! Shared test support: a company that is played through the library, the built program in a separate home, and random numbers.
#![allow(dead_code, reason = "each test program uses a part of the helpers")]

pub mod company;
pub mod dice;
pub mod forging;
pub mod home;
pub mod lessons;
pub mod python;
pub mod record;
