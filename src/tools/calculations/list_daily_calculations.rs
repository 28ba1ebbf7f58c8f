use serde::Serialize;

use super::super::arguments::Arguments;
use super::super::keeping::owned;
use super::super::{Kind, Module, Output, Planned, Refusal, Spec, Tool, ToolId, View, When};
use super::kept;

/// The tool `list_daily_calculations`.
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

/// Registered calculations.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Calculations {
    /// Names in the order in which they were registered.
    pub calculations: Vec<String>,
}

impl Tool for ListDailyCalculations {
    type Args = ();
    type Answer = Calculations;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn read(&self, _: &View<'_>, _: &Arguments) -> Result<(), Refusal> {
        Ok(())
    }

    fn plan(&self, view: &View<'_>, (): ()) -> Result<Planned<Calculations>, Refusal> {
        Ok(Planned::reading(Calculations { calculations: owned(kept(view).names()) }))
    }
}
