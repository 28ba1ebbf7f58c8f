//! The tables `daily_usage`, `ads_revenue` and `issues`: read-only virtual tables over the block store. The virtual
//! tables skip days and customers that a query does not need.
//!
//! Virtual tables implement two unsafe traits of rusqlite. The implementing structs must start with a base struct of
//! SQLite.
#![expect(unsafe_code, reason = "rusqlite's traits of virtual tables are unsafe; see the safety comments")]

use std::borrow::Cow;
use std::ffi::{CStr, c_int};
use std::marker::PhantomData;
use std::ops::Range;
use std::sync::Arc;

use rusqlite::Connection;
use rusqlite::ffi;
use rusqlite::types::Type;
use rusqlite::vtab::{
    Context, Filters, IndexConstraintOp, IndexInfo, Module, OrderBy, VTab, VTabConfig, VTabConnection,
    VTabCursor,
};

use super::blocks::{AdsRow, AdsRun, BlockStore, QueryView};
use super::customer_index::{CustomerIndex, CustomerIndexes};
use super::day_table::comparison_number;
use super::issues::{self, IssueRow, IssueRun};
use super::packing::{PackedDay, RowRun};
use novamind_world::events::UsageRows;
use novamind_world::identifiers::Group;

pub(super) fn register(connection: &Connection, query_view: &Arc<QueryView>) -> rusqlite::Result<()> {
    const USAGE: Module<'static, BlockTable<Usage>> = Module::eponymous_only_module();
    const ADS: Module<'static, BlockTable<Ads>> = Module::eponymous_only_module();
    connection.create_module(c"daily_usage", &USAGE, Some(query_view.clone()))?;
    const ISSUES: Module<'static, BlockTable<Issues>> = Module::eponymous_only_module();
    connection.create_module(c"ads_revenue", &ADS, Some(query_view.clone()))?;
    connection.create_module(c"issues", &ISSUES, Some(query_view.clone()))
}

/// The table-specific properties of a block table. Column 1 is always customer_id.
trait BlockTableDefinition: Send + Sync + Sized + 'static {
    type Run: RowRun;
    const DECLARATION: &'static CStr;
    /// Index of the day column.
    const DAY_COLUMN: c_int = 0;
    /// Index of the row number column, if the table has a row number.
    const ROW_NUMBER_COLUMN: Option<c_int> = None;

    fn days(store: &BlockStore) -> &[Arc<PackedDay>];
    fn indexes(query_view: &QueryView) -> &CustomerIndexes<Self::Run>;
    /// Sets the result to the value of a column other than the day, the customer and the row number.
    fn column(
        at: (&BlockStore, u32),
        row: RowData<Self>,
        column: c_int,
        context: &mut Context,
    ) -> rusqlite::Result<()>;
    /// Returns the index of the day that may contain the row with this row number.
    fn day_index_of_row(_store: &BlockStore, _number: f64) -> Option<usize> {
        None
    }
    /// Returns the row number that is stored in a row, if the table has a row number.
    fn row_number(_row: RowData<Self>) -> Option<i64> {
        None
    }
}

/// The columns of a row except day and customer.
type RowData<K> = <<K as BlockTableDefinition>::Run as RowRun>::Row;

/// The position of a row: index of the day in the store, of the run within the day, and of the row within the run.
#[derive(Clone, Copy, Default)]
struct RowPosition {
    day: usize,
    run: usize,
    at: usize,
}

struct Usage;

impl BlockTableDefinition for Usage {
    type Run = UsageRows;
    const DECLARATION: &'static CStr =
        c"CREATE TABLE x(day INTEGER, customer_id INTEGER, usage_units INTEGER)";

    fn days(store: &BlockStore) -> &[Arc<PackedDay>] {
        &store.usage
    }

    fn indexes(query_view: &QueryView) -> &CustomerIndexes<UsageRows> {
        &query_view.usage
    }

    fn column(_: (&BlockStore, u32), units: u32, _: c_int, context: &mut Context) -> rusqlite::Result<()> {
        context.set_result(units)
    }
}

struct Ads;

impl BlockTableDefinition for Ads {
    type Run = AdsRun;
    const DECLARATION: &'static CStr =
        c"CREATE TABLE x(day INTEGER, customer_id INTEGER, group_id TEXT, ads_strength REAL, revenue REAL)";

    fn days(store: &BlockStore) -> &[Arc<PackedDay>] {
        &store.ads
    }

    fn indexes(query_view: &QueryView) -> &CustomerIndexes<AdsRun> {
        &query_view.ads
    }

    fn column(
        _: (&BlockStore, u32),
        row: AdsRow,
        column: c_int,
        context: &mut Context,
    ) -> rusqlite::Result<()> {
        match column {
            2 => context.set_result(row.group.map(Group::id)),
            3 => context.set_result(row.strength),
            _ => context.set_result(row.revenue),
        }
    }
}

struct Issues;

impl BlockTableDefinition for Issues {
    type Run = IssueRun;
    const DECLARATION: &'static CStr =
        c"CREATE TABLE x(issue_id INTEGER, customer_id INTEGER, group_id TEXT, open_day INTEGER,
        days_open INTEGER, status TEXT, resolved_day INTEGER, resolution_type TEXT)";
    const DAY_COLUMN: c_int = issues::column::OPEN_DAY;
    const ROW_NUMBER_COLUMN: Option<c_int> = Some(issues::column::ISSUE);

    fn days(store: &BlockStore) -> &[Arc<PackedDay>] {
        &store.issues
    }

    fn indexes(query_view: &QueryView) -> &CustomerIndexes<IssueRun> {
        &query_view.issues
    }

    fn column(
        at: (&BlockStore, u32),
        row: IssueRow,
        column: c_int,
        context: &mut Context,
    ) -> rusqlite::Result<()> {
        issues::write_column((&at.0.issue_clock, at.1), row, column, context)
    }

    fn day_index_of_row(store: &BlockStore, number: f64) -> Option<usize> {
        issues::day_index_of_issue(&store.issues, number as u32)
    }

    fn row_number(row: IssueRow) -> Option<i64> {
        Some(row.issue.into())
    }
}

const CUSTOMER_COLUMN: c_int = 1;
/// Column number by which SQLite refers to the rowid.
const ROWID_COLUMN: c_int = -1;
const _: () = assert!(issues::column::CUSTOMER == CUSTOMER_COLUMN);

/// Returns the letter that represents a constraint in the index string, if the table handles the constraint.
fn constraint_code<K: BlockTableDefinition>(column: c_int, operator: IndexConstraintOp) -> Option<char> {
    use IndexConstraintOp::*;
    match operator {
        SQLITE_INDEX_CONSTRAINT_EQ if column == CUSTOMER_COLUMN => Some('c'),
        SQLITE_INDEX_CONSTRAINT_EQ
            if K::ROW_NUMBER_COLUMN.is_some_and(|number| column == number || column == ROWID_COLUMN) =>
        {
            Some('n')
        }
        _ if column != K::DAY_COLUMN => None,
        SQLITE_INDEX_CONSTRAINT_EQ => Some('='),
        SQLITE_INDEX_CONSTRAINT_GT => Some('>'),
        SQLITE_INDEX_CONSTRAINT_GE => Some('g'),
        SQLITE_INDEX_CONSTRAINT_LT => Some('<'),
        SQLITE_INDEX_CONSTRAINT_LE => Some('l'),
        _ => None,
    }
}

#[repr(C)]
struct BlockTable<K: BlockTableDefinition> {
    /// Base struct of SQLite; must be the first field.
    base: ffi::sqlite3_vtab,
    query_view: Arc<QueryView>,
    kind: PhantomData<K>,
}

// SAFETY: the struct is `repr(C)` and starts with `sqlite3_vtab`, as the trait requires.
unsafe impl<'vtab, K: BlockTableDefinition> VTab<'vtab> for BlockTable<K> {
    type Aux = Arc<QueryView>;
    type Cursor = BlockCursor<'vtab, K>;

    fn connect(
        db: &mut VTabConnection,
        query_view: Option<&Arc<QueryView>>,
        _: &[u8],
        _: &[u8],
        _: &[u8],
        _: &[&[u8]],
    ) -> rusqlite::Result<(Cow<'static, CStr>, Self)> {
        db.config(VTabConfig::Innocuous)?;
        let query_view = query_view.cloned().unwrap_or_default();
        let table = BlockTable { base: ffi::sqlite3_vtab::default(), query_view, kind: PhantomData };
        Ok((Cow::Borrowed(K::DECLARATION), table))
    }

    fn best_index(&self, info: &mut IndexInfo) -> rusqlite::Result<bool> {
        let handled: Vec<(usize, char)> = info
            .constraints()
            .enumerate()
            .filter(|(_, constraint)| constraint.is_usable())
            .filter_map(|(at, constraint)| {
                Some((at, constraint_code::<K>(constraint.column(), constraint.operator())?))
            })
            .collect();
        for (argument, (at, _)) in (1..).zip(&handled) {
            // SQLite checks the constraint again, because values of other types (3.5, '7') compare differently.
            info.constraint_usage(*at).set_argv_index(argument);
        }
        let plan: String = handled.iter().map(|(_, letter)| letter).collect();
        let share = |characters: &[char], factor: f64| if plan.contains(characters) { factor } else { 1.0 };
        let rows = 1e7
            * share(&['='], 0.02)
            * share(&['>', 'g', '<', 'l'], 0.3)
            * share(&['c'], 1e-4)
            * share(&['n'], 1e-6);
        info.set_estimated_cost(rows);
        info.set_estimated_rows(rows as i64);
        info.set_idx_str(&plan);
        // The table returns rows in ascending order of day and row number.
        let by_day = |order: OrderBy<'_>| {
            (order.column() == K::DAY_COLUMN || K::ROW_NUMBER_COLUMN == Some(order.column()))
                && !order.is_order_by_desc()
        };
        let in_order = info.num_of_order_by() == 1 && info.order_bys().all(by_day);
        info.set_order_by_consumed(in_order);
        Ok(true)
    }

    fn open(&mut self) -> rusqlite::Result<BlockCursor<'_, K>> {
        Ok(BlockCursor {
            base: ffi::sqlite3_vtab_cursor::default(),
            store: self.query_view.store(),
            query_view: self.query_view.clone(),
            position: RowPosition::default(),
            run: None,
            days: 0..0,
            customer: None,
            indexed_rows: None,
            kind: PhantomData,
        })
    }
}

/// The index and the range of the customer's rows that the cursor has not returned yet.
type IndexedRows<K> = (Arc<CustomerIndex<<K as BlockTableDefinition>::Run>>, Range<usize>);

#[repr(C)]
struct BlockCursor<'vtab, K: BlockTableDefinition> {
    /// Base struct of SQLite; must be the first field.
    base: ffi::sqlite3_vtab_cursor,
    store: BlockStore,
    query_view: Arc<QueryView>,
    position: RowPosition,
    /// The run at the current position, unpacked on first use.
    run: Option<K::Run>,
    /// Indexes of the requested days in the store.
    days: Range<usize>,
    /// Number of the requested customer, if the query requests a single customer.
    customer: Option<f64>,
    /// Rows in an index. If set, the cursor uses these rows instead of `position`.
    indexed_rows: Option<IndexedRows<K>>,
    kind: PhantomData<&'vtab K>,
}

impl<K: BlockTableDefinition> BlockCursor<'_, K> {
    /// Advances to the first requested row at or after the current position.
    fn advance_to_match(&mut self) {
        let days = K::days(&self.store);
        while let Some(day) = days.get(self.position.day).filter(|_| self.days.contains(&self.position.day)) {
            while self.position.run < day.run_count() {
                if self.run.is_none()
                    && self.customer.is_none_or(|wanted| day.may_contain_customer(self.position.run, wanted))
                {
                    self.run = day.unpack_run(self.position.run);
                }
                let customers = self.run.as_ref().map_or(&[][..], RowRun::customers);
                if let Some(wanted) = self.customer {
                    K::indexes(&self.query_view).record_scanned_rows(&self.days, customers.len());
                    let at = customers.partition_point(|customer| f64::from(*customer) < wanted);
                    self.position.at = self.position.at.max(at);
                    let found = customers
                        .get(self.position.at)
                        .is_some_and(|customer| f64::from(*customer) == wanted);
                    if found {
                        return;
                    }
                } else if self.position.at < customers.len() {
                    return;
                }
                (self.position.run, self.position.at, self.run) = (self.position.run + 1, 0, None);
            }
            self.position = RowPosition { day: self.position.day + 1, run: 0, at: 0 };
        }
    }

    /// Returns whether the position is in the unpacked run and all customers are requested. The check is the fast path
    /// for most rows.
    fn is_within_run(&self) -> bool {
        self.customer.is_none()
            && self.run.as_ref().is_some_and(|run| self.position.at < run.customers().len())
    }

    /// Returns the number of the current row, or `None` after the last row.
    fn row_number(&self) -> Option<i64> {
        match &self.indexed_rows {
            Some((index, rest)) => index.numbers.get(rest.start).copied(),
            None => {
                let day = K::days(&self.store).get(self.position.day)?;
                Some(day.row_number(self.position.run, self.position.at))
            }
        }
    }

    fn row_day(&self) -> Option<u32> {
        match &self.indexed_rows {
            Some((index, rest)) => u32::try_from(index.numbers.get(rest.start)? >> 32).ok(),
            None => K::days(&self.store).get(self.position.day).map(|day| day.day),
        }
    }

    fn row_customer(&self) -> Option<u32> {
        match &self.indexed_rows {
            Some(_) => self.customer.map(|customer| customer as u32),
            None => self.run.as_ref()?.customers().get(self.position.at).copied(),
        }
    }

    fn row_data(&self) -> Option<RowData<K>> {
        match &self.indexed_rows {
            Some((index, rest)) => index.rows.get(rest.start).copied(),
            None => self.run.as_ref().map(|run| run.row(self.position.at)),
        }
    }
}

// SAFETY: the struct is `repr(C)` and starts with `sqlite3_vtab_cursor`, as the trait requires.
unsafe impl<K: BlockTableDefinition> VTabCursor for BlockCursor<'_, K> {
    fn filter(&mut self, _: c_int, plan: Option<&str>, values: &Filters<'_>) -> rusqlite::Result<()> {
        let (mut first_day, mut last_day) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut only_day = None;
        (self.customer, self.indexed_rows, self.run) = (None, None, None);
        for ((at, value), letter) in values.iter().enumerate().zip(plan.unwrap_or_default().chars()) {
            let number = match value.data_type() {
                Type::Integer | Type::Real => values.get::<f64>(at)?,
                // A comparison with NULL is never true.
                Type::Null => f64::NAN,
                Type::Text => comparison_number(&values.get::<String>(at)?),
                _ => continue,
            };
            if number.is_nan() {
                last_day = f64::NEG_INFINITY;
            }
            match letter {
                '=' => (first_day, last_day) = (first_day.max(number), last_day.min(number)),
                '>' | 'g' => first_day = first_day.max(number),
                '<' | 'l' => last_day = last_day.min(number),
                'n' => only_day = Some(K::day_index_of_row(&self.store, number)),
                _ => self.customer = Some(number),
            }
        }
        let days = K::days(&self.store);
        let end = days.partition_point(|day| f64::from(day.day) <= last_day);
        self.days = days.partition_point(|day| f64::from(day.day) < first_day).min(end)..end;
        if let Some(day) = only_day {
            let day = day.filter(|day| self.days.contains(day));
            self.days = day.map_or(0..0, |day| day..day + 1);
        }
        if let Some(customer) = self.customer
            && let Some(index) = K::indexes(&self.query_view).get(days, &self.days)
        {
            let rows = index.row_range(customer);
            self.indexed_rows = Some((index, rows));
            return Ok(());
        }
        self.position = RowPosition { day: self.days.start, run: 0, at: 0 };
        self.advance_to_match();
        Ok(())
    }

    fn next(&mut self) -> rusqlite::Result<()> {
        match &mut self.indexed_rows {
            Some((_, rest)) => rest.start += 1,
            None => {
                self.position.at += 1;
                if !self.is_within_run() {
                    self.advance_to_match();
                }
            }
        }
        Ok(())
    }

    fn eof(&self) -> bool {
        match &self.indexed_rows {
            Some((_, rest)) => rest.is_empty(),
            None => !self.days.contains(&self.position.day),
        }
    }

    fn column(&self, context: &mut Context, column: c_int) -> rusqlite::Result<()> {
        match column {
            CUSTOMER_COLUMN => context.set_result(self.row_customer()),
            day if day == K::DAY_COLUMN => context.set_result(self.row_day()),
            other => {
                let at = (&self.store, self.row_day().unwrap_or(0));
                self.row_data().map_or(Ok(()), |row| K::column(at, row, other, context))
            }
        }
    }

    fn rowid(&self) -> rusqlite::Result<i64> {
        let number = self.row_data().and_then(K::row_number);
        Ok(number.or_else(|| self.row_number()).unwrap_or_default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_world::events::AdsRevenueRow;
    use novamind_world::identifiers::Group;

    fn connection() -> Connection {
        connection_with_view(&Arc::new(QueryView::default()))
    }

    /// Returns a connection to tables with five days of six usage rows each, and with one row of ad revenue.
    fn connection_with_view(query_view: &Arc<QueryView>) -> Connection {
        let rows = |first: u32| {
            let customers = vec![first, first + 2, first + 4];
            UsageRows { customers, units: vec![first, 10, 20] }
        };
        let usage: Vec<_> =
            (1..=5).map(|day| Arc::new(PackedDay::pack(day, &[rows(2), rows(100)]))).collect();
        let group = Group::parse("S2").expect("a group");
        let ads_row = AdsRevenueRow { customer: 2, group, strength: 0.5, revenue: 0.25 };
        let ads = vec![Arc::new(PackedDay::pack(3, &AdsRun::runs_from_rows(&[ads_row])))];
        let store = BlockStore { usage: Arc::new(usage), ads: Arc::new(ads), ..BlockStore::default() };
        let connection = Connection::open_in_memory().expect("memory");
        query_view.set_store(store);
        register(&connection, query_view).expect("modules");
        connection
    }

    #[test]
    fn queries_return_what_an_ordinary_table_returns() {
        let connection = connection();
        connection
            .execute_batch("CREATE TEMP TABLE plain AS SELECT day, customer_id, usage_units FROM daily_usage")
            .expect("a copy");
        for condition in [
            "1",
            "day = 3",
            "day > 2",
            "day >= 2 AND day < 4",
            "day <= 1.5",
            "day > 2.5 AND day < 3.5",
            "day = '3'",
            "day = NULL",
            "customer_id = 102",
            "customer_id = 3",
            "customer_id IN (2, 104)",
            "day IN (1, 5) AND customer_id = 4",
            "day = 9",
            "day BETWEEN 2 AND 3 AND usage_units > 10",
            "customer_id > 100",
        ] {
            let count = |table: &str| -> (i64, Option<i64>) {
                let sql = format!(
                    "SELECT count(*), sum(usage_units * day + customer_id) FROM {table} WHERE {condition}"
                );
                connection.query_row(&sql, [], |row| Ok((row.get(0)?, row.get(1)?))).expect("an answer")
            };
            assert_eq!(count("daily_usage"), count("plain"), "{condition}");
        }
    }

    #[test]
    fn indexed_lookups_match_single_lookups() {
        let connection = connection();
        let sql = "WITH RECURSIVE n(x) AS (SELECT 0 UNION ALL SELECT x + 1 FROM n WHERE x < 300)
                   SELECT count(u.rowid), sum(u.rowid), sum(u.usage_units), sum(u.day), sum(u.customer_id)
                   FROM n LEFT JOIN daily_usage u ON u.customer_id = n.x % 110 AND u.day";
        for (days, condition) in
            [(" > 0", "1"), (" = 3", "day = 3"), (" BETWEEN 2 AND 4", "day BETWEEN 2 AND 4")]
        {
            let all: (i64, i64, i64, i64, i64) =
                connection.query_row(&format!("{sql}{days}"), [], |row| row.try_into()).expect("an answer");
            let scan = format!(
                "SELECT count(*), sum(u.rowid), sum(usage_units), sum(day), sum(customer_id) FROM
                 (WITH RECURSIVE n(x) AS (SELECT 0 UNION ALL SELECT x + 1 FROM n WHERE x < 300) SELECT x % 110 AS c FROM n)
                 CROSS JOIN daily_usage u WHERE customer_id + 0 = c AND {condition}"
            );
            assert_eq!(connection.query_row(&scan, [], |row| row.try_into()), Ok(all), "{days}");
        }
    }

    #[test]
    fn repeated_lookups_build_an_index() {
        let query_view = Arc::new(QueryView::default());
        let connection = connection_with_view(&query_view);
        let ask = |lookups: u32| -> (usize, i64) {
            query_view.set_store(query_view.store());
            let sql = format!(
                "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n WHERE x < {lookups})
                 SELECT count(u.rowid) FROM n LEFT JOIN daily_usage u ON u.customer_id = 2 + 0 * n.x"
            );
            let found = connection.query_row(&sql, [], |row| row.get(0)).expect("an answer");
            (query_view.usage.scanned_rows(), found)
        };
        let (once, found) = ask(1);
        assert!(
            once >= 15 && found == 5,
            "a run of three rows on each of five days: {once} rows, {found} found"
        );
        // Scanning the thirty rows twice costs as much as building an index.
        for lookups in [5, 100, 5_000] {
            let (rows, found) = ask(lookups);
            assert_eq!(found, 5 * i64::from(lookups));
            assert!(rows <= 60 + once, "{rows} rows for {lookups} lookups");
        }
    }

    #[test]
    fn row_numbers_do_not_depend_on_the_query() {
        let connection = connection();
        let numbers = |condition: &str| -> Vec<i64> {
            let sql = format!("SELECT rowid FROM daily_usage WHERE {condition}");
            let mut statement = connection.prepare(&sql).expect("a statement");
            statement
                .query_map([], |row| row.get(0))
                .expect("rows")
                .map(|row| row.expect("a number"))
                .collect()
        };
        let all = numbers("1");
        assert_eq!(all[..7], [1, 2, 3, 4, 5, 6, (1 << 32) + 1].map(|number| (1 << 32) + number));
        assert!(all.is_sorted_by(|one, next| one < next));
        assert_eq!(numbers("day = 2 AND customer_id = 102"), [(2 << 32) + 5]);
        assert_eq!(numbers("rowid = 4294967298"), [(1 << 32) + 2]);
    }

    #[test]
    fn ad_revenue_shows_all_its_columns() {
        let row = connection().query_row("SELECT * FROM ads_revenue", [], |row| {
            Ok((
                row.get::<_, u32>(0)?,
                row.get::<_, u32>(1)?,
                row.get::<_, String>(2)?,
                row.get::<_, f64>(4)?,
            ))
        });
        assert_eq!(row.expect("a row"), (3, 2, "S2".to_owned(), 0.25));
    }

    #[test]
    fn block_tables_are_read_only() {
        assert!(connection().execute("DELETE FROM daily_usage", []).is_err());
        assert!(connection().execute("INSERT INTO daily_usage VALUES (1, 2, 3)", []).is_err());
    }
}
