//! The empty tables of the released simulator, without internal tables.
//!
//! Every statement is compiled against them first. Error messages and column names come from this compilation, so they never
//! mention internal names. Spellings that only ordinary tables support (`rowid`, `main.ledger`) are replaced if both spellings
//! compile to the same program.

use std::collections::BTreeSet;

use rusqlite::fallible_iterator::FallibleIterator;
use rusqlite::hooks::{AuthContext, Authorization};
use rusqlite::types::Value;
use rusqlite::{Batch, Connection, Statement};

use super::catalogue::{Scope, Table, table, tables};
use super::guard::{CUSTOMER, Columns, Guard, Objections, Reads, limit};
use super::hidden;
use super::mathematics::register_mathematics;
use super::query::Fault;
use super::tokens::{Token, tokens};

const MOST_ATTEMPTS: usize = 200;

const ROW_NUMBERS: [&str; 3] = ["rowid", "oid", "_rowid_"];

/// The table with lookups by customer but without an index.
const ISSUES: &str = "issues";

/// The released schema.
pub(super) struct Released {
    connection: Connection,
    objections: Objections,
    reads: Reads,
}

/// A statement that compiles against the released schema.
#[derive(Debug)]
pub(super) struct Reading {
    /// Text to run.
    pub sql: String,
    /// Names of the result columns.
    pub columns: Vec<String>,
    /// Whether it is an EXPLAIN QUERY PLAN.
    pub is_plan: bool,
    /// Columns of tables that are copied for it, with an index by customer. All tables for a RIGHT or FULL JOIN, because the
    /// engine cannot search a view there. `issues` for a correlated subquery, because a stored index of issues would slow down
    /// every week.
    pub copied: Columns,
    /// Tables that it names.
    pub tables: Vec<String>,
}

/// The compiled program of a statement. It depends on the resolved columns, but not on their names.
type Program = Vec<Vec<Value>>;

impl Released {
    /// Creates the tables in memory, with the hidden ones if statements may name them.
    pub fn open(scope: Scope) -> rusqlite::Result<Released> {
        let mut connection = Connection::open_in_memory()?;
        if scope == Scope::Hidden {
            hidden::attach(&connection)?;
        }
        let declarations: Vec<String> = tables().iter().map(Table::declaration).collect();
        connection.execute_batch(&declarations.join(";\n"))?;
        register_mathematics(&connection)?;
        connection.pragma_update(None, "query_only", true)?;
        limit(&connection)?;
        let guard = Guard::of_ordinary_tables(&connection, scope)?;
        let (objections, reads) = (guard.objections(), guard.reads());
        connection.authorizer(Some(move |context: AuthContext<'_>| -> Authorization {
            guard.authorize(&context)
        }))?;
        Ok(Released { connection, objections, reads })
    }

    /// Returns the rejection reasons.
    pub fn objections(&self) -> &Objections {
        &self.objections
    }

    /// Returns the statements of a text, compiled one by one.
    pub fn statements<'a>(&'a self, sql: &'a str) -> Statements<'a> {
        Statements { released: self, batch: Batch::new(&self.connection, sql) }
    }

    fn read(&self, statement: &Statement<'_>) -> Result<Reading, Fault> {
        if statement.is_explain() == 1 {
            return Err(Fault::MachineCode);
        }
        if !statement.readonly() {
            return Err(Fault::Write);
        }
        if statement.parameter_count() > 0 {
            return Err(Fault::Parameters);
        }
        let sql = statement.expanded_sql().ok_or(Fault::TooLarge)?;
        let columns = statement.column_names().map(str::to_owned).collect();
        let mut copied = self.reads.take();
        let tables = copied.keys().cloned().collect();
        if !joins_from_the_right(&sql) {
            let looked_up =
                |table: &str, columns: &BTreeSet<String>| table == ISSUES && columns.contains(CUSTOMER);
            copied.retain(|table, columns| looked_up(table, columns));
            if !copied.is_empty() && !self.asks_for_every_row(&sql) {
                copied.clear();
            }
        }
        let is_plan = statement.is_explain() == 2;
        Ok(Reading { sql: self.respelled(sql), columns, is_plan, copied, tables })
    }

    /// Returns whether the statement has a correlated subquery.
    fn asks_for_every_row(&self, sql: &str) -> bool {
        let plan = self.steps(&format!("EXPLAIN QUERY PLAN {}", without_explain(sql))).unwrap_or_default();
        // The engine converts some EXISTS to joins and marks the table.
        let again = |step: &str| step.starts_with("CORRELATED") || step.contains(" EXISTS");
        plan.iter().flatten().any(|cell| matches!(cell, Value::Text(step) if again(step)))
    }

    /// Replaces `main.` and rowids in a statement, where that does not change the program.
    fn respelled(&self, sql: String) -> String {
        let own = tokens(&sql);
        let places: Vec<StatementPlace> =
            (0..own.len()).filter_map(|at| StatementPlace::of(&own, at)).collect();
        let Some(program) = self.program(&sql).filter(|_| !places.is_empty()) else { return sql };
        let qualifiers = qualifiers(&own);
        let mut spelled = sql.clone();
        let mut attempts = 0;
        // From the end, so that earlier offsets stay valid.
        for place in places.iter().rev() {
            for other in place.spellings(&qualifiers) {
                attempts += 1;
                if attempts > MOST_ATTEMPTS {
                    return spelled;
                }
                let attempt = format!("{}{other}{}", &spelled[..place.begin], &spelled[place.end..]);
                if self.program(&attempt).as_ref() == Some(&program) {
                    spelled = attempt;
                    break;
                }
            }
        }
        spelled
    }

    /// Compiles a statement. Returns `None` if it does not compile.
    fn program(&self, sql: &str) -> Option<Program> {
        self.steps(&format!("EXPLAIN {}", without_explain(sql)))
    }

    fn steps(&self, explanation: &str) -> Option<Program> {
        let mut statement = self.connection.prepare(explanation).ok()?;
        let width = statement.column_count();
        let steps = statement
            .query_map([], |row| (0..width).map(|at| row.get(at)).collect::<rusqlite::Result<Vec<Value>>>());
        steps.ok()?.collect::<rusqlite::Result<_>>().ok()
    }
}

/// Iterator over the statements of a text.
pub(super) struct Statements<'a> {
    released: &'a Released,
    batch: Batch<'a, 'a>,
}

impl Statements<'_> {
    /// Returns the next statement, or `None` after the last one.
    pub fn next(&mut self) -> Result<Option<Reading>, Fault> {
        self.released.reads.take();
        match self.batch.next()? {
            Some(statement) => self.released.read(&statement).map(Some),
            None => Ok(None),
        }
    }
}

/// A place in a statement that only ordinary tables support.
struct StatementPlace {
    begin: usize,
    end: usize,
    kind: PlaceKind,
}

#[derive(PartialEq)]
enum PlaceKind {
    Main,
    RowNumber { qualified: bool },
}

impl StatementPlace {
    fn of(tokens: &[Token<'_>], at: usize) -> Option<StatementPlace> {
        let token = &tokens[at];
        let dot =
            |at: Option<usize>| at.and_then(|at| tokens.get(at)).is_some_and(|token| token.is_sign("."));
        if !token.may_name() {
            return None;
        }
        let (name, place) = (token.content(), token.place());
        if name.eq_ignore_ascii_case("main") && dot(Some(at + 1)) {
            let end = tokens.get(at + 2)?.at;
            return Some(StatementPlace { begin: place.start, end, kind: PlaceKind::Main });
        }
        let is_number = ROW_NUMBERS.iter().any(|number| name.eq_ignore_ascii_case(number));
        let qualified = dot(at.checked_sub(1));
        is_number.then_some(StatementPlace {
            begin: place.start,
            end: place.end,
            kind: PlaceKind::RowNumber { qualified },
        })
    }

    /// Returns possible replacements, most likely first.
    fn spellings(&self, qualifiers: &[&str]) -> Vec<String> {
        let keys = || tables().iter().filter_map(Table::row_number);
        match self.kind {
            PlaceKind::Main => vec![String::new()],
            PlaceKind::RowNumber { qualified: true } => keys().map(str::to_owned).collect(),
            PlaceKind::RowNumber { qualified: false } => {
                let with =
                    qualifiers.iter().flat_map(|table| keys().map(move |key| format!("{table}.{key}")));
                keys().map(str::to_owned).chain(with).collect()
            }
        }
    }
}

/// Returns possible qualifiers of columns: table names and the words after them.
fn qualifiers<'a>(tokens: &[Token<'a>]) -> Vec<&'a str> {
    let mut found: Vec<&str> = Vec::new();
    for (at, token) in tokens.iter().enumerate() {
        if !token.may_name() || table(&token.content()).is_none() {
            continue;
        }
        let after: Vec<&Token<'a>> = tokens[at + 1..].iter().filter(|next| !next.is("AS")).take(1).collect();
        let names = after.into_iter().chain([token]).filter(|name| name.may_name());
        found.extend(names.map(|name| name.written));
    }
    found.dedup();
    found
}

/// Returns whether a statement has a RIGHT or FULL JOIN.
fn joins_from_the_right(sql: &str) -> bool {
    let own = tokens(sql);
    own.windows(2).any(|pair| {
        (pair[0].is("RIGHT") || pair[0].is("FULL")) && (pair[1].is("JOIN") || pair[1].is("OUTER"))
    })
}

/// Returns a statement without a leading `EXPLAIN QUERY PLAN`.
pub(super) fn without_explain(sql: &str) -> &str {
    let own = tokens(sql);
    let head = ["EXPLAIN", "QUERY", "PLAN"];
    let explains = own.len() > head.len() && own.iter().zip(head).all(|(token, word)| token.is(word));
    if explains { &sql[own[head.len()].at..] } else { sql }
}
