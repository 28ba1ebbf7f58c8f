//! What is changed when days are simulated again.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use serde_json::Value;

use novamind_record::figures::WeekFigures;
use novamind_session::engine::UsageRule;
use novamind_tools::ToolId;
use novamind_world::customers::numbers::CustomerNumbers;
use novamind_world::held::Held;
use novamind_world::params::Params;

/// Changes to the days of a run. Without any, they lead to the state they led to.
#[derive(Debug, Clone, Default)]
pub(crate) struct Edits {
    /// Calls that are made before everything else.
    pub opening: Vec<(ToolId, Value)>,
    /// Lines of calls that are not made, and of parameters that are not set.
    pub dropped: BTreeSet<u64>,
    /// Other arguments of calls, by line.
    pub changed: BTreeMap<u64, Value>,
    /// Calls that are made besides.
    pub added: Vec<AddedCall>,
    /// Parameters that are set besides, before those calls.
    pub set: Vec<AddedSetting>,
    /// The capacity follows usage at the start of every week.
    pub capacity: Option<FollowedUsage>,
    /// The week before all of it, for the first day on which the capacity follows usage.
    pub week_before: Option<WeekFigures>,
    /// Which customers the calls mean by their numbers; none where numbers are the same in every branch.
    pub meant: Option<Arc<CustomerNumbers>>,
    /// Inputs of the world that are held.
    pub held: Held,
    /// Other parameters.
    pub params: Option<Arc<Params>>,
    /// Other luck.
    pub redrawn: Option<Redrawn>,
}

/// By which rule the capacity follows usage, and from which day on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct FollowedUsage {
    pub rule: UsageRule,
    pub from: u32,
}

/// Luck that is redrawn after a day.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Redrawn {
    /// The last day with the luck of the run.
    pub after: u32,
    /// Equal salts give equal luck.
    pub salt: u64,
}

/// A call that was not made in the run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AddedCall {
    /// Decision day; it is made after the calls of the run on that day.
    pub day: u32,
    /// Tool.
    pub tool: ToolId,
    /// Arguments.
    pub args: Value,
}

/// A parameter that was not set in the run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AddedSetting {
    /// Decision day; it is set after the calls of the run on that day.
    pub day: u32,
    /// Full key.
    pub key: String,
    /// Its value from then on.
    pub value: Value,
}
