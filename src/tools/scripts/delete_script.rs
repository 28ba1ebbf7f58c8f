use super::super::arguments::Arguments;
use super::super::keeping::Remaining;
use super::super::{
    Argument, ArgumentKind, Kept, Kind, Module, Output, Planned, Refusal, Spec, Tool, ToolId, View, When,
};
use super::{find, name_of, stored};

/// The tool `delete_script`.
pub struct DeleteScript;

static SPEC: Spec = Spec {
    id: ToolId::DeleteScript,
    code: "DELS",
    module: Module::Time,
    kind: Kind::Engine,
    summary: "Delete a stored script",
    arguments: &[Argument {
        name: "name",
        alias: None,
        kind: ArgumentKind::Text,
        required: true,
        unit: "",
        doc: "name of the script",
    }],
    own_unknown: false,
    whole: None,
    when: When::Now,
    effect: "The script is deleted.",
    cost: "nothing",
    writes: &[],
    refusals: &["script_not_found"],
    returns: &[
        Output { name: "name", kind: "text", doc: "the name" },
        Output { name: "remaining", kind: "list of text", doc: "remaining names" },
    ],
    example: r#"{"name": "churn"}"#,
};

impl Tool for DeleteScript {
    type Args = String;
    type Answer = Remaining;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn read(&self, _: &View<'_>, arguments: &Arguments) -> Result<String, Refusal> {
        name_of(arguments)
    }

    fn plan(&self, view: &View<'_>, name: String) -> Result<Planned<Remaining>, Refusal> {
        find(&name, view)?;
        Ok(Remaining::without(stored(view), Kept::Script, name))
    }
}
