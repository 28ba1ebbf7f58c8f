use super::super::arguments::{Arguments, json_f64, text_argument, wrong_type_rejection};
use super::super::{
    Argument, ArgumentKind, EffectTiming, NumberRange, PlannedCall, Rejection, ResultField, Script,
    ScriptOutput, Tool, ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};
use super::{CODE_DESCRIPTION, MAX_SCRIPT_SECONDS};

/// The tool `python_exec`, which runs SQL statements or Python code.
pub struct PythonExec;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::PythonExec,
    code: "PYX",
    module: ToolModule::Time,
    kind: ToolKind::Engine,
    summary: "Run SQL statements or Python over the visible tables",
    arguments: &[
        Argument {
            name: "code",
            alias: None,
            kind: ArgumentKind::Text,
            required: true,
            unit: "",
            description: CODE_DESCRIPTION,
        },
        Argument {
            name: "timeout_seconds",
            alias: None,
            kind: ArgumentKind::Number(NumberRange {
                excludes_min: true,
                ..NumberRange::between(0.0, MAX_SCRIPT_SECONDS)
            }),
            required: false,
            unit: "s",
            description: "time limit of the whole script; 600 if left out",
        },
    ],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::Never,
    effect: "",
    cost: "nothing",
    written_tables: &[],
    rejection_codes: &["script_failed", "script_timeout"],
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
    example: r#"{"code": "SELECT COUNT(*) AS n FROM customers"}"#,
};

impl Tool for PythonExec {
    type Args = Script;
    type Answer = ScriptOutput;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(&self, _: &ToolContext<'_>, arguments: &Arguments) -> Result<Script, Rejection> {
        let code = text_argument(arguments, "code")?.to_owned();
        let seconds = arguments.parse_argument("timeout_seconds", |value, name| {
            json_f64(value).filter(|seconds| *seconds > 0.0 && *seconds <= MAX_SCRIPT_SECONDS).ok_or_else(
                || wrong_type_rejection(name, &format!("a number above 0, at most {MAX_SCRIPT_SECONDS}")),
            )
        })?;
        Ok(Script { code, timeout_seconds: seconds.unwrap_or(MAX_SCRIPT_SECONDS) })
    }

    fn plan(&self, _: &ToolContext<'_>, script: Script) -> Result<PlannedCall<ScriptOutput>, Rejection> {
        Ok(PlannedCall::with_script(script))
    }
}
