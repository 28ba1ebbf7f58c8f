//! The first line: what the run is, and by which rules it is played.

use serde::{Deserialize, Serialize};
use toml::Table;

use super::shortest;
use crate::consent::Consent;
use crate::mode::Mode;
use crate::rules::SessionRules;
use crate::stamp::HandoutStamp;
use crate::stamp::LessonStamp;
use crate::stamp::{EarlierRun, StudyStamp};
use novamind_voice::model::settings::ModelStamp;
use novamind_world::fault::Fault;

/// What the first line says of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Start {
    /// Format of the trajectory.
    pub format: u32,
    /// Version that recorded the run.
    pub version: String,
    /// Number of the mechanics.
    #[serde(default = "first_mechanics")]
    pub mechanics: u32,
    /// Run.
    pub run: String,
    /// Seed.
    pub seed: u64,
    /// Last day.
    pub days: u32,
    /// Cash on day 0, dollars.
    #[serde(serialize_with = "shortest")]
    pub cash: f64,
    /// Scenario.
    pub scenario: String,
    /// Parameters that differ from the shipped ones.
    #[serde(default)]
    pub overrides: Table,
    /// The mechanism that is wrong on purpose; debug runs only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fault: Option<Fault>,
    /// Digest of the effective parameters.
    pub parameters_digest: String,
    /// Mode.
    pub mode: Mode,
    /// Who plays, as the experimenter names them.
    pub participant: Option<String>,
    /// Which text was agreed to, and when.
    #[serde(default)]
    pub consent: Option<Consent>,
    /// The study it belongs to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub study: Option<StudyStamp>,
    /// The lesson it belongs to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lesson: Option<LessonStamp>,
    /// The hand-out of a class that it began with.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub handout: Option<HandoutStamp>,
    /// The language model that lends its voice; none in nearly all runs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub voice: Option<ModelStamp>,
    /// By which rules it is played; none in runs of format 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rules: Option<SessionRules>,
    /// What the same person played before.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub earlier_runs: Vec<EarlierRun>,
    /// Where a branch comes from.
    pub parent: Option<Parent>,
    /// Whether every line ends with a sum; those of the first builds do not.
    #[serde(default)]
    pub line_sums: bool,
}

/// Where a branch comes from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parent {
    /// Run.
    pub run: String,
    /// Number of the last line that was copied.
    pub seq: u64,
}

/// Number of the mechanics of runs whose first line names none.
pub(crate) fn first_mechanics() -> u32 {
    1
}
