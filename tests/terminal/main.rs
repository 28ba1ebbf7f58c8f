//! The built program in a pseudo terminal: start, play, leave, come back; signals, small windows.
#![cfg(unix)]

#[path = "../console/dice.rs"]
mod dice;

mod hardship;
mod kill;
mod play;
mod terminal;
