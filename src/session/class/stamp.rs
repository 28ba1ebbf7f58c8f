//! Which hand-out of a class a run began with.

use serde::{Deserialize, Serialize};

/// Which hand-out of a class a run began with, as its first line says.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HandoutStamp {
    /// Name of the class: eight hexadecimal digits.
    pub class: String,
    /// The run that the hand-out begins; later parts and tries have names of their own.
    pub run: String,
}

/// What a hand-out lays down for a new run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HandoutEntry {
    /// The hand-out.
    pub stamp: HandoutStamp,
    /// Name of the run; one of its own where the hand-out names another.
    pub run: Option<String>,
}

impl HandoutEntry {
    /// For the run that a hand-out begins.
    pub(super) fn of_first_run(stamp: HandoutStamp) -> HandoutEntry {
        HandoutEntry { run: Some(stamp.run.clone()), stamp }
    }

    /// For a run that follows the one that the hand-out begins.
    pub(crate) fn of_later_run(stamp: HandoutStamp) -> HandoutEntry {
        HandoutEntry { stamp, run: None }
    }
}
