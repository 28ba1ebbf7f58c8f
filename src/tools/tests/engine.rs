//! Tests of calculations, scripts and documentation. Tests of the session cover the execution of statements.

use serde_json::{Value, json};

use super::super::{
    Arguments, ColumnDocument, Notebook, NotebookSection, ParameterNumbers, Rejection, Reply, Script,
    SessionContext, TableDocument, ToolContext, find,
};
use novamind_world::command::ResolvedCommand;
use novamind_world::events::Facts;
use novamind_world::events::Reading;
use novamind_world::params::{Interface, Params};
use novamind_world::state::World;

#[derive(Default)]
struct TestHost {
    notebook: Notebook,
}

fn column(name: &'static str, description: &'static str) -> ColumnDocument {
    ColumnDocument { name, kind: "INTEGER", values: &[], description }
}

impl SessionContext for TestHost {
    fn describe_economy(&self, _: &Reading) -> String {
        String::new()
    }

    fn tables(&self, _: Interface) -> Vec<TableDocument> {
        vec![
            TableDocument {
                name: "ledger",
                description: "cash",
                columns: vec![column("id", "number"), column("day", "day")],
            },
            TableDocument {
                name: "issues",
                description: "support",
                columns: vec![column("issue_id", "number")],
            },
        ]
    }

    fn notebook(&self) -> &Notebook {
        &self.notebook
    }
}

impl TestHost {
    /// Returns the result of a call, or the script that the session would run.
    fn try_call(&mut self, name: &str, given: &Value) -> Result<Result<Value, Script>, Rejection> {
        let tool = find(name).expect("the tool exists");
        let params = Params::bundled();
        let world = World::new(500, 1.0, &params, &mut Facts::default());
        let view = ToolContext::new(&world, &params).with_session(self);
        let arguments = Arguments::parse(tool.spec(), given, || ParameterNumbers::bundled().into())?;
        let planned = tool.plan(&view, &arguments)?;
        let beyond = |change| self.notebook.check_quota(change);
        planned.notebook_change.as_ref().map_or(Ok(()), beyond)?;
        let outcome = match planned.reply {
            Reply::FromScript(script, _) => Err(script),
            reply => {
                Ok(reply.into_answer_without_script(&ResolvedCommand::None).expect("an answer").to_json())
            }
        };
        planned.notebook_change.iter().for_each(|change| self.notebook.apply(change));
        Ok(outcome)
    }

    fn call(&mut self, name: &str, given: Value) -> Value {
        let outcome =
            self.try_call(name, &given).unwrap_or_else(|rejection| panic!("{name} {given}: {rejection}"));
        outcome.unwrap_or_default()
    }

    fn assert_rejections(&mut self, name: &str, cases: &[(Value, &str, &str)]) {
        for (given, code, field) in cases {
            let rejection = self.try_call(name, given).expect_err(&format!("{name} {given} is invalid"));
            assert_eq!(
                (rejection.code, rejection.field.as_deref().unwrap_or("")),
                (*code, *field),
                "{name} {given}"
            );
            assert!(rejection.message.len() > 10);
        }
        let spec = find(name).expect("the tool exists").spec();
        // Tests of the session cover these codes, because they need a database.
        let codes_tested_by_session = ["script_failed", "script_timeout"];
        for code in spec.rejection_codes.iter().filter(|code| !codes_tested_by_session.contains(code)) {
            assert!(cases.iter().any(|(_, tested, _)| tested == code), "{name}: {code} is not tested");
        }
    }
}

#[test]
fn calculations_are_stored_listed_and_removed() {
    let mut host = TestHost::default();
    let data = host.call("register_daily_calculation", json!({"name": "mrr", "code": "SELECT 1"}));
    assert_eq!(data, json!({"name": "mrr", "code_length": 8}));
    host.call("register_daily_calculation", json!({"name": "", "code": "SELECT '\u{e9}'"}));
    let data = host.call("register_daily_calculation", json!({"name": "mrr", "code": "SELECT 22"}));
    assert_eq!(data["code_length"], 9);
    assert_eq!(host.call("list_daily_calculations", json!({})), json!({"calculations": ["mrr", ""]}));
    assert_eq!(host.notebook.statements(NotebookSection::Calculation).get("mrr"), Some("SELECT 22"));
    host.assert_rejections(
        "register_daily_calculation",
        &[
            (json!({"code": "SELECT 1"}), "argument_missing", "name"),
            (json!({"name": "x"}), "argument_missing", "code"),
            (json!({"name": 5, "code": "SELECT 1"}), "wrong_type", "name"),
            (json!({"name": "x", "code": ["SELECT 1"]}), "wrong_type", "code"),
            (json!({"name": "x", "code": "x".repeat(300_000)}), "quota_exceeded", "code"),
        ],
    );
    host.assert_rejections(
        "remove_daily_calculation",
        &[
            (json!({"name": "MRR"}), "calculation_not_found", "name"),
            (json!({"name": 1}), "wrong_type", "name"),
            (json!({}), "argument_missing", "name"),
        ],
    );
    let data = host.call("remove_daily_calculation", json!({"name": "mrr"}));
    assert_eq!(data, json!({"name": "mrr", "remaining": [""]}));
    host.assert_rejections("list_daily_calculations", &[(json!({"x": 1}), "unknown_argument", "x")]);
}

#[test]
fn scripts_are_stored_run_and_deleted() {
    let mut host = TestHost::default();
    host.assert_rejections(
        "register_script",
        &[
            (json!({"name": " \t", "code": "SELECT 1"}), "script_name_blank", "name"),
            (json!({"name": "x", "code": 5}), "wrong_type", "code"),
            (json!({"name": "x"}), "argument_missing", "code"),
            (json!({"name": "x".repeat(300), "code": "SELECT 1"}), "quota_exceeded", "name"),
        ],
    );
    let data = host.call("register_script", json!({"name": " churn ", "code": "SELECT 1"}));
    assert_eq!(data, json!({"name": "churn", "code_length": 8}));
    host.call("register_script", json!({"name": "other", "code": "SELECT 2"}));
    assert_eq!(host.call("list_scripts", json!({})), json!({"scripts": ["churn", "other"]}));
    let missing = [(json!({"name": "nothing"}), "script_not_found", "name")];
    host.assert_rejections("run_script", &missing);
    host.assert_rejections("delete_script", &missing);
    let script = host.try_call("run_script", &json!({"name": "churn"})).expect("it is stored");
    assert_eq!(script, Err(Script { code: "SELECT 1".to_owned(), timeout_seconds: 600.0 }));
    let data = host.call("delete_script", json!({"name": "churn"}));
    assert_eq!(data, json!({"name": "churn", "remaining": ["other"]}));
    host.assert_rejections("run_script", &[(json!({"name": "churn"}), "script_not_found", "name")]);
}

#[test]
fn python_exec_validates_code_and_timeout() {
    let mut host = TestHost::default();
    let script =
        host.try_call("python_exec", &json!({"code": "SELECT 1", "timeout_seconds": 2.5})).expect("a script");
    assert_eq!(script, Err(Script { code: "SELECT 1".to_owned(), timeout_seconds: 2.5 }));
    host.assert_rejections(
        "python_exec",
        &[
            (json!({}), "argument_missing", "code"),
            (json!({"code": 5}), "wrong_type", "code"),
            (json!({"code": "SELECT 1", "timeout_seconds": 0}), "wrong_type", "timeout_seconds"),
            (json!({"code": "SELECT 1", "timeout_seconds": 601}), "wrong_type", "timeout_seconds"),
            (json!({"code": "SELECT 1", "timeout_seconds": "5"}), "wrong_type", "timeout_seconds"),
        ],
    );
}

#[test]
fn documentation_tools_describe_tables_and_tools() {
    let mut host = TestHost::default();
    let data = host.call("list_all_tables", json!({}));
    assert_eq!(data, json!({"count": 2, "tables": {"ledger": "cash", "issues": "support"}}));
    let ledger = json!({"description": "cash", "columns": {"id": "INTEGER: number", "day": "INTEGER: day"}});
    for given in [json!("ledger"), json!(["ledger"]), json!(["ledger", "nothing"])] {
        let data = host.call("describe_tables", json!({"table_names": given}));
        assert_eq!(data, json!({"tables": {"ledger": ledger}}));
    }
    for given in [json!({}), json!({"table_names": "all"}), json!({"table_names": null})] {
        let data = host.call("describe_tables", given);
        assert_eq!(data["tables"].as_object().map(|tables| tables.len()), Some(2));
    }
    let wrong = |field: &str, code: &'static str| {
        [
            (json!({ field: "nothing" }), code, field.to_owned()),
            (json!({ field: [] }), code, field.to_owned()),
            (json!({ field: 5 }), "wrong_type", field.to_owned()),
            (json!({ field: [5] }), "wrong_type", field.to_owned()),
        ]
    };
    for (tool, field, code) in [
        ("describe_tables", "table_names", "table_not_found"),
        ("get_tool_documentation", "tool_names", "tool_not_found"),
    ] {
        let cases = wrong(field, code);
        let cases: Vec<(Value, &str, &str)> =
            cases.iter().map(|(given, code, field)| (given.clone(), *code, field.as_str())).collect();
        host.assert_rejections(tool, &cases);
    }
    let data = host.call("get_tool_documentation", json!({"tool_names": ["set_prices", "query"]}));
    assert_eq!(data.as_object().map(|tools| tools.len()), Some(2));
    assert_eq!(data["set_prices"]["name"], "set_prices");
    let all = host.call("get_tool_documentation", json!({}));
    assert_eq!(all.as_object().map(|tools| tools.len()), Some(super::super::CATALOGUE.len()));
}
