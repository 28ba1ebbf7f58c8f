//! Checks of the experimenter's code.

use std::sync::Arc;

/// A function that checks whether a text is the experimenter's code.
pub type CodeCheck = Arc<dyn Fn(&str) -> bool + Send + Sync>;
