use super::super::arguments::{Arguments, text_argument};
use super::super::notebook::QUOTA_EXCEEDED;
use super::super::stored_code::{NamedCode, StoredCode};
use super::super::{
    Argument, ArgumentKind, EffectTiming, NotebookSection, PlannedCall, Rejection, ResultField, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};
use super::CODE_DESCRIPTION;

/// The tool `register_script`, which stores a script under a name.
pub struct RegisterScript;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::RegisterScript,
    code: "SCR",
    module: ToolModule::Time,
    kind: ToolKind::Engine,
    summary: "Store a named script of SQL statements or Python",
    arguments: &[
        Argument {
            name: "name",
            alias: None,
            kind: ArgumentKind::Text,
            required: true,
            unit: "",
            description: "name of the script",
        },
        Argument {
            name: "code",
            alias: None,
            kind: ArgumentKind::Text,
            required: true,
            unit: "",
            description: CODE_DESCRIPTION,
        },
    ],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::Now,
    effect: "run_script runs it. A script of the same name is replaced. At most 100 scripts are stored, each with a name of at \
             most 200 bytes and at most 262,144 bytes of code. Scripts and calculations together have at most 4,194,304 bytes.",
    cost: "nothing",
    written_tables: &[],
    rejection_codes: &["script_name_blank", QUOTA_EXCEEDED],
    result_fields: &[
        ResultField { name: "name", kind: "text", description: "the name, without surrounding spaces" },
        ResultField { name: "code_length", kind: "integer", description: "characters" },
    ],
    example: r#"{"name": "churn", "code": "SELECT status, COUNT(*) AS n FROM subscriptions GROUP BY 1"}"#,
};

impl Tool for RegisterScript {
    type Args = NamedCode;
    type Answer = StoredCode;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(&self, _: &ToolContext<'_>, arguments: &Arguments) -> Result<NamedCode, Rejection> {
        let name = text_argument(arguments, "name")?.trim();
        if name.is_empty() {
            return Err(Rejection::for_field("name", "script_name_blank", "the script needs a name"));
        }
        Ok(NamedCode { name: name.to_owned(), code: text_argument(arguments, "code")?.to_owned() })
    }

    fn plan(&self, _: &ToolContext<'_>, named_code: NamedCode) -> Result<PlannedCall<StoredCode>, Rejection> {
        Ok(named_code.planned_store(NotebookSection::Script))
    }
}
