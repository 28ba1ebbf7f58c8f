//! The event in the first line of a trajectory.

use serde::{Deserialize, Serialize};
use toml::Table;

use super::serialize_shortest;
use crate::consent::Consent;
use crate::mode::Mode;
use crate::rules::SessionRules;
use crate::stamp::HandoutStamp;
use crate::stamp::LessonStamp;
use crate::stamp::{EarlierRun, StudyStamp};
use novamind_voice::model::settings::RecordedModelSettings;
use novamind_world::fault::Fault;

/// The event in the first line: manifest and rules of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Start {
    /// Format number of the trajectory.
    pub format: u32,
    /// Version of the program that created the run.
    pub version: String,
    /// Version number of the mechanics.
    #[serde(default = "first_mechanics")]
    pub mechanics: u32,
    /// ID of the run.
    pub run: String,
    /// Seed of all random draws.
    pub seed: u64,
    /// Last day of the run.
    pub days: u32,
    /// Length that scales competitor events, if it differs from the last day.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub total_days: Option<u32>,
    /// Cash on day 0, dollars.
    #[serde(serialize_with = "serialize_shortest")]
    pub cash: f64,
    /// Name of the scenario.
    pub scenario: String,
    /// Parameters whose values differ from the bundled parameters.
    #[serde(default)]
    pub overrides: Table,
    /// Seeded fault of the mechanics; debug runs only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fault: Option<Fault>,
    /// Digest of the effective parameters.
    pub parameters_digest: String,
    /// Mode of the run.
    pub mode: Mode,
    /// Label of the participant.
    pub participant: Option<String>,
    /// Consent of the participant, if consent was required.
    #[serde(default)]
    pub consent: Option<Consent>,
    /// Study to which the run belongs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub study: Option<StudyStamp>,
    /// Lesson to which the run belongs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lesson: Option<LessonStamp>,
    /// Handout from which the run started.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub handout: Option<HandoutStamp>,
    /// Language model that words posts and messages, if one is used.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub voice: Option<RecordedModelSettings>,
    /// Session rules; `None` in runs of format 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rules: Option<SessionRules>,
    /// Earlier runs of the same participant.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub earlier_runs: Vec<EarlierRun>,
    /// Parent run and last copied line, if the run is a branch.
    pub parent: Option<Parent>,
    /// Whether every line has a checksum; false in runs of the first builds.
    #[serde(default)]
    pub line_sums: bool,
}

/// The parent run of a branch, and the last line that the branch copied.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parent {
    /// ID of the parent run.
    pub run: String,
    /// Number of the last copied line.
    pub seq: u64,
}

/// Returns the mechanics number for runs whose first line has no mechanics number.
pub(crate) fn first_mechanics() -> u32 {
    1
}
