//! Guarded queries: one read-only statement over the 19 visible tables (chapter 60 §3.4, rule C).
//!
//! The connection can only read; an authorizer (`guard.rs`) allows the visible tables and ordinary functions;
//! limits bound the size of statements, values and results; a progress handler stops what takes too long or too
//! much memory. What is refused is decided by what a statement does, never by how its text looks.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, RwLock};
use std::time::{Duration, Instant};

use rusqlite::Connection;
use rusqlite::fallible_iterator::FallibleIterator;
use rusqlite::hooks::{AuthContext, Authorization};
use rusqlite::limits::Limit;
use rusqlite::types::ValueRef;

use super::block_table;
use super::blocks::SharedShelf;
use super::guard::{Guard, Objection, Objections, is_hidden_table};
use super::help::{explain_error, hints};
use super::interrupt::{Cause, Interrupt, STEPS_BETWEEN_LOOKS};
use super::location::Location;

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

impl Cell {
    fn text_length(&self) -> usize {
        match self {
            Cell::Text(text) => text.len(),
            _ => 0,
        }
    }
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

/// A cell of a row as a number; 0 if it holds none.
pub fn number_at(row: &[Cell], at: usize) -> f64 {
    match row.get(at) {
        Some(Cell::Integer(number)) => *number as f64,
        Some(Cell::Real(number)) => *number,
        _ => 0.0,
    }
}

/// A cell of a row as text; empty if it holds none.
pub fn text_at(row: &[Cell], at: usize) -> &str {
    match row.get(at) {
        Some(Cell::Text(text)) => text,
        _ => "",
    }
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
/// Why a script was not run to its end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScriptError {
    /// Number of the statement, from 1.
    pub statement: usize,
    /// What is wrong with it.
    pub error: QueryError,
}

/// Limits of a query.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Rows at most.
    pub rows: usize,
    /// Time at most.
    pub time: Duration,
    /// Steps of SQLite's machine at most; none: only time and memory count.
    pub steps: Option<u64>,
}

/// A result may hold this many bytes of text.
const MOST_TEXT: usize = 64 << 20;

/// A place to ask questions.
pub struct Desk {
    connection: Connection,
    objections: Objections,
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
        connection.pragma_update(None, "temp_store", "MEMORY")?;
        let guard = Guard::set_up(&connection)?;
        connection.pragma_update(None, "query_only", true)?;
        connection.set_limit(Limit::SQLITE_LIMIT_ATTACHED, 0)?;
        // A function works on its values in one step that nothing can stop, so values and patterns are short.
        connection.set_limit(Limit::SQLITE_LIMIT_LENGTH, 2 << 20)?;
        connection.set_limit(Limit::SQLITE_LIMIT_LIKE_PATTERN_LENGTH, 1000)?;
        connection.set_limit(Limit::SQLITE_LIMIT_SQL_LENGTH, 1 << 20)?;
        connection.set_limit(Limit::SQLITE_LIMIT_EXPR_DEPTH, 500)?;
        connection.set_limit(Limit::SQLITE_LIMIT_COMPOUND_SELECT, 200)?;
        connection.set_limit(Limit::SQLITE_LIMIT_VDBE_OP, 250_000)?;
        connection.set_limit(Limit::SQLITE_LIMIT_WORKER_THREADS, 0)?;
        // Virtual tables connect at their first use, which the authorizer would refuse.
        for table in ["daily_usage", "ads_revenue"] {
            connection.prepare(&format!("SELECT 1 FROM {table}"))?;
        }
        let (objections, trusted) = (guard.objections(), Arc::new(AtomicBool::new(false)));
        let by_desk = trusted.clone();
        connection.authorizer(Some(move |context: AuthContext<'_>| {
            match by_desk.load(Ordering::Relaxed) {
                true => Authorization::Allow,
                false => guard.authorize(&context),
            }
        }))?;
        let interrupt = Interrupt::new();
        let clock = interrupt.clone();
        connection.progress_handler(STEPS_BETWEEN_LOOKS as i32, Some(move || clock.must_end()))?;
        Ok(Desk { connection, objections, trusted, interrupt, gate, shelf: shelf.clone(), seen })
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
        self.look(sql, limits)?;
        let answer = self.run(sql, limits).map_err(|fault| self.told(sql, fault, limits));
        self.look_away()?;
        answer
    }

    /// Runs statements one after the other, each with the rows and time of `limits`, all of them in `time`
    /// together; `answered` gets each result. They all see the same state.
    ///
    /// # Errors
    /// The first statement that is refused; the ones before it were answered.
    pub fn run_script(
        &self,
        sql: &str,
        limits: Limits,
        time: Duration,
        mut answered: impl FnMut(Rows),
    ) -> Result<(), ScriptError> {
        let end = Instant::now() + time;
        let at = |statement: usize| move |error: QueryError| ScriptError { statement, error };
        self.look(sql, limits).map_err(at(1))?;
        let mut batch = rusqlite::Batch::new(&self.connection, sql);
        let mut done = Ok(());
        for number in 1.. {
            let own =
                Limits { time: limits.time.min(end.saturating_duration_since(Instant::now())), ..limits };
            self.interrupt.go_on(own.time, own.steps);
            let answer = match batch.next() {
                Ok(None) => break,
                Ok(Some(statement)) => self.fetch(statement, sql, own),
                Err(error) => Err(Fault::Sqlite(error)),
            };
            match answer {
                Ok(rows) => answered(rows),
                Err(fault) => {
                    done = Err(at(number)(self.told(sql, fault, own)));
                    break;
                }
            }
        }
        self.look_away().map_err(at(1))?;
        done
    }

    /// Fixes what the query sees: rows and blocks of the same commit, whatever is written meanwhile.
    fn look(&self, sql: &str, limits: Limits) -> Result<(), QueryError> {
        self.objections.clear();
        self.interrupt.begin(limits.time, limits.steps);
        let _open = self.gate.read().unwrap_or_else(|poisoned| poisoned.into_inner());
        self.as_desk("BEGIN; SELECT seq FROM projection")
            .map_err(|error| self.told(sql, Fault::Sqlite(error), limits))?;
        let shelf = self.shelf.read().unwrap_or_else(|poisoned| poisoned.into_inner()).clone();
        *self.seen.write().unwrap_or_else(|poisoned| poisoned.into_inner()) = shelf;
        Ok(())
    }

    fn look_away(&self) -> Result<(), QueryError> {
        self.as_desk("ROLLBACK").map_err(|error| refusal("sql_error", &error.to_string()))
    }

    fn as_desk(&self, sql: &str) -> rusqlite::Result<()> {
        self.trusted.store(true, Ordering::Relaxed);
        let done = self.connection.execute_batch(sql);
        self.trusted.store(false, Ordering::Relaxed);
        done
    }

    fn run(&self, sql: &str, limits: Limits) -> Result<Rows, Fault> {
        let mut batch = rusqlite::Batch::new(&self.connection, sql);
        let Some(statement) = batch.next()? else {
            return Err(Fault::Empty);
        };
        match batch.next() {
            Ok(None) => {}
            _ => return Err(Fault::Several),
        }
        self.fetch(statement, sql, limits)
    }

    fn fetch(
        &self,
        mut statement: rusqlite::Statement<'_>,
        sql: &str,
        limits: Limits,
    ) -> Result<Rows, Fault> {
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
        let (mut truncated, mut text) = (false, 0);
        while let Some(row) = next {
            if rows.len() == limits.rows {
                truncated = true;
                break;
            }
            let cells = (0..width).map(|at| row.get_ref(at).map(cell)).collect::<Result<Vec<_>, _>>()?;
            text += cells.iter().map(Cell::text_length).sum::<usize>();
            if text > MOST_TEXT {
                return Err(Fault::TooLarge);
            }
            rows.push(cells);
            next = cursor.next()?;
        }
        let warning = truncated
            .then(|| format!("only the first {} rows are shown; more exist: aggregate in SQL", limits.rows));
        let hint = if rows.is_empty() { hints(sql) } else { None };
        Ok(Rows { columns, rows, truncated, warning, hint })
    }

    fn told(&self, sql: &str, fault: Fault, limits: Limits) -> QueryError {
        let objection = self.objections.last();
        match fault {
            Fault::Empty => refusal("sql_empty", "no SQL was given"),
            Fault::Several => {
                refusal("sql_error", "one statement at a time; leave out what follows the first ;")
            }
            Fault::Explain => refusal("sql_schema", "query plans are not shown"),
            Fault::Write => write_refusal(),
            Fault::TooLarge => {
                let most = MOST_TEXT >> 20;
                refusal("sql_error", &format!("the result is larger than {most} MiB; ask for less at a time"))
            }
            Fault::Sqlite(_) if objection == Objection::Write => write_refusal(),
            Fault::Sqlite(_) if objection == Objection::Schema => refusal(
                "sql_schema",
                "schema statements are not allowed; the table browser describes all tables",
            ),
            Fault::Sqlite(_) if objection == Objection::Hidden => hidden_refusal(None),
            Fault::Sqlite(error) => self.told_by_sqlite(sql, &error, limits),
        }
    }

    fn told_by_sqlite(&self, sql: &str, error: &rusqlite::Error, limits: Limits) -> QueryError {
        if error.sqlite_error_code() == Some(rusqlite::ErrorCode::OperationInterrupted) {
            let seconds = limits.time.as_secs();
            let message = match self.interrupt.cause() {
                Cause::Request => "the query was cancelled".to_owned(),
                Cause::Memory => "the query needs too much memory; ask for less at a time".to_owned(),
                Cause::Time => format!("the query ran longer than {seconds} s; ask for less at a time"),
            };
            return refusal("sql_timeout", &message);
        }
        let (text, position) = match error {
            rusqlite::Error::SqlInputError { msg, offset, .. } => {
                (msg.clone(), usize::try_from(*offset).ok())
            }
            rusqlite::Error::SqliteFailure(_, Some(text)) => (text.clone(), None),
            rusqlite::Error::InvalidParameterCount(..) => {
                ("a statement has no parameters here; write the values where they belong".to_owned(), None)
            }
            other => (other.to_string(), None),
        };
        if text.starts_with("cannot modify") || text.ends_with("may not be modified") {
            return write_refusal();
        }
        if let Some(table) = text.strip_prefix("no such table: ") {
            let name = table.rsplit('.').next().unwrap_or(table);
            if is_hidden_table(name) {
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
    TooLarge,
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
