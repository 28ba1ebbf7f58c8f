//! Work that the user may have to wait for.

use std::time::Instant;

use super::SimulationProgress;
use novamind_worker::request::SCRIPT_STATUS;

/// Work that the user may have to wait for.
#[derive(Debug, Clone)]
pub struct BusyState {
    /// Label of the work.
    pub label: &'static str,
    /// Progress in days, for simulations and seeking.
    pub progress: Option<SimulationProgress>,
    /// Time at which the work started.
    pub started_at: Instant,
    /// Whether the script is being stopped. The stop request is repeated until the script ends, because a script that
    /// is starting may miss a request.
    pub is_stopping_script: bool,
}

impl BusyState {
    /// Returns the state of work that starts now.
    pub fn new(what: &'static str) -> BusyState {
        BusyState { label: what, progress: None, started_at: Instant::now(), is_stopping_script: false }
    }

    /// Returns whether the work is a script. The user can stop scripts.
    pub fn is_script(&self) -> bool {
        self.label == SCRIPT_STATUS
    }
}
