//! The first line of a trajectory.

use serde::{Deserialize, Serialize};
use toml::Table;

use super::serialize_shortest;
use crate::consent::Consent;
use crate::mode::Mode;
use crate::rules::SessionRules;
use crate::stamp::HandoutStamp;
use crate::stamp::LessonStamp;
use crate::stamp::{EarlierRun, StudyStamp};
use novamind_voice::model::settings::ModelStamp;
use novamind_world::fault::Fault;

/// The first line: manifest and rules of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Start {
    /// Format of the trajectory.
    pub format: u32,
    /// Version that created the run.
    pub version: String,
    /// Number of the mechanics.
    #[serde(default = "first_mechanics")]
    pub mechanics: u32,
    /// Id of the run.
    pub run: String,
    /// Seed.
    pub seed: u64,
    /// Last day.
    pub days: u32,
    /// Cash on day 0, dollars.
    #[serde(serialize_with = "serialize_shortest")]
    pub cash: f64,
    /// Scenario.
    pub scenario: String,
    /// Parameters that differ from the bundled ones.
    #[serde(default)]
    pub overrides: Table,
    /// The seeded fault; debug runs only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fault: Option<Fault>,
    /// Digest of the effective parameters.
    pub parameters_digest: String,
    /// Mode.
    pub mode: Mode,
    /// Label of the participant.
    pub participant: Option<String>,
    /// Consent of the participant.
    #[serde(default)]
    pub consent: Option<Consent>,
    /// The study of the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub study: Option<StudyStamp>,
    /// The lesson of the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lesson: Option<LessonStamp>,
    /// The handout from which the run started.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub handout: Option<HandoutStamp>,
    /// The language model that words texts, if any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub voice: Option<ModelStamp>,
    /// Session rules; `None` in runs of format 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rules: Option<SessionRules>,
    /// Earlier runs of the same participant.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub earlier_runs: Vec<EarlierRun>,
    /// Origin of a branch.
    pub parent: Option<Parent>,
    /// Whether every line has a sum; false in runs of the first builds.
    #[serde(default)]
    pub line_sums: bool,
}

/// Origin of a branch.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parent {
    /// Id of the parent run.
    pub run: String,
    /// Number of the last copied line.
    pub seq: u64,
}

/// Returns the number of the mechanics of runs whose first line has none.
pub(crate) fn first_mechanics() -> u32 {
    1
}
