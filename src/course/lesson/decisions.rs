//! The decisions in a week of a lesson, and the differences between two plays.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;
use serde_json::{Map, Value};

use novamind_session::{JournalEntry, Session};
use novamind_tools::{ToolId, ToolKind};

/// The settings in force in a week, and the one-time actions at the start of the week.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct WeekDecisions {
    /// Settings in force, by tool.
    settings: BTreeMap<ToolId, Map<String, Value>>,
    /// Tool and arguments of each one-time action, in order.
    actions: Vec<(ToolId, Value)>,
}

/// A tool that the student used differently from the reference play.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DifferentDecision {
    /// The tool with different settings or calls.
    pub tool: ToolId,
    /// How the settings or calls of the tool differ.
    #[serde(flatten)]
    pub difference: DecisionDifference,
}

/// The difference between the student's play and the reference play for one tool.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum DecisionDifference {
    /// Some settings of the tool differ.
    Settings {
        /// The settings that differ between the two plays.
        settings: Vec<SettingDifference>,
    },
    /// The one-time calls of the tool differ.
    Calls {
        /// Arguments of the student's calls.
        own: Vec<Value>,
        /// Arguments of the reference play's calls.
        good: Vec<Value>,
    },
}

/// A setting that differs between the student's play and the reference play.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SettingDifference {
    /// Path of the argument, such as `content_marketing S1`.
    pub name: String,
    /// Value in the student's play; null if the play does not set it.
    pub own: Value,
    /// Value in the reference play; null if the play does not set it.
    pub good: Value,
}

impl WeekDecisions {
    /// Returns the session's settings and the one-time actions of its current day.
    pub(super) fn from_session(session: &Session) -> WeekDecisions {
        let setting = |tool: ToolId| {
            let current = tool.tool().current_arguments(session.settings());
            (tool.spec().kind == ToolKind::Setting && !current.is_empty()).then_some((tool, current))
        };
        let settings: BTreeMap<ToolId, Map<String, Value>> = ToolId::all().filter_map(setting).collect();
        let today = session.day();
        let one_time_actions = session.journal().iter().filter_map(|entry| match entry {
            JournalEntry::Call { day, tool, args, .. }
                if *day == today && tool.spec().kind.changes_company() && !settings.contains_key(tool) =>
            {
                Some((*tool, args.clone()))
            }
            _ => None,
        });
        let one_time_actions = one_time_actions.collect();
        WeekDecisions { settings, actions: one_time_actions }
    }

    fn one_time_calls(&self, tool: ToolId) -> Vec<Value> {
        self.actions.iter().filter(|(tool_id, _)| *tool_id == tool).map(|(_, args)| args.clone()).collect()
    }

    /// Returns tool calls that reproduce the decisions of the selected tools.
    pub(super) fn calls_for_tools(&self, tools: &dyn Fn(&ToolId) -> bool) -> Vec<(ToolId, Value)> {
        let settings = self.settings.iter().map(|(tool, args)| (*tool, Value::Object(args.clone())));
        settings.chain(self.actions.iter().cloned()).filter(|(tool, _)| tools(tool)).collect()
    }
}

/// Returns the tools that were used differently from the reference play.
pub(super) fn different_decisions(
    week_decisions: &WeekDecisions,
    good: &WeekDecisions,
) -> Vec<DifferentDecision> {
    let settings = week_decisions.settings.iter().filter_map(|(tool, settings)| {
        let other = good.settings.get(tool)?;
        let (actual, good) = (flatten_arguments(settings), flatten_arguments(other));
        let names: BTreeSet<&String> = actual.keys().chain(good.keys()).collect();
        let value =
            |of: &BTreeMap<String, Value>, name: &String| of.get(name).cloned().unwrap_or(Value::Null);
        let settings: Vec<SettingDifference> = names
            .into_iter()
            .map(|name| SettingDifference {
                name: name.clone(),
                own: value(&actual, name),
                good: value(&good, name),
            })
            .filter(|setting| !is_same_value(&setting.own, &setting.good))
            .collect();
        (!settings.is_empty()).then_some(DifferentDecision {
            tool: *tool,
            difference: DecisionDifference::Settings { settings },
        })
    });
    let done: BTreeSet<ToolId> =
        week_decisions.actions.iter().chain(&good.actions).map(|(tool, _)| *tool).collect();
    let one_time_actions = done.into_iter().filter_map(|tool| {
        let (values, good) = (week_decisions.one_time_calls(tool), good.one_time_calls(tool));
        (values != good).then_some(DifferentDecision {
            tool,
            difference: DecisionDifference::Calls { own: values, good },
        })
    });
    settings.chain(one_time_actions).collect()
}

/// Returns whether two values are equal: 12 equals 12.0, and null equals zero.
fn is_same_value(one: &Value, other: &Value) -> bool {
    let number = |value: &Value| if value.is_null() { Some(0.0) } else { value.as_f64() };
    match (number(one), number(other)) {
        (Some(one), Some(other)) => one.total_cmp(&other).is_eq(),
        _ => one == other,
    }
}

/// Flattens nested arguments. The keys of the result are paths, such as `content_marketing S1`.
fn flatten_arguments(arguments: &Map<String, Value>) -> BTreeMap<String, Value> {
    let mut found = BTreeMap::new();
    for (name, value) in arguments {
        match value {
            Value::Object(inner) => {
                found.extend(flatten_arguments(inner).into_iter().map(|(deeper, value)| {
                    // The name of a single outer argument adds no information.
                    let path = if arguments.len() == 1 { deeper } else { format!("{name} {deeper}") };
                    (path, value)
                }))
            }
            value => {
                found.insert(name.clone(), value.clone());
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn week_decisions(prices: &Value, one_time_actions: &[(ToolId, Value)]) -> WeekDecisions {
        let settings = prices.as_object().cloned().unwrap_or_default();
        WeekDecisions { settings: [(ToolId::SetPrices, settings)].into(), actions: one_time_actions.to_vec() }
    }

    #[test]
    fn different_decisions_lists_settings_and_calls() {
        let decisions = week_decisions(&json!({"A": 12, "B": 20}), &[]);
        assert!(
            different_decisions(&decisions, &week_decisions(&json!({"A": 12.0, "B": 20}), &[])).is_empty()
        );
        let other = week_decisions(
            &json!({"A": 12, "B": 30}),
            &[(ToolId::RejectEnterpriseDeal, json!({"deal_id": 4}))],
        );
        let found = different_decisions(&decisions, &other);
        let b = SettingDifference { name: "B".to_owned(), own: json!(20), good: json!(30) };
        assert_eq!(found[0].difference, DecisionDifference::Settings { settings: vec![b] });
        let calls = DecisionDifference::Calls { own: Vec::new(), good: vec![json!({"deal_id": 4})] };
        assert_eq!(found[1].difference, calls);
        let made = other.calls_for_tools(&|tool| *tool == ToolId::SetPrices);
        assert_eq!(made, [(ToolId::SetPrices, json!({"A": 12, "B": 30}))]);
    }

    #[test]
    fn flatten_arguments_names_values_by_path() {
        let spend = json!({"targeted_spend": {"linkedin": {"S1": 5.0}, "search": {"S2": 1.0}}});
        let found = flatten_arguments(spend.as_object().expect("an object"));
        let names: Vec<&str> = found.keys().map(String::as_str).collect();
        assert_eq!(names, ["linkedin S1", "search S2"]);
    }
}
