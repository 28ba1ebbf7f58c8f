//! Work that the person may have to wait for.

use std::time::Instant;

use super::DaysRun;
use novamind_worker::request::SCRIPT_RUNS;

/// Work that the person may have to wait for.
#[derive(Debug, Clone)]
pub struct Busy {
    /// What it is.
    pub what: &'static str,
    /// How far a week, or a way through a record, has come.
    pub days: Option<DaysRun>,
    /// When it began.
    pub since: Instant,
    /// The script that keeps it busy is to end. Asked again until it does: it may only just be starting.
    pub stops_script: bool,
}

impl Busy {
    /// From now on, with something.
    pub fn with(what: &'static str) -> Busy {
        Busy { what, days: None, since: Instant::now(), stops_script: false }
    }

    /// Whether a script runs, which can be stopped.
    pub fn is_script(&self) -> bool {
        self.what == SCRIPT_RUNS
    }
}
