use serde::Serialize;

use super::super::arguments::Arguments;
use super::super::{Kind, Module, Output, Planned, Refusal, Spec, Tool, ToolId, View, When};

/// The tool `get_vars`.
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

/// Variables of the run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Vars {
    /// The last simulated day.
    pub current_day: u32,
}

impl Tool for GetVars {
    type Args = ();
    type Answer = Vars;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn read(&self, _: &View<'_>, _: &Arguments) -> Result<(), Refusal> {
        Ok(())
    }

    fn plan(&self, view: &View<'_>, (): ()) -> Result<Planned<Vars>, Refusal> {
        Ok(Planned::reading(Vars { current_day: view.day() }))
    }
}
