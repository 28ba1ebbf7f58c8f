//! Shared test support: a company run through the library, the built program in its own home, random numbers.
#![allow(dead_code, reason = "each group of stories uses its part")]

pub mod company;
pub mod dice;
pub mod forging;
pub mod home;
pub mod lessons;
pub mod python;
pub mod record;
