//! The tools of the catalog in the form of the protocol.

use std::sync::Arc;

use rmcp::model::{CallToolResult, Tool, ToolAnnotations};
use serde_json::Value;

use crate::request::Answer;
use crate::schema;
use novamind_tools::describe::manual;
use novamind_tools::{Kind, Numbers, Spec};

/// Returns all tools.
pub fn all(numbers: &Numbers) -> Vec<Tool> {
    schema::specs().map(|spec| tool(spec, numbers)).collect()
}

/// Returns the tool of a name.
pub fn named(name: &str, numbers: &Numbers) -> Option<Tool> {
    schema::specs().find(|spec| spec.name() == name).map(|spec| tool(spec, numbers))
}

fn tool(spec: &'static Spec, numbers: &Numbers) -> Tool {
    let mut arguments = schema::arguments(spec, numbers);
    if let Some(Value::Object(properties)) = arguments.get_mut("properties") {
        properties.extend(schema::of_retries(spec.id));
    }
    let arguments = Arc::new(arguments);
    Tool::new(spec.name(), manual(spec, numbers), arguments).with_annotations(hints(spec))
}

fn hints(spec: &Spec) -> ToolAnnotations {
    let settles = matches!(spec.kind, Kind::Read | Kind::Setting);
    ToolAnnotations::new()
        .read_only(spec.kind == Kind::Read)
        .destructive(matches!(spec.kind, Kind::Purchase | Kind::Time))
        .idempotent(settles)
        .open_world(false)
}

/// Converts an answer to the result of a call. A rejection is an error that the model reads, not a protocol error.
pub fn result(answer: Answer) -> CallToolResult {
    if answer.succeeded() {
        CallToolResult::structured(answer.body)
    } else {
        CallToolResult::structured_error(answer.body)
    }
}
