//! The built program in a pseudo terminal: start, play, quit, resume; signals, small windows.

mod failures;
mod kill;
mod play;
mod pty;
mod record;
mod scripts;
