use serde_json::{Value, json};

use super::super::arguments::Arguments;
use super::super::{Kind, Module, Output, Refusal, Spec, Tool, ToolId, View, When};
use super::stored;
use crate::world::command::{Command, ResolvedCommand};

/// Lists the scripts.
pub struct ListScripts;

static SPEC: Spec = Spec {
    id: ToolId::ListScripts,
    code: "SCRS",
    module: Module::Time,
    kind: Kind::Engine,
    summary: "List the names of the stored scripts",
    arguments: &[],
    own_unknown: false,
    whole: None,
    when: When::Never,
    effect: "",
    cost: "nothing",
    writes: &[],
    refusals: &[],
    returns: &[Output {
        name: "scripts",
        kind: "list of text",
        doc: "names in the order in which they were stored",
    }],
    example: r#"{}"#,
};

impl Tool for ListScripts {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn plan(&self, _: &View<'_>, _: &Arguments) -> Result<Command, Refusal> {
        Ok(Command::None)
    }

    fn answer(&self, view: &View<'_>, _: &Arguments, _: &ResolvedCommand) -> Value {
        json!({ "scripts": stored(view).names() })
    }
}
