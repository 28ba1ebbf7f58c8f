//! A value that a higher crate keeps with an open run, for instance what earlier looks have simulated.

use std::any::Any;

/// A value of a higher crate whose type the session does not know.
#[derive(Default)]
pub struct Companion {
    kept: Option<Box<dyn Any + Send>>,
}

impl Companion {
    /// Takes the value that was kept with the run, or the default if no value of this type was kept.
    pub fn take<T: Any + Default>(&mut self) -> Box<T> {
        self.kept.take().and_then(|kept| kept.downcast().ok()).unwrap_or_default()
    }

    /// Keeps a value with the run until it is taken.
    pub fn keep<T: Any + Send>(&mut self, kept: Box<T>) {
        self.kept = Some(kept);
    }
}
