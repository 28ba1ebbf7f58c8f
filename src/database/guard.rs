//! Authorization of SQL statements (docs/formats/database.md#queries). Statements may read visible tables and call
//! ordinary functions. Statements may read internal tables only through a view. The decision depends on the actions of
//! a statement, not on its text.

use std::collections::hash_map::RandomState;
use std::collections::{BTreeMap, BTreeSet};
use std::hash::{BuildHasher, Hasher};
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::sync::{Arc, Mutex};

use rusqlite::Connection;
use rusqlite::hooks::{AuthAction, AuthContext, Authorization};
use rusqlite::limits::Limit;

use super::catalogue::{self, Surface, Table};
use novamind_world::params::Interface;

/// The reason for the authorizer's last rejection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RejectionReason {
    /// The authorizer has not rejected an action.
    None,
    /// The statement accesses the schema.
    Schema,
    /// The statement accesses a table that is not visible.
    HiddenTable,
    /// The statement accesses the hidden columns of a table.
    HiddenColumn,
    /// The statement changes data.
    Write,
}

/// The last rejection reason, shared between the authorizer and the query.
#[derive(Clone, Default)]
pub(super) struct LastRejection(Arc<AtomicU8>);

impl LastRejection {
    pub fn clear(&self) {
        self.0.store(0, Ordering::Relaxed);
    }

    pub fn get(&self) -> RejectionReason {
        match self.0.load(Ordering::Relaxed) {
            0 => RejectionReason::None,
            1 => RejectionReason::Schema,
            2 => RejectionReason::HiddenTable,
            3 => RejectionReason::HiddenColumn,
            _ => RejectionReason::Write,
        }
    }
}

/// Tables that the released simulator hides and that this database does not contain. Queries that name such a table
/// get a separate error code.
const RELEASED_HIDDEN_TABLES: [&str; 25] = [
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

/// Returns whether the released simulator hides the table with this name, ignoring case.
pub(super) fn is_hidden_table(name: &str) -> bool {
    RELEASED_HIDDEN_TABLES.iter().any(|hidden| hidden.eq_ignore_ascii_case(name))
}

/// Internal tables of the database. The flag is true if a visible table has the same rows.
const INTERNAL_TABLES: [(&str, bool); 11] = [
    ("customer_rows", true),
    ("subscription_rows", true),
    ("ledger_blocks", false),
    ("issue_blocks", false),
    ("words", false),
    ("projection", false),
    ("issue_clock", false),
    ("usage_blocks", false),
    ("ads_blocks", false),
    ("notice_blocks", false),
    ("repeated_losses", false),
];

/// Functions with effects outside of the database.
const UNSAFE_FUNCTIONS: [&str; 2] = ["load_extension", "fts3_tokenizer"];

/// Returns whether a function has effects outside of the database.
pub(super) fn is_unsafe_function(name: &str) -> bool {
    UNSAFE_FUNCTIONS.contains(&name)
}

/// Table-valued functions that statements may call under release 1.
const TABLE_FUNCTIONS: [&str; 4] = ["json_each", "json_tree", "jsonb_each", "jsonb_tree"];

/// Returns whether a table belongs to the engine rather than to the run.
pub(super) fn is_engine_table(name: &str) -> bool {
    let name = name.to_lowercase();
    name.starts_with("sqlite_") || name.starts_with("pragma_") || name == "dbstat"
}

/// Returns the visible table whose rows an internal table stores.
pub(super) fn find_visible_table(internal_table: &str) -> Option<&'static str> {
    let table = catalogue::tables(Interface::Release1).iter().find(|table| {
        let stem = internal_table.strip_suffix("_rows").unwrap_or(internal_table);
        table.name.strip_suffix('s').unwrap_or(&table.name) == stem
    });
    table.map(|table| table.name.as_str()).filter(|_| is_internal_table(internal_table))
}

/// Returns whether the table with this name is internal, ignoring case.
pub(super) fn is_internal_table(name: &str) -> bool {
    INTERNAL_TABLES.iter().any(|(table, _)| table.eq_ignore_ascii_case(name))
}

/// Sets limits for statements. A running SQL function cannot be interrupted, so values and patterns must be short.
pub(super) fn set_limits(connection: &Connection) -> rusqlite::Result<()> {
    connection.set_limit(Limit::SQLITE_LIMIT_ATTACHED, 0)?;
    connection.set_limit(Limit::SQLITE_LIMIT_LENGTH, 2 << 20)?;
    connection.set_limit(Limit::SQLITE_LIMIT_LIKE_PATTERN_LENGTH, 1000)?;
    connection.set_limit(Limit::SQLITE_LIMIT_SQL_LENGTH, 1 << 20)?;
    connection.set_limit(Limit::SQLITE_LIMIT_EXPR_DEPTH, 500)?;
    connection.set_limit(Limit::SQLITE_LIMIT_COMPOUND_SELECT, 200)?;
    connection.set_limit(Limit::SQLITE_LIMIT_VDBE_OP, 250_000)?;
    connection.set_limit(Limit::SQLITE_LIMIT_WORKER_THREADS, 0).map(|_| ())
}

/// Columns of visible tables that statements read, by table. The authorizer and its users share this record.
#[derive(Clone, Default)]
pub(super) struct ColumnReads(Arc<Mutex<ColumnsByTable>>);

/// Names of columns by table.
pub(super) type ColumnsByTable = BTreeMap<String, BTreeSet<String>>;

impl ColumnReads {
    /// Returns the recorded columns and clears the record.
    pub fn take(&self) -> ColumnsByTable {
        std::mem::take(&mut self.0.lock().unwrap_or_else(|poisoned| poisoned.into_inner()))
    }

    fn add(&self, table: &str, column: &str) {
        let mut reads = self.0.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        reads.entry(table.to_owned()).or_default().insert(column.to_owned());
    }
}

/// Prefix of a column that stands for the hidden columns of a table in the released schema.
pub(super) const HIDDEN_COLUMN: &str = "hidden_columns_of_";

/// The views behind the visible tables, under unpredictable names.
#[derive(Clone)]
pub(super) struct InnerViews {
    interface: Interface,
    /// Prefix of the view names.
    secret: String,
    names: Vec<String>,
}

impl InnerViews {
    /// Returns statements that replace a view with a temporary table that contains the columns in `read`. Returns
    /// `None` if the visible table is not a view.
    pub fn copy_statements(&self, name: &str, read: &BTreeSet<String>) -> Option<String> {
        let table =
            catalogue::table(self.interface, name).filter(|table| self.names.contains(&table.name))?;
        // The authorizer does not report the columns of a USING clause, which usually joins tables by customer.
        let is_filled = |column: &&str| {
            read.contains(*column) || *column == CUSTOMER_ID || table.key.iter().any(|key| key == column)
        };
        let columns = table.columns.iter().map(|column| column.name.as_str());
        let filled: Vec<&str> = columns.filter(is_filled).collect();
        let (name, secret, columns) = (&table.name, &self.secret, filled.join(", "));
        let declaration = table.create_statement().replacen("TABLE", "TEMP TABLE", 1);
        let index = match filled.contains(&CUSTOMER_ID) && table.row_number_column() != Some(CUSTOMER_ID) {
            true => format!("; CREATE INDEX temp.{name}_of_customers ON {name} ({CUSTOMER_ID})"),
            false => String::new(),
        };
        Some(format!(
            "DROP VIEW temp.{name}; {declaration}; \
             INSERT INTO temp.{name} ({columns}) SELECT {columns} FROM {secret}{name}{index}"
        ))
    }
}

/// The column on which statements join tables.
pub(super) const CUSTOMER_ID: &str = "customer_id";

/// The authorizer that allows or denies the actions of statements.
pub(super) struct Guard {
    last_rejection: LastRejection,
    reads: ColumnReads,
    /// Views behind the visible tables, or `None` if there are no internal tables.
    views: Option<InnerViews>,
    /// Tables that statements may name.
    surface: Surface,
    /// Names of all tables, views and modules, in lower case. Any other name belongs to a common table expression.
    existing: BTreeSet<String>,
}

impl Guard {
    /// Replaces the views of the visible tables with temporary views of the same names. The temporary views read
    /// copies of the original views; the copies have unpredictable names.
    ///
    /// SQLite reports to the authorizer in which view a table is read, but it treats common table expressions like
    /// views. Therefore, internal tables are readable only in views with unpredictable names.
    pub fn with_inner_views(connection: &Connection, surface: Surface) -> rusqlite::Result<Guard> {
        let existing = existing_names(connection)?;
        let secret = format!("inner_{:016x}{:016x}_", random_bits(), random_bits());
        let mut statement =
            connection.prepare("SELECT name, sql FROM main.sqlite_schema WHERE type = 'view'")?;
        let mut views: Vec<(String, String)> =
            statement.query_map([], |row| Ok((row.get(0)?, row.get(1)?)))?.collect::<Result<_, _>>()?;
        for table in catalogue::tables(surface.interface) {
            // The database has the columns of release 1. A table with other columns becomes a view.
            let is_view = views.iter().any(|(name, _)| *name == table.name);
            if !is_view && catalogue::table(Interface::Release1, &table.name) != Some(table) {
                views.push((table.name.clone(), format!("{0} AS SELECT * FROM main.{0}", table.name)));
            }
        }
        for (name, sql) in &views {
            let body = sql.split_once(name).map_or(sql.as_str(), |(_, body)| body);
            let columns =
                catalogue::table(surface.interface, name).map_or_else(Vec::new, Table::column_names);
            let columns = columns.join(", ");
            connection.execute_batch(&format!(
                "CREATE TEMP VIEW {secret}{name}{body}; \
                 CREATE TEMP VIEW {name} AS SELECT {columns} FROM {secret}{name}"
            ))?;
        }
        let names = views.into_iter().map(|(name, _)| name).collect();
        let views = Some(InnerViews { interface: surface.interface, secret, names });
        Ok(Guard {
            last_rejection: LastRejection::default(),
            reads: ColumnReads::default(),
            views,
            surface,
            existing,
        })
    }

    /// Returns a guard for a connection that has no internal tables.
    pub fn for_ordinary_tables(connection: &Connection, surface: Surface) -> rusqlite::Result<Guard> {
        let existing = existing_names(connection)?;
        Ok(Guard {
            last_rejection: LastRejection::default(),
            reads: ColumnReads::default(),
            views: None,
            surface,
            existing,
        })
    }

    /// Returns the shared record of the columns that statements read.
    pub fn column_reads(&self) -> ColumnReads {
        self.reads.clone()
    }

    /// Returns the inner views, or `None` if there are no internal tables.
    pub fn views(&self) -> Option<InnerViews> {
        self.views.clone()
    }

    /// Returns the shared record of the last rejection reason.
    pub fn last_rejection(&self) -> LastRejection {
        self.last_rejection.clone()
    }

    /// Allows or denies one action of a statement.
    pub fn authorize(&self, context: &AuthContext<'_>) -> Authorization {
        match self.rejection_reason(context) {
            None => Authorization::Allow,
            Some(problem) => {
                self.last_rejection.0.store(problem as u8, Ordering::Relaxed);
                Authorization::Deny
            }
        }
    }

    fn rejection_reason(&self, context: &AuthContext<'_>) -> Option<RejectionReason> {
        match context.action {
            AuthAction::Select | AuthAction::Recursive => None,
            AuthAction::Function { function_name } if !UNSAFE_FUNCTIONS.contains(&function_name) => None,
            AuthAction::Read { table_name, column_name } => {
                match self.surface.hidden_table(context.database_name, table_name) {
                    Some(table) => {
                        self.record_read(&table.name, column_name);
                        None
                    }
                    None => self.check_read(table_name, column_name, context.accessor),
                }
            }
            AuthAction::Pragma { .. } => Some(RejectionReason::Schema),
            _ => Some(RejectionReason::Write),
        }
    }

    fn record_read(&self, table: &str, column: &str) {
        if self.views.is_none() {
            self.reads.add(table, column);
        }
    }

    fn check_read(&self, table: &str, column: &str, accessor: Option<&str>) -> Option<RejectionReason> {
        let name = table.to_lowercase();
        let internal_table = INTERNAL_TABLES.iter().find(|(table, _)| *table == name);
        let is_inner_view =
            |name: &str| self.views.as_ref().is_some_and(|views| name.starts_with(&views.secret));
        self.record_read(&name, column);
        let interface = self.surface.interface;
        if interface == Interface::Release2 && column.starts_with(HIDDEN_COLUMN) {
            return Some(RejectionReason::HiddenColumn);
        }
        let visible = catalogue::table(interface, &name).is_some()
            || (interface == Interface::Release1 && TABLE_FUNCTIONS.contains(&name.as_str()))
            || is_inner_view(&name);
        let from_view = accessor.is_some_and(is_inner_view);
        // If no column is read, the statement only counts rows of a common table expression or of a view that the
        // planner has flattened. Any other table that exists and is not listed is rejected.
        let counted = column.is_empty()
            && match internal_table {
                Some((_, behind_view)) => *behind_view,
                None => !self.existing.contains(&name),
            };
        let engine = is_engine_table(&name);
        match (visible || from_view || (counted && !engine), engine) {
            (true, _) => None,
            (false, true) => Some(RejectionReason::Schema),
            (false, false) => Some(RejectionReason::HiddenTable),
        }
    }
}

/// Returns the names of all tables, views and modules of a connection, in lower case.
fn existing_names(connection: &Connection) -> rusqlite::Result<BTreeSet<String>> {
    let names = |sql: &str| -> rusqlite::Result<Vec<String>> {
        connection.prepare(sql)?.query_map([], |row| row.get(0))?.collect()
    };
    let mut existing = names("SELECT name FROM pragma_module_list")?;
    for schema in names("SELECT name FROM pragma_database_list")? {
        existing.extend(names(&format!("SELECT name FROM \"{schema}\".sqlite_schema"))?);
    }
    Ok(existing.into_iter().map(|name| name.to_lowercase()).collect())
}

/// Disables the authorizer while the program executes its own statements. Dropping the guard restores the previous
/// state, even after a panic.
pub(super) struct TrustGuard<'a> {
    trusted: &'a AtomicBool,
    previous: bool,
}

impl TrustGuard<'_> {
    pub fn enter(trusted: &AtomicBool) -> TrustGuard<'_> {
        TrustGuard { trusted, previous: trusted.swap(true, Ordering::Relaxed) }
    }
}

impl Drop for TrustGuard<'_> {
    fn drop(&mut self) {
        self.trusted.store(self.previous, Ordering::Relaxed);
    }
}

/// Returns 64 unpredictable bits. The bits are used only for the names of a connection's views and never affect a run.
fn random_bits() -> u64 {
    RandomState::new().build_hasher().finish()
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};

    use super::super::catalogue::Scope;
    use super::*;

    #[test]
    fn guard_rejects_row_counts_of_unlisted_tables() {
        let mut connection = Connection::open_in_memory().expect("a database");
        connection
            .execute_batch("CREATE TABLE Added_Later (a); CREATE TABLE ledger (amount)")
            .expect("tables");
        let surface = Surface { interface: Interface::Release1, scope: Scope::Visible };
        let guards = [
            Guard::with_inner_views(&connection, surface).expect("a guard"),
            Guard::for_ordinary_tables(&connection, surface).expect("a guard"),
        ];
        for guard in guards {
            let rejections = guard.last_rejection();
            let authorizer = move |context: AuthContext<'_>| guard.authorize(&context);
            connection.authorizer(Some(authorizer)).expect("an authorizer");
            let is_allowed = |sql: &str| connection.prepare(sql).is_ok();
            for refused in [
                "SELECT count(*) FROM added_later",
                "SELECT 1 FROM main.ADDED_LATER",
                "SELECT EXISTS (SELECT 1 FROM added_later)",
                "SELECT count(*) FROM ledger, added_later",
                "SELECT count(*) FROM ledger WHERE 0 < (SELECT count(*) FROM added_later)",
                "WITH x AS (SELECT 1 FROM added_later) SELECT count(*) FROM x",
            ] {
                rejections.clear();
                assert!(!is_allowed(refused), "{refused}");
                assert_eq!(rejections.get(), RejectionReason::HiddenTable, "{refused}");
            }
            for allowed in [
                "SELECT count(*) FROM ledger",
                "WITH x AS (SELECT 1) SELECT count(*) FROM x",
                "WITH x AS MATERIALIZED (SELECT amount FROM ledger) SELECT count(*) FROM x",
                "SELECT count(*) FROM (SELECT amount FROM ledger) AS x",
                "SELECT count(*) FROM json_each('[1]')",
            ] {
                assert!(is_allowed(allowed), "{allowed}");
            }
        }
    }

    #[test]
    fn trust_guard_ends_on_drop_and_panic() {
        let trusted = AtomicBool::new(false);
        let outer = TrustGuard::enter(&trusted);
        let panicked = catch_unwind(AssertUnwindSafe(|| {
            let _inner = TrustGuard::enter(&trusted);
            panic!("the work fails");
        }));
        assert!(panicked.is_err() && trusted.load(Ordering::Relaxed), "the outer work continues");
        drop(outer);
        assert!(!trusted.load(Ordering::Relaxed));
    }
}
