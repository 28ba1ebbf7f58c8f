//! The tables `daily_usage` and `ads_revenue`: read-only virtual tables over the shelf of blocks, which skip
//! days and customers that a query does not ask for.
//!
//! SQLite's interface to virtual tables is a pair of unsafe traits: their structs must start with the base
//! class. This is the only file that implements them.
#![expect(unsafe_code, reason = "rusqlite's traits of virtual tables are unsafe; see the safety comments")]

use std::borrow::Cow;
use std::ffi::{CStr, c_int};
use std::marker::PhantomData;
use std::sync::Arc;

use rusqlite::Connection;
use rusqlite::ffi;
use rusqlite::types::Type;
use rusqlite::vtab::{
    Context, Filters, IndexConstraintOp, IndexInfo, Module, VTab, VTabConfig, VTabConnection, VTabCursor,
};

use super::blocks::{AdsRun, PackedDay, Run, SharedShelf, Shelf};
use crate::world::events::UsageRows;

/// Registers both tables on a connection.
pub(super) fn register(connection: &Connection, shelf: &SharedShelf) -> rusqlite::Result<()> {
    const USAGE: Module<'static, BlockTable<Usage>> = Module::eponymous_only_module();
    const ADS: Module<'static, BlockTable<Ads>> = Module::eponymous_only_module();
    connection.create_module(c"daily_usage", &USAGE, Some(shelf.clone()))?;
    connection.create_module(c"ads_revenue", &ADS, Some(shelf.clone()))
}

/// What the two tables differ in. Columns 0 and 1 are always day and customer_id.
trait Kind: Send + Sync + 'static {
    type Run: Run;
    const DECLARATION: &'static CStr;

    fn days(shelf: &Shelf) -> &[Arc<PackedDay>];
    fn column(run: &Self::Run, at: usize, column: c_int, context: &mut Context) -> rusqlite::Result<()>;
}

/// A row: day on the shelf, run of the day, position in the run.
#[derive(Clone, Copy, Default)]
struct Place {
    day: usize,
    run: usize,
    at: usize,
}

struct Usage;

impl Kind for Usage {
    type Run = UsageRows;
    const DECLARATION: &'static CStr =
        c"CREATE TABLE x(day INTEGER, customer_id INTEGER, usage_units INTEGER)";

    fn days(shelf: &Shelf) -> &[Arc<PackedDay>] {
        &shelf.usage
    }

    fn column(run: &UsageRows, at: usize, _: c_int, context: &mut Context) -> rusqlite::Result<()> {
        context.set_result(run.units[at])
    }
}

struct Ads;

impl Kind for Ads {
    type Run = AdsRun;
    const DECLARATION: &'static CStr =
        c"CREATE TABLE x(day INTEGER, customer_id INTEGER, group_id TEXT, ads_strength REAL, revenue REAL)";

    fn days(shelf: &Shelf) -> &[Arc<PackedDay>] {
        &shelf.ads
    }

    fn column(run: &AdsRun, at: usize, column: c_int, context: &mut Context) -> rusqlite::Result<()> {
        match column {
            2 => context.set_result(run.group.id()),
            3 => context.set_result(run.strengths[at]),
            _ => context.set_result(run.revenues[at]),
        }
    }
}

const DAY: c_int = 0;
const CUSTOMER: c_int = 1;

/// Constraints that the table handles itself, as one letter each in the index text.
fn letter(column: c_int, operator: IndexConstraintOp) -> Option<char> {
    use IndexConstraintOp::*;
    match (column, operator) {
        (DAY, SQLITE_INDEX_CONSTRAINT_EQ) => Some('='),
        (DAY, SQLITE_INDEX_CONSTRAINT_GT) => Some('>'),
        (DAY, SQLITE_INDEX_CONSTRAINT_GE) => Some('g'),
        (DAY, SQLITE_INDEX_CONSTRAINT_LT) => Some('<'),
        (DAY, SQLITE_INDEX_CONSTRAINT_LE) => Some('l'),
        (CUSTOMER, SQLITE_INDEX_CONSTRAINT_EQ) => Some('c'),
        _ => None,
    }
}

#[repr(C)]
struct BlockTable<K: Kind> {
    /// Base class; must be first.
    base: ffi::sqlite3_vtab,
    shelf: SharedShelf,
    kind: PhantomData<K>,
}

// SAFETY: the struct is `repr(C)` and starts with `sqlite3_vtab`, as the trait requires.
unsafe impl<'vtab, K: Kind> VTab<'vtab> for BlockTable<K> {
    type Aux = SharedShelf;
    type Cursor = BlockCursor<'vtab, K>;

    fn connect(
        db: &mut VTabConnection,
        shelf: Option<&SharedShelf>,
        _: &[u8],
        _: &[u8],
        _: &[u8],
        _: &[&[u8]],
    ) -> rusqlite::Result<(Cow<'static, CStr>, Self)> {
        db.config(VTabConfig::Innocuous)?;
        let shelf = shelf.cloned().unwrap_or_default();
        let table = BlockTable { base: ffi::sqlite3_vtab::default(), shelf, kind: PhantomData };
        Ok((Cow::Borrowed(K::DECLARATION), table))
    }

    fn best_index(&self, info: &mut IndexInfo) -> rusqlite::Result<bool> {
        let handled: Vec<(usize, char)> = info
            .constraints()
            .enumerate()
            .filter(|(_, constraint)| constraint.is_usable())
            .filter_map(|(at, constraint)| Some((at, letter(constraint.column(), constraint.operator())?)))
            .collect();
        for (argument, (at, _)) in (1..).zip(&handled) {
            // SQLite checks the constraint again: a value of another type (3.5, '7') is compared its own way.
            info.constraint_usage(*at).set_argv_index(argument);
        }
        let plan: String = handled.iter().map(|(_, letter)| letter).collect();
        let share = |letters: &[char], factor: f64| if plan.contains(letters) { factor } else { 1.0 };
        let rows = 1e7 * share(&['='], 0.02) * share(&['>', 'g', '<', 'l'], 0.3) * share(&['c'], 1e-4);
        info.set_estimated_cost(rows);
        info.set_estimated_rows(rows as i64);
        info.set_idx_str(&plan);
        Ok(true)
    }

    fn open(&mut self) -> rusqlite::Result<BlockCursor<'_, K>> {
        let shelf = self.shelf.read().unwrap_or_else(|poisoned| poisoned.into_inner()).clone();
        Ok(BlockCursor {
            base: ffi::sqlite3_vtab_cursor::default(),
            shelf,
            place: Place::default(),
            run: None,
            last_day: f64::INFINITY,
            customer: None,
            kind: PhantomData,
        })
    }
}

#[repr(C)]
struct BlockCursor<'vtab, K: Kind> {
    /// Base class; must be first.
    base: ffi::sqlite3_vtab_cursor,
    shelf: Shelf,
    place: Place,
    /// The run of the place, once a row of it was asked for.
    run: Option<K::Run>,
    /// Days after this one are not asked for.
    last_day: f64,
    /// Only rows of this customer are asked for.
    customer: Option<f64>,
    kind: PhantomData<&'vtab K>,
}

impl<K: Kind> BlockCursor<'_, K> {
    /// Moves on to the first row at or after the place that may be asked for.
    fn settle(&mut self) {
        let days = K::days(&self.shelf);
        while let Some(day) = days.get(self.place.day) {
            if f64::from(day.day) > self.last_day {
                self.place.day = days.len();
                return;
            }
            while self.place.run < day.len() {
                if self.run.is_none()
                    && self.customer.is_none_or(|wanted| day.may_hold(self.place.run, wanted))
                {
                    self.run = day.open(self.place.run);
                }
                let customers = self.run.as_ref().map_or(&[][..], Run::customers);
                if let Some(wanted) = self.customer {
                    let at = customers.partition_point(|customer| f64::from(*customer) < wanted);
                    self.place.at = self.place.at.max(at);
                    let found =
                        customers.get(self.place.at).is_some_and(|customer| f64::from(*customer) == wanted);
                    if found {
                        return;
                    }
                } else if self.place.at < customers.len() {
                    return;
                }
                (self.place.run, self.place.at, self.run) = (self.place.run + 1, 0, None);
            }
            self.place = Place { day: self.place.day + 1, run: 0, at: 0 };
        }
    }

    /// Day and customer number of the place; nothing once all rows were seen.
    fn keys(&self) -> Option<(u32, u32)> {
        let day = K::days(&self.shelf).get(self.place.day)?;
        Some((day.day, *self.run.as_ref()?.customers().get(self.place.at)?))
    }
}

// SAFETY: the struct is `repr(C)` and starts with `sqlite3_vtab_cursor`, as the trait requires.
unsafe impl<K: Kind> VTabCursor for BlockCursor<'_, K> {
    fn filter(&mut self, _: c_int, plan: Option<&str>, values: &Filters<'_>) -> rusqlite::Result<()> {
        let mut first_day = f64::NEG_INFINITY;
        (self.last_day, self.customer) = (f64::INFINITY, None);
        for ((at, value), letter) in values.iter().enumerate().zip(plan.unwrap_or_default().chars()) {
            let number = match value.data_type() {
                Type::Integer | Type::Real => values.get::<f64>(at)?,
                // No number equals NULL; how texts compare is left to SQLite, which checks again.
                Type::Null => f64::NAN,
                _ => continue,
            };
            if number.is_nan() {
                self.last_day = f64::NEG_INFINITY;
            }
            match letter {
                '=' => (first_day, self.last_day) = (first_day.max(number), self.last_day.min(number)),
                '>' | 'g' => first_day = first_day.max(number),
                '<' | 'l' => self.last_day = self.last_day.min(number),
                _ => self.customer = Some(number),
            }
        }
        let day = K::days(&self.shelf).partition_point(|day| f64::from(day.day) < first_day);
        (self.place, self.run) = (Place { day, run: 0, at: 0 }, None);
        self.settle();
        Ok(())
    }

    fn next(&mut self) -> rusqlite::Result<()> {
        self.place.at += 1;
        self.settle();
        Ok(())
    }

    fn eof(&self) -> bool {
        self.place.day >= K::days(&self.shelf).len()
    }

    fn column(&self, context: &mut Context, column: c_int) -> rusqlite::Result<()> {
        match (column, &self.run) {
            (DAY, _) => context.set_result(self.keys().map(|(day, _)| day)),
            (CUSTOMER, _) => context.set_result(self.keys().map(|(_, customer)| customer)),
            (other, Some(run)) => K::column(run, self.place.at, other, context),
            (_, None) => Ok(()),
        }
    }

    fn rowid(&self) -> rusqlite::Result<i64> {
        let (day, customer) = self.keys().unwrap_or_default();
        Ok(i64::from(day) << 32 | i64::from(customer))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::RwLock;

    use super::*;
    use crate::world::events::AdsRevenueRow;
    use crate::world::identifiers::Group;

    fn connection() -> Connection {
        let rows = |first: u32| {
            let customers = vec![first, first + 2, first + 4];
            UsageRows { customers, units: vec![first, 10, 20] }
        };
        let usage: Vec<_> =
            (1..=5).map(|day| Arc::new(PackedDay::pack(day, &[rows(2), rows(100)]))).collect();
        let group = Group::parse("S2").expect("a group");
        let ads_row = AdsRevenueRow { customer: 2, group, strength: 0.5, revenue: 0.25 };
        let ads = vec![Arc::new(PackedDay::pack(3, &AdsRun::runs_of(&[ads_row])))];
        let shelf = Shelf { usage: Arc::new(usage), ads: Arc::new(ads) };
        let connection = Connection::open_in_memory().expect("memory");
        register(&connection, &Arc::new(RwLock::new(shelf))).expect("modules");
        connection
    }

    #[test]
    fn questions_are_answered_as_by_an_ordinary_table() {
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
    fn nothing_can_be_written() {
        assert!(connection().execute("DELETE FROM daily_usage", []).is_err());
        assert!(connection().execute("INSERT INTO daily_usage VALUES (1, 2, 3)", []).is_err());
    }
}
