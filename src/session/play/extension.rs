//! Storage in a session for a value of a crate that depends on this crate.

use std::any::Any;

/// A value of any type that a dependent crate stores in the session.
#[derive(Default)]
pub struct Extension {
    value: Option<Box<dyn Any + Send>>,
}

impl Extension {
    /// Removes and returns the stored value, or returns the default if no value of this type is stored.
    pub fn take<T: Any + Default>(&mut self) -> Box<T> {
        self.value.take().and_then(|kept| kept.downcast().ok()).unwrap_or_default()
    }

    /// Stores a value until [`Extension::take`] is called.
    pub fn store<T: Any + Send>(&mut self, kept: Box<T>) {
        self.value = Some(kept);
    }
}
