use serde_json::{Value, json};

use super::super::arguments::Arguments;
use super::super::{Kind, Module, Output, Refusal, Spec, Tool, ToolId, View, When};
use super::kept;
use crate::world::command::{Command, ResolvedCommand};

/// Lists the calculations.
pub struct ListDailyCalculations;

static SPEC: Spec = Spec {
    id: ToolId::ListDailyCalculations,
    code: "CALCS",
    module: Module::Time,
    kind: Kind::Engine,
    summary: "List the names of the registered calculations",
    arguments: &[],
    own_unknown: false,
    whole: None,
    when: When::Never,
    effect: "",
    cost: "nothing",
    writes: &[],
    refusals: &[],
    returns: &[Output {
        name: "calculations",
        kind: "list of text",
        doc: "names in the order in which they were registered",
    }],
    example: r#"{}"#,
};

impl Tool for ListDailyCalculations {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn plan(&self, _: &View<'_>, _: &Arguments) -> Result<Command, Refusal> {
        Ok(Command::None)
    }

    fn answer(&self, view: &View<'_>, _: &Arguments, _: &ResolvedCommand) -> Value {
        json!({ "calculations": kept(view).names() })
    }
}
