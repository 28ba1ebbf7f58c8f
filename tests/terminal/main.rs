//! The built program in a pseudo terminal: start, play, leave, come back; signals, small windows.
#![cfg(unix)]

mod hardship;
mod play;
mod terminal;
