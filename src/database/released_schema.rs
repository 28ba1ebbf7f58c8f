//! The schema of the released simulator: empty tables in memory, without internal tables.
//!
//! Every statement is first compiled against these tables. Error messages and column names are taken from this
//! compilation, so that they never contain internal names. Spellings that only ordinary tables support (`rowid`,
//! `main.ledger`) are replaced if the replacement compiles to the same program.
//!
//! Under release 2, a statement must also compile against tables with hidden columns and views without them, as in the
//! release: `SELECT * FROM customers` and `SELECT * FROM temp.customers` read the view, `SELECT * FROM main.customers`
//! reads the table and is rejected.

use std::borrow::Cow;
use std::collections::BTreeSet;

use rusqlite::fallible_iterator::FallibleIterator;
use rusqlite::hooks::{AuthContext, Authorization};
use rusqlite::types::Value;
use rusqlite::{Batch, Connection, Statement};

use super::catalogue::{Scope, Surface, Table, table, tables};
use super::guard::{
    CUSTOMER_ID, ColumnReads, ColumnsByTable, Guard, HIDDEN_COLUMN, LastRejection, RejectionReason,
    set_limits,
};
use super::hidden_schema;
use super::math_functions::register_math_functions;
use super::query::QueryFault;
use super::tokens::{Token, tokenize};
use novamind_world::params::Interface;

const MAX_SPELLINGS: usize = 200;

const ROWID_NAMES: [&str; 3] = ["rowid", "oid", "_rowid_"];

/// The table `issues`, which has no index although statements search it by customer.
const ISSUES_TABLE: &str = "issues";

/// A connection to empty tables with the schema of the released simulator.
pub(super) struct ReleasedSchema {
    connection: Connection,
    interface: Interface,
    last_rejection: LastRejection,
    reads: ColumnReads,
    /// Connection to tables with hidden columns, only under release 2.
    with_hidden_columns: Option<Box<ReleasedSchema>>,
}

/// A statement that compiles against the released schema.
#[derive(Debug)]
pub(super) struct CheckedStatement {
    /// Text of the statement to run.
    pub sql: String,
    /// Names of the result columns.
    pub columns: Vec<String>,
    /// Whether the statement is an EXPLAIN QUERY PLAN.
    pub is_plan: bool,
    /// Columns, by table, that are copied to an indexed temporary table before the statement runs. A RIGHT or FULL
    /// JOIN needs a copy of every table, because the engine cannot search a view in such a join. A correlated subquery
    /// needs a copy of `issues`, because a stored index of issues would slow down every week.
    pub copied: ColumnsByTable,
    /// Names of the tables that the statement reads.
    pub tables: Vec<String>,
    /// Rows of an EXPLAIN statement: the program for these empty tables. Only release 2 allows EXPLAIN.
    pub program: Option<Program>,
}

/// The compiled program of a statement. Equal programs read the same columns, even if the statements spell names
/// differently.
pub(super) type Program = Vec<Vec<Value>>;

impl ReleasedSchema {
    /// Creates the tables in memory, including the hidden tables if the scope allows them.
    pub fn open(surface: Surface) -> rusqlite::Result<ReleasedSchema> {
        let tables = tables(surface.interface).iter();
        match surface.interface {
            Interface::Release1 => {
                ReleasedSchema::with_tables(surface, tables.map(Table::create_statement).collect())
            }
            Interface::Release2 => {
                let without_rowid = |table: &Table| table.create_statement() + " WITHOUT ROWID";
                let declarations = tables.clone().map(without_rowid).collect();
                let checker = ReleasedSchema::with_tables(surface, tables.map(table_and_view).collect())?;
                let schema = ReleasedSchema::with_tables(surface, declarations)?;
                Ok(ReleasedSchema { with_hidden_columns: Some(Box::new(checker)), ..schema })
            }
        }
    }

    fn with_tables(surface: Surface, declarations: Vec<String>) -> rusqlite::Result<ReleasedSchema> {
        let mut connection = Connection::open_in_memory()?;
        if surface.scope == Scope::Hidden {
            hidden_schema::create_hidden_tables(&connection)?;
        }
        connection.execute_batch(&declarations.join(";\n"))?;
        register_math_functions(&connection)?;
        connection.pragma_update(None, "query_only", true)?;
        set_limits(&connection)?;
        let guard = Guard::for_ordinary_tables(&connection, surface)?;
        let (rejections, reads) = (guard.last_rejection(), guard.column_reads());
        connection.authorizer(Some(move |context: AuthContext<'_>| -> Authorization {
            guard.authorize(&context)
        }))?;
        Ok(ReleasedSchema {
            connection,
            interface: surface.interface,
            last_rejection: rejections,
            reads,
            with_hidden_columns: None,
        })
    }

    /// Returns the reason for the last rejection.
    pub fn last_rejection(&self) -> RejectionReason {
        match (self.last_rejection.get(), &self.with_hidden_columns) {
            (RejectionReason::None, Some(checker)) => checker.last_rejection(),
            (reason, _) => reason,
        }
    }

    /// Clears the reason for the last rejection.
    pub fn clear_rejection(&self) {
        self.last_rejection.clear();
        if let Some(checker) = &self.with_hidden_columns {
            checker.clear_rejection();
        }
    }

    /// Returns the spelling of a text for these tables. Under release 2, `temp.ledger` becomes `main.ledger`, because
    /// the views of the release are tables here. The spelling does not change offsets.
    pub fn spell<'a>(&self, sql: &'a str) -> Cow<'a, str> {
        match self.interface {
            Interface::Release1 => sql.into(),
            Interface::Release2 => temp_as_main(sql).into(),
        }
    }

    /// Returns an iterator that compiles the statements of a text one by one. `spelled` is the result of `spell`.
    pub fn statements<'a>(&'a self, sql: &'a str, spelled: &'a str) -> Statements<'a> {
        let checker = self.with_hidden_columns.as_ref();
        Statements {
            released: self,
            checked: checker.map(|checker| Batch::new(&checker.connection, sql)),
            batch: Batch::new(&self.connection, spelled),
        }
    }

    fn check_statement(&self, statement: &Statement<'_>) -> Result<CheckedStatement, QueryFault> {
        if statement.is_explain() == 1 && self.interface == Interface::Release1 {
            return Err(QueryFault::MachineCode);
        }
        if !statement.readonly() {
            return Err(QueryFault::Write);
        }
        if statement.parameter_count() > 0 {
            return Err(QueryFault::Parameters);
        }
        let sql = statement.expanded_sql().ok_or(QueryFault::TooLarge)?;
        let columns = statement.column_names().map(str::to_owned).collect();
        let mut copied = self.reads.take();
        let tables = copied.keys().cloned().collect();
        if !has_right_join(&sql) {
            let looked_up = |table: &str, columns: &BTreeSet<String>| {
                table == ISSUES_TABLE && columns.contains(CUSTOMER_ID)
            };
            copied.retain(|table, columns| looked_up(table, columns));
            if !copied.is_empty() && !self.has_correlated_subquery(&sql) {
                copied.clear();
            }
        }
        let program = match statement.is_explain() {
            1 => Some(self.explain_statement(&sql).ok_or(QueryFault::MachineCode)?),
            _ => None,
        };
        let is_plan = statement.is_explain() == 2;
        Ok(CheckedStatement { sql: self.rewrite_for_views(sql), columns, is_plan, copied, tables, program })
    }

    /// Returns whether the statement has a correlated subquery.
    fn has_correlated_subquery(&self, sql: &str) -> bool {
        let plan = self
            .explain_statement(&format!("EXPLAIN QUERY PLAN {}", strip_explain_query_plan(sql)))
            .unwrap_or_default();
        // The engine converts some EXISTS subqueries to joins and marks their table in the plan.
        let is_correlated_step = |step: &str| step.starts_with("CORRELATED") || step.contains(" EXISTS");
        plan.iter().flatten().any(|cell| matches!(cell, Value::Text(step) if is_correlated_step(step)))
    }

    /// Replaces `main.` and rowids in a statement if the replacement does not change the program.
    fn rewrite_for_views(&self, sql: String) -> String {
        let tokens = tokenize(&sql);
        let places: Vec<ReplaceableName> =
            (0..tokens.len()).filter_map(|at| ReplaceableName::at_token(&tokens, at)).collect();
        let Some(program) = self.compile_program(&sql).filter(|_| !places.is_empty()) else { return sql };
        let qualifiers = possible_qualifiers(&tokens);
        let mut spelled = sql.clone();
        let mut attempts = 0;
        // Replace from the end, so that earlier offsets stay valid.
        for place in places.iter().rev() {
            for other in place.replacements(&qualifiers) {
                attempts += 1;
                if attempts > MAX_SPELLINGS {
                    return spelled;
                }
                let attempt = format!("{}{other}{}", &spelled[..place.start], &spelled[place.end..]);
                if self.compile_program(&attempt).as_ref() == Some(&program) {
                    spelled = attempt;
                    break;
                }
            }
        }
        spelled
    }

    /// Compiles a statement and returns its program. Returns `None` if the statement does not compile.
    fn compile_program(&self, sql: &str) -> Option<Program> {
        self.explain_statement(&format!("EXPLAIN {}", strip_explain_query_plan(sql)))
    }

    fn explain_statement(&self, explanation: &str) -> Option<Program> {
        let mut statement = self.connection.prepare(explanation).ok()?;
        let width = statement.column_count();
        let steps = statement
            .query_map([], |row| (0..width).map(|at| row.get(at)).collect::<rusqlite::Result<Vec<Value>>>());
        steps.ok()?.collect::<rusqlite::Result<_>>().ok()
    }
}

/// Iterator over the statements of a text.
pub(super) struct Statements<'a> {
    released: &'a ReleasedSchema,
    checked: Option<Batch<'a, 'a>>,
    batch: Batch<'a, 'a>,
}

impl Statements<'_> {
    /// Returns the next statement, or `None` after the last one.
    pub fn next(&mut self) -> Result<Option<CheckedStatement>, QueryFault> {
        if let Some(checked) = &mut self.checked {
            checked.next()?;
        }
        self.released.reads.take();
        match self.batch.next()? {
            Some(statement) => self.released.check_statement(&statement).map(Some),
            None => Ok(None),
        }
    }
}

/// Returns the declarations of a release 2 table and of its view. A column of the table represents the hidden columns,
/// if the table has any. The view does not have this column.
fn table_and_view(table: &Table) -> String {
    let (name, columns) = (&table.name, table.column_names().join(", "));
    let declaration = match table.has_hidden_columns {
        true => table.create_statement().replacen('(', &format!("({HIDDEN_COLUMN}{name}, "), 1),
        false => table.create_statement(),
    };
    format!("{declaration} WITHOUT ROWID; CREATE TEMP VIEW {name} AS SELECT {columns} FROM main.{name}")
}

/// Replaces the schema `temp` of visible tables with `main`.
fn temp_as_main(sql: &str) -> String {
    let mut spelled = sql.to_owned();
    for names in tokenize(sql).windows(3) {
        let [schema, dot, name] = names else { continue };
        let is_table = name.can_be_name() && table(Interface::Release2, &name.unquoted()).is_some();
        let temp = schema.text.to_ascii_lowercase().find("temp");
        if let Some(at) = temp.filter(|_| {
            schema.can_be_name()
                && schema.unquoted().eq_ignore_ascii_case("temp")
                && dot.is_symbol(".")
                && is_table
        }) {
            let start = schema.offset + at;
            spelled.replace_range(start..start + "temp".len(), "main");
        }
    }
    spelled
}

/// A name in a statement that only ordinary tables support.
struct ReplaceableName {
    start: usize,
    end: usize,
    kind: ReplaceableKind,
}

#[derive(PartialEq)]
enum ReplaceableKind {
    Main,
    RowNumber { qualified: bool },
}

impl ReplaceableName {
    fn at_token(tokens: &[Token<'_>], at: usize) -> Option<ReplaceableName> {
        let token = &tokens[at];
        let dot =
            |at: Option<usize>| at.and_then(|at| tokens.get(at)).is_some_and(|token| token.is_symbol("."));
        if !token.can_be_name() {
            return None;
        }
        let (name, place) = (token.unquoted(), token.range());
        if name.eq_ignore_ascii_case("main") && dot(Some(at + 1)) {
            let end = tokens.get(at + 2)?.offset;
            return Some(ReplaceableName { start: place.start, end, kind: ReplaceableKind::Main });
        }
        let is_number = ROWID_NAMES.iter().any(|number| name.eq_ignore_ascii_case(number));
        let qualified = dot(at.checked_sub(1));
        is_number.then_some(ReplaceableName {
            start: place.start,
            end: place.end,
            kind: ReplaceableKind::RowNumber { qualified },
        })
    }

    /// Returns possible replacements of the name, most likely first.
    fn replacements(&self, qualifiers: &[&str]) -> Vec<String> {
        let keys = || tables(Interface::Release1).iter().filter_map(Table::row_number_column);
        match self.kind {
            ReplaceableKind::Main => vec![String::new()],
            ReplaceableKind::RowNumber { qualified: true } => keys().map(str::to_owned).collect(),
            ReplaceableKind::RowNumber { qualified: false } => {
                let with =
                    qualifiers.iter().flat_map(|table| keys().map(move |key| format!("{table}.{key}")));
                keys().map(str::to_owned).chain(with).collect()
            }
        }
    }
}

/// Returns possible qualifiers of columns: table names and the words after table names, which may be aliases.
fn possible_qualifiers<'a>(tokens: &[Token<'a>]) -> Vec<&'a str> {
    let mut found: Vec<&str> = Vec::new();
    for (at, token) in tokens.iter().enumerate() {
        if !token.can_be_name() || table(Interface::Release1, &token.unquoted()).is_none() {
            continue;
        }
        let after: Vec<&Token<'a>> =
            tokens[at + 1..].iter().filter(|next| !next.is_word("AS")).take(1).collect();
        let names = after.into_iter().chain([token]).filter(|name| name.can_be_name());
        found.extend(names.map(|name| name.text));
    }
    found.dedup();
    found
}

/// Returns whether a statement has a RIGHT or FULL JOIN.
fn has_right_join(sql: &str) -> bool {
    let tokens = tokenize(sql);
    tokens.windows(2).any(|pair| {
        (pair[0].is_word("RIGHT") || pair[0].is_word("FULL"))
            && (pair[1].is_word("JOIN") || pair[1].is_word("OUTER"))
    })
}

/// Returns a statement without a leading `EXPLAIN QUERY PLAN`.
pub(super) fn strip_explain_query_plan(sql: &str) -> &str {
    let tokens = tokenize(sql);
    let head = ["EXPLAIN", "QUERY", "PLAN"];
    let explains =
        tokens.len() > head.len() && tokens.iter().zip(head).all(|(token, word)| token.is_word(word));
    if explains { &sql[tokens[head.len()].offset..] } else { sql }
}
