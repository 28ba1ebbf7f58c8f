use super::super::arguments::{Arguments, text};
use super::super::keeping::Remaining;
use super::super::{
    Argument, ArgumentKind, Kept, Kind, Module, Output, Planned, Refusal, Spec, Tool, ToolId, View, When,
};
use super::{kept, not_found};

/// The tool `remove_daily_calculation`.
pub struct RemoveDailyCalculation;

static SPEC: Spec = Spec {
    id: ToolId::RemoveDailyCalculation,
    code: "UNCAL",
    module: Module::Time,
    kind: Kind::Engine,
    summary: "Remove a named calculation",
    arguments: &[Argument {
        name: "name",
        alias: None,
        kind: ArgumentKind::Text,
        required: true,
        unit: "",
        doc: "name of the calculation",
    }],
    own_unknown: false,
    whole: None,
    when: When::Now,
    effect: "The calculation no longer runs.",
    cost: "nothing",
    writes: &[],
    refusals: &["calculation_not_found"],
    returns: &[
        Output { name: "name", kind: "text", doc: "the name" },
        Output { name: "remaining", kind: "list of text", doc: "remaining names" },
    ],
    example: r#"{"name": "cash"}"#,
};

impl Tool for RemoveDailyCalculation {
    type Args = String;
    type Answer = Remaining;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn read(&self, _: &View<'_>, arguments: &Arguments) -> Result<String, Refusal> {
        text(arguments, "name").map(str::to_owned)
    }

    fn plan(&self, view: &View<'_>, name: String) -> Result<Planned<Remaining>, Refusal> {
        match kept(view).get(&name) {
            Some(_) => Ok(Remaining::without(kept(view), Kept::Calculation, name)),
            None => Err(not_found(&name, view)),
        }
    }
}
