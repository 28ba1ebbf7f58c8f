//! Guarded queries: one read-only statement over the 19 visible tables (chapter 60 §3.4, rule C).
//!
//! The connection can only read; an authorizer allows the visible tables, their insides only from within a
//! view, and ordinary functions; limits bound the size of statements and values; a progress handler stops what
//! takes too long. What is refused is decided by what a statement does, never by how its text looks.

use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU64, Ordering};
use std::sync::{Arc, RwLock};
use std::time::{Duration, Instant};

use rusqlite::Connection;
use rusqlite::fallible_iterator::FallibleIterator;
use rusqlite::hooks::{AuthAction, AuthContext, Authorization};
use rusqlite::limits::Limit;
use rusqlite::types::ValueRef;

use super::blocks::SharedShelf;
use super::help::{explain_error, hints};
use super::location::Location;
use super::{block_table, catalogue};

/// One value of a result.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// SQL NULL.
    Null,
    /// A whole number.
    Integer(i64),
    /// A number.
    Real(f64),
    /// Text; blobs arrive as text too.
    Text(String),
}

/// A result.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Rows {
    /// Names of the columns; they may repeat.
    pub columns: Vec<String>,
    /// Rows, each with one cell per column.
    pub rows: Vec<Vec<Cell>>,
    /// Whether more rows exist than were fetched.
    pub truncated: bool,
    /// What to know about the result, when it was cut.
    pub warning: Option<String>,
    /// Why an empty result may be empty.
    pub hint: Option<String>,
}

/// Why a query was not answered.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct QueryError {
    /// Code of chapter 50: `sql_empty`, `sql_schema`, `sql_hidden_table`, `sql_write`, `sql_timeout`, `sql_error`.
    pub code: &'static str,
    /// What is wrong, with help where there is some.
    pub message: String,
    /// Place in the statement in bytes, where it is known.
    pub position: Option<usize>,
}

/// Stops a running query from another thread, or by itself when its time is over.
#[derive(Debug, Clone)]
pub struct Interrupt(Arc<Clockwork>);

#[derive(Debug)]
struct Clockwork {
    stopped: AtomicBool,
    started: Instant,
    /// Milliseconds after `started` at which the running query has to end.
    deadline: AtomicU64,
}

impl Interrupt {
    fn new() -> Interrupt {
        let (stopped, deadline) = (AtomicBool::new(false), AtomicU64::new(u64::MAX));
        Interrupt(Arc::new(Clockwork { stopped, started: Instant::now(), deadline }))
    }

    /// Stops the query that is running, if one is.
    pub fn stop(&self) {
        self.0.stopped.store(true, Ordering::Relaxed);
    }

    fn begin(&self, time: Duration) {
        let deadline = self.0.started.elapsed() + time;
        self.0.deadline.store(deadline.as_millis() as u64, Ordering::Relaxed);
        self.0.stopped.store(false, Ordering::Relaxed);
    }

    fn is_stopped(&self) -> bool {
        self.0.stopped.load(Ordering::Relaxed)
    }

    fn must_end(&self) -> bool {
        self.is_stopped()
            || self.0.started.elapsed().as_millis() as u64 > self.0.deadline.load(Ordering::Relaxed)
    }
}

/// Size limits of a query.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Rows at most.
    pub rows: usize,
    /// Time at most.
    pub time: Duration,
}

/// What the authorizer objected to, as a number.
#[derive(Clone, Default)]
struct Objection(Arc<AtomicU8>);

const SCHEMA: u8 = 1;
const HIDDEN: u8 = 2;
const WRITE: u8 = 3;

/// Tables that the released simulator hides and that do not exist here; asking for them has a code of its own.
const HIDDEN_TABLES: [&str; 25] = [
    "events",
    "api_costs",
    "customer_state",
    "group_reputation",
    "group_awareness",
    "reputation_history",
    "global_state",
    "feature_tests",
    "test_assignments",
    "customer_personas",
    "customer_persona_map",
    "group_characteristics",
    "enterprise_thread_counter",
    "world_context",
    "pending_group_research",
    "group_parameters",
    "competitor_events",
    "_hidden_leads_per_1k_snapshot",
    "_hidden_group_params_history",
    "_hidden_quality_snapshot",
    "_hidden_satisfaction_snapshot",
    "_hidden_lead_multiplier_snapshot",
    "global_drift_state",
    "group_insight_snapshots",
    "_rng_states",
];

/// Tables inside the database, and whether a visible table is made of them row by row.
const INSIDES: [(&str, bool); 9] = [
    ("customer_rows", true),
    ("subscription_rows", true),
    ("ledger_rows", true),
    ("issue_rows", true),
    ("words", false),
    ("projection", false),
    ("issue_clock", false),
    ("usage_blocks", false),
    ("ads_blocks", false),
];

/// A place to ask questions.
pub struct Desk {
    connection: Connection,
    objection: Objection,
    /// Set while the desk itself works on the connection.
    trusted: Arc<AtomicBool>,
    interrupt: Interrupt,
    /// Closed while a commit and its blocks become visible together.
    gate: Arc<RwLock<()>>,
    /// The blocks of all desks, and those that the running query sees.
    shelf: SharedShelf,
    seen: SharedShelf,
}

impl Desk {
    /// Opens a guarded connection.
    pub(super) fn open(
        location: &Location,
        shelf: &SharedShelf,
        gate: Arc<RwLock<()>>,
    ) -> rusqlite::Result<Desk> {
        let mut connection = location.open_reader()?;
        let seen = SharedShelf::default();
        block_table::register(&connection, &seen)?;
        connection.pragma_update(None, "query_only", true)?;
        connection.pragma_update(None, "temp_store", "MEMORY")?;
        connection.set_limit(Limit::SQLITE_LIMIT_ATTACHED, 0)?;
        connection.set_limit(Limit::SQLITE_LIMIT_LENGTH, 16 << 20)?;
        connection.set_limit(Limit::SQLITE_LIMIT_SQL_LENGTH, 1 << 20)?;
        connection.set_limit(Limit::SQLITE_LIMIT_EXPR_DEPTH, 500)?;
        connection.set_limit(Limit::SQLITE_LIMIT_COMPOUND_SELECT, 200)?;
        connection.set_limit(Limit::SQLITE_LIMIT_VDBE_OP, 250_000)?;
        connection.set_limit(Limit::SQLITE_LIMIT_WORKER_THREADS, 0)?;
        // Virtual tables connect at their first use, which the authorizer would refuse.
        for table in ["daily_usage", "ads_revenue"] {
            connection.prepare(&format!("SELECT 1 FROM {table}"))?;
        }
        let (objection, trusted) = (Objection::default(), Arc::new(AtomicBool::new(false)));
        let (noted, by_desk) = (objection.clone(), trusted.clone());
        connection.authorizer(Some(move |context: AuthContext<'_>| {
            match by_desk.load(Ordering::Relaxed) {
                true => Authorization::Allow,
                false => authorize(&context, &noted),
            }
        }))?;
        let interrupt = Interrupt::new();
        let clock = interrupt.clone();
        connection.progress_handler(10_000, Some(move || clock.must_end()))?;
        Ok(Desk { connection, objection, trusted, interrupt, gate, shelf: shelf.clone(), seen })
    }

    /// A handle that stops the queries of this desk.
    pub fn interrupt(&self) -> Interrupt {
        self.interrupt.clone()
    }

    /// Answers one statement.
    ///
    /// # Errors
    /// The codes of chapter 50, query.
    pub fn ask(&self, sql: &str, limits: Limits) -> Result<Rows, QueryError> {
        if sql.trim().is_empty() {
            return Err(refusal("sql_empty", "no SQL was given"));
        }
        self.objection.0.store(0, Ordering::Relaxed);
        self.interrupt.begin(limits.time);
        self.look().map_err(|error| self.told(sql, Fault::Sqlite(error), limits))?;
        let answer = self.run(sql, limits).map_err(|fault| self.told(sql, fault, limits));
        self.as_desk("ROLLBACK").map_err(|error| refusal("sql_error", &error.to_string()))?;
        answer
    }

    /// Fixes what the query sees: rows and blocks of the same commit, whatever is written meanwhile.
    fn look(&self) -> rusqlite::Result<()> {
        let _open = self.gate.read().unwrap_or_else(|poisoned| poisoned.into_inner());
        self.as_desk("BEGIN; SELECT seq FROM projection")?;
        let shelf = self.shelf.read().unwrap_or_else(|poisoned| poisoned.into_inner()).clone();
        *self.seen.write().unwrap_or_else(|poisoned| poisoned.into_inner()) = shelf;
        Ok(())
    }

    fn as_desk(&self, sql: &str) -> rusqlite::Result<()> {
        self.trusted.store(true, Ordering::Relaxed);
        let done = self.connection.execute_batch(sql);
        self.trusted.store(false, Ordering::Relaxed);
        done
    }

    fn run(&self, sql: &str, limits: Limits) -> Result<Rows, Fault> {
        let mut batch = rusqlite::Batch::new(&self.connection, sql);
        let Some(mut statement) = batch.next()? else {
            return Err(Fault::Empty);
        };
        match batch.next() {
            Ok(None) => {}
            _ => return Err(Fault::Several),
        }
        if statement.is_explain() != 0 {
            return Err(Fault::Explain);
        }
        if !statement.readonly() {
            return Err(Fault::Write);
        }
        let columns: Vec<String> = statement.column_names().map(str::to_owned).collect();
        let width = columns.len();
        let mut cursor = statement.query([])?;
        let mut next = cursor.next()?;
        let mut rows = Vec::new();
        let mut truncated = false;
        while let Some(row) = next {
            if rows.len() == limits.rows {
                truncated = true;
                break;
            }
            rows.push((0..width).map(|at| row.get_ref(at).map(cell)).collect::<Result<Vec<_>, _>>()?);
            next = cursor.next()?;
        }
        let warning = truncated
            .then(|| format!("only the first {} rows are shown; more exist: aggregate in SQL", limits.rows));
        let hint = if rows.is_empty() { hints(sql) } else { None };
        Ok(Rows { columns, rows, truncated, warning, hint })
    }

    fn told(&self, sql: &str, fault: Fault, limits: Limits) -> QueryError {
        let objection = self.objection.0.load(Ordering::Relaxed);
        match fault {
            Fault::Empty => refusal("sql_empty", "no SQL was given"),
            Fault::Several => {
                refusal("sql_error", "one statement at a time; leave out what follows the first ;")
            }
            Fault::Explain => refusal("sql_schema", "query plans are not shown"),
            Fault::Write => write_refusal(),
            Fault::Sqlite(_) if objection == WRITE => write_refusal(),
            Fault::Sqlite(_) if objection == SCHEMA => refusal(
                "sql_schema",
                "schema statements are not allowed; the table browser describes all tables",
            ),
            Fault::Sqlite(_) if objection == HIDDEN => hidden_refusal(None),
            Fault::Sqlite(error) => self.told_by_sqlite(sql, &error, limits),
        }
    }

    fn told_by_sqlite(&self, sql: &str, error: &rusqlite::Error, limits: Limits) -> QueryError {
        if error.sqlite_error_code() == Some(rusqlite::ErrorCode::OperationInterrupted) {
            return if self.interrupt.is_stopped() {
                refusal("sql_timeout", "the query was cancelled")
            } else {
                let seconds = limits.time.as_secs();
                refusal(
                    "sql_timeout",
                    &format!("the query ran longer than {seconds} s; ask for less at a time"),
                )
            };
        }
        let (text, position) = match error {
            rusqlite::Error::SqlInputError { msg, offset, .. } => {
                (msg.clone(), usize::try_from(*offset).ok())
            }
            rusqlite::Error::SqliteFailure(_, Some(text)) => (text.clone(), None),
            other => (other.to_string(), None),
        };
        if text.starts_with("cannot modify") || text.ends_with("may not be modified") {
            return write_refusal();
        }
        if let Some(table) = text.strip_prefix("no such table: ") {
            let name = table.rsplit('.').next().unwrap_or(table);
            if HIDDEN_TABLES.iter().any(|hidden| hidden.eq_ignore_ascii_case(name)) {
                return hidden_refusal(Some(name));
            }
            if name.to_lowercase().starts_with("pragma_") {
                return refusal("sql_schema", "schema statements are not allowed");
            }
        }
        QueryError { code: "sql_error", message: explain_error(&text, sql), position }
    }
}

enum Fault {
    Empty,
    Several,
    Explain,
    Write,
    Sqlite(rusqlite::Error),
}

impl From<rusqlite::Error> for Fault {
    fn from(error: rusqlite::Error) -> Self {
        Fault::Sqlite(error)
    }
}

fn refusal(code: &'static str, message: &str) -> QueryError {
    QueryError { code, message: message.to_owned(), position: None }
}

fn write_refusal() -> QueryError {
    refusal("sql_write", "only reading is allowed; use the tools to change anything")
}

fn hidden_refusal(table: Option<&str>) -> QueryError {
    match table {
        Some(table) => refusal("sql_hidden_table", &format!("table {table} is not accessible")),
        None => refusal("sql_hidden_table", "that table is not accessible; the 19 tables of the browser are"),
    }
}

fn cell(value: ValueRef<'_>) -> Cell {
    match value {
        ValueRef::Null => Cell::Null,
        ValueRef::Integer(number) => Cell::Integer(number),
        ValueRef::Real(number) => Cell::Real(number),
        ValueRef::Text(bytes) | ValueRef::Blob(bytes) => {
            Cell::Text(String::from_utf8_lossy(bytes).into_owned())
        }
    }
}

fn authorize(context: &AuthContext<'_>, objection: &Objection) -> Authorization {
    let problem = match context.action {
        AuthAction::Select | AuthAction::Recursive => return Authorization::Allow,
        AuthAction::Function { function_name } if function_name != "load_extension" => {
            return Authorization::Allow;
        }
        AuthAction::Read { table_name, column_name } => {
            let name = table_name.to_lowercase();
            let inside = INSIDES.iter().find(|(table, _)| *table == name);
            let visible = catalogue::table(&name).is_some();
            let from_view = context.accessor.is_some_and(|view| catalogue::table(view).is_some());
            // Without a column only rows are counted: those of a common table expression, or of a view that the
            // planner has opened up.
            let counted = column_name.is_empty() && inside.is_none_or(|(_, behind_view)| *behind_view);
            let engine = name.starts_with("sqlite_") || name.starts_with("pragma_");
            if visible || from_view || (counted && !engine) {
                return Authorization::Allow;
            }
            if engine { SCHEMA } else { HIDDEN }
        }
        AuthAction::Pragma { .. } => SCHEMA,
        _ => WRITE,
    };
    objection.0.store(problem, Ordering::Relaxed);
    Authorization::Deny
}
