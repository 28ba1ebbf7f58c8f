//! Which lesson a run belongs to.

use serde::{Deserialize, Serialize};

/// Which lesson a run belongs to, as its first line says.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LessonStamp {
    /// Name of the lesson.
    pub name: String,
    /// Digest of its plan and texts.
    pub digest: String,
    /// The part, counted from 1.
    pub part: u32,
}
