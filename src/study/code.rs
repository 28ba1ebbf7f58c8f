//! The experimenter's code.

use std::sync::Arc;

/// Says whether a word is the experimenter's code.
pub type CodeCheck = Arc<dyn Fn(&str) -> bool + Send + Sync>;
