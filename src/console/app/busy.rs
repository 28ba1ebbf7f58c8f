//! Work that the user may have to wait for.

use std::time::Instant;

use super::DaysRun;
use novamind_worker::request::SCRIPT_RUNS;

/// Work that the user may have to wait for.
#[derive(Debug, Clone)]
pub struct Busy {
    /// Label of the work.
    pub what: &'static str,
    /// Progress in days, for simulations and seeking.
    pub days: Option<DaysRun>,
    /// When it started.
    pub since: Instant,
    /// The script is being stopped. The stop is repeated until it ends, because the script may only just be starting.
    pub stops_script: bool,
}

impl Busy {
    /// Returns the state of work that starts now.
    pub fn with(what: &'static str) -> Busy {
        Busy { what, days: None, since: Instant::now(), stops_script: false }
    }

    /// Returns whether a script is running. Scripts can be stopped.
    pub fn is_script(&self) -> bool {
        self.what == SCRIPT_RUNS
    }
}
