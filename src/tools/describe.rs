//! Generates the documentation of a tool as text and as JSON.

use std::fmt::Write;

use serde::Serialize;
use serde_json::Value;

use super::ParameterNumbers;
use super::analytics::RELEASE_2_FIELDS;
use super::spec::{Argument, ResultField, ToolSpec};
use super::tool_id::ToolId;
use novamind_world::params::Interface;

impl ToolSpec {
    /// Returns the fields of the tool's result under the interface of a release.
    pub fn returned_fields(&self, interface: Interface) -> &'static [ResultField] {
        match (self.id, interface) {
            (ToolId::GetSocialPosts, Interface::Release2) => &RELEASE_2_FIELDS,
            _ => self.result_fields,
        }
    }
}

/// Returns the manual of a tool as text, with the current parameters.
pub fn format_manual(spec: &ToolSpec, numbers: &ParameterNumbers) -> String {
    let mut text = format!("{}.{} ({}): {}\n", spec.module.id(), spec.name(), spec.code, spec.summary);
    for argument in spec.arguments {
        let _ = writeln!(text, "  {}", numbers.substitute(&format_argument(argument)));
    }
    if !spec.effect.is_empty() {
        let _ = writeln!(text, "Effect ({}): {}", spec.effect_timing.id(), numbers.substitute(spec.effect));
    }
    let _ = writeln!(text, "Cost: {}.", numbers.substitute(spec.cost));
    if !spec.written_tables.is_empty() {
        let _ = writeln!(text, "Tables: {}.", spec.written_tables.join(", "));
    }
    if !spec.rejection_codes.is_empty() {
        let _ = writeln!(text, "Rejections: {}.", spec.rejection_codes.join(", "));
    }
    for output in spec.returned_fields(numbers.interface()) {
        let _ = writeln!(
            text,
            "Returns {} ({}): {}.",
            output.name,
            output.kind,
            numbers.substitute(output.description)
        );
    }
    let _ = writeln!(text, "Example: {}({})", spec.name(), spec.example);
    text
}

fn format_argument(argument: &Argument) -> String {
    let need = if argument.required { "required" } else { "optional" };
    let unit = if argument.unit.is_empty() { String::new() } else { format!(", {}", argument.unit) };
    format!("{} ({}{unit}, {need}): {}", argument.name, argument.kind.describe(), argument.description)
}

/// Documentation of a tool for programs, with the current parameters.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ToolDocument {
    name: &'static str,
    code: &'static str,
    module: &'static str,
    kind: &'static str,
    summary: String,
    arguments: Vec<ArgumentDocument>,
    effect: EffectDocument,
    cost: String,
    writes: &'static [&'static str],
    refusals: &'static [&'static str],
    returns: Vec<OutputDocument>,
    example: Value,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct ArgumentDocument {
    name: &'static str,
    alias: Option<&'static str>,
    #[serde(rename = "type")]
    kind: String,
    required: bool,
    unit: &'static str,
    description: String,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct EffectDocument {
    when: &'static str,
    description: String,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct OutputDocument {
    name: &'static str,
    #[serde(rename = "type")]
    kind: &'static str,
    description: String,
}

/// Returns the documentation of a tool for programs, with the current parameters.
pub fn document_tool(spec: &'static ToolSpec, numbers: &ParameterNumbers) -> ToolDocument {
    let argument = |argument: &Argument| ArgumentDocument {
        name: argument.name,
        alias: argument.alias,
        kind: argument.kind.describe(),
        required: argument.required,
        unit: argument.unit,
        description: numbers.substitute(argument.description),
    };
    let output = |output: &ResultField| OutputDocument {
        name: output.name,
        kind: output.kind,
        description: numbers.substitute(output.description),
    };
    ToolDocument {
        name: spec.name(),
        code: spec.code,
        module: spec.module.id(),
        kind: spec.kind.id(),
        summary: numbers.substitute(spec.summary),
        arguments: spec.arguments.iter().map(argument).collect(),
        effect: EffectDocument {
            when: spec.effect_timing.id(),
            description: numbers.substitute(spec.effect),
        },
        cost: numbers.substitute(spec.cost),
        writes: spec.written_tables,
        refusals: spec.rejection_codes,
        returns: spec.returned_fields(numbers.interface()).iter().map(output).collect(),
        example: serde_json::from_str(spec.example).unwrap_or(Value::Null),
    }
}
