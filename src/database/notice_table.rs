//! The table `notifications`: a read-only virtual table over the inbox, which skips days and types that a query does not
//! ask for, and hands rows out in the order of types or days so that nothing needs sorting.
//!
//! SQLite's interface to virtual tables is a pair of unsafe traits: their structs must start with the base class.
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

use super::blocks::Seen;
use super::notices::{Inbox, LEAD_LOST, NoticeDay, Place, TYPES};

/// Registers the table on a connection.
pub(super) fn register(connection: &Connection, seen: &Arc<Seen>) -> rusqlite::Result<()> {
    const NOTICES: Module<'static, NoticeTable> = Module::eponymous_only_module();
    connection.create_module(c"notifications", &NOTICES, Some(seen.clone()))
}

const DECLARATION: &CStr = c"CREATE TABLE x(notification_id INTEGER, day INTEGER, type TEXT, message TEXT)";
const NUMBER: c_int = 0;
const DAY: c_int = 1;
const TYPE: c_int = 2;
/// The number again, as SQLite names the row.
const ROW: c_int = -1;

/// Constraints that the table handles itself, as one letter each in the index text.
fn letter(column: c_int, operator: IndexConstraintOp) -> Option<char> {
    use IndexConstraintOp::*;
    match (column, operator) {
        (DAY, SQLITE_INDEX_CONSTRAINT_EQ) => Some('='),
        (DAY, SQLITE_INDEX_CONSTRAINT_GT) => Some('>'),
        (DAY, SQLITE_INDEX_CONSTRAINT_GE) => Some('g'),
        (DAY, SQLITE_INDEX_CONSTRAINT_LT) => Some('<'),
        (DAY, SQLITE_INDEX_CONSTRAINT_LE) => Some('l'),
        (TYPE, SQLITE_INDEX_CONSTRAINT_EQ) => Some('t'),
        (NUMBER | ROW, SQLITE_INDEX_CONSTRAINT_EQ) => Some('n'),
        _ => None,
    }
}

/// The order in which rows are handed out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Order {
    /// As they are numbered, which is day by day.
    Numbers,
    /// Type by type, and day by day within one.
    Types,
    /// Day by day, and type by type within one.
    DaysAndTypes,
}

impl Order {
    /// The order that needs no sorting for a list of columns; none if there is no such order.
    fn by(columns: &[c_int]) -> Option<Order> {
        match columns {
            [NUMBER | ROW, ..] | [DAY] | [DAY, NUMBER | ROW, ..] => Some(Order::Numbers),
            [TYPE] | [TYPE, DAY] | [TYPE, NUMBER | ROW, ..] | [TYPE, DAY, NUMBER | ROW, ..] => {
                Some(Order::Types)
            }
            [DAY, TYPE] | [DAY, TYPE, NUMBER | ROW, ..] => Some(Order::DaysAndTypes),
            _ => None,
        }
    }

    fn letter(self) -> char {
        match self {
            Order::Numbers => 'N',
            Order::Types => 'T',
            Order::DaysAndTypes => 'D',
        }
    }

    fn read(letter: char) -> Option<Order> {
        [Order::Numbers, Order::Types, Order::DaysAndTypes].into_iter().find(|own| own.letter() == letter)
    }
}

#[repr(C)]
struct NoticeTable {
    /// Base class; must be first.
    base: ffi::sqlite3_vtab,
    seen: Arc<Seen>,
}

// SAFETY: the struct is `repr(C)` and starts with `sqlite3_vtab`, as the trait requires.
unsafe impl<'vtab> VTab<'vtab> for NoticeTable {
    type Aux = Arc<Seen>;
    type Cursor = NoticeCursor<'vtab>;

    fn connect(
        db: &mut VTabConnection,
        seen: Option<&Arc<Seen>>,
        _: &[u8],
        _: &[u8],
        _: &[u8],
        _: &[&[u8]],
    ) -> rusqlite::Result<(Cow<'static, CStr>, Self)> {
        db.config(VTabConfig::Innocuous)?;
        let table =
            NoticeTable { base: ffi::sqlite3_vtab::default(), seen: seen.cloned().unwrap_or_default() };
        Ok((Cow::Borrowed(DECLARATION), table))
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
        let columns: Option<Vec<c_int>> =
            info.order_bys().map(|order| (!order.is_order_by_desc()).then(|| order.column())).collect();
        let order = columns.filter(|columns| !columns.is_empty()).and_then(|columns| Order::by(&columns));
        info.set_order_by_consumed(order.is_some());
        let mut plan: String = handled.iter().map(|(_, letter)| letter).collect();
        let share = |letters: &[char], factor: f64| if plan.contains(letters) { factor } else { 1.0 };
        let rows = 1e6
            * share(&['n'], 1e-6)
            * share(&['='], 0.002)
            * share(&['>', 'g', '<', 'l'], 0.3)
            * share(&['t'], 0.3);
        info.set_estimated_cost(rows);
        info.set_estimated_rows(rows as i64);
        plan.push(order.unwrap_or(Order::Numbers).letter());
        info.set_idx_str(&plan);
        Ok(true)
    }

    fn open(&mut self) -> rusqlite::Result<NoticeCursor<'_>> {
        Ok(NoticeCursor {
            base: ffi::sqlite3_vtab_cursor::default(),
            inbox: self.seen.store().inbox,
            passes: Vec::new(),
            pass: 0,
            place: 0,
            only: None,
            table: PhantomData,
        })
    }
}

/// What is looked through at once.
#[derive(Debug, Clone, Copy)]
struct Pass {
    /// Position among the days.
    day: usize,
    /// Only notices of this type.
    notice_type: Option<u8>,
}

#[repr(C)]
struct NoticeCursor<'vtab> {
    /// Base class; must be first.
    base: ffi::sqlite3_vtab_cursor,
    inbox: Inbox,
    passes: Vec<Pass>,
    pass: usize,
    place: u64,
    /// Only the notice with this number.
    only: Option<f64>,
    table: PhantomData<&'vtab NoticeTable>,
}

impl NoticeCursor<'_> {
    fn day(&self) -> Option<&NoticeDay> {
        self.passes.get(self.pass).map(|pass| &*self.inbox.days[pass.day])
    }

    /// Moves on to the first row at or after the place that may be asked for.
    fn settle(&mut self) {
        while let Some(pass) = self.passes.get(self.pass) {
            let day = &self.inbox.days[pass.day];
            let next = match (pass.notice_type, self.only) {
                (_, Some(number)) => {
                    let place = number - day.first as f64;
                    let is_here =
                        place.fract() == 0.0 && place >= self.place as f64 && place < day.len() as f64;
                    is_here.then_some(place as u64)
                }
                (Some(own), None) => day.next_of_type(own, self.place),
                (None, None) => Some(self.place).filter(|place| *place < day.len()),
            };
            if let Some(next) = next {
                self.place = next;
                return;
            }
            (self.pass, self.place) = (self.pass + 1, 0);
        }
    }

    /// What is to be looked through: days between two, types if they matter.
    fn passes(&self, days: [f64; 2], types: &[Option<u8>], order: Order) -> Vec<Pass> {
        let all = &self.inbox.days;
        let end = all.partition_point(|day| f64::from(day.day) <= days[1]);
        let days = all.partition_point(|day| f64::from(day.day) < days[0]).min(end)..end;
        let pass = |day: usize, notice_type: Option<u8>| Pass { day, notice_type };
        match order {
            Order::Types => {
                types.iter().flat_map(|own| days.clone().map(move |day| pass(day, *own))).collect()
            }
            Order::Numbers | Order::DaysAndTypes => {
                days.flat_map(|day| types.iter().map(move |own| pass(day, *own))).collect()
            }
        }
    }
}

// SAFETY: the struct is `repr(C)` and starts with `sqlite3_vtab_cursor`, as the trait requires.
unsafe impl VTabCursor for NoticeCursor<'_> {
    fn filter(&mut self, _: c_int, plan: Option<&str>, values: &Filters<'_>) -> rusqlite::Result<()> {
        let (mut days, mut only_type) = ([f64::NEG_INFINITY, f64::INFINITY], None);
        self.only = None;
        let plan = plan.unwrap_or_default();
        for ((at, value), letter) in values.iter().enumerate().zip(plan.chars()) {
            let number = match value.data_type() {
                Type::Text if letter == 't' => {
                    let wanted: String = values.get(at)?;
                    // A type that does not exist has no rows.
                    only_type =
                        Some(TYPES.iter().position(|own| *own == wanted).map_or(u8::MAX, |at| at as u8));
                    continue;
                }
                Type::Integer | Type::Real if letter != 't' => values.get::<f64>(at)?,
                // No number equals NULL; how texts compare is left to SQLite, which checks again.
                Type::Null => f64::NAN,
                _ => continue,
            };
            if number.is_nan() {
                days[1] = f64::NEG_INFINITY;
            }
            match letter {
                '=' => days = [days[0].max(number), days[1].min(number)],
                '>' | 'g' => days[0] = days[0].max(number),
                '<' | 'l' => days[1] = days[1].min(number),
                _ => self.only = Some(number),
            }
        }
        let order = plan.chars().next_back().and_then(Order::read).unwrap_or(Order::Numbers);
        let all: Vec<Option<u8>> = (0..TYPES.len() as u8).map(Some).collect();
        let types = match (only_type, order) {
            // One row is looked for once, in whatever order.
            _ if self.only.is_some() => vec![None],
            (Some(_), _) => vec![only_type],
            (None, Order::Numbers) => vec![None],
            (None, _) => all,
        };
        self.passes = self.passes(days, &types, order);
        (self.pass, self.place) = (0, 0);
        self.settle();
        Ok(())
    }

    fn next(&mut self) -> rusqlite::Result<()> {
        self.place += 1;
        self.settle();
        Ok(())
    }

    fn eof(&self) -> bool {
        self.pass >= self.passes.len()
    }

    fn column(&self, context: &mut Context, column: c_int) -> rusqlite::Result<()> {
        let Some(day) = self.day() else { return Ok(()) };
        let place = day.at(self.place);
        match (column, place) {
            (NUMBER, _) => context.set_result((day.first + self.place) as i64),
            (DAY, _) => context.set_result(day.day),
            (TYPE, Place::Own(at)) => context.set_result(TYPES[usize::from(day.type_at(at))]),
            (TYPE, Place::Repeated(_)) => context.set_result(TYPES[usize::from(LEAD_LOST)]),
            (_, Place::Own(at)) => context.set_result(day.text_at(at)),
            (_, Place::Repeated(at)) => context.set_result(self.inbox.losses[at].words()),
        }
    }

    fn rowid(&self) -> rusqlite::Result<i64> {
        Ok(self.day().map_or(0, |day| (day.first + self.place) as i64))
    }
}

#[cfg(test)]
mod tests {
    use super::super::blocks::BlockStore;
    use super::super::notices::RepeatedLoss;
    use super::*;
    use crate::world::events::LossCause;

    /// A connection to five days: notices of three types, losses that repeat from day 2 on, a call on day 3.
    fn connection() -> Connection {
        let losses =
            (0..3).map(|at| RepeatedLoss { customer: 10 + at, message_day: 1, cause: LossCause::Silence });
        let (mut days, mut first) = (Vec::new(), 1);
        for number in 1..=5u32 {
            let mut day = NoticeDay::of(number, first);
            day.push(6, &format!("R&D of day {number}"));
            day.push(LEAD_LOST, "lost");
            day.push(0, "won");
            day.repeat(number.saturating_sub(1).min(3));
            if number == 3 {
                day.push(5, "found");
            }
            first += day.len();
            days.push(Arc::new(day));
        }
        let inbox = Inbox { days: Arc::new(days), losses: Arc::new(losses.collect()) };
        let seen = Arc::new(Seen::default());
        seen.see(BlockStore { inbox, ..BlockStore::default() });
        let connection = Connection::open_in_memory().expect("memory");
        register(&connection, &seen).expect("a module");
        connection
    }

    #[test]
    fn questions_are_answered_as_by_an_ordinary_table() {
        let connection = connection();
        connection
            .execute_batch(
                "CREATE TEMP TABLE plain(notification_id INTEGER PRIMARY KEY, day INTEGER, type TEXT, message TEXT);
                 INSERT INTO plain SELECT * FROM notifications",
            )
            .expect("a copy");
        let count: i64 =
            connection.query_row("SELECT count(*) FROM plain", [], |row| row.get(0)).expect("rows");
        assert_eq!(count, 15 + 1 + 2 + 3 + 3 + 1, "own notices, repeated ones of days 2 to 5, a call");
        let conditions = [
            "1",
            "day = 3",
            "day > 2",
            "day >= 2 AND day < 4",
            "day <= 1.5",
            "day = '3'",
            "day = NULL",
            "type = 'lead_lost'",
            "type = 'deal_won' AND day > 3",
            "type = 'nothing'",
            "type = 7",
            "type IS NULL",
            "notification_id = 9",
            "rowid = 9",
            "notification_id IN (1, 8, 200)",
            "notification_id = 2.5",
            "notification_id > 9",
            "type IN ('lead_lost', 'market_discovery')",
            "message LIKE '%our offer%'",
        ];
        let orders = [
            "rowid",
            "day",
            "type, day, rowid",
            "day, type, rowid",
            "type, rowid",
            "rowid DESC",
            "day DESC, rowid",
            "type DESC, day, rowid",
        ];
        for condition in conditions {
            for order in orders {
                let rows = |table: &str| -> Vec<(i64, i64, String, String)> {
                    let unique = if order == "day" { "day, rowid" } else { order };
                    let sql = format!("SELECT * FROM {table} WHERE {condition} ORDER BY {unique}");
                    let mut statement = connection.prepare(&sql).expect("a statement");
                    let rows = statement.query_map([], |row| row.try_into()).expect("rows");
                    rows.collect::<Result<_, _>>().expect("a row")
                };
                assert_eq!(rows("notifications"), rows("plain"), "{condition}, {order}");
            }
            for key in ["type", "day", "day, type", "type, day"] {
                let groups = |table: &str| -> Vec<(i64, i64)> {
                    let sql = format!(
                        "SELECT count(*), sum(notification_id) FROM {table} WHERE {condition} GROUP BY {key} ORDER BY {key}"
                    );
                    let mut statement = connection.prepare(&sql).expect("a statement");
                    let rows = statement.query_map([], |row| row.try_into()).expect("rows");
                    rows.collect::<Result<_, _>>().expect("a row")
                };
                assert_eq!(groups("notifications"), groups("plain"), "{condition}, {key}");
            }
        }
    }

    #[test]
    fn counting_by_type_or_day_sorts_nothing() {
        let connection = connection();
        for key in ["type", "day", "day, type", "type, day"] {
            let sql = format!("EXPLAIN QUERY PLAN SELECT {key}, count(*) FROM notifications GROUP BY {key}");
            let mut statement = connection.prepare(&sql).expect("a statement");
            let rows = statement.query_map([], |row| row.get::<_, String>(3)).expect("rows");
            let plan: Vec<String> = rows.map(|row| row.expect("a row")).collect();
            assert!(plan.len() == 1 && plan[0].starts_with("SCAN notifications"), "{plan:?}");
        }
    }

    #[test]
    fn a_repeated_loss_tells_its_reason() {
        let sql = "SELECT message FROM notifications WHERE day = 2 AND message LIKE 'Customer%'";
        let text: String = connection().query_row(sql, [], |row| row.get(0)).expect("a row");
        assert_eq!(
            text,
            "Customer 10 did not answer our offer of day 1. The lead is lost; this repeats daily."
        );
    }

    #[test]
    fn nothing_can_be_written() {
        assert!(connection().execute("DELETE FROM notifications", []).is_err());
    }
}
