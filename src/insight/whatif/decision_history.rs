//! The recorded decisions of a run, with the settings in force before and after each of them.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Map, Value};

use crate::counterfactual::recorded_steps::{RecordedCall, RecordedDecision};
use novamind_record::trajectory::record::Reversal;
use novamind_tools::{ToolId, ToolKind};
use novamind_world::settings::Settings;

/// The recorded decisions of a run, in order, with the settings before the first decision.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DecisionHistory {
    decisions: Vec<RecordedDecision>,
    /// Lines of calls that were undone, and of the calls that undid them.
    undone_lines: BTreeSet<u64>,
    /// Arguments of each tool that would set the initial settings.
    initial: BTreeMap<ToolId, Map<String, Value>>,
    days_per_week: u32,
}

impl DecisionHistory {
    /// Creates the history of decisions. `settings` contains the settings before the first decision.
    pub fn new(decisions: Vec<RecordedDecision>, settings: &Settings, days_per_week: u32) -> DecisionHistory {
        let initial = ToolId::all().map(|tool| (tool, tool.tool().current_arguments(settings))).collect();
        let mut undone_lines = BTreeSet::new();
        for call in decisions.iter().filter_map(RecordedDecision::call) {
            if let (Some(Reversal::Undoes(line)), true) = (call.reversal, call.accepted) {
                undone_lines.extend([line, call.seq]);
            }
        }
        DecisionHistory { decisions, undone_lines, initial, days_per_week }
    }

    /// Returns all decisions, in order.
    pub fn decisions(&self) -> &[RecordedDecision] {
        &self.decisions
    }

    /// Returns the number of days per week of the run.
    pub fn days_per_week(&self) -> u32 {
        self.days_per_week.max(1)
    }

    /// Returns the week, counted from 1, at the start of which or during which a decision was made.
    pub fn decision_week(&self, decision: &RecordedDecision) -> u32 {
        decision.day() / self.days_per_week() + 1
    }

    /// Returns the decision that a line of the trajectory records.
    pub fn decision(&self, line: u64) -> Option<&RecordedDecision> {
        self.decisions.iter().find(|decision| decision.seq() == line)
    }

    /// Returns the decisions of a week, without undone calls and the calls that undid them.
    pub fn decisions_of_week(&self, week: u32) -> impl Iterator<Item = &RecordedDecision> {
        self.decisions
            .iter()
            .filter(move |decision| self.decision_week(decision) == week && !self.is_undone(decision.seq()))
    }

    /// Returns whether the call in a line was undone, or undid another call.
    pub fn is_undone(&self, line: u64) -> bool {
        self.undone_lines.contains(&line)
    }

    /// Returns the arguments that would set the values in force before a call. The map is empty for tools without
    /// settings.
    pub fn values_before(&self, call: &RecordedCall) -> Map<String, Value> {
        self.fold_calls(call.tool, |earlier| earlier.seq < call.seq)
    }

    /// Returns the arguments that would set the values in force after the decisions at the start of a week.
    pub fn values_in_week(&self, tool: ToolId, week: u32) -> Map<String, Value> {
        let start = week.saturating_sub(1) * self.days_per_week();
        self.fold_calls(tool, |call| call.day <= start)
    }

    fn fold_calls(&self, tool: ToolId, includes: impl Fn(&RecordedCall) -> bool) -> Map<String, Value> {
        let mut values = self.initial.get(&tool).cloned().unwrap_or_default();
        if tool.spec().kind != ToolKind::Setting {
            return values;
        }
        let calls = self.decisions.iter().filter_map(RecordedDecision::call);
        for call in calls.filter(|call| call.tool == tool && call.accepted && includes(call)) {
            set_arguments(tool, &mut values, &call.args);
        }
        values
    }
}

/// Replaces the values that a call sets. A map in a call replaces the complete earlier map.
fn set_arguments(tool: ToolId, values: &mut Map<String, Value>, args: &Value) {
    let spec = tool.spec();
    let Some(given) = args.as_object() else { return };
    let mut is_named = false;
    for argument in spec.arguments {
        let value = given.get(argument.name).or_else(|| given.get(argument.alias?));
        if let Some(value) = value.filter(|value| !value.is_null()) {
            values.insert(argument.name.to_owned(), value.clone());
            is_named = true;
        }
    }
    if let (false, Some(whole), false) = (is_named, spec.unnamed_argument, given.is_empty()) {
        values.insert(whole.to_owned(), args.clone());
    }
}
