//! The built program in a pseudoterminal: start, play, quit and resume, signals and small windows.

mod failures;
mod kill;
mod play;
mod pty;
mod record;
mod scripts;
