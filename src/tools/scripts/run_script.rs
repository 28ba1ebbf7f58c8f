use super::super::arguments::Arguments;
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, Planned, Refusal, Script, ScriptOutput, Spec, Tool, ToolId,
    View, When,
};
use super::{LONGEST_SECONDS, find, name_of};

/// The tool `run_script`.
pub struct RunScript;

static SPEC: Spec = Spec {
    id: ToolId::RunScript,
    code: "RUN",
    module: Module::Time,
    kind: Kind::Engine,
    summary: "Run a stored script",
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
    when: When::Never,
    effect: "",
    cost: "nothing",
    writes: &[],
    refusals: &["script_not_found", "script_failed", "script_timeout"],
    returns: &[
        Output { name: "returncode", kind: "integer", doc: "0: the script ran to its end" },
        Output {
            name: "stdout",
            kind: "text",
            doc: "results as tables, or the output of Python; the first 5,000 characters",
        },
        Output { name: "stderr", kind: "text", doc: "warnings and hints, the first 2,000 characters" },
    ],
    example: r#"{"name": "churn"}"#,
};

impl Tool for RunScript {
    type Args = String;
    type Answer = ScriptOutput;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn read(&self, _: &View<'_>, arguments: &Arguments) -> Result<String, Refusal> {
        name_of(arguments)
    }

    fn plan(&self, view: &View<'_>, name: String) -> Result<Planned<ScriptOutput>, Refusal> {
        let code = find(&name, view)?.to_owned();
        Ok(Planned::running(Script { code, seconds: LONGEST_SECONDS }))
    }
}
