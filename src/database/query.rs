//! Guarded queries: one read-only statement over the 19 visible tables (docs/formats/database.md#queries).
//!
//! A statement is first compiled against the released schema (`released_schema.rs`), which contains no hidden names.
//! The query connection is read-only. An authorizer (`guard.rs`) allows the visible tables and ordinary functions.
//! Limits restrict the size of statements, values and results, and a progress handler interrupts queries that take too
//! much time or memory. Rejections depend on what a statement does, not on its text.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rusqlite::hooks::{AuthContext, Authorization};
use rusqlite::types::Value;
use rusqlite::{Connection, ffi};

use super::block_loading::BlockSource;
use super::block_table;
use super::blocks::{BlockStore, QueryView};
use super::catalogue::{Scope, Surface};
use super::error_help::{empty_result_hint, explain_error};
use super::guard::{
    Guard, InnerViews, LastRejection, RejectionReason, TrustGuard, is_engine_table, is_hidden_table,
    is_internal_table, set_limits,
};
use super::hidden_schema;
use super::location::DatabaseLocation;
use super::math_functions::register_math_functions;
use super::packed_tables;
use super::query_interrupt::{Interrupt, QueryTicket, STEPS_BETWEEN_CHECKS, StopCause};
use super::query_plan;
use super::query_result::{Cell, QueryResult};
use super::released_schema::{CheckedStatement, ReleasedSchema, strip_explain_query_plan};
use super::tokens::tokenize;

/// An error that a query returned.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct QueryError {
    /// Error code for programs: `sql_empty`, `sql_schema`, `sql_hidden_table`, `sql_write`, `sql_timeout`,
    /// [`SQL_CANCELLED`], `sql_error`.
    pub code: &'static str,
    /// Error message with suggestions for the user.
    pub message: String,
    /// Byte offset of the error in the statement, if it is known.
    pub position: Option<usize>,
}
/// An error that stopped a script of several statements.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScriptError {
    /// Number of the failed statement, counted from 1.
    pub statement: usize,
    /// Error that the statement returned.
    pub error: QueryError,
}

/// Limits of a query's result, time and steps.
#[derive(Debug, Clone, Copy)]
pub struct QueryLimits {
    /// Maximum number of returned rows.
    pub rows: usize,
    /// Maximum duration of the query.
    pub time: Duration,
    /// Maximum number of steps of SQLite's virtual machine; `None` means no limit.
    pub steps: Option<u64>,
}

const MAX_RESULT_TEXT_BYTES: usize = 64 << 20;

/// A read-only connection whose statements are checked by a guard.
pub struct QueryConnection {
    pub(super) released: ReleasedSchema,
    connection: Connection,
    /// Tables that statements may name.
    surface: Surface,
    last_rejection: LastRejection,
    views: Option<InnerViews>,
    /// Whether the authorizer is disabled because the program executes its own statements.
    trusted: Arc<AtomicBool>,
    pub(super) interrupt: Interrupt,
    source: BlockSource,
    /// Packed days and indexes of the running query.
    view: Arc<QueryView>,
}

impl QueryConnection {
    /// Opens a read-only connection and installs the guard.
    pub(super) fn open(
        location: &DatabaseLocation,
        source: BlockSource,
        surface: Surface,
    ) -> rusqlite::Result<QueryConnection> {
        let released = ReleasedSchema::open(surface)?;
        let mut connection = location.open_reader()?;
        let seen = Arc::new(QueryView::default());
        block_table::register(&connection, &seen)?;
        packed_tables::register(&connection, &seen)?;
        register_math_functions(&connection)?;
        connection.pragma_update(None, "temp_store", "MEMORY")?;
        if surface.scope == Scope::Hidden {
            hidden_schema::create_hidden_tables(&connection)?;
        }
        let guard = Guard::with_inner_views(&connection, surface)?;
        connection.pragma_update(None, "query_only", true)?;
        set_limits(&connection)?;
        // Connect the virtual tables now, because the authorizer would reject a connection at first use.
        for table in ["daily_usage", "ads_revenue", "issues", "ledger", "notifications"] {
            connection.prepare(&format!("SELECT 1 FROM {table}"))?;
        }
        let (rejection_slot, views) = (guard.last_rejection(), guard.views());
        let trusted = Arc::new(AtomicBool::new(false));
        let authorizer_trust = trusted.clone();
        connection.authorizer(Some(move |context: AuthContext<'_>| {
            match authorizer_trust.load(Ordering::Relaxed) {
                true => Authorization::Allow,
                false => guard.authorize(&context),
            }
        }))?;
        let interrupt = Interrupt::new();
        let clock = interrupt.clone();
        connection.progress_handler(STEPS_BETWEEN_CHECKS as i32, Some(move || clock.should_stop()))?;
        Ok(QueryConnection {
            released,
            connection,
            surface,
            last_rejection: rejection_slot,
            views,
            trusted,
            interrupt,
            source,
            view: seen,
        })
    }

    /// Returns a handle that another thread can use to stop the queries of this connection.
    pub fn interrupt(&self) -> Interrupt {
        self.interrupt.clone()
    }

    /// Runs one SQL statement.
    ///
    /// # Errors
    /// The statement fails with one of the `sql_` codes of [`QueryError::code`].
    pub fn query(&self, sql: &str, limits: QueryLimits) -> Result<QueryResult, QueryError> {
        self.query_with_ticket(self.interrupt.issue_ticket(), sql, limits)
    }

    /// Runs one statement under a ticket that was issued earlier.
    ///
    /// # Errors
    /// The statement fails with one of the `sql_` codes of [`QueryError::code`].
    pub fn query_with_ticket(
        &self,
        ticket: QueryTicket,
        sql: &str,
        limits: QueryLimits,
    ) -> Result<QueryResult, QueryError> {
        if sql.trim().is_empty() {
            return Err(query_error("sql_empty", "no SQL was given"));
        }
        if sql.contains('\0') {
            // SQLite would ignore the rest of the statement.
            return Err(query_error("sql_error", "the statement contains a NUL character"));
        }
        self.begin_read(ticket, sql, limits)?;
        let answer =
            self.run_single_statement(sql, limits).map_err(|fault| self.fault_to_error(sql, fault, limits));
        let closed = self.end_read();
        // If the statement and the end of the transaction both fail, report the error of the statement.
        answer.and_then(|rows| closed.map(|()| rows))
    }

    /// Runs statements in order on the same state of the database. `limits` applies to each statement, and `time` to
    /// the whole script. Calls `answered` with each result.
    ///
    /// # Errors
    /// A statement fails. The results of earlier statements have been passed to `answered`.
    pub fn run_script(
        &self,
        sql: &str,
        limits: QueryLimits,
        time: Duration,
        mut answered: impl FnMut(QueryResult),
    ) -> Result<(), ScriptError> {
        let end = Instant::now() + time;
        let at = |statement: usize| move |error: QueryError| ScriptError { statement, error };
        self.begin_read(self.interrupt.issue_ticket(), sql, limits).map_err(at(1))?;
        let spelled = self.released.spell(sql);
        let mut statements = self.released.statements(sql, &spelled);
        let mut done = Ok(());
        for number in 1.. {
            let query_limits = QueryLimits {
                time: limits.time.min(end.saturating_duration_since(Instant::now())),
                ..limits
            };
            self.interrupt.begin_statement(query_limits.time, query_limits.steps);
            let answer = match statements.next() {
                Ok(None) => break,
                Ok(Some(reading)) => self.run_statement(reading, sql, query_limits),
                Err(fault) => Err(fault),
            };
            match answer {
                Ok(rows) => answered(rows),
                Err(fault) => {
                    done = Err(at(number)(self.fault_to_error(sql, fault, query_limits)));
                    break;
                }
            }
        }
        let closed = self.end_read().map_err(at(1));
        done.and(closed)
    }

    /// Starts a read transaction. The rows and the packed days of the transaction belong to the same commit.
    fn begin_read(&self, ticket: QueryTicket, sql: &str, limits: QueryLimits) -> Result<(), QueryError> {
        self.last_rejection.clear();
        self.released.clear_rejection();
        self.interrupt.begin(ticket, limits.time, limits.steps);
        if self.interrupt.is_stop_requested() {
            return Err(query_error(SQL_CANCELLED, CANCELLED_MESSAGE));
        }
        let begin = || {
            self.execute_trusted("BEGIN; SELECT seq FROM projection")
                .map_err(|error| self.fault_to_error(sql, QueryFault::Sqlite(error), limits))
        };
        match &self.source {
            BlockSource::Writer(store, gate) => {
                let _open = gate.read().unwrap_or_else(|poisoned| poisoned.into_inner());
                begin()?;
                self.view.set_store(store.read().unwrap_or_else(|poisoned| poisoned.into_inner()).clone());
            }
            BlockSource::File(blocks) => {
                begin()?;
                self.with_trust(|connection| blocks.borrow_mut().refresh(connection));
            }
        }
        Ok(())
    }

    /// Returns whether a query found damaged packed days. After such a query, results are not reliable.
    pub fn has_found_damage(&self) -> bool {
        matches!(&self.source, BlockSource::File(blocks) if blocks.borrow().is_damaged())
    }

    fn load_blocks(&self, reading: &CheckedStatement) -> Result<(), QueryFault> {
        let BlockSource::File(blocks) = &self.source else { return Ok(()) };
        let mut blocks = blocks.borrow_mut();
        let loaded = self.with_trust(|connection| blocks.load(connection, &reading.tables));
        self.view.set_store(blocks.store().clone());
        match loaded {
            true => Ok(()),
            false if self.interrupt.should_stop() => {
                let stopped = ffi::Error::new(ffi::SQLITE_INTERRUPT);
                Err(QueryFault::Sqlite(rusqlite::Error::SqliteFailure(stopped, None)))
            }
            false => {
                blocks.mark_damaged();
                Err(QueryFault::Damaged)
            }
        }
    }

    pub(super) fn with_trust<T>(&self, work: impl FnOnce(&Connection) -> T) -> T {
        let _trust = TrustGuard::enter(&self.trusted);
        work(&self.connection)
    }

    fn end_read(&self) -> Result<(), QueryError> {
        self.view.set_store(BlockStore::default());
        // If memory ran out, SQLite has already ended the transaction.
        if self.connection.is_autocommit() {
            return Ok(());
        }
        self.execute_trusted("ROLLBACK").map_err(|error| query_error("sql_error", &error.to_string()))
    }

    fn execute_trusted(&self, sql: &str) -> rusqlite::Result<()> {
        self.with_trust(|connection| connection.execute_batch(sql))
    }

    fn run_single_statement(&self, sql: &str, limits: QueryLimits) -> Result<QueryResult, QueryFault> {
        let spelled = self.released.spell(sql);
        let mut statements = self.released.statements(sql, &spelled);
        let reading = statements.next()?.ok_or(QueryFault::Empty)?;
        match statements.next() {
            Ok(None) => self.run_statement(reading, sql, limits),
            _ => Err(QueryFault::MultipleStatements),
        }
    }

    fn run_statement(
        &self,
        reading: CheckedStatement,
        sql: &str,
        limits: QueryLimits,
    ) -> Result<QueryResult, QueryFault> {
        if let Some(program) = reading.program {
            let cell = |value: &Value| Cell::from_sqlite(value.into());
            let rows = program.iter().map(|step| step.iter().map(cell).collect()).collect();
            return Ok(QueryResult { columns: reading.columns, rows, ..QueryResult::default() });
        }
        self.load_blocks(&reading)?;
        let read = reading.copied.iter();
        let copies: Vec<String> = read
            .filter_map(|(table, columns)| self.views.as_ref()?.copy_statements(table, columns))
            .collect();
        if copies.is_empty() {
            return self.read_rows(reading, sql, limits);
        }
        let copies = copies.join("; ");
        let copied = self.execute_trusted(&format!(
            "SAVEPOINT copies; PRAGMA query_only = 0; {copies}; PRAGMA query_only = 1"
        ));
        let answer = copied.map_err(QueryFault::Sqlite).and_then(|()| self.read_rows(reading, sql, limits));
        // An interrupted copy has ended the whole transaction.
        let undo = match self.connection.is_autocommit() {
            true => "PRAGMA query_only = 1",
            false => "PRAGMA query_only = 1; ROLLBACK TO copies; RELEASE copies",
        };
        let undone = self.execute_trusted(undo);
        let rows = answer?;
        undone?;
        Ok(rows)
    }

    fn read_rows(
        &self,
        reading: CheckedStatement,
        sql: &str,
        limits: QueryLimits,
    ) -> Result<QueryResult, QueryFault> {
        let CheckedStatement { sql: spelled, columns, is_plan, .. } = reading;
        let mut statement = self.connection.prepare(&spelled)?;
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
            let cells =
                (0..width).map(|at| row.get_ref(at).map(Cell::from_sqlite)).collect::<Result<Vec<_>, _>>()?;
            text += cells.iter().map(Cell::text_bytes).sum::<usize>();
            if text > MAX_RESULT_TEXT_BYTES {
                return Err(QueryFault::TooLarge);
            }
            rows.push(cells);
            next = cursor.next()?;
        }
        let warning = truncated
            .then(|| format!("only the first {} rows are shown; more exist: aggregate in SQL", limits.rows));
        let hint = if rows.is_empty() { empty_result_hint(sql, self.surface) } else { None };
        if is_plan {
            query_plan::mask_plan(&mut rows, sql);
        }
        Ok(QueryResult { columns, rows, truncated, warning, hint })
    }

    pub(super) fn fault_to_error(&self, sql: &str, fault: QueryFault, limits: QueryLimits) -> QueryError {
        let rejection = match self.released.last_rejection() {
            RejectionReason::None => self.last_rejection.get(),
            rejection => rejection,
        };
        match fault {
            QueryFault::Empty => query_error("sql_empty", "no SQL was given"),
            QueryFault::MultipleStatements => {
                query_error("sql_error", "only one statement is allowed; remove the text after the first ;")
            }
            QueryFault::MachineCode => query_error(
                "sql_schema",
                "EXPLAIN returns the engine's bytecode; use EXPLAIN QUERY PLAN to see how a query is executed",
            ),
            QueryFault::Parameters => {
                query_error("sql_error", "parameters are not supported; write the values into the statement")
            }
            QueryFault::Write => write_error(),
            QueryFault::Damaged => query_error(
                "sql_error",
                "world.db is damaged; open the run to play it, which rebuilds world.db",
            ),
            QueryFault::TooLarge => {
                let max = MAX_RESULT_TEXT_BYTES >> 20;
                query_error("sql_error", &format!("the result is larger than {max} MiB; select less data"))
            }
            QueryFault::Sqlite(_) if rejection == RejectionReason::Write || is_write_statement(sql) => {
                write_error()
            }
            QueryFault::Sqlite(_) if rejection == RejectionReason::Schema => {
                query_error("sql_schema", SCHEMA_MESSAGE)
            }
            QueryFault::Sqlite(_) if rejection == RejectionReason::HiddenTable => hidden_table_error(None),
            QueryFault::Sqlite(_) if rejection == RejectionReason::HiddenColumn => query_error(
                "sql_hidden_table",
                "main.TABLE has hidden columns; write the table without main, or name the columns to read",
            ),
            QueryFault::Sqlite(error) => self.sqlite_to_error(sql, &error, limits),
        }
    }

    fn sqlite_to_error(&self, sql: &str, error: &rusqlite::Error, limits: QueryLimits) -> QueryError {
        use rusqlite::ErrorCode::{OperationInterrupted, OutOfMemory};
        if error.sqlite_error_code() == Some(OutOfMemory) {
            // The machine ran out of memory before the query reached its limit.
            return query_error("sql_timeout", TOO_MUCH_MEMORY_MESSAGE);
        }
        if error.sqlite_error_code() == Some(OperationInterrupted) {
            let seconds = limits.time.as_secs();
            let too_long = format!("the query ran longer than {seconds} s; select less data");
            return match self.interrupt.stop_cause() {
                StopCause::Request => query_error(SQL_CANCELLED, CANCELLED_MESSAGE),
                StopCause::Memory => query_error("sql_timeout", TOO_MUCH_MEMORY_MESSAGE),
                StopCause::Time => query_error("sql_timeout", &too_long),
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
            return write_error();
        }
        if let Some(table) = text.strip_prefix("no such table: ") {
            let name = table.rsplit('.').next().unwrap_or(table);
            if is_hidden_table(name) || is_internal_table(name) {
                return hidden_table_error(Some(name));
            }
            if is_engine_table(name) {
                return query_error("sql_schema", SCHEMA_MESSAGE);
            }
        }
        QueryError { code: "sql_error", message: explain_error(&text, sql, self.surface), position }
    }
}

/// Returns whether a statement begins with a keyword of statements that change data. Syntax errors in such statements
/// are reported without help.
fn is_write_statement(sql: &str) -> bool {
    const WRITE_KEYWORDS: [&str; 11] = [
        "INSERT", "REPLACE", "UPDATE", "DELETE", "CREATE", "DROP", "ALTER", "ATTACH", "DETACH", "REINDEX",
        "VACUUM",
    ];
    let tokens = tokenize(strip_explain_query_plan(sql));
    let first = tokens.iter().find(|token| !token.is_symbol(";") && !token.is_word("EXPLAIN"));
    first.is_some_and(|first| WRITE_KEYWORDS.iter().any(|word| first.is_word(word)))
}

/// Internal error of a statement, before its conversion to a [`QueryError`].
#[derive(Debug)]
pub(super) enum QueryFault {
    /// The text contains no statement.
    Empty,
    /// The text contains more than one statement.
    MultipleStatements,
    /// The statement is an EXPLAIN without QUERY PLAN.
    MachineCode,
    /// The statement contains parameters.
    Parameters,
    /// The statement changes data.
    Write,
    /// The packed days of a table are damaged.
    Damaged,
    /// The statement or its result is too large.
    TooLarge,
    /// SQLite returned an error.
    Sqlite(rusqlite::Error),
}

impl From<rusqlite::Error> for QueryFault {
    fn from(error: rusqlite::Error) -> Self {
        QueryFault::Sqlite(error)
    }
}

const TOO_MUCH_MEMORY_MESSAGE: &str = "the query needs too much memory; select less data";

/// Error code of a query that the user cancelled.
pub const SQL_CANCELLED: &str = "sql_cancelled";

const CANCELLED_MESSAGE: &str = "the query was cancelled";

const SCHEMA_MESSAGE: &str =
    "schema statements are not allowed; describe_tables and the table browser show all tables";

fn query_error(code: &'static str, message: &str) -> QueryError {
    QueryError { code, message: message.to_owned(), position: None }
}

fn write_error() -> QueryError {
    query_error("sql_write", "only reading is allowed; use the tools to make changes")
}

fn hidden_table_error(table: Option<&str>) -> QueryError {
    match table {
        Some(table) => query_error("sql_hidden_table", &format!("table {table} is not accessible")),
        None => {
            query_error("sql_hidden_table", "that table is not accessible; the 19 tables of the browser are")
        }
    }
}
