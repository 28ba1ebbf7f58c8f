use serde_json::{Value, json};

use super::super::arguments::Arguments;
use super::super::{Kind, Module, Output, Refusal, Spec, Tool, ToolId, View, When};
use crate::world::command::{Command, ResolvedCommand};

/// Tells the day.
pub struct GetVars;

static SPEC: Spec = Spec {
    id: ToolId::GetVars,
    code: "VARS",
    module: Module::Time,
    kind: Kind::Read,
    summary: "Show the current day",
    arguments: &[],
    own_unknown: false,
    whole: None,
    when: When::Never,
    effect: "",
    cost: "nothing",
    writes: &[],
    refusals: &[],
    returns: &[Output { name: "current_day", kind: "integer", doc: "the last simulated day" }],
    example: "{}",
};

impl Tool for GetVars {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn plan(&self, _: &View<'_>, _: &Arguments) -> Result<Command, Refusal> {
        Ok(Command::None)
    }

    fn answer(&self, view: &View<'_>, _: &Arguments, _: &ResolvedCommand) -> Value {
        json!({ "current_day": view.day() })
    }
}
