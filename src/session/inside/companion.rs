//! A value that a higher crate keeps with an open run, for instance what earlier looks have simulated.

use std::any::Any;

use crate::state::Session;

/// A value of a higher crate whose type the session does not know.
#[derive(Default)]
pub(crate) struct Companion {
    kept: Option<Box<dyn Any + Send>>,
    /// Number of times that the database was replaced since the run was opened.
    pub(crate) databases: u32,
}

impl Session {
    /// Takes the value that was kept with the run, or the default if no value of this type was kept.
    pub fn take_companion<T: Any + Default>(&mut self) -> Box<T> {
        self.companion.kept.take().and_then(|kept| kept.downcast().ok()).unwrap_or_default()
    }

    /// Keeps a value with the run until it is taken.
    pub fn keep_companion<T: Any + Send>(&mut self, kept: Box<T>) {
        self.companion.kept = Some(kept);
    }

    /// Number of times that the database was replaced since the run was opened. Connections to an earlier database are stale.
    pub fn databases(&self) -> u32 {
        self.companion.databases
    }
}
