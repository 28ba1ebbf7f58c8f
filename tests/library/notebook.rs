//! Calculations and scripts of a run: they are stored, run, displayed and replayed.

use novamind::record::folder::configuration::Configuration;
use novamind::record::trajectory::record::Via;
use novamind::session::{Access, NewRun, Session, Storage, verify};
use novamind::tools::Rejection;
use serde_json::{Value, json};

use crate::support::company::{advance_week, call_tool};
use crate::support::forging::forge_lines;

fn create(storage: Storage) -> Session {
    let new = NewRun { seed: Some(7), days: Some(28), storage, ..NewRun::default() };
    Session::create(new, &Configuration::bundled()).expect("the run begins")
}

fn try_call(session: &mut Session, tool: &str, arguments: Value) -> Result<Value, Rejection> {
    session.call(tool, &arguments, Via::Script).map(|answer| answer.to_json())
}

#[test]
fn script_statements_return_tables() {
    let mut session = create(Storage::Memory);
    let data = call_tool(&mut session, "python_exec", json!({"code": "SELECT COUNT(*) AS n FROM customers"}));
    assert_eq!(data, json!({"returncode": 0, "stdout": "n\n1\n", "stderr": ""}));
    let several = "SELECT day, category FROM ledger; -- more\n SELECT 'a;b' AS t;\n;";
    let data = call_tool(&mut session, "python_exec", json!({"code": several}));
    assert_eq!(data["stdout"], "day  category\n0    initial_funding\nt\na;b\n");
    let empty = call_tool(&mut session, "python_exec", json!({"code": " -- nothing\n"}));
    assert_eq!((&empty["stdout"], &empty["returncode"]), (&json!(""), &json!(0)));
    let long = "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n WHERE x < 9000) SELECT x FROM n; \
                SELECT * FROM subscriptions WHERE status = 'active'";
    let data = call_tool(&mut session, "python_exec", json!({"code": long}));
    let length = |field: &str| data[field].as_str().map_or(0, |text| text.chars().count());
    assert_eq!(length("stdout"), 5000);
    let remarks = data["stderr"].as_str().expect("text");
    assert!(remarks.contains("first 5000 rows") && remarks.contains("status is never 'active'"), "{remarks}");
}

#[test]
fn scripts_have_the_limits_of_queries() {
    let mut session = create(Storage::Memory);
    let hash = session.state_hash();
    for (code, part) in [
        ("SELECT 1; DELETE FROM ledger", "statement 2: only reading is allowed"),
        ("SELECT c_max FROM customers", "statement 1: there is no column c_max"),
        (
            "SELECT 1; SELECT 2; SELECT * FROM customer_state",
            "statement 3: table customer_state is not accessible",
        ),
        ("PRAGMA query_only = 0", "statement 1: schema"),
        ("SELECT 1; COMMIT", "statement 2: only reading"),
        ("print('hello')", "statement 1: "),
    ] {
        let refusal = try_call(&mut session, "python_exec", json!({ "code": code })).expect_err(code);
        assert_eq!((refusal.code, refusal.field.as_deref()), ("script_failed", Some("code")), "{code}");
        assert!(refusal.message.starts_with(part), "{code}: {}", refusal.message);
    }
    let endless = "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT count(*) FROM n";
    let given = json!({"code": endless, "timeout_seconds": 0.05});
    let refusal = try_call(&mut session, "python_exec", given).expect_err("endless");
    assert_eq!(refusal.code, "script_timeout");
    call_tool(&mut session, "register_script", json!({"name": "bad", "code": "SELECT nothing"}));
    let refusal = try_call(&mut session, "run_script", json!({"name": "bad"})).expect_err("no such column");
    assert_eq!(refusal.code, "script_failed");
    assert_eq!(session.state_hash(), hash);
    call_tool(&mut session, "python_exec", json!({"code": "SELECT 1"}));
}

#[test]
fn calculations_run_before_the_week_and_appear_on_its_dashboard() {
    let mut session = create(Storage::Memory);
    let cash = "SELECT max(day) AS day, sum(amount) AS cash FROM ledger";
    call_tool(&mut session, "register_daily_calculation", json!({"name": "money", "code": cash}));
    call_tool(
        &mut session,
        "register_daily_calculation",
        json!({"name": "wrong", "code": "SELECT c_max FROM customers"}),
    );
    let long =
        "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n WHERE x < 900) SELECT x FROM n";
    call_tool(&mut session, "register_daily_calculation", json!({"name": "long", "code": long}));
    assert!(!session.company().dashboard().contains("Weekly Calculations"));
    let dashboard = advance_week(&mut session).dashboard;
    let expected = "\n--- Weekly Calculations ---\nmoney:\n  day  cash\n  0    1000000.0\nwrong:\n  failed: statement 1: there is no column c_max";
    assert!(dashboard.contains(expected), "{dashboard}");
    assert_eq!(session.company().calculation_outputs()[2].output.chars().count(), 500);
    call_tool(&mut session, "remove_daily_calculation", json!({"name": "long"}));
    let dashboard = advance_week(&mut session).dashboard;
    assert!(
        dashboard.contains("money:\n  day  cash\n  7    999405.0\n") && !dashboard.contains("long:"),
        "{dashboard}"
    );
}

#[test]
fn stored_scripts_survive_reopening() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut session = create(Storage::Runs(runs.path().to_owned()));
    let folder = session.folder().expect("a folder").to_owned();
    let cash = "SELECT sum(amount) AS cash FROM ledger";
    call_tool(&mut session, "register_daily_calculation", json!({"name": "money", "code": cash}));
    call_tool(&mut session, "register_script", json!({"name": "one", "code": "SELECT 1"}));
    call_tool(&mut session, "register_script", json!({"name": "two", "code": "SELECT 2"}));
    call_tool(&mut session, "delete_script", json!({"name": "one"}));
    let random = call_tool(&mut session, "python_exec", json!({"code": "SELECT random() AS r"}));
    assert_eq!(random["returncode"], 0);
    call_tool(&mut session, "run_script", json!({"name": "two"}));
    let dashboard = advance_week(&mut session).dashboard;
    drop(session);
    // Outputs of scripts are not compared, so random functions in SQL do not damage a run.
    assert_eq!(verify(&folder).expect("it verifies").states, 1);
    let mut session = Session::open(&folder, Access::Write, true).expect("it opens");
    assert_eq!(session.company().dashboard(), dashboard);
    assert!(dashboard.contains("money:\n  cash\n  1000000.0\n"), "{dashboard}");
    assert_eq!(call_tool(&mut session, "list_scripts", json!({})), json!({"scripts": ["two"]}));
    assert_eq!(call_tool(&mut session, "run_script", json!({"name": "two"}))["stdout"], "2\n2\n");
    let dashboard = advance_week(&mut session).dashboard;
    assert!(dashboard.contains("money:\n  cash\n  999405.0\n"), "{dashboard}");

    // A branch contains the calculations and scripts that were stored before its first day.
    let mut branch = session.branch(2, novamind::record::mode::Mode::Sandbox).expect("a branch");
    assert_eq!(
        call_tool(&mut branch, "list_daily_calculations", json!({})),
        json!({"calculations": ["money"]})
    );
}

#[test]
fn scripts_run_after_the_end() {
    let mut session = create(Storage::Memory);
    (0..4).for_each(|_| {
        advance_week(&mut session);
    });
    assert!(session.ended().is_some());
    assert_eq!(call_tool(&mut session, "python_exec", json!({"code": "SELECT 5 AS x"}))["stdout"], "x\n5\n");
    call_tool(&mut session, "register_script", json!({"name": "late", "code": "SELECT 1"}));
    assert_eq!(
        try_call(&mut session, "research_market", json!({})).expect_err("it is over").code,
        "run_over"
    );
    assert_eq!(call_tool(&mut session, "get_market_overview", json!({}))["undiscovered_count"], 20);
}

#[test]
fn documentation_tools_describe_the_run() {
    let mut session = create(Storage::Memory);
    let tables = call_tool(&mut session, "list_all_tables", json!({}));
    assert_eq!(
        (tables["count"].as_u64(), tables["tables"].as_object().map(|all| all.len())),
        (Some(19), Some(19))
    );
    let described = call_tool(&mut session, "describe_tables", json!({}));
    let columns = described["tables"].as_object().expect("tables").values();
    let count: usize =
        columns.map(|table| table["columns"].as_object().map_or(0, |columns| columns.len())).sum();
    assert_eq!(count, 148);
    let overview = call_tool(&mut session, "get_market_overview", json!({}));
    assert_eq!(overview["macroeconomic"], Value::Null);
}

#[test]
fn dashboard_changes_only_with_the_week() {
    let runs = tempfile::tempdir().expect("a folder");
    let new = NewRun { days: Some(60), storage: Storage::Runs(runs.path().to_owned()), ..NewRun::default() };
    let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
    let set = |session: &mut Session, price: f64| {
        session.call("set_prices", &json!({ "A": price }), Via::Script).expect("prices");
    };
    set(&mut session, 12.0);
    assert!(session.company().dashboard().contains("Prices: A $12"), "before the first week it is fresh");
    let forecasts = session.company().naive_forecasts();
    let text = session.advance("on", &forecasts, Via::Script, &mut |_| {}).expect("a week").dashboard;
    set(&mut session, 13.0);
    assert!(text.contains("Prices: A $12"), "{text}");
    assert_eq!(
        (session.company().dashboard(), session.company().observe().dashboard),
        (text.clone(), text.clone())
    );
    session.save().expect("saved");
    let folder = session.folder().expect("a folder").to_owned();
    drop(session);
    // The run is opened with the snapshot and without it.
    for _ in 0..2 {
        let again = Session::open(&folder, Access::Read, true).expect("it opens");
        assert_eq!(again.company().dashboard(), text);
        std::fs::remove_file(folder.join("snapshot.bin")).ok();
    }
    let mut again = Session::open(&folder, Access::Write, true).expect("it opens");
    let next = again.advance("on", &forecasts, Via::Script, &mut |_| {}).expect("a week").dashboard;
    assert!(next.contains("Prices: A $13"), "{next}");
}

#[test]
fn text_quotas_apply_only_to_new_calls() {
    let place = tempfile::tempdir().expect("a folder");
    let mut session = create(Storage::Runs(place.path().to_owned()));
    let folder = session.folder().expect("a folder").to_owned();
    let large = format!("SELECT '{}'", "x".repeat(300_000));
    for tool in ["register_script", "register_daily_calculation"] {
        let refusal =
            try_call(&mut session, tool, json!({ "name": "large", "code": large })).expect_err("a quota");
        assert_eq!((refusal.code, refusal.field.as_deref()), ("quota_exceeded", Some("code")), "{tool}");
        assert!(
            refusal.message.contains("300,009") && refusal.message.contains("262,144"),
            "{}",
            refusal.message
        );
    }
    call_tool(&mut session, "register_script", json!({"name": "small", "code": "SELECT 1"}));
    drop(session);
    // Forges the record of a program version without text quotas.
    forge_lines(&folder, |_, line| {
        if line["tool"] == "register_script" && line["ok"] == true {
            line["args"]["code"] = large.clone().into();
            line["result"]["code_length"] = 300_009.into();
        }
    });
    verify(&folder).expect("it verifies");
    for derived in ["snapshot.bin", "world.db"] {
        let _ = std::fs::remove_file(folder.join(derived));
    }
    let session = Session::open(&folder, Access::Write, true).expect("it opens");
    let kept =
        session.notebook().statements(novamind::tools::NotebookSection::Script).get("small").map(str::len);
    assert_eq!(kept, Some(300_009));
}
