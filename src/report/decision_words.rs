//! Tool calls in words: the name of the decision, and its values with the values before.

use serde_json::{Map, Value};

use super::deals::describe_deals;
use super::formatting::format_number;
use novamind_insight::Cause;
use novamind_session::EnterpriseNames;
use novamind_tools::{Argument, ArgumentKind, ToolId, ToolKind, ToolSpec};

/// Returns the name of the decision that a call to this tool makes, such as `price`.
pub fn decision_name(tool: ToolId) -> &'static str {
    Cause::Calls(tool).name()
}

/// Describes the values of a call: `A 6, B 12.50`.
pub fn describe_values(tool: ToolId, args: &Value, names: &EnterpriseNames) -> String {
    if let Some(deals) = describe_deals(tool, args, names) {
        return deals;
    }
    let value =
        |(name, value): (String, &Value)| format!("{name} {}", format_value(value)).trim_start().to_owned();
    values_by_name(tool.spec(), args).into_iter().map(value).collect::<Vec<_>>().join(", ")
}

/// Describes the values that a call changes: `B 25 → 30`. `before` contains the arguments that would set the previous
/// values. If the tool changes no setting, describes the values of the call.
pub fn describe_value_changes(
    tool: ToolId,
    before: &Map<String, Value>,
    args: &Value,
    names: &EnterpriseNames,
) -> String {
    let spec = tool.spec();
    if spec.kind != ToolKind::Setting {
        return describe_values(tool, args, names);
    }
    let earlier = Value::Object(before.clone());
    let (old, new) = (values_by_name(spec, &earlier), values_by_name(spec, args));
    let find = |values: &[(String, &Value)], name: &str| {
        values.iter().find(|(other, _)| other == name).map_or(0.0, |(_, value)| value.as_f64().unwrap_or(0.0))
    };
    // The map in a call replaces the whole previous map, so values that are missing from the call become 0.
    let given = given_arguments(spec, args);
    let is_replaced = |name: &str| {
        given.iter().any(|argument| {
            argument.is_empty() || name == *argument || name.starts_with(&format!("{argument} "))
        })
    };
    let gone =
        old.iter().filter(|(name, _)| is_replaced(name) && !new.iter().any(|(other, _)| other == name));
    let changes: Vec<String> = new
        .iter()
        .chain(gone)
        .map(|(name, _)| (name, find(&old, name), find(&new, name)))
        .filter(|(_, old, new)| old != new)
        .map(|(name, old, new)| {
            format!("{name} {} → {}", format_number(old), format_number(new)).trim_start().to_owned()
        })
        .collect();
    if changes.is_empty() { "no change".to_owned() } else { changes.join(", ") }
}

/// Returns the names of the values that a call specifies, in the form of [`values_by_name`].
fn given_arguments(spec: &ToolSpec, args: &Value) -> Vec<String> {
    let given = args.as_object().into_iter().flatten();
    given.map(|(name, _)| argument_label(spec, name)).collect()
}

/// Returns the label of an argument. The label is empty for the only map of a tool and for the text of a post, because
/// their values are clear without it.
fn argument_label(spec: &ToolSpec, name: &str) -> String {
    let is_main_text = |argument: &Argument| {
        argument.name == name && argument.required && argument.kind == ArgumentKind::Text
    };
    let is_clear = spec.unnamed_argument == Some(name) || spec.arguments.iter().any(is_main_text);
    if is_clear { String::new() } else { name.replace('_', " ") }
}

/// Returns the values of a call, each with the path of its name, such as `linkedin E1`.
fn values_by_name<'a>(spec: &ToolSpec, args: &'a Value) -> Vec<(String, &'a Value)> {
    let mut values = Vec::new();
    for (name, value) in args.as_object().into_iter().flatten() {
        collect_values(value, &argument_label(spec, name), &mut values);
    }
    values
}

fn collect_values<'a>(value: &'a Value, name: &str, values: &mut Vec<(String, &'a Value)>) {
    match value {
        Value::Object(fields) => {
            for (key, inner) in fields {
                collect_values(inner, format!("{name} {key}").trim_start(), values);
            }
        }
        Value::Null => {}
        value => values.push((name.to_owned(), value)),
    }
}

fn format_value(value: &Value) -> String {
    match value {
        Value::Number(number) => number.as_f64().map_or_else(|| number.to_string(), format_number),
        Value::String(text) => text.split_whitespace().collect::<Vec<_>>().join(" "),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use novamind_world::params::Params;

    #[test]
    fn calls_are_described_without_json() {
        let names = EnterpriseNames::new(3, &Params::bundled().personas.email);
        for (tool, args, words) in [
            (ToolId::SetPrices, json!({"A": 6, "B": 12.5}), "A 6, B 12.50"),
            (
                ToolId::SetTargetedAdSpend,
                json!({"targeted_spend": {"linkedin": {"E1": 40}}}),
                "linkedin E1 40",
            ),
            (ToolId::SetPromotion, json!({"by_group": {"S1": 2}, "by_plan": null}), "by group S1 2"),
            (ToolId::PostSocialMedia, json!({"content": "two\nlines"}), "two lines"),
            (ToolId::ResearchMarket, json!({}), ""),
        ] {
            assert_eq!(describe_values(tool, &args, &names), words);
        }
        assert_eq!(decision_name(ToolId::SetPrices), "price");
    }

    #[test]
    fn changes_name_the_values_before_and_after() {
        let names = EnterpriseNames::new(3, &Params::bundled().personas.email);
        let describe = |tool, before: Value, args: Value| {
            describe_value_changes(tool, before.as_object().expect("an object"), &args, &names)
        };
        let prices = json!({"A": 12, "B": 25, "C": 55});
        assert_eq!(describe(ToolId::SetPrices, prices.clone(), json!({"A": 12, "B": 30})), "B 25 → 30");
        assert_eq!(describe(ToolId::SetPrices, prices, json!({"A": 12})), "no change");
        let ads = |groups: Value| json!({"targeted_spend": {"linkedin": groups}});
        assert_eq!(
            describe(ToolId::SetTargetedAdSpend, ads(json!({"E1": 200, "E2": 50})), ads(json!({"E1": 300}))),
            "linkedin E1 200 → 300, linkedin E2 50 → 0"
        );
        assert_eq!(
            describe(
                ToolId::SetPromotion,
                json!({"global_promotion": 1, "by_group": {"S1": 2}}),
                json!({"global_promotion": 3})
            ),
            "global promotion 1 → 3"
        );
        assert_eq!(describe(ToolId::StartResearchProject, json!({}), json!({"tier": 3})), "tier 3");
    }
}
