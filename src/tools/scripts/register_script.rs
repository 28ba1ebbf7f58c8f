use super::super::arguments::{Arguments, text};
use super::super::keeping::{KeptCode, NamedCode};
use super::super::notebook::QUOTA_EXCEEDED;
use super::super::{
    Argument, ArgumentKind, Kept, Kind, Module, Output, Planned, Refusal, Spec, Tool, ToolId, View, When,
};
use super::CODE;

/// The tool `register_script`.
pub struct RegisterScript;

static SPEC: Spec = Spec {
    id: ToolId::RegisterScript,
    code: "SCR",
    module: Module::Time,
    kind: Kind::Engine,
    summary: "Store a named script of SQL statements or Python",
    arguments: &[
        Argument {
            name: "name",
            alias: None,
            kind: ArgumentKind::Text,
            required: true,
            unit: "",
            doc: "name of the script",
        },
        Argument { name: "code", alias: None, kind: ArgumentKind::Text, required: true, unit: "", doc: CODE },
    ],
    own_unknown: false,
    whole: None,
    when: When::Now,
    effect: "run_script runs it. A script of the same name is replaced. At most 100 scripts are stored, each with a name of at \
             most 200 bytes and at most 262,144 bytes of code. Scripts and calculations together have at most 4,194,304 bytes.",
    cost: "nothing",
    writes: &[],
    refusals: &["script_name_blank", QUOTA_EXCEEDED],
    returns: &[
        Output { name: "name", kind: "text", doc: "the name, without surrounding spaces" },
        Output { name: "code_length", kind: "integer", doc: "characters" },
    ],
    example: r#"{"name": "churn", "code": "SELECT status, COUNT(*) AS n FROM subscriptions GROUP BY 1"}"#,
};

impl Tool for RegisterScript {
    type Args = NamedCode;
    type Answer = KeptCode;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn read(&self, _: &View<'_>, arguments: &Arguments) -> Result<NamedCode, Refusal> {
        let name = text(arguments, "name")?.trim();
        if name.is_empty() {
            return Err(Refusal::at("name", "script_name_blank", "the script needs a name"));
        }
        Ok(NamedCode { name: name.to_owned(), code: text(arguments, "code")?.to_owned() })
    }

    fn plan(&self, _: &View<'_>, given: NamedCode) -> Result<Planned<KeptCode>, Refusal> {
        Ok(given.keep(Kept::Script))
    }
}
