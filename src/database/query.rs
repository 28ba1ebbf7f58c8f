//! Guarded queries: one read-only statement over the 19 visible tables (docs/formats/database.md#queries).
//!
//! A statement is first compiled against the released schema (`released.rs`), which has no hidden names. The query connection
//! is read-only. An authorizer (`guard.rs`) allows the visible tables and ordinary functions. Limits restrict the size of
//! statements, values and results, and a progress handler interrupts queries that take too much time or memory. Rejections
//! depend on what a statement does, not on its text.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rusqlite::hooks::{AuthContext, Authorization};
use rusqlite::{Connection, ffi};

use super::answer::{Cell, Rows};
use super::block_table;
use super::blocks::{BlockStore, Seen};
use super::catalogue::Scope;
use super::guard::{
    Guard, InnerViews, Objection, Objections, Trust, is_hidden_table, is_inside, is_of_engine, limit,
};
use super::help::{explain_error, hints};
use super::hidden;
use super::interrupt::{Cause, Interrupt, STEPS_BETWEEN_LOOKS, Ticket};
use super::loading::BlockSource;
use super::location::Location;
use super::mathematics::register_mathematics;
use super::packed_tables;
use super::plan;
use super::released::{Reading, Released, without_explain};
use super::tokens::tokens;

/// An error of a query.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct QueryError {
    /// Code for programs: `sql_empty`, `sql_schema`, `sql_hidden_table`, `sql_write`, `sql_timeout`, [`SQL_CANCELLED`],
    /// `sql_error`.
    pub code: &'static str,
    /// Message with help.
    pub message: String,
    /// Byte offset in the statement, if it is known.
    pub position: Option<usize>,
}
/// An error of a script.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScriptError {
    /// Number of the statement, from 1.
    pub statement: usize,
    /// Error of the statement.
    pub error: QueryError,
}

/// Limits of a query.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Maximum rows.
    pub rows: usize,
    /// Maximum time.
    pub time: Duration,
    /// Maximum steps of SQLite's virtual machine; `None` for no limit.
    pub steps: Option<u64>,
}

const MOST_TEXT: usize = 64 << 20;

/// A connection for guarded queries.
pub struct QueryConnection {
    pub(super) released: Released,
    connection: Connection,
    /// Tables that statements may name.
    scope: Scope,
    objections: Objections,
    views: Option<InnerViews>,
    /// Whether the authorizer is disabled for the program itself.
    trusted: Arc<AtomicBool>,
    pub(super) interrupt: Interrupt,
    source: BlockSource,
    /// Blocks of the running query.
    seen: Arc<Seen>,
}

impl QueryConnection {
    /// Opens a guarded connection.
    pub(super) fn open(
        location: &Location,
        source: BlockSource,
        scope: Scope,
    ) -> rusqlite::Result<QueryConnection> {
        let released = Released::open(scope)?;
        let mut connection = location.open_reader()?;
        let seen = Arc::new(Seen::default());
        block_table::register(&connection, &seen)?;
        packed_tables::register(&connection, &seen)?;
        register_mathematics(&connection)?;
        connection.pragma_update(None, "temp_store", "MEMORY")?;
        if scope == Scope::Hidden {
            hidden::attach(&connection)?;
        }
        let guard = Guard::set_up(&connection, scope)?;
        connection.pragma_update(None, "query_only", true)?;
        limit(&connection)?;
        // Virtual tables connect at their first use, which the authorizer would reject.
        for table in ["daily_usage", "ads_revenue", "issues", "ledger", "notifications"] {
            connection.prepare(&format!("SELECT 1 FROM {table}"))?;
        }
        let (objections, views) = (guard.objections(), guard.views());
        let trusted = Arc::new(AtomicBool::new(false));
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
        Ok(QueryConnection {
            released,
            connection,
            scope,
            objections,
            views,
            trusted,
            interrupt,
            source,
            seen,
        })
    }

    /// Returns a handle that stops the queries of this connection.
    pub fn interrupt(&self) -> Interrupt {
        self.interrupt.clone()
    }

    /// Runs one statement.
    ///
    /// # Errors
    /// The `sql_` codes.
    pub fn ask(&self, sql: &str, limits: Limits) -> Result<Rows, QueryError> {
        self.ask_as(self.interrupt.ticket(), sql, limits)
    }

    /// Runs one statement with the ticket of its request.
    ///
    /// # Errors
    /// The `sql_` codes.
    pub fn ask_as(&self, ticket: Ticket, sql: &str, limits: Limits) -> Result<Rows, QueryError> {
        if sql.trim().is_empty() {
            return Err(refusal("sql_empty", "no SQL was given"));
        }
        if sql.contains('\0') {
            // SQLite would ignore the rest of the statement.
            return Err(refusal("sql_error", "the statement contains a NUL character"));
        }
        self.look(ticket, sql, limits)?;
        let answer = self.run(sql, limits).map_err(|fault| self.told(sql, fault, limits));
        let closed = self.look_away();
        // Report the error of the statement rather than a following one.
        answer.and_then(|rows| closed.map(|()| rows))
    }

    /// Runs statements in order on the same state, each with the limits of `limits`, and all together within `time`. Calls
    /// `answered` with each result.
    ///
    /// # Errors
    /// The first statement that fails; the results of earlier ones were passed.
    pub fn run_script(
        &self,
        sql: &str,
        limits: Limits,
        time: Duration,
        mut answered: impl FnMut(Rows),
    ) -> Result<(), ScriptError> {
        let end = Instant::now() + time;
        let at = |statement: usize| move |error: QueryError| ScriptError { statement, error };
        self.look(self.interrupt.ticket(), sql, limits).map_err(at(1))?;
        let mut statements = self.released.statements(sql);
        let mut done = Ok(());
        for number in 1.. {
            let own =
                Limits { time: limits.time.min(end.saturating_duration_since(Instant::now())), ..limits };
            self.interrupt.go_on(own.time, own.steps);
            let answer = match statements.next() {
                Ok(None) => break,
                Ok(Some(reading)) => self.fetch(reading, sql, own),
                Err(fault) => Err(fault),
            };
            match answer {
                Ok(rows) => answered(rows),
                Err(fault) => {
                    done = Err(at(number)(self.told(sql, fault, own)));
                    break;
                }
            }
        }
        let closed = self.look_away().map_err(at(1));
        done.and(closed)
    }

    /// Starts a read transaction with rows and blocks of the same commit.
    fn look(&self, ticket: Ticket, sql: &str, limits: Limits) -> Result<(), QueryError> {
        self.objections.clear();
        self.released.objections().clear();
        self.interrupt.begin(ticket, limits.time, limits.steps);
        if self.interrupt.is_stopped() {
            return Err(refusal(SQL_CANCELLED, CANCELLED));
        }
        let begin = || {
            self.as_desk("BEGIN; SELECT seq FROM projection")
                .map_err(|error| self.told(sql, Fault::Sqlite(error), limits))
        };
        match &self.source {
            BlockSource::Writer(store, gate) => {
                let _open = gate.read().unwrap_or_else(|poisoned| poisoned.into_inner());
                begin()?;
                self.seen.see(store.read().unwrap_or_else(|poisoned| poisoned.into_inner()).clone());
            }
            BlockSource::File(blocks) => {
                begin()?;
                self.trusting(|connection| blocks.borrow_mut().refresh(connection));
            }
        }
        Ok(())
    }

    /// Returns whether damaged blocks were found, so that results are not reliable.
    pub fn found_damage(&self) -> bool {
        matches!(&self.source, BlockSource::File(blocks) if blocks.borrow().is_damaged())
    }

    fn load_for(&self, reading: &Reading) -> Result<(), Fault> {
        let BlockSource::File(blocks) = &self.source else { return Ok(()) };
        let mut blocks = blocks.borrow_mut();
        let loaded = self.trusting(|connection| blocks.load(connection, &reading.tables));
        self.seen.see(blocks.store().clone());
        match loaded {
            true => Ok(()),
            false if self.interrupt.must_end() => {
                let stopped = ffi::Error::new(ffi::SQLITE_INTERRUPT);
                Err(Fault::Sqlite(rusqlite::Error::SqliteFailure(stopped, None)))
            }
            false => {
                blocks.set_damaged();
                Err(Fault::Damaged)
            }
        }
    }

    pub(super) fn trusting<T>(&self, work: impl FnOnce(&Connection) -> T) -> T {
        let _trust = Trust::begin(&self.trusted);
        work(&self.connection)
    }

    fn look_away(&self) -> Result<(), QueryError> {
        self.seen.see(BlockStore::default());
        // If memory ran out, SQLite has already ended the transaction.
        if self.connection.is_autocommit() {
            return Ok(());
        }
        self.as_desk("ROLLBACK").map_err(|error| refusal("sql_error", &error.to_string()))
    }

    fn as_desk(&self, sql: &str) -> rusqlite::Result<()> {
        self.trusting(|connection| connection.execute_batch(sql))
    }

    fn run(&self, sql: &str, limits: Limits) -> Result<Rows, Fault> {
        let mut statements = self.released.statements(sql);
        let reading = statements.next()?.ok_or(Fault::Empty)?;
        match statements.next() {
            Ok(None) => self.fetch(reading, sql, limits),
            _ => Err(Fault::Several),
        }
    }

    fn fetch(&self, reading: Reading, sql: &str, limits: Limits) -> Result<Rows, Fault> {
        self.load_for(&reading)?;
        let read = reading.copied.iter();
        let copies: Vec<String> =
            read.filter_map(|(table, columns)| self.views.as_ref()?.copy(table, columns)).collect();
        if copies.is_empty() {
            return self.answer(reading, sql, limits);
        }
        let copies = copies.join("; ");
        let copied = self
            .as_desk(&format!("SAVEPOINT copies; PRAGMA query_only = 0; {copies}; PRAGMA query_only = 1"));
        let answer = copied.map_err(Fault::Sqlite).and_then(|()| self.answer(reading, sql, limits));
        // An interrupted copy has ended the whole transaction.
        let undo = match self.connection.is_autocommit() {
            true => "PRAGMA query_only = 1",
            false => "PRAGMA query_only = 1; ROLLBACK TO copies; RELEASE copies",
        };
        let undone = self.as_desk(undo);
        let rows = answer?;
        undone?;
        Ok(rows)
    }

    fn answer(&self, reading: Reading, sql: &str, limits: Limits) -> Result<Rows, Fault> {
        let Reading { sql: spelled, columns, is_plan, .. } = reading;
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
            let cells = (0..width).map(|at| row.get_ref(at).map(Cell::of)).collect::<Result<Vec<_>, _>>()?;
            text += cells.iter().map(Cell::text_length).sum::<usize>();
            if text > MOST_TEXT {
                return Err(Fault::TooLarge);
            }
            rows.push(cells);
            next = cursor.next()?;
        }
        let warning = truncated
            .then(|| format!("only the first {} rows are shown; more exist: aggregate in SQL", limits.rows));
        let hint = if rows.is_empty() { hints(sql, self.scope) } else { None };
        if is_plan {
            plan::mask(&mut rows, sql);
        }
        Ok(Rows { columns, rows, truncated, warning, hint })
    }

    pub(super) fn told(&self, sql: &str, fault: Fault, limits: Limits) -> QueryError {
        let objection = match self.released.objections().last() {
            Objection::None => self.objections.last(),
            objection => objection,
        };
        match fault {
            Fault::Empty => refusal("sql_empty", "no SQL was given"),
            Fault::Several => {
                refusal("sql_error", "one statement at a time; remove what follows the first ;")
            }
            Fault::MachineCode => refusal(
                "sql_schema",
                "EXPLAIN alone shows the engine's machine code; EXPLAIN QUERY PLAN shows how a query is \
                 answered",
            ),
            Fault::Parameters => {
                refusal("sql_error", "statements take no parameters here; write the values in their place")
            }
            Fault::Write => write_refusal(),
            Fault::Damaged => {
                refusal("sql_error", "world.db is damaged; open the run to play it, which rebuilds world.db")
            }
            Fault::TooLarge => {
                let most = MOST_TEXT >> 20;
                refusal("sql_error", &format!("the result is larger than {most} MiB; ask for less at a time"))
            }
            Fault::Sqlite(_) if objection == Objection::Write || is_change(sql) => write_refusal(),
            Fault::Sqlite(_) if objection == Objection::Schema => refusal("sql_schema", SCHEMA_WORDS),
            Fault::Sqlite(_) if objection == Objection::Hidden => hidden_refusal(None),
            Fault::Sqlite(error) => self.told_by_sqlite(sql, &error, limits),
        }
    }

    fn told_by_sqlite(&self, sql: &str, error: &rusqlite::Error, limits: Limits) -> QueryError {
        use rusqlite::ErrorCode::{OperationInterrupted, OutOfMemory};
        if error.sqlite_error_code() == Some(OutOfMemory) {
            // The machine has less memory than the limit.
            return refusal("sql_timeout", TOO_MUCH_MEMORY);
        }
        if error.sqlite_error_code() == Some(OperationInterrupted) {
            let seconds = limits.time.as_secs();
            let too_long = format!("the query ran longer than {seconds} s; ask for less at a time");
            return match self.interrupt.cause() {
                Cause::Request => refusal(SQL_CANCELLED, CANCELLED),
                Cause::Memory => refusal("sql_timeout", TOO_MUCH_MEMORY),
                Cause::Time => refusal("sql_timeout", &too_long),
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
            if is_hidden_table(name) || is_inside(name) {
                return hidden_refusal(Some(name));
            }
            if is_of_engine(name) {
                return refusal("sql_schema", SCHEMA_WORDS);
            }
        }
        QueryError { code: "sql_error", message: explain_error(&text, sql, self.scope), position }
    }
}

/// Returns whether a statement starts like one that changes data. Help on its syntax would be useless.
fn is_change(sql: &str) -> bool {
    const WORDS: [&str; 11] = [
        "INSERT", "REPLACE", "UPDATE", "DELETE", "CREATE", "DROP", "ALTER", "ATTACH", "DETACH", "REINDEX",
        "VACUUM",
    ];
    let own = tokens(without_explain(sql));
    let first = own.iter().find(|token| !token.is_sign(";") && !token.is("EXPLAIN"));
    first.is_some_and(|first| WORDS.iter().any(|word| first.is(word)))
}

/// Internal error of a statement.
#[derive(Debug)]
pub(super) enum Fault {
    /// No statement.
    Empty,
    /// More than one statement.
    Several,
    /// EXPLAIN without QUERY PLAN.
    MachineCode,
    /// Parameters.
    Parameters,
    /// A change of data.
    Write,
    /// Damaged blocks.
    Damaged,
    /// A statement or a result that is too large.
    TooLarge,
    /// An error of the engine.
    Sqlite(rusqlite::Error),
}

impl From<rusqlite::Error> for Fault {
    fn from(error: rusqlite::Error) -> Self {
        Fault::Sqlite(error)
    }
}

const TOO_MUCH_MEMORY: &str = "the query needs too much memory; ask for less at a time";

/// Error code of a query that the user cancelled.
pub const SQL_CANCELLED: &str = "sql_cancelled";

const CANCELLED: &str = "the query was cancelled";

const SCHEMA_WORDS: &str =
    "schema statements are not allowed; describe_tables and the table browser show all tables";

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
