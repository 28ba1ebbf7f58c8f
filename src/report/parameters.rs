//! Texts for parameters that a debug run has changed.

use serde_json::Value;

use novamind_session::{ChangedParameter, ChangedParameters};

/// Describes the change of a parameter: `group.S1.c_max_mean: 50 → 300, from day 30`.
pub fn describe_changed_parameter(set: &ChangedParameter, today: u32) -> String {
    let ChangedParameter { key, old, new, from_day } = set;
    let change = if old == new { format!("{new}, unchanged") } else { format!("{old} → {new}") };
    match from_day {
        Some(day) => format!("{key}: {change}, from day {day}"),
        None => format!("{key}: {change}, effective from day {}", today + 1),
    }
}

/// Describes a recorded change of a parameter: `set leads.saturation_base: 1 → 0.9 from day 30`.
pub fn describe_recorded_parameter_change(
    key: &str,
    [old, new]: [&Value; 2],
    from_day: Option<u32>,
) -> String {
    format!("set {key}: {old} → {new}{}", describe_start_day(from_day))
}

/// Returns ` from day 30`, or an empty string for an immediate change.
pub fn describe_start_day(from_day: Option<u32>) -> String {
    from_day.map_or(String::new(), |day| format!(" from day {day}"))
}

/// Lists the parameters that differ from the scenario, and the changes that take effect on a later day.
pub fn describe_changed_parameters(changed: &ChangedParameters) -> Vec<String> {
    let against = match &changed.scenario {
        Some(name) => format!("scenario {name}"),
        None => "the start of the run".to_owned(),
    };
    let mut lines = match changed.in_force.len() {
        0 => vec![format!("no parameter differs from {against}")],
        1 => vec![format!("1 parameter differs from {against}:")],
        count => vec![format!("{count} parameters differ from {against}:")],
    };
    lines.extend(changed.in_force.iter().map(|changed_parameter| {
        format!(
            "  {}: {} → {}",
            changed_parameter.key,
            format_value(&changed_parameter.old),
            changed_parameter.new
        )
    }));
    if !changed.waiting.is_empty() {
        lines.push("scheduled for a later day:".to_owned());
    }
    lines.extend(changed.waiting.iter().map(|change| {
        format!("  {}: {} from day {}", change.key, change.new, change.from_day.unwrap_or_default())
    }));
    lines
}

fn format_value(value: &Value) -> String {
    if value.is_null() { "nothing".to_owned() } else { value.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn changed_parameter(key: &str, old: Value, new: Value, from_day: Option<u32>) -> ChangedParameter {
        ChangedParameter { key: key.to_owned(), old, new, from_day }
    }

    #[test]
    fn parameter_change_names_old_value_new_value_and_day() {
        let now = changed_parameter("a.b", json!(50), json!(300), None);
        assert_eq!(describe_changed_parameter(&now, 7), "a.b: 50 → 300, effective from day 8");
        let later = changed_parameter("a.b", json!(0.5), json!([1, 2]), Some(30));
        assert_eq!(describe_changed_parameter(&later, 7), "a.b: 0.5 → [1,2], from day 30");
        assert_eq!(
            describe_changed_parameter(&changed_parameter("a.b", json!(1), json!(1), Some(9)), 7),
            "a.b: 1, unchanged, from day 9"
        );
    }

    #[test]
    fn parameter_list_names_scenario_and_pending_changes() {
        let mut all =
            ChangedParameters { scenario: Some("default".to_owned()), in_force: vec![], waiting: vec![] };
        assert_eq!(describe_changed_parameters(&all), ["no parameter differs from scenario default"]);
        all.in_force = vec![changed_parameter("a.b", json!(50), json!(300), None)];
        all.waiting = vec![changed_parameter("c.d", json!(1), json!(2), Some(30))];
        all.scenario = None;
        assert_eq!(
            describe_changed_parameters(&all),
            [
                "1 parameter differs from the start of the run:",
                "  a.b: 50 → 300",
                "scheduled for a later day:",
                "  c.d: 2 from day 30",
            ]
        );
    }
}
