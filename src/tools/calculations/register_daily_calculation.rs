use serde_json::{Value, json};

use super::super::arguments::{Arguments, text};
use super::super::{
    Argument, ArgumentKind, Kept, Kind, Module, Output, Refusal, Spec, Task, Tool, ToolId, View, When,
};
use crate::world::command::{Command, ResolvedCommand};

/// Keeps a calculation for the dashboard.
pub struct RegisterDailyCalculation;

static SPEC: Spec = Spec {
    id: ToolId::RegisterDailyCalculation,
    code: "CALC",
    module: Module::Time,
    kind: Kind::Engine,
    summary: "Register a named calculation: it runs before every week, and the dashboard shows its output",
    arguments: &[
        Argument {
            name: "name",
            alias: None,
            kind: ArgumentKind::Text,
            required: true,
            unit: "",
            doc: "name of the calculation",
        },
        Argument {
            name: "code",
            alias: None,
            kind: ArgumentKind::Text,
            required: true,
            unit: "",
            doc: "read-only SQL statements, separated by ;",
        },
    ],
    own_unknown: false,
    whole: None,
    when: When::NextDay,
    effect: "From the next week on, the statements run before each week, on the company as it is then. The \
             dashboard shows the first 500 characters of the output. A calculation of the same name is \
             replaced.",
    cost: "nothing",
    writes: &[],
    refusals: &[],
    returns: &[
        Output { name: "name", kind: "text", doc: "the name" },
        Output { name: "code_length", kind: "integer", doc: "characters" },
    ],
    example: r#"{"name": "cash", "code": "SELECT SUM(amount) AS cash FROM ledger"}"#,
};

impl Tool for RegisterDailyCalculation {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn plan(&self, _: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        text(arguments, "name")?;
        text(arguments, "code")?;
        Ok(Command::None)
    }

    fn task(&self, _: &View<'_>, arguments: &Arguments) -> Option<Task> {
        let (name, code) = (text(arguments, "name").ok()?, text(arguments, "code").ok()?);
        Some(Task::Keep { what: Kept::Calculation, name: name.to_owned(), code: code.to_owned() })
    }

    fn answer(&self, _: &View<'_>, arguments: &Arguments, _: &ResolvedCommand) -> Value {
        let code = text(arguments, "code").unwrap_or_default();
        json!({ "name": arguments.get("name"), "code_length": code.chars().count() })
    }
}
