//! The built program in a pseudoterminal: start, play, quit and resume, signals and small windows.

mod failures;
#[cfg(all(feature = "server", target_os = "linux"))]
mod hosting;
mod kill;
mod play;
mod pty;
mod record;
mod scripts;
