//! Converts the tools of the catalog to the types of the Model Context Protocol.

use std::sync::Arc;

use rmcp::model::{CallToolResult, Tool, ToolAnnotations};
use serde_json::Value;

use crate::request::ApiResponse;
use crate::schema;
use novamind_tools::describe::format_manual;
use novamind_tools::{ParameterNumbers, ToolKind, ToolSpec};

/// Returns the descriptions of all tools.
pub fn list(numbers: &ParameterNumbers) -> Vec<Tool> {
    schema::specs().map(|spec| describe_tool(spec, numbers)).collect()
}

/// Returns the description of the tool with this name.
pub fn find(name: &str, numbers: &ParameterNumbers) -> Option<Tool> {
    schema::specs().find(|spec| spec.name() == name).map(|spec| describe_tool(spec, numbers))
}

fn describe_tool(spec: &'static ToolSpec, numbers: &ParameterNumbers) -> Tool {
    let mut arguments = schema::arguments_schema(spec, numbers);
    if let Some(Value::Object(properties)) = arguments.get_mut("properties") {
        properties.extend(schema::retry_fields(spec.id));
    }
    let arguments = Arc::new(arguments);
    Tool::new(spec.name(), format_manual(spec, numbers), arguments).with_annotations(tool_annotations(spec))
}

fn tool_annotations(spec: &ToolSpec) -> ToolAnnotations {
    let is_idempotent = matches!(spec.kind, ToolKind::Read | ToolKind::Setting);
    ToolAnnotations::new()
        .read_only(spec.kind == ToolKind::Read)
        .destructive(matches!(spec.kind, ToolKind::Purchase | ToolKind::Time))
        .idempotent(is_idempotent)
        .open_world(false)
}

/// Converts a response to the result of a tool call. A rejection becomes a tool error that the model can read, not a
/// protocol error.
pub fn to_call_result(answer: ApiResponse) -> CallToolResult {
    if answer.is_success() {
        CallToolResult::structured(answer.body)
    } else {
        CallToolResult::structured_error(answer.body)
    }
}
