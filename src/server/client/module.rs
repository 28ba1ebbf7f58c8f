//! A module of the Python client: a method and a function for each tool, with type hints and docstrings from the catalog.

use std::fmt::Write;

use crate::schema;
use novamind_tools::{Argument, ArgumentKind, Module, Numbers, Spec, ToolId};

/// Line width of a docstring.
const WIDTH: usize = 116;

/// Returns the name of the module in Python.
pub fn name(module: Module) -> &'static str {
    // A module `time` would shadow that of the standard library.
    if module == Module::Time { "scripts" } else { module.id() }
}

/// Returns the name of the class with the tools of a module.
fn class(module: Module) -> String {
    let name = name(module);
    name[..1].to_uppercase() + &name[1..]
}

/// Returns the source of a module: a class whose methods are the tools, and functions that use the default connection.
pub fn text(module: Module, numbers: &Numbers) -> String {
    let (name, class) = (name(module), class(module));
    let mut text = format!(
        "\"\"\"The tools of {name}.\n\nEach function calls the tool of the same name. Omitted arguments are not sent. A rejection \
         raises NovamindError.\n\"\"\"\nfrom __future__ import annotations\n\nfrom typing import Any, Dict, List, Optional\n\n\
         from .connection import Connection, default\n\n\nclass {class}:\n    \"\"\"The tools of {name}, of one run.\"\"\"\n\n    \
         def __init__(self, connection: Connection) -> None:\n        self._connection = connection\n"
    );
    // The package has separate functions for these.
    let elsewhere = [ToolId::NextWeek, ToolId::Query, ToolId::GetVars];
    let own = || schema::specs().filter(|spec| spec.module == module && !elsewhere.contains(&spec.id));
    own().for_each(|spec| text += &method(spec, numbers));
    let _ = writeln!(text, "\n\n_default = {class}(default)");
    own().for_each(|spec| {
        let _ = writeln!(text, "{0} = _default.{0}", spec.name());
    });
    text
}

fn method(spec: &Spec, numbers: &Numbers) -> String {
    let mut sorted: Vec<&Argument> = spec.arguments.iter().collect();
    sorted.sort_by_key(|argument| !argument.required);
    let arguments = sorted.iter().map(|argument| parameter(argument));
    let parameters: Vec<String> = std::iter::once("self".to_owned()).chain(arguments).collect();
    let mut text = format!("\n    def {}({}) -> Dict[str, Any]:\n", spec.name(), parameters.join(", "));
    let summary = numbers.fill(spec.summary);
    let effect = numbers.fill(spec.effect);
    let cost = numbers.fill(spec.cost);
    text += &wrapped(&format!("\"\"\"{summary}."), 8, 8);
    if !effect.is_empty() {
        text += &format!("\n{}", wrapped(&format!("Effect ({}): {effect}", spec.when.id()), 8, 8));
    }
    text += &format!("\n{}", wrapped(&format!("Cost: {cost}."), 8, 8));
    if !sorted.is_empty() {
        text += "\n        Args:\n";
        for argument in &sorted {
            let words = format!("{}: {} ({})", argument.name, argument.doc, argument.kind.words());
            text += &wrapped(&numbers.fill(&words), 12, 16);
        }
    }
    if !spec.returns.is_empty() {
        text += "\n        Returns:\n";
        for output in spec.returns {
            let words = format!("{}: {} ({})", output.name, output.doc, output.kind);
            text += &wrapped(&numbers.fill(&words), 12, 16);
        }
    }
    if !spec.refusals.is_empty() {
        text += "\n        Raises:\n";
        text += &wrapped(&format!("NovamindError: code {}", spec.refusals.join(", ")), 12, 16);
    }
    text += "        \"\"\"\n";
    let sent: Vec<String> = spec.arguments.iter().map(|it| format!("\"{0}\": {0}", it.name)).collect();
    let _ =
        writeln!(text, "        return self._connection.call(\"{}\", {{{}}})", spec.name(), sent.join(", "));
    text
}

fn parameter(argument: &Argument) -> String {
    let hint = hint(&argument.kind);
    match argument.required {
        true => format!("{}: {hint}", argument.name),
        false => format!("{}: Optional[{hint}] = None", argument.name),
    }
}

fn hint(kind: &ArgumentKind) -> &'static str {
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
fn wrapped(words: &str, first: usize, others: usize) -> String {
    let mut text = String::new();
    let mut line = " ".repeat(first);
    for word in words.replace('\\', "/").split_whitespace() {
        let begins = line.trim().is_empty();
        if !begins && line.chars().count() + 1 + word.chars().count() > WIDTH {
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
