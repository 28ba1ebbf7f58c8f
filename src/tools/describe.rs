//! Documentation of a tool as text and as JSON.

use std::fmt::Write;

use serde::Serialize;
use serde_json::Value;

use super::Numbers;
use super::spec::{Argument, Output, Spec};

/// Returns the manual of a tool, with the numbers in force.
pub fn manual(spec: &Spec, numbers: &Numbers) -> String {
    let mut text = format!("{}.{} ({}): {}\n", spec.module.id(), spec.name(), spec.code, spec.summary);
    for argument in spec.arguments {
        let _ = writeln!(text, "  {}", numbers.fill(&argument_line(argument)));
    }
    if !spec.effect.is_empty() {
        let _ = writeln!(text, "Effect ({}): {}", spec.when.id(), numbers.fill(spec.effect));
    }
    let _ = writeln!(text, "Cost: {}.", numbers.fill(spec.cost));
    if !spec.writes.is_empty() {
        let _ = writeln!(text, "Tables: {}.", spec.writes.join(", "));
    }
    if !spec.refusals.is_empty() {
        let _ = writeln!(text, "Rejections: {}.", spec.refusals.join(", "));
    }
    for output in spec.returns {
        let _ = writeln!(text, "Returns {} ({}): {}.", output.name, output.kind, numbers.fill(output.doc));
    }
    let _ = writeln!(text, "Example: {}({})", spec.name(), spec.example);
    text
}

fn argument_line(argument: &Argument) -> String {
    let need = if argument.required { "required" } else { "optional" };
    let unit = if argument.unit.is_empty() { String::new() } else { format!(", {}", argument.unit) };
    format!("{} ({}{unit}, {need}): {}", argument.name, argument.kind.words(), argument.doc)
}

/// Documentation of a tool for programs, with the numbers in force.
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

/// Documentation of a tool for programs, with the numbers in force.
pub fn document(spec: &'static Spec, numbers: &Numbers) -> ToolDocument {
    let argument = |argument: &Argument| ArgumentDocument {
        name: argument.name,
        alias: argument.alias,
        kind: argument.kind.words(),
        required: argument.required,
        unit: argument.unit,
        description: numbers.fill(argument.doc),
    };
    let output = |output: &Output| OutputDocument {
        name: output.name,
        kind: output.kind,
        description: numbers.fill(output.doc),
    };
    ToolDocument {
        name: spec.name(),
        code: spec.code,
        module: spec.module.id(),
        kind: spec.kind.id(),
        summary: numbers.fill(spec.summary),
        arguments: spec.arguments.iter().map(argument).collect(),
        effect: EffectDocument { when: spec.when.id(), description: numbers.fill(spec.effect) },
        cost: numbers.fill(spec.cost),
        writes: spec.writes,
        refusals: spec.refusals,
        returns: spec.returns.iter().map(output).collect(),
        example: serde_json::from_str(spec.example).unwrap_or(Value::Null),
    }
}
