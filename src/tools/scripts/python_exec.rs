use super::super::arguments::{Arguments, number, text, wrong_type};
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, Planned, Range, Refusal, Script, ScriptOutput, Spec, Tool,
    ToolId, View, When,
};
use super::{CODE, LONGEST_SECONDS};

/// The tool `python_exec`.
pub struct PythonExec;

static SPEC: Spec = Spec {
    id: ToolId::PythonExec,
    code: "PYX",
    module: Module::Time,
    kind: Kind::Engine,
    summary: "Run SQL statements or Python over the visible tables",
    arguments: &[
        Argument { name: "code", alias: None, kind: ArgumentKind::Text, required: true, unit: "", doc: CODE },
        Argument {
            name: "timeout_seconds",
            alias: None,
            kind: ArgumentKind::Number(Range { above: true, ..Range::between(0.0, LONGEST_SECONDS) }),
            required: false,
            unit: "s",
            doc: "time limit of the whole script; 600 if left out",
        },
    ],
    own_unknown: false,
    whole: None,
    when: When::Never,
    effect: "",
    cost: "nothing",
    writes: &[],
    refusals: &["script_failed", "script_timeout"],
    returns: &[
        Output { name: "returncode", kind: "integer", doc: "0: the script ran to its end" },
        Output {
            name: "stdout",
            kind: "text",
            doc: "results as tables, or the output of Python; the first 5,000 characters",
        },
        Output { name: "stderr", kind: "text", doc: "warnings and hints, the first 2,000 characters" },
    ],
    example: r#"{"code": "SELECT COUNT(*) AS n FROM customers"}"#,
};

impl Tool for PythonExec {
    type Args = Script;
    type Answer = ScriptOutput;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn read(&self, _: &View<'_>, arguments: &Arguments) -> Result<Script, Refusal> {
        let code = text(arguments, "code")?.to_owned();
        let seconds = arguments.read("timeout_seconds", |value, name| {
            number(value)
                .filter(|seconds| *seconds > 0.0 && *seconds <= LONGEST_SECONDS)
                .ok_or_else(|| wrong_type(name, &format!("a number above 0, at most {LONGEST_SECONDS}")))
        })?;
        Ok(Script { code, seconds: seconds.unwrap_or(LONGEST_SECONDS) })
    }

    fn plan(&self, _: &View<'_>, script: Script) -> Result<Planned<ScriptOutput>, Refusal> {
        Ok(Planned::running(script))
    }
}
