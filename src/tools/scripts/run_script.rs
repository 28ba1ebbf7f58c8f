use super::super::arguments::Arguments;
use super::super::{
    Argument, ArgumentKind, EffectTiming, PlannedCall, Rejection, ResultField, Script, ScriptOutput, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};
use super::{MAX_SCRIPT_SECONDS, find_script, script_name};

/// The tool `run_script`, which runs a stored script.
pub struct RunScript;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::RunScript,
    code: "RUN",
    module: ToolModule::Time,
    kind: ToolKind::Engine,
    summary: "Run a stored script",
    arguments: &[Argument {
        name: "name",
        alias: None,
        kind: ArgumentKind::Text,
        required: true,
        unit: "",
        description: "name of the script",
    }],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::Never,
    effect: "",
    cost: "nothing",
    written_tables: &[],
    rejection_codes: &["script_not_found", "script_failed", "script_timeout"],
    result_fields: &[
        ResultField { name: "returncode", kind: "integer", description: "0: the script ran to its end" },
        ResultField {
            name: "stdout",
            kind: "text",
            description: "results as tables, or the output of Python; the first 5,000 characters",
        },
        ResultField {
            name: "stderr",
            kind: "text",
            description: "warnings and hints, the first 2,000 characters",
        },
    ],
    example: r#"{"name": "churn"}"#,
};

impl Tool for RunScript {
    type Args = String;
    type Answer = ScriptOutput;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(&self, _: &ToolContext<'_>, arguments: &Arguments) -> Result<String, Rejection> {
        script_name(arguments)
    }

    fn plan(&self, view: &ToolContext<'_>, name: String) -> Result<PlannedCall<ScriptOutput>, Rejection> {
        let code = find_script(&name, view)?.to_owned();
        Ok(PlannedCall::with_script(Script { code, timeout_seconds: MAX_SCRIPT_SECONDS }))
    }
}
