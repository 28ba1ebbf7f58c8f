//! Changes to recorded days in a re-simulation.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use serde_json::Value;

use novamind_record::figures::WeekFigures;
use novamind_session::engine::UsageRule;
use novamind_tools::ToolId;
use novamind_world::customers::numbers::CustomerNumbers;
use novamind_world::held::Held;
use novamind_world::params::Params;

/// Changes to the days of a run. Without changes, the re-simulation reproduces the recorded states.
#[derive(Debug, Clone, Default)]
pub(crate) struct Edits {
    /// Calls before all recorded steps.
    pub opening: Vec<(ToolId, Value)>,
    /// Lines of omitted calls and parameter changes.
    pub dropped: BTreeSet<u64>,
    /// Changed arguments of calls, by line.
    pub changed: BTreeMap<u64, Value>,
    /// Added calls.
    pub added: Vec<AddedCall>,
    /// Added parameter changes, made before the added calls.
    pub set: Vec<AddedSetting>,
    /// Rule that adjusts the capacity to usage at the start of every week.
    pub capacity: Option<FollowedUsage>,
    /// Usage of the previous week, for the first adjustment of the capacity.
    pub week_before: Option<WeekFigures>,
    /// Customers by their numbers in the run; `None` if the numbers are equal in every branch.
    pub meant: Option<Arc<CustomerNumbers>>,
    /// Fixed inputs of the world.
    pub held: Held,
    /// Replaced parameters.
    pub params: Option<Arc<Params>>,
    /// Redrawn random draws.
    pub redrawn: Option<Redrawn>,
}

/// A rule that adjusts the capacity to usage, with its first day.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct FollowedUsage {
    pub rule: UsageRule,
    pub from: u32,
}

/// New random draws after a day.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Redrawn {
    /// Last day with the random draws of the run.
    pub after: u32,
    /// Salt; equal salts give equal draws.
    pub salt: u64,
}

/// A call that was not made in the run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AddedCall {
    /// Decision day; the call follows the recorded calls of that day.
    pub day: u32,
    /// Tool.
    pub tool: ToolId,
    /// Arguments.
    pub args: Value,
}

/// A parameter that was not set in the run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AddedSetting {
    /// Decision day; the change follows the recorded calls of that day.
    pub day: u32,
    /// Full key.
    pub key: String,
    /// New value.
    pub value: Value,
}
