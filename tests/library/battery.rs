//! Hundreds of typical SQL statements of agents. Their results in the database of a run are compared with ordinary
//! tables that have the same rows.
//!
//! Durations with 190,000 subscribers are printed, not checked:
//! `cargo test --release --test library -- battery --ignored --nocapture`

use std::cmp::Reverse;
use std::time::{Duration, Instant};

use novamind::database::query::QueryLimits;
use novamind::database::{Cell, Interface, QueryConnection, QueryResult, register_math_functions, tables};
use novamind::lab::benchmark::{BenchContext, create_company_for_queries};
use novamind::record::folder::configuration::Configuration;
use novamind::record::mode::Mode;
use novamind::record::trajectory::record::Via;
use novamind::session::{NewRun, Session, WaitingThread};
use rusqlite::Connection;
use rusqlite::types::{ToSqlOutput, ValueRef};
use serde_json::{Value, json};

use crate::support::company::call_tool;

/// A step limit instead of a time limit. Statements with nested scans would exceed the step limit.
const LIMITS: QueryLimits =
    QueryLimits { rows: 5000, time: Duration::from_secs(3600), steps: Some(6_000_000) };

const UNLIMITED_ROWS: QueryLimits = QueryLimits { rows: usize::MAX, steps: None, ..LIMITS };

fn statement_battery() -> Vec<(&'static str, &'static str)> {
    let mut heading = "";
    let mut statements = Vec::new();
    for line in include_str!("../data/battery.sql").lines() {
        match (line.strip_prefix("-- # "), line.strip_suffix(';')) {
            (Some(title), _) => heading = title,
            (None, Some(statement)) => statements.push((heading, statement)),
            (None, None) => assert!(line.is_empty() || line.starts_with("-- "), "{line} has no end"),
        }
    }
    statements
}

/// Returns a company that uses every mechanism within nine weeks.
fn played_session() -> Session {
    let overrides = vec![("market_research.market_research_discover_prob".to_owned(), "0.5".to_owned())];
    let cash = Some(20_000_000.0);
    let new =
        NewRun { seed: Some(11), days: Some(140), mode: Mode::Debug, cash, overrides, ..NewRun::default() };
    let mut session = Session::create(new, &Configuration::bundled()).expect("the run begins");
    for (tool, arguments) in [
        ("set_prices", json!({"A": 12, "B": 25, "C": 55})),
        ("set_model_tiers", json!({"A": 3, "B": 4, "C": 4})),
        ("set_usage_quotas", json!({"A": 59.5, "B": 30_000, "C": 1_000_000})),
        ("set_daily_spend", json!({"operations": 120, "development": 200.5})),
        ("set_targeted_dev_spend", json!({"S1": 5000, "E1": 20_000.0, "E2": 20_000})),
        ("set_targeted_ops_spend", json!({"by_group": {"S1": 4}, "by_plan": {"A": 2.5}})),
        (
            "set_targeted_ad_spend",
            json!({"content_marketing": {"S1": 350, "S2": 120.0}, "linkedin": {"E1": 6000, "E2": 6000}}),
        ),
        ("set_promotion", json!({"by_group": {"S2": 3}, "global_promotion": 0.5})),
        ("set_lead_promotion", json!({"by_channel": {"content_marketing": 2}})),
        ("set_capacity_tier", json!({"tier": 4})),
        ("start_research_project", json!({"tier": 1})),
        ("start_research_project", json!({"tier": 3})),
        ("research_group", json!({"group_id": "S1", "target_level": 2})),
    ] {
        call_tool(&mut session, tool, arguments);
    }
    (0..9).for_each(|at| play_week(&mut session, at));
    session.wait_for_database().expect("everything is written");
    session
}

fn play_week(session: &mut Session, at: u32) {
    answer_threads(session);
    if at < 5 {
        call_tool(session, "research_market", json!({}));
    }
    let weekly_call = match at {
        2 => Some(("post_social_media", json!({"content": "Support answers within a day now."}))),
        3 => Some(("set_prices", json!({"A": 11, "B": 27.5}))),
        4 => Some(("set_ads_strength", json!({"global_strength": 0.1, "by_group": {"S1": 0.2}}))),
        5 => Some(("post_social_media", json!({"content": "Lower prices on plan A from today."}))),
        6 => Some(("set_targeted_dev_spend", json!({"S1": 4000, "S2": 333}))),
        _ => None,
    };
    if let Some((tool, arguments)) = weekly_call {
        call_tool(session, tool, arguments);
    }
    let forecasts = session.company().naive_forecasts();
    session.advance("as planned", &forecasts, Via::Script, &mut |_| {}).expect("a week");
}

/// Accepts the requested terms in most threads, ends some threads and ignores some threads.
fn answer_threads(session: &mut Session) {
    let waiting = session.company().observe().waiting;
    let offer = |thread: &WaitingThread| {
        let price = thread.asked.unwrap_or(30.0);
        json!([thread.customer, [["C", price * 1.5], ["B", price]]])
    };
    let of = |rest: &[u32]| {
        waiting.iter().filter(|thread| rest.contains(&(thread.thread % 6))).collect::<Vec<_>>()
    };
    let offers: Vec<Value> = of(&[0, 1, 2, 3]).into_iter().map(offer).collect();
    let ended: Vec<Value> = of(&[4]).iter().map(|thread| json!(thread.customer)).collect();
    for (tool, deals) in [("send_enterprise_deal", offers), ("reject_enterprise_deal", ended)] {
        if !deals.is_empty() {
            call_tool(session, tool, json!({ "deals": deals }));
        }
    }
}

/// Returns ordinary tables with the schema of the released simulator and the rows of a company.
fn plain_tables(connection: &QueryConnection) -> Connection {
    let mut plain = Connection::open_in_memory().expect("memory");
    register_math_functions(&plain).expect("functions");
    let transaction = plain.transaction().expect("a transaction");
    for table in tables(Interface::Release1) {
        transaction.execute_batch(&table.create_statement()).expect("a table");
        let all = connection.query(&format!("SELECT rowid, * FROM {}", table.name), UNLIMITED_ROWS);
        let all = all.unwrap_or_else(|error| panic!("{}: {}", table.name, error.message));
        let columns: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
        let places = vec!["?"; columns.len() + 1].join(", ");
        let insert = format!("INSERT INTO {} (rowid, {}) VALUES ({places})", table.name, columns.join(", "));
        let mut insert = transaction.prepare(&insert).expect("a statement");
        for row in &all.rows {
            insert.execute(rusqlite::params_from_iter(row.iter().map(to_sql_output))).expect("a row");
        }
        assert!(!all.rows.is_empty(), "{} is empty: the company must use every mechanism", table.name);
    }
    for table in ["daily_usage", "ads_revenue", "subscriptions", "issues", "enterprise_turns"] {
        let index = format!("CREATE INDEX {table}_of_customers ON {table} (customer_id)");
        transaction.execute_batch(&index).expect("an index");
    }
    transaction.commit().expect("a commit");
    plain
}

fn to_sql_output(cell: &Cell) -> ToSqlOutput<'_> {
    ToSqlOutput::Borrowed(match cell {
        Cell::Null => ValueRef::Null,
        Cell::Integer(number) => ValueRef::Integer(*number),
        Cell::Real(number) => ValueRef::Real(*number),
        Cell::Text(text) => ValueRef::Text(text.as_bytes()),
    })
}

fn query_plain_tables(plain: &Connection, sql: &str) -> QueryResult {
    let mut statement = plain.prepare(sql).unwrap_or_else(|error| panic!("{sql}: {error}"));
    let columns: Vec<String> = statement.column_names().map(str::to_owned).collect();
    let width = columns.len();
    let cell = |value: ValueRef<'_>| match value {
        ValueRef::Null => Cell::Null,
        ValueRef::Integer(number) => Cell::Integer(number),
        ValueRef::Real(number) => Cell::Real(number),
        ValueRef::Text(bytes) | ValueRef::Blob(bytes) => {
            Cell::Text(String::from_utf8_lossy(bytes).into_owned())
        }
    };
    let row = |row: &rusqlite::Row<'_>| (0..width).map(|at| row.get_ref(at).map(cell)).collect();
    let rows = statement.query_map([], row).expect("an answer").collect::<rusqlite::Result<_>>();
    QueryResult {
        columns,
        rows: rows.unwrap_or_else(|error| panic!("{sql}: {error}")),
        ..QueryResult::default()
    }
}

/// Returns whether an SQL statement defines the order of its rows.
fn is_ordered(sql: &str) -> bool {
    sql.rfind("ORDER BY").is_some_and(|at| sql[at..].matches(')').count() <= sql[at..].matches('(').count())
}

fn result_difference(sql: &str, actual: &QueryResult, plain: &QueryResult) -> Option<String> {
    let sorted = |rows: &QueryResult| {
        let mut rows: Vec<String> = rows.rows.iter().map(|row| format!("{row:?}")).collect();
        if !is_ordered(sql) {
            rows.sort_unstable();
        }
        rows
    };
    if actual.columns != plain.columns {
        return Some(format!("columns {:?}, not {:?}", actual.columns, plain.columns));
    }
    let (actual, plain) = (sorted(actual), sorted(plain));
    let first = actual.iter().zip(&plain).find(|(actual, plain)| actual != plain);
    match first {
        Some((actual, plain)) => Some(format!("{actual}\n    not {plain}")),
        None if actual.len() != plain.len() => Some(format!("{} rows, not {}", actual.len(), plain.len())),
        None => None,
    }
}

#[test]
fn queries_match_plain_tables_within_step_limit() {
    let session = played_session();
    let connection = session.database().open_connection().expect("a connection");
    let plain = plain_tables(&connection);
    let statements = statement_battery();
    assert!(statements.len() >= 300, "{}", statements.len());
    let (mut problems, mut empty) = (Vec::new(), Vec::new());
    for (heading, sql) in statements {
        let problem = match connection.query(sql, LIMITS) {
            Ok(query_result) => {
                empty.extend(query_result.rows.is_empty().then_some(sql));
                result_difference(sql, &query_result, &query_plain_tables(&plain, sql))
            }
            Err(error) => Some(format!("refused {}: {}", error.code, error.message)),
        };
        problems.extend(problem.map(|problem| format!("[{heading}] {sql}\n    {problem}")));
    }
    assert!(problems.is_empty(), "{}:\n{}", problems.len(), problems.join("\n"));
    assert!(empty.len() <= 8, "{} statements find nothing:\n{}", empty.len(), empty.join("\n"));
}

#[test]
#[ignore = "takes minutes; prints how long the statements take with 190,000 subscribers"]
fn print_statement_times_with_190_000_subscribers() {
    let scratch = tempfile::tempdir().expect("a folder");
    let configuration = Configuration::bundled();
    let bench = BenchContext {
        repetitions: 1,
        scratch_folder: scratch.path().to_owned(),
        configuration,
        scenario: None,
    };
    let session = create_company_for_queries(&bench).expect("a company");
    let connection = session.database().open_connection().expect("a connection");
    let patient = QueryLimits { steps: None, time: Duration::from_secs(120), ..LIMITS };
    let mut times: Vec<(Duration, &str)> = Vec::new();
    for (_, sql) in statement_battery() {
        let started = Instant::now();
        if let Err(error) = connection.query(sql, patient) {
            println!("{}: {}\n    {sql}", error.code, error.message);
        }
        times.push((started.elapsed(), sql));
    }
    times.sort_by_key(|(took, _)| Reverse(*took));
    let size = |table: &str| {
        connection.query(&format!("SELECT count(*) FROM {table}"), patient).map(|rows| rows.rows)
    };
    for table in tables(Interface::Release1) {
        println!("{:<28} {:?}", table.name, size(&table.name));
    }
    for (took, sql) in times.iter().take(25) {
        println!("{:>9.1} ms  {sql}", took.as_secs_f64() * 1e3);
    }
}
