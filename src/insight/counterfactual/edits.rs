//! Edits to recorded days for a re-simulation.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use serde_json::Value;

use super::suspended_setting::SuspendedSetting;
use novamind_record::figures::WeekFigures;
use novamind_session::engine::UsageCapacityRule;
use novamind_tools::ToolId;
use novamind_world::customers::customer_numbers::CustomerNumbers;
use novamind_world::fixed_inputs::FixedInputs;
use novamind_world::params::Params;

/// Changes to recorded days of a run. If there are no edits, the re-simulation reproduces the recorded states.
#[derive(Debug, Clone, Default)]
pub(crate) struct Edits {
    /// Calls that are executed before all recorded steps.
    pub initial_calls: Vec<(ToolId, Value)>,
    /// Line numbers of the calls and parameter changes to omit.
    pub dropped_lines: BTreeSet<u64>,
    /// New arguments of recorded calls, by line number.
    pub changed_arguments: BTreeMap<u64, Value>,
    /// Calls that are not in the record.
    pub added_calls: Vec<AddedCall>,
    /// Parameter changes that are not in the record. The changes are applied before the added calls.
    pub added_settings: Vec<AddedSetting>,
    /// Rule that adjusts the capacity to usage at the start of every week.
    pub capacity_rule: Option<UsageBasedCapacity>,
    /// Usage of the week before the re-simulation, for the first adjustment of the capacity.
    pub week_before: Option<WeekFigures>,
    /// Customer numbers of the recorded run; `None` if the branch has the same numbers.
    pub recorded_numbers: Option<Arc<CustomerNumbers>>,
    /// World inputs that are fixed at given values.
    pub fixed_inputs: FixedInputs,
    /// Whether the bills that fall due are counted. Only *why* needs them, for the residual.
    pub counts_due_bills: bool,
    /// Settings that are 0 while days are simulated.
    pub suspended_settings: Vec<SuspendedSetting>,
    /// Parameters that replace the parameters of the run.
    pub params: Option<Arc<Params>>,
    /// New random draws that replace the draws of the run after a day.
    pub redraw: Option<Redraw>,
}

/// A rule that adjusts the capacity to usage from a given day.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct UsageBasedCapacity {
    pub rule: UsageCapacityRule,
    pub from_day: u32,
}

/// New random draws that replace the draws of the run after a day.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Redraw {
    /// Last day that uses the random draws of the run.
    pub after_day: u32,
    /// Salt of the new draws. Equal salts produce equal draws.
    pub salt: u64,
}

/// A call that is added to the recorded calls.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AddedCall {
    /// Decision day; the call follows the recorded calls of that day.
    pub day: u32,
    /// Tool of the added call.
    pub tool: ToolId,
    /// Arguments of the added call.
    pub args: Value,
}

/// A parameter change that is added to the recorded changes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AddedSetting {
    /// Decision day; the change is applied after the recorded calls of that day.
    pub day: u32,
    /// Full key of the parameter, for example `demand_surge.probability`.
    pub key: String,
    /// New value of the parameter.
    pub value: Value,
}
