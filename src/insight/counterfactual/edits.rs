//! Changes to recorded days in a re-simulation.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use serde_json::Value;

use novamind_record::figures::WeekFigures;
use novamind_session::engine::UsageCapacityRule;
use novamind_tools::ToolId;
use novamind_world::customers::customer_numbers::CustomerNumbers;
use novamind_world::fixed_inputs::FixedInputs;
use novamind_world::params::Params;

/// Changes to the days of a run. Without changes, the re-simulation reproduces the recorded states.
#[derive(Debug, Clone, Default)]
pub(crate) struct Edits {
    /// Calls before all recorded steps.
    pub initial_calls: Vec<(ToolId, Value)>,
    /// Lines of omitted calls and parameter changes.
    pub dropped_lines: BTreeSet<u64>,
    /// Changed arguments of calls, by line.
    pub changed_arguments: BTreeMap<u64, Value>,
    /// Added calls.
    pub added_calls: Vec<AddedCall>,
    /// Added parameter changes, made before the added calls.
    pub added_settings: Vec<AddedSetting>,
    /// Rule that adjusts the capacity to usage at the start of every week.
    pub capacity_rule: Option<UsageBasedCapacity>,
    /// Usage of the previous week, for the first adjustment of the capacity.
    pub week_before: Option<WeekFigures>,
    /// Customers by their numbers in the run; `None` if the numbers are equal in every branch.
    pub recorded_numbers: Option<Arc<CustomerNumbers>>,
    /// Fixed inputs of the world.
    pub held_inputs: FixedInputs,
    /// Replaced parameters.
    pub params: Option<Arc<Params>>,
    /// Redrawn random draws.
    pub redraw: Option<Redraw>,
}

/// A rule that adjusts the capacity to usage, with its first day.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct UsageBasedCapacity {
    pub rule: UsageCapacityRule,
    pub from_day: u32,
}

/// New random draws after a day.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Redraw {
    /// Last day with the random draws of the run.
    pub after_day: u32,
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
