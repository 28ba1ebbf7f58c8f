//! What get_group_insights and get_market_overview answer, as people are shown it: every estimate as the range of the
//! truth behind it, with the day it is of. Programs get the answers as they are.

use serde_json::{Map, Value, json};

use super::fit::Fit;
use super::words::range;
use novamind_session::truth_behind;

/// Fields of the insights that hold estimates.
const ESTIMATED: [&str; 3] = ["estimates", "network_influence", "reputation_influence"];

/// The answer about a group with ranges in place of estimates, and the day they are of.
pub fn insights_as_ranges(answer: &Value, fit: &Fit) -> Value {
    let Value::Object(fields) = answer else { return answer.clone() };
    let mut shown = Map::new();
    for (name, value) in fields {
        let estimated = ESTIMATED.contains(&name.as_str());
        shown.insert(name.clone(), if estimated { ranges(value, fit.noise) } else { value.clone() });
        if name == "noise" {
            shown.insert("as_of".to_owned(), json!(fit.studied()));
        }
    }
    Value::Object(shown)
}

/// The overview of the market with the day that the figures of each group are of.
pub fn overview_with_ages(answer: &Value, fits: &[Fit]) -> Value {
    let mut shown = answer.clone();
    let groups = shown.get_mut("known_groups").and_then(Value::as_array_mut);
    for group in groups.into_iter().flatten().filter_map(Value::as_object_mut) {
        let fit = fits.iter().find(|fit| group.get("group_id").is_some_and(|id| id == fit.group.id()));
        if let Some(fit) = fit {
            group.insert("as_of".to_owned(), json!(fit.studied()));
        }
    }
    shown
}

fn ranges(value: &Value, noise: f64) -> Value {
    match value {
        Value::Object(fields) => {
            fields.iter().map(|(name, value)| (name.clone(), ranges(value, noise))).collect()
        }
        Value::Array(items) => items.iter().map(|item| ranges(item, noise)).collect(),
        other => other.as_f64().map_or(other.clone(), |estimate| json!(written(estimate, noise))),
    }
}

/// The range with the decimals that its least end needs for two digits.
fn written(estimate: f64, noise: f64) -> String {
    let (least, most) = truth_behind(estimate, noise);
    let decimals = match least.abs() {
        size if size >= 10.0 || most == 0.0 => 0,
        size if size >= 0.1 => 3,
        size if size >= 0.001 => 5,
        _ => 7,
    };
    range(least, most, decimals)
}
