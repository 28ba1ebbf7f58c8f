//! Storage for a value of a higher crate with an open run.

use std::any::Any;

/// A value of a higher crate, whose type the session does not know.
#[derive(Default)]
pub struct Extension {
    value: Option<Box<dyn Any + Send>>,
}

impl Extension {
    /// Takes the stored value, or the default if there is none of this type.
    pub fn take<T: Any + Default>(&mut self) -> Box<T> {
        self.value.take().and_then(|kept| kept.downcast().ok()).unwrap_or_default()
    }

    /// Stores a value until it is taken.
    pub fn store<T: Any + Send>(&mut self, kept: Box<T>) {
        self.value = Some(kept);
    }
}
