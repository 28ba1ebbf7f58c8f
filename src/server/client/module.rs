//! Generates a module of the Python client: a method and a function for each tool, with type hints and docstrings from
//! the catalog.

use std::fmt::Write;

use crate::schema;
use novamind_tools::{Argument, ArgumentKind, ParameterNumbers, ToolId, ToolModule, ToolSpec};

/// Line width of a docstring, in characters.
const DOCSTRING_COLUMNS: usize = 116;

/// Returns the name of the Python module that contains the tools of a catalog module.
pub fn module_name(module: ToolModule) -> &'static str {
    // A module `time` would shadow the module of the standard library.
    if module == ToolModule::Time { "scripts" } else { module.id() }
}

/// Returns the name of the Python class that contains the tools of a module.
fn class_name(module: ToolModule) -> String {
    let name = module_name(module);
    name[..1].to_uppercase() + &name[1..]
}

/// Returns the Python source of a module: a class with one method per tool, and functions that call the methods on the
/// default connection.
pub fn module_source(module: ToolModule, numbers: &ParameterNumbers) -> String {
    let (name, class) = (module_name(module), class_name(module));
    let mut text = format!(
        "\"\"\"The tools of {name}.\n\nEach function calls the tool of the same name. Omitted arguments are not sent. A rejection \
         raises NovamindError.\n\"\"\"\nfrom __future__ import annotations\n\nfrom typing import Any, Dict, List, Optional\n\n\
         from .connection import Connection, default\n\n\nclass {class}:\n    \"\"\"The tools of {name}, of one run.\"\"\"\n\n    \
         def __init__(self, connection: Connection) -> None:\n        self._connection = connection\n"
    );
    // Other modules of the package contain the functions for these tools.
    let elsewhere = [ToolId::NextWeek, ToolId::Query, ToolId::GetVars];
    let own_specs = || schema::specs().filter(|spec| spec.module == module && !elsewhere.contains(&spec.id));
    own_specs().for_each(|spec| text += &method_source(spec, numbers));
    let _ = writeln!(text, "\n\n_default = {class}(default)");
    own_specs().for_each(|spec| {
        let _ = writeln!(text, "{0} = _default.{0}", spec.name());
    });
    text
}

fn method_source(spec: &ToolSpec, numbers: &ParameterNumbers) -> String {
    let mut sorted: Vec<&Argument> = spec.arguments.iter().collect();
    sorted.sort_by_key(|argument| !argument.required);
    let arguments = sorted.iter().map(|argument| parameter_source(argument));
    let parameters: Vec<String> = std::iter::once("self".to_owned()).chain(arguments).collect();
    let mut text = format!("\n    def {}({}) -> Dict[str, Any]:\n", spec.name(), parameters.join(", "));
    let summary = numbers.substitute(spec.summary);
    let effect = numbers.substitute(spec.effect);
    let cost = numbers.substitute(spec.cost);
    text += &wrap_docstring(&format!("\"\"\"{summary}."), 8, 8);
    if !effect.is_empty() {
        text += &format!(
            "\n{}",
            wrap_docstring(&format!("Effect ({}): {effect}", spec.effect_timing.id()), 8, 8)
        );
    }
    text += &format!("\n{}", wrap_docstring(&format!("Cost: {cost}."), 8, 8));
    if !sorted.is_empty() {
        text += "\n        Args:\n";
        for argument in &sorted {
            let words = format!("{}: {} ({})", argument.name, argument.description, argument.kind.describe());
            text += &wrap_docstring(&numbers.substitute(&words), 12, 16);
        }
    }
    let returned = spec.returned_fields(numbers.interface());
    if !returned.is_empty() {
        text += "\n        Returns:\n";
        for output in returned {
            let words = format!("{}: {} ({})", output.name, output.description, output.kind);
            text += &wrap_docstring(&numbers.substitute(&words), 12, 16);
        }
    }
    if !spec.rejection_codes.is_empty() {
        text += "\n        Raises:\n";
        text += &wrap_docstring(&format!("NovamindError: code {}", spec.rejection_codes.join(", ")), 12, 16);
    }
    text += "        \"\"\"\n";
    let sent: Vec<String> = spec.arguments.iter().map(|it| format!("\"{0}\": {0}", it.name)).collect();
    let _ =
        writeln!(text, "        return self._connection.call(\"{}\", {{{}}})", spec.name(), sent.join(", "));
    text
}

fn parameter_source(argument: &Argument) -> String {
    let hint = type_hint(&argument.kind);
    match argument.required {
        true => format!("{}: {hint}", argument.name),
        false => format!("{}: Optional[{hint}] = None", argument.name),
    }
}

fn type_hint(kind: &ArgumentKind) -> &'static str {
    match kind {
        ArgumentKind::Number(_) => "float",
        ArgumentKind::Integer(_) => "int",
        ArgumentKind::Text => "str",
        ArgumentKind::Structure(_) => "Any",
        ArgumentKind::Deals(_) => "List[Any]",
        ArgumentKind::Map(..) => "Dict[str, float]",
        ArgumentKind::Matrix(..) => "Dict[str, Dict[str, float]]",
    }
}

/// Wraps text into lines and escapes backslashes for Python.
fn wrap_docstring(words: &str, first: usize, others: usize) -> String {
    let mut text = String::new();
    let mut line = " ".repeat(first);
    for word in words.replace('\\', "/").split_whitespace() {
        let begins = line.trim().is_empty();
        if !begins && line.chars().count() + 1 + word.chars().count() > DOCSTRING_COLUMNS {
            let _ = writeln!(text, "{line}");
            line = " ".repeat(others);
            line += word;
            continue;
        }
        if !begins {
            line.push(' ');
        }
        line += word;
    }
    let _ = writeln!(text, "{line}");
    text
}
