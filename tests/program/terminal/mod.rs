//! The built program in a pseudo terminal: start, play, leave, come back; signals, small windows.

mod hardship;
mod kill;
mod play;
mod pty;
mod record;
mod scripts;
