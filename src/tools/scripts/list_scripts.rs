use serde::Serialize;

use super::super::arguments::Arguments;
use super::super::keeping::owned;
use super::super::{Kind, Module, Output, Planned, Refusal, Spec, Tool, ToolId, View, When};
use super::stored;

/// The tool `list_scripts`.
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

/// Stored scripts.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Scripts {
    /// Names in the order in which they were stored.
    pub scripts: Vec<String>,
}

impl Tool for ListScripts {
    type Args = ();
    type Answer = Scripts;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn read(&self, _: &View<'_>, _: &Arguments) -> Result<(), Refusal> {
        Ok(())
    }

    fn plan(&self, view: &View<'_>, (): ()) -> Result<Planned<Scripts>, Refusal> {
        Ok(Planned::reading(Scripts { scripts: owned(stored(view).names()) }))
    }
}
