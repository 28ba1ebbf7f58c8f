//! What several stories use: a company run through the library, the built program in a home of its own, dice.
#![allow(dead_code, reason = "each group of stories uses its part")]

pub mod company;
pub mod dice;
pub mod forging;
pub mod home;
pub mod lessons;
pub mod python;
pub mod record;
