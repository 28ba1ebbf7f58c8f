//! What those who look inside keep with an open run between two looks.

use std::any::Any;

use crate::state::Session;

/// What is kept with a run for those who look inside; a session does not know what it is.
#[derive(Default)]
pub(crate) struct Companion {
    kept: Option<Box<dyn Any + Send>>,
    /// How often the database was replaced since the run was opened.
    pub(crate) databases: u32,
}

impl Session {
    /// Takes what was kept with the run; nothing, as it is by default, before something of this type was kept.
    pub fn take_companion<T: Any + Default>(&mut self) -> Box<T> {
        self.companion.kept.take().and_then(|kept| kept.downcast().ok()).unwrap_or_default()
    }

    /// Keeps something with the run, until it is taken.
    pub fn keep_companion<T: Any + Send>(&mut self, kept: Box<T>) {
        self.companion.kept = Some(kept);
    }

    /// How often the database was replaced since the run was opened: connections to an earlier one are stale.
    pub fn databases(&self) -> u32 {
        self.companion.databases
    }
}
