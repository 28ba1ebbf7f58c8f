//! Converts results of `get_group_insights` and `get_market_overview` for display: replaces each estimate with the
//! range of possible true values, and adds the day of the estimates. Programs receive the unchanged results.

use serde_json::{Map, Value, json};

use super::fit::Fit;
use super::formatting::format_range;
use novamind_session::true_value_range;

const ESTIMATE_FIELDS: [&str; 3] = ["estimates", "network_influence", "reputation_influence"];

/// Returns the result of `get_group_insights` with ranges instead of estimates, and the day of the estimates.
pub fn insights_as_ranges(answer: &Value, fit: &Fit) -> Value {
    let Value::Object(fields) = answer else { return answer.clone() };
    let mut shown = Map::new();
    for (name, value) in fields {
        let estimated = ESTIMATE_FIELDS.contains(&name.as_str());
        shown.insert(
            name.clone(),
            if estimated { replace_with_ranges(value, fit.max_relative_error) } else { value.clone() },
        );
        if name == "noise" {
            shown.insert("as_of".to_owned(), json!(fit.describe_study_day()));
        }
    }
    Value::Object(shown)
}

/// Returns the result of `get_market_overview` with the day of each group's estimates.
pub fn overview_with_ages(answer: &Value, fits: &[Fit]) -> Value {
    let mut shown = answer.clone();
    let groups = shown.get_mut("known_groups").and_then(Value::as_array_mut);
    for group in groups.into_iter().flatten().filter_map(Value::as_object_mut) {
        let fit = fits.iter().find(|fit| group.get("group_id").is_some_and(|id| id == fit.group.id()));
        if let Some(fit) = fit {
            group.insert("as_of".to_owned(), json!(fit.describe_study_day()));
        }
    }
    shown
}

fn replace_with_ranges(value: &Value, noise: f64) -> Value {
    match value {
        Value::Object(fields) => {
            fields.iter().map(|(name, value)| (name.clone(), replace_with_ranges(value, noise))).collect()
        }
        Value::Array(items) => items.iter().map(|item| replace_with_ranges(item, noise)).collect(),
        other => other.as_f64().map_or(other.clone(), |estimate| json!(format_noise_range(estimate, noise))),
    }
}

/// Formats a range with so many decimals that its lower endpoint has two significant digits.
fn format_noise_range(estimate: f64, noise: f64) -> String {
    let (least, most) = true_value_range(estimate, noise);
    let decimals = match least.abs() {
        size if size >= 10.0 || most == 0.0 => 0,
        size if size >= 0.1 => 3,
        size if size >= 0.001 => 5,
        _ => 7,
    };
    format_range(least, most, decimals)
}
