//! Hundreds of hostile SQL statements: no statement reads hidden data or writes, and every statement ends within the limits
//! (docs/formats/database.md#queries).
//!
//! These tests are a separate program because SQLite limits memory for the whole process.

use std::path::Path;
use std::sync::{Mutex, MutexGuard};
use std::time::Duration;

use novamind::database::query::QueryLimits;
use novamind::database::{Cell, QueryConnection, QueryError, QueryResult};
use novamind::insight::Inspect;
use novamind::record::folder::configuration::Configuration;
use novamind::record::mode::Mode;
use novamind::record::trajectory::record::Via;
use novamind::session::{NewRun, Session, Storage};
use serde_json::json;

/// Limits for hostile statements. Endless statements end at the step limit, because the time limit is never reached.
const LIMITS: QueryLimits = QueryLimits { rows: 5000, time: Duration::from_secs(3600), steps: Some(400_000) };

/// Limits for statements that must complete.
const AMPLE_LIMITS: QueryLimits = QueryLimits { steps: Some(1_000_000_000), ..LIMITS };

/// Serializes the tests, because the memory that one test uses could stop the queries of another test.
static MEMORY: Mutex<()> = Mutex::new(());

fn lock_memory_limit() -> MutexGuard<'static, ()> {
    MEMORY.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// Plays a company for six weeks so that as many tables as possible have rows.
fn played_session(folder: &Path, scenario: &str) -> Session {
    let (storage, scenario) = (Storage::Runs(folder.to_owned()), scenario.to_owned());
    let new = NewRun { seed: Some(7), days: Some(60), storage, scenario, ..NewRun::default() };
    let mut session = Session::create(new, &Configuration::bundled()).expect("the run starts");
    for (tool, arguments) in [
        ("set_prices", json!({"A": 12, "B": 25, "C": 55})),
        ("set_model_tiers", json!({"B": 2, "C": 4})),
        ("set_usage_quotas", json!({"A": 60000, "B": 250000, "C": 1200000})),
        ("set_targeted_dev_spend", json!({"S1": 6000})),
        ("set_targeted_ad_spend", json!({"content_marketing": {"S1": 750}, "linkedin": {"E1": 3000}})),
        ("set_ads_strength", json!({"global_strength": 0.3})),
        ("research_market", json!({})),
    ] {
        session.call(tool, &arguments, Via::Script).unwrap_or_else(|refusal| panic!("{tool}: {refusal}"));
    }
    for _ in 0..6 {
        let forecasts = session.company().naive_forecasts();
        session.advance("as planned", &forecasts, Via::Script, &mut |_| {}).expect("a week");
    }
    session.wait_for_database().expect("everything is written");
    session
}

/// Returns the schema and the contents of the database in a run folder.
fn database_contents(folder: &Path) -> Vec<String> {
    let flags = rusqlite::OpenFlags::SQLITE_OPEN_READ_ONLY;
    let connection =
        rusqlite::Connection::open_with_flags(folder.join("world.db"), flags).expect("a database");
    let texts = |sql: &str| -> Vec<String> {
        let mut statement = connection.prepare(sql).expect("a statement");
        let width = statement.column_count();
        let row = |row: &rusqlite::Row<'_>| {
            (0..width)
                .map(|at| row.get_ref(at).map(|value| format!("{value:?}")))
                .collect::<Result<Vec<_>, _>>()
        };
        let rows = statement.query_map([], row).expect("rows");
        rows.map(|row| row.expect("a row").join("|")).collect()
    };
    let mut all = texts("SELECT type, name, sql FROM sqlite_schema ORDER BY 1, 2");
    let tables = "SELECT name FROM sqlite_schema WHERE type = 'table' ORDER BY 1";
    let mut statement = connection.prepare(tables).expect("a statement");
    let names: Vec<String> =
        statement.query_map([], |row| row.get(0)).expect("rows").map(|name| name.expect("a name")).collect();
    names.iter().for_each(|name| all.extend(texts(&format!("SELECT * FROM \"{name}\""))));
    all
}

struct Attack {
    head: String,
    sql: String,
}

fn read_attacks() -> Vec<Attack> {
    let mut head = String::new();
    let mut attacks = Vec::new();
    for line in include_str!("data/attacks.txt").lines() {
        if let Some(inner) = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            inner.clone_into(&mut head);
        } else if !line.is_empty() && !line.starts_with("# ") {
            attacks.push(Attack { head: head.clone(), sql: line.replace("\\n", "\n").replace("\\t", "\t") });
        }
    }
    attacks
}

fn first_cell(rows: &QueryResult) -> String {
    match rows.rows.first().and_then(|row| row.first()) {
        Some(Cell::Integer(number)) => number.to_string(),
        Some(Cell::Real(number)) => number.to_string(),
        Some(Cell::Text(text)) => text.clone(),
        Some(Cell::Null) => "NULL".to_owned(),
        None => String::new(),
    }
}

/// Returns a description of the problem if an attack does not have the expected outcome.
fn outcome_problem(attack: &Attack, outcome: &Result<QueryResult, QueryError>) -> Option<String> {
    let (head, value) = attack.head.split_once(' ').unwrap_or((&attack.head, ""));
    let fits = match (head, outcome) {
        ("refused", Err(error)) => error.code == value,
        ("stopped", Err(error)) => ["sql_timeout", "sql_error"].contains(&error.code),
        ("answered", Ok(rows)) => value.is_empty() || first_cell(rows) == value,
        _ => false,
    };
    let text = match outcome {
        Ok(rows) => format!("answered with {} rows, first {}", rows.rows.len(), first_cell(rows)),
        Err(error) => format!("refused {}: {}", error.code, error.message),
    };
    (!fits).then(|| format!("{}\n    expected {}, got {text}", attack.sql, attack.head))
}

fn run_attacks(connection: &QueryConnection, attacks: &[Attack], secrets: &[String]) {
    let mut problems = Vec::new();
    for attack in attacks {
        let limits = if attack.head.starts_with("answered") { AMPLE_LIMITS } else { LIMITS };
        let outcome = connection.query(&attack.sql, limits);
        problems.extend(outcome_problem(attack, &outcome));
        let texts: Vec<String> = match outcome {
            Ok(rows) => {
                assert!(rows.rows.len() <= LIMITS.rows, "{}", attack.sql);
                let text = |cell: Cell| if let Cell::Text(text) = cell { Some(text) } else { None };
                rows.rows.into_iter().flatten().filter_map(text).chain(rows.columns).collect()
            }
            Err(error) => vec![error.message],
        };
        for secret in secrets {
            if texts.iter().any(|text| text.contains(secret.as_str()))
                && !attack.sql.contains(secret.as_str())
            {
                problems.push(format!("{}\n    reveals {secret}", attack.sql));
            }
        }
    }
    assert!(problems.is_empty(), "{} of {}:\n{}", problems.len(), attacks.len(), problems.join("\n"));
}

#[test]
fn hostile_statements_are_rejected_or_bounded() {
    let _alone = lock_memory_limit();
    let runs = tempfile::tempdir().expect("a folder");
    let session = played_session(runs.path(), "default");
    let folder = session.folder().expect("a folder").to_owned();
    let (before, hash) = (database_contents(&folder), session.state_hash());
    let position = rusqlite::Connection::open(folder.join("world.db")).and_then(|connection| {
        connection.query_row("SELECT line_hash FROM projection", [], |row| row.get::<_, String>(0))
    });
    // Internal names and values that no result and no message may reveal.
    const INTERNAL_WORDS: [&str; 12] = [
        "inner_",
        "customer_rows",
        "subscription_rows",
        "ledger_rows",
        "issue_rows",
        "usage_blocks",
        "ads_blocks",
        "issue_clock",
        "_by_customer",
        "_by_day",
        "autoindex",
        "CREATE TABLE",
    ];
    let mut secrets: Vec<String> = INTERNAL_WORDS.map(str::to_owned).into();
    secrets.push(position.expect("a position"));

    let attacks = read_attacks();
    assert!(attacks.len() >= 300, "{}", attacks.len());
    let connection = session.database().open_connection().expect("a connection");
    run_attacks(&connection, &attacks, &secrets);

    assert_eq!(database_contents(&folder), before, "something was written");
    assert_eq!(session.state_hash(), hash);
    for stray in ["attack_copy.db", "attack_other.db", "attack_file.txt"] {
        assert!(!Path::new(stray).exists() && !folder.join(stray).exists(), "{stray} was created");
    }
    // After the rejected statements, the connection still answers queries.
    let rows = connection.query("SELECT count(*) FROM group_info_levels", LIMITS).expect("an answer");
    assert_eq!(first_cell(&rows), "26");
}

#[test]
fn hidden_columns_and_tables_are_not_reachable() {
    let _alone = lock_memory_limit();
    let runs = tempfile::tempdir().expect("a folder");
    let session = played_session(runs.path(), "default");
    let mut attacks = Vec::new();
    let mut reader = csv::Reader::from_reader(include_str!("data/sealed.csv").as_bytes());
    for record in reader.records().map(|record| record.expect("a row")) {
        let (table, column) = (&record[0], &record[1]);
        let (head, forms): (&str, &[&str]) = if column.is_empty() {
            let forms = &[
                "SELECT * FROM {t}",
                "SELECT count(*) FROM {t}",
                "select x from \"{t}\"",
                "SELECT a.x FROM [{t}] a",
                "SELECT * FROM ledger, {t}",
                "SELECT * FROM main.{t}",
                "SELECT (SELECT x FROM {t})",
                "SELECT * FROM ledger WHERE id IN (SELECT x FROM {t})",
                "WITH x AS (SELECT * FROM {t}) SELECT * FROM x",
                "WITH ledger AS (SELECT * FROM {t}) SELECT * FROM ledger",
            ];
            ("refused sql_hidden_table", forms)
        } else {
            let forms = &[
                "SELECT {c} FROM {t}",
                "SELECT {c} AS x FROM {t}",
                "SELECT max({c}) FROM {t}",
                "SELECT a.{c} FROM {t} a",
                "SELECT [{c}] FROM {t}",
                "SELECT 1 FROM {t} WHERE {c} IS NOT NULL",
                "SELECT * FROM {t} ORDER BY {c}",
                "SELECT count(*) FROM {t} GROUP BY {c}",
                "SELECT first_value({c}) OVER () FROM {t}",
                "SELECT * FROM {t} a JOIN {t} b ON a.{c} = b.{c}",
                "WITH x AS (SELECT {c} FROM {t}) SELECT * FROM x",
                "SELECT (SELECT {c} FROM {t} LIMIT 1)",
            ];
            ("refused sql_error", forms)
        };
        let statements = forms.iter().map(|form| form.replace("{t}", table).replace("{c}", column));
        attacks.extend(statements.map(|sql| Attack { head: head.to_owned(), sql }));
    }
    assert!(attacks.len() > 700);
    run_attacks(&session.database().open_connection().expect("a connection"), &attacks, &[]);

    let runs = tempfile::tempdir().expect("a folder");
    let session = played_session(runs.path(), "release-2");
    let connection = session.database().open_connection().expect("a connection");
    run_attacks(&connection, &attacks, &[]);
    // Release 2 rejects everything that release 1 rejects, except `temp.TABLE` and EXPLAIN.
    let secrets = ["hidden_columns_of_", "inner_", "customer_rows", "subscription_rows"].map(str::to_owned);
    let mut rejected = read_attacks();
    rejected.retain(|attack| {
        let sql = attack.sql.to_uppercase();
        attack.head.starts_with("refused")
            && !sql.contains("TEMP.")
            && !sql.trim_start().starts_with("EXPLAIN")
    });
    assert!(rejected.len() > 150, "{}", rejected.len());
    for attack in &mut rejected {
        if let Err(error) = connection.query(&attack.sql, LIMITS) {
            attack.head = format!("refused {}", error.code);
        }
    }
    run_attacks(&connection, &rejected, &secrets);
}

/// A query with x-ray permission reads the hidden tables. All other data that ordinary queries cannot read stays hidden.
#[test]
fn xray_connection_rejects_hostile_statements() {
    let _alone = lock_memory_limit();
    let runs = tempfile::tempdir().expect("a folder");
    let storage = Storage::Runs(runs.path().to_owned());
    let new = NewRun { days: Some(28), mode: Mode::Debug, storage, ..NewRun::default() };
    let mut session = Session::create(new, &Configuration::bundled()).expect("the run starts");
    session.step(2, &mut |_| {}).expect("days");
    let mut problems = Vec::new();
    let names_hidden = |sql: &str| {
        let names = ["hidden.", "\"hidden\"", "[hidden]", "groups", "threads", "competitors", "factors"];
        names.iter().any(|name| sql.to_lowercase().contains(name))
    };
    for attack in read_attacks() {
        // Endless statements are excluded, because the step limit does not apply to x-ray queries.
        let is_endless = attack.head.starts_with("stopped");
        let is_answered = attack.head.starts_with("answered");
        if is_endless || (!attack.head.starts_with("refused sql_write") && names_hidden(&attack.sql)) {
            continue;
        }
        let outcome = match session.inspect().query_hidden_tables(&attack.sql, None) {
            Err(refusal) => {
                Err(QueryError { code: refusal.code, message: refusal.message.clone(), position: None })
            }
            Ok(rows) => Ok(rows),
        };
        // The run of this test has different data than the run of the other test, so only success is checked.
        let head = if is_answered { "answered".to_owned() } else { attack.head };
        problems.extend(outcome_problem(&Attack { head, sql: attack.sql }, &outcome));
    }
    assert!(problems.is_empty(), "{}:\n{}", problems.len(), problems.join("\n"));
}

#[test]
fn query_above_the_memory_limit_is_stopped() {
    let _alone = lock_memory_limit();
    let session = Session::create(NewRun { days: Some(60), ..NewRun::default() }, &Configuration::bundled())
        .expect("a run");
    let connection = session.database().open_connection().expect("a connection");
    let limits = QueryLimits { steps: None, ..LIMITS };
    let sorted = "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) \
                  SELECT length(z) FROM (SELECT randomblob(1900000) AS z FROM n ORDER BY 1)";
    let error = connection.query(sorted, limits).expect_err("too much memory");
    assert_eq!(error.code, "sql_timeout", "{}", error.message);
    assert!(error.message.contains("memory"), "{}", error.message);
    let wide = "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT hex(zeroblob(1000000)) FROM n";
    let error = connection.query(wide, limits).expect_err("too large a result");
    assert_eq!(error.code, "sql_error", "{}", error.message);
    assert!(error.message.contains("MiB"), "{}", error.message);
    connection.query("SELECT 1", limits).expect("an answer");
}
