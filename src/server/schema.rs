//! JSON Schema of tool arguments, generated from the catalog.

use serde_json::{Map, Value, json};

use novamind_tools::{
    Argument, ArgumentKind, CATALOGUE, FORECAST_KEYS, NumberRange, ParameterNumbers, ToolId, ToolSpec,
};

/// Name of the request field that contains the request id.
pub const REQUEST_ID: &str = "request_id";

/// Returns the schema of the fields that let a client retry a tool call safely.
pub fn retry_fields(tool: ToolId) -> Map<String, Value> {
    let mut fields = Map::new();
    if tool == ToolId::NextWeek {
        let description = "Rejects the week unless the run is on this day";
        fields.insert(
            "expected_day".to_owned(),
            json!({ "type": "integer", "minimum": 0, "description": description }),
        );
    }
    if tool.takes_request_id() {
        fields.insert(REQUEST_ID.to_owned(), request_id_schema());
    }
    fields
}

/// Returns the schema of a request id.
pub fn request_id_schema() -> Value {
    let description = "A unique text for each request. Send it again to retry; the request runs only once";
    json!({ "type": "string", "minLength": 1, "maxLength": 128, "description": description })
}

/// Returns the specifications of all tools, in the order of the catalog.
pub fn specs() -> impl Iterator<Item = &'static ToolSpec> {
    CATALOGUE.iter().map(|tool| tool.spec())
}

/// Returns the JSON Schema of a tool's arguments.
pub fn arguments_schema(spec: &ToolSpec, numbers: &ParameterNumbers) -> Map<String, Value> {
    let property = |argument: &Argument| {
        let schema = match (spec.id, argument.name) {
            (ToolId::NextWeek, "predictions") => predictions_schema(),
            _ => value_schema(&argument.kind),
        };
        (argument.name.to_owned(), with_description(schema, &numbers.substitute(&description(argument))))
    };
    let properties: Map<String, Value> = spec.arguments.iter().map(property).collect();
    let required: Vec<&str> =
        spec.arguments.iter().filter(|argument| argument.required).map(|argument| argument.name).collect();
    let mut schema = Map::from_iter([
        ("type".to_owned(), "object".into()),
        ("properties".to_owned(), properties.into()),
        ("additionalProperties".to_owned(), false.into()),
    ]);
    if !required.is_empty() {
        schema.insert("required".to_owned(), json!(required));
    }
    schema
}

/// Returns all tools in the format for function calling: name, description and schema of the arguments.
pub fn function_schemas(numbers: &ParameterNumbers) -> Vec<Value> {
    let function = |spec: &'static ToolSpec| {
        let parameters = arguments_schema(spec, numbers);
        json!({
            "type": "function",
            "function": { "name": spec.name(), "description": numbers.substitute(spec.summary), "parameters": parameters },
        })
    };
    specs().map(function).collect()
}

fn description(argument: &Argument) -> String {
    let unit = if argument.unit.is_empty() { String::new() } else { format!(" ({})", argument.unit) };
    match &argument.kind {
        ArgumentKind::Structure(words) | ArgumentKind::Deals(words) => {
            format!("{}{unit}: {words}", argument.description)
        }
        _ => format!("{}{unit}", argument.description),
    }
}

fn with_description(mut schema: Value, text: &str) -> Value {
    schema["description"] = text.into();
    schema
}

fn value_schema(kind: &ArgumentKind) -> Value {
    match kind {
        ArgumentKind::Number(range) => number_schema("number", range),
        ArgumentKind::Integer(range) => number_schema("integer", range),
        ArgumentKind::Text => json!({ "type": "string" }),
        // The description explains the structure, and the tool checks the value.
        ArgumentKind::Structure(_) => json!({}),
        ArgumentKind::Deals(_) => json!({ "type": "array" }),
        ArgumentKind::Map(_, range) => map_schema(number_schema("number", range)),
        ArgumentKind::Matrix(_, _, range) => map_schema(map_schema(number_schema("number", range))),
    }
}

fn map_schema(values_schema: Value) -> Value {
    json!({ "type": "object", "additionalProperties": values_schema })
}

fn number_schema(kind: &str, range: &NumberRange) -> Value {
    let mut schema = json!({ "type": kind });
    if range.min.is_finite() {
        schema[if range.excludes_min { "exclusiveMinimum" } else { "minimum" }] = json!(range.min);
    }
    let max = range.max.min(range.magnitude_limit);
    if max.is_finite() {
        schema["maximum"] = json!(max);
    }
    schema
}

fn predictions_schema() -> Value {
    let number = json!({ "type": "number" });
    let forecast = json!({
        "type": "object",
        "properties": { "point": number, "lower": number, "upper": number },
        "required": ["point", "lower", "upper"],
    });
    let horizons: Map<String, Value> =
        FORECAST_KEYS.iter().map(|key| ((*key).to_owned(), forecast.clone())).collect();
    json!({ "type": "object", "properties": horizons, "required": FORECAST_KEYS })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tool_has_a_schema_that_its_example_meets() {
        let numbers = ParameterNumbers::bundled();
        for spec in specs() {
            let schema = arguments_schema(spec, &numbers);
            let example: Value = serde_json::from_str(spec.example).expect("an example");
            let known = schema["properties"].as_object().expect("properties");
            let given = example.as_object().expect("an object");
            for name in given.keys() {
                assert!(known.contains_key(name), "{}: {name}", spec.name());
            }
            for name in schema.get("required").and_then(Value::as_array).into_iter().flatten() {
                assert!(given.contains_key(name.as_str().expect("a name")), "{}: {name}", spec.name());
            }
        }
    }
}
