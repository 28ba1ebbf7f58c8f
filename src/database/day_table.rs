//! The tables `notifications` and `ledger`: read-only virtual tables over packed days. The virtual tables skip days
//! and kinds that a query does not need. The virtual tables can return rows ordered by kind or day, so that SQLite
//! need not sort.
//!
//! Virtual tables implement two unsafe traits of rusqlite. The implementing structs must start with a base struct of
//! SQLite.
#![expect(unsafe_code, reason = "rusqlite's traits of virtual tables are unsafe; see the safety comments")]

use std::borrow::Cow;
use std::cell::OnceCell;
use std::ffi::{CStr, c_int};
use std::marker::PhantomData;
use std::ops::Range;
use std::sync::Arc;

use rusqlite::ffi;
use rusqlite::types::Type;
use rusqlite::vtab::{
    Context, Filters, IndexConstraintOp, IndexInfo, VTab, VTabConfig, VTabConnection, VTabCursor,
};

use super::blocks::{BlockStore, QueryView};
use super::packing::{KindSet, PackedRows};
use super::text_index::{TextIndex, TextIndexes, TextRow};

/// The table-specific properties of a day table. Columns 0 to 2 are always number, day and kind.
pub(super) trait DayTableDefinition: Send + Sync + Sized + 'static {
    type Day: PackedRows;
    /// Unpacked data of a day.
    type Unpacked: Default;
    const DECLARATION: &'static CStr;
    /// Names of the row kinds, in ascending order.
    const KINDS: &'static [&'static str];

    fn days(store: &BlockStore) -> &[Arc<Self::Day>];
    fn unpack(day: &Self::Day, kinds: KindSet) -> Self::Unpacked;
    /// Returns the kind of the row at a position, as an index into `KINDS`.
    fn kind(day: &Self::Day, place: u64) -> usize;
    /// Index of the text column, which is the last column.
    const TEXT_COLUMN: c_int;
    fn text<'a>(row: &DayRow<'a, Self>) -> Cow<'a, str>;
    fn texts(query_view: &QueryView) -> &TextIndexes;
    /// Sets the result to the value of a table-specific column, which is a column after the third and before the last.
    fn column(_: &DayRow<'_, Self>, _: c_int, _: &mut Context) -> rusqlite::Result<()> {
        Ok(())
    }
    /// Returns the kinds whose rows can satisfy a comparison of a table-specific column. Returns all kinds if the
    /// comparison does not restrict kinds.
    fn matching_kinds(_column: c_int, _comparison: Comparison, _value: f64) -> KindSet {
        KindSet::MAX
    }
}

/// The row whose columns SQLite reads.
pub(super) struct DayRow<'a, K: DayTableDefinition> {
    pub store: &'a BlockStore,
    pub day: &'a K::Day,
    pub unpacked: &'a K::Unpacked,
    pub place: u64,
}

const NUMBER_COLUMN: c_int = 0;
const DAY_COLUMN: c_int = 1;
const KIND_COLUMN: c_int = 2;
/// Column number by which SQLite refers to the rowid.
const ROWID_COLUMN: c_int = -1;

/// A comparison operator of SQL.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Comparison {
    Equal,
    Greater,
    AtLeast,
    Less,
    AtMost,
}

impl Comparison {
    const ALL: [(Comparison, char); 5] = [
        (Comparison::Equal, '='),
        (Comparison::Greater, '>'),
        (Comparison::AtLeast, 'g'),
        (Comparison::Less, '<'),
        (Comparison::AtMost, 'l'),
    ];

    fn from_operator(operator: &IndexConstraintOp) -> Option<Comparison> {
        Some(match operator {
            IndexConstraintOp::SQLITE_INDEX_CONSTRAINT_EQ => Comparison::Equal,
            IndexConstraintOp::SQLITE_INDEX_CONSTRAINT_GT => Comparison::Greater,
            IndexConstraintOp::SQLITE_INDEX_CONSTRAINT_GE => Comparison::AtLeast,
            IndexConstraintOp::SQLITE_INDEX_CONSTRAINT_LT => Comparison::Less,
            IndexConstraintOp::SQLITE_INDEX_CONSTRAINT_LE => Comparison::AtMost,
            _ => return None,
        })
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct HandledConstraint {
    column: c_int,
    comparison: Comparison,
}

impl HandledConstraint {
    fn from_constraint(
        column: c_int,
        operator: &IndexConstraintOp,
        text: c_int,
    ) -> Option<HandledConstraint> {
        let comparison = Comparison::from_operator(operator)?;
        let column = if column == ROWID_COLUMN { NUMBER_COLUMN } else { column };
        let useful = !(column == text || matches!(column, NUMBER_COLUMN | KIND_COLUMN))
            || comparison == Comparison::Equal;
        (useful && (0..10).contains(&column)).then_some(HandledConstraint { column, comparison })
    }

    /// Returns the two characters that represent this constraint in the index string.
    fn encode(self) -> String {
        let letter = Comparison::ALL.iter().find(|(comparison, _)| *comparison == self.comparison);
        format!("{}{}", self.column, letter.map_or('=', |(_, letter)| *letter))
    }

    fn decode(pair: &[u8]) -> Option<HandledConstraint> {
        let &[column, letter] = pair else { return None };
        let comparison = Comparison::ALL.iter().find(|(_, character)| *character == char::from(letter))?.0;
        Some(HandledConstraint { column: c_int::from(column.wrapping_sub(b'0')), comparison })
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum RowOrder {
    /// Order by row number, which is also the order of days.
    Number,
    /// Order by kind, then by day.
    ByKind,
    /// Order by day, then by kind.
    DayAndKind,
}

impl RowOrder {
    /// Returns the order for sorting by a list of columns, or `None` if the table does not support this order.
    fn for_columns(columns: &[c_int]) -> Option<RowOrder> {
        match columns {
            [NUMBER_COLUMN | ROWID_COLUMN, ..]
            | [DAY_COLUMN]
            | [DAY_COLUMN, NUMBER_COLUMN | ROWID_COLUMN, ..] => Some(RowOrder::Number),
            [KIND_COLUMN]
            | [KIND_COLUMN, DAY_COLUMN]
            | [KIND_COLUMN, NUMBER_COLUMN | ROWID_COLUMN, ..]
            | [KIND_COLUMN, DAY_COLUMN, NUMBER_COLUMN | ROWID_COLUMN, ..] => Some(RowOrder::ByKind),
            [DAY_COLUMN, KIND_COLUMN] | [DAY_COLUMN, KIND_COLUMN, NUMBER_COLUMN | ROWID_COLUMN, ..] => {
                Some(RowOrder::DayAndKind)
            }
            _ => None,
        }
    }
}

#[repr(C)]
pub(super) struct DayTable<K: DayTableDefinition> {
    /// Base struct of SQLite; must be the first field.
    base: ffi::sqlite3_vtab,
    query_view: Arc<QueryView>,
    kind: PhantomData<K>,
}

// SAFETY: the struct is `repr(C)` and starts with `sqlite3_vtab`, as the trait requires.
unsafe impl<'vtab, K: DayTableDefinition> VTab<'vtab> for DayTable<K> {
    type Aux = Arc<QueryView>;
    type Cursor = DayCursor<'vtab, K>;

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
        let table = DayTable { base: ffi::sqlite3_vtab::default(), query_view, kind: PhantomData };
        Ok((Cow::Borrowed(K::DECLARATION), table))
    }

    fn best_index(&self, info: &mut IndexInfo) -> rusqlite::Result<bool> {
        let usable = info.constraints().enumerate().filter(|(_, constraint)| constraint.is_usable());
        let is_text = |handled_constraint: &HandledConstraint| {
            handled_constraint.column == KIND_COLUMN || handled_constraint.column == K::TEXT_COLUMN
        };
        let handled: Vec<(usize, HandledConstraint)> = usable
            .filter_map(|(at, constraint)| {
                Some((
                    at,
                    HandledConstraint::from_constraint(
                        constraint.column(),
                        &constraint.operator(),
                        K::TEXT_COLUMN,
                    )?,
                ))
            })
            // The table compares texts byte by byte, so it cannot check a constraint with another collation, such as
            // NOCASE.
            .filter(|(at, constraint)| {
                !is_text(constraint) || info.collation(*at).is_ok_and(|text| text == "BINARY")
            })
            .collect();
        for (argument, (at, constraint)) in (1..).zip(&handled) {
            let mut usage = info.constraint_usage(*at);
            usage.set_argv_index(argument);
            // The table checks equality of days and kinds exactly for values of every type. SQLite checks all other
            // constraints again.
            usage.set_omit(
                constraint.comparison == Comparison::Equal
                    && matches!(constraint.column, DAY_COLUMN | KIND_COLUMN),
            );
        }
        let columns: Option<Vec<c_int>> =
            info.order_bys().map(|order| (!order.is_order_by_desc()).then(|| order.column())).collect();
        let order =
            columns.filter(|columns| !columns.is_empty()).and_then(|columns| RowOrder::for_columns(&columns));
        info.set_order_by_consumed(order.is_some());
        let share = |column: c_int, equal_share: f64, other_share: f64| {
            let constraints = handled.iter().filter(|(_, constraint)| constraint.column == column);
            constraints
                .map(
                    |(_, constraint)| {
                        if constraint.comparison == Comparison::Equal { equal_share } else { other_share }
                    },
                )
                .fold(1.0, f64::min)
        };
        let rows = 1e6
            * share(NUMBER_COLUMN, 1e-6, 1.0)
            * share(DAY_COLUMN, 0.002, 0.3)
            * share(KIND_COLUMN, 0.3, 1.0)
            * share(K::TEXT_COLUMN, 1e-5, 1.0);
        info.set_estimated_cost(rows);
        info.set_estimated_rows(rows as i64);
        info.set_idx_num(order.unwrap_or(RowOrder::Number) as c_int);
        info.set_idx_str(&handled.iter().map(|(_, constraint)| constraint.encode()).collect::<String>());
        Ok(true)
    }

    fn open(&mut self) -> rusqlite::Result<DayCursor<'_, K>> {
        Ok(DayCursor {
            base: ffi::sqlite3_vtab_cursor::default(),
            store: self.query_view.store(),
            query_view: self.query_view.clone(),
            passes: Vec::new(),
            pass: 0,
            place: 0,
            unpacked: Vec::new(),
            row_number_filter: None,
            indexed_rows: None,
            table: PhantomData,
        })
    }
}

#[derive(Debug, Clone, Copy)]
struct ScanPass {
    /// Index of the day in the store.
    day: usize,
    kinds: KindSet,
}

impl ScanPass {
    /// Returns whether the row at a position has one of the kinds of this pass.
    fn contains(self, day: &impl PackedRows, place: u64) -> bool {
        day.next_of_kinds(self.kinds, place) == Some(place)
    }
}

#[repr(C)]
pub(super) struct DayCursor<'vtab, K: DayTableDefinition> {
    /// Base struct of SQLite; must be the first field.
    base: ffi::sqlite3_vtab_cursor,
    store: BlockStore,
    query_view: Arc<QueryView>,
    passes: Vec<ScanPass>,
    pass: usize,
    place: u64,
    /// Unpacked data of each requested day. All days are kept because the rows of an index can be on any day.
    unpacked: Vec<OnceCell<K::Unpacked>>,
    /// Requested row number, if the query requests a single row.
    row_number_filter: Option<f64>,
    /// Remaining rows of a text index. The day of such a row is an index into `passes`.
    indexed_rows: Option<(Arc<TextIndex>, Range<usize>)>,
    table: PhantomData<&'vtab DayTable<K>>,
}

impl<K: DayTableDefinition> DayCursor<'_, K> {
    fn day(&self) -> Option<&K::Day> {
        self.passes.get(self.pass).map(|pass| &*K::days(&self.store)[pass.day])
    }

    /// Advances to the first requested row at or after the current position.
    fn advance_to_match(&mut self) {
        if let Some((index, rest)) = &mut self.indexed_rows {
            let mut rows = rest.map(|at| index.row(at)).map(|row| (row.day as usize, u64::from(row.place)));
            let days = K::days(&self.store);
            let next = rows.find(|(pass, place)| {
                let pass = self.passes[*pass];
                pass.contains(&*days[pass.day], *place)
            });
            (self.pass, self.place) = next.unwrap_or((self.passes.len(), 0));
            return;
        }
        while let Some(pass) = self.passes.get(self.pass) {
            let day = &K::days(&self.store)[pass.day];
            let next = match self.row_number_filter {
                Some(number) => {
                    let place = number - day.first() as f64;
                    let is_here =
                        place.fract() == 0.0 && place >= self.place as f64 && place < day.len() as f64;
                    is_here.then_some(place as u64).filter(|place| pass.contains(&**day, *place))
                }
                None => day.next_of_kinds(pass.kinds, self.place),
            };
            if let Some(next) = next {
                self.place = next;
                return;
            }
            if let Some(left) = self.unpacked.get_mut(pass.day) {
                left.take();
            }
            (self.pass, self.place) = (self.pass + 1, 0);
        }
    }

    fn row_at(&self, day: usize, place: u64, kinds: KindSet) -> Option<DayRow<'_, K>> {
        let packed_day = &*K::days(&self.store)[day];
        let unpacked = self.unpacked.get(day)?.get_or_init(|| K::unpack(packed_day, kinds));
        Some(DayRow { store: &self.store, day: packed_day, unpacked, place })
    }

    /// Returns the kinds that must be unpacked to read the rows of a pass.
    fn kinds_to_read(&self, pass: &ScanPass) -> KindSet {
        if self.indexed_rows.is_some() { KindSet::MAX } else { pass.kinds }
    }

    /// Returns every row of a range of days with the hash of its text.
    fn text_rows(&self, days: Range<usize>) -> Vec<TextRow> {
        let rows = |day: usize| {
            let row =
                move |place| self.row_at(day, place, KindSet::MAX).map(|row| (day, place, K::text(&row)));
            (0..K::days(&self.store)[day].len()).filter_map(row)
        };
        let first = days.start;
        days.flat_map(rows).map(|(day, place, text)| TextRow::new(&text, day - first, place)).collect()
    }

    /// Returns the passes that scan a range of days for these kinds in this order.
    fn plan_passes(&self, days: [f64; 2], kinds: KindSet, order: RowOrder) -> Vec<ScanPass> {
        let all = K::days(&self.store);
        let end = all.partition_point(|day| f64::from(day.day()) <= days[1]);
        let days = all.partition_point(|day| f64::from(day.day()) < days[0]).min(end)..end;
        let single = || (0..K::KINDS.len()).map(|at| 1 << at).filter(move |bit| kinds & bit != 0);
        match order {
            // A request for a single row needs only one pass, in any row order.
            _ if self.row_number_filter.is_some() => days.map(|day| ScanPass { day, kinds }).collect(),
            RowOrder::Number => days.map(|day| ScanPass { day, kinds }).collect(),
            RowOrder::ByKind => {
                single().flat_map(|kinds| days.clone().map(move |day| ScanPass { day, kinds })).collect()
            }
            RowOrder::DayAndKind => {
                days.flat_map(|day| single().map(move |kinds| ScanPass { day, kinds })).collect()
            }
        }
    }
}

// SAFETY: the struct is `repr(C)` and starts with `sqlite3_vtab_cursor`, as the trait requires.
unsafe impl<K: DayTableDefinition> VTabCursor for DayCursor<'_, K> {
    fn filter(
        &mut self,
        order_number: c_int,
        plan: Option<&str>,
        values: &Filters<'_>,
    ) -> rusqlite::Result<()> {
        let (mut days, mut kinds) = ([f64::NEG_INFINITY, f64::INFINITY], KindSet::MAX);
        if self.indexed_rows.is_none() {
            // The unpacked data of the previous scan may lack kinds that this scan requests.
            self.unpacked.clear();
        }
        (self.row_number_filter, self.indexed_rows) = (None, None);
        self.unpacked.resize_with(K::days(&self.store).len(), OnceCell::new);
        let mut wanted_text = None;
        let handled = plan.unwrap_or_default().as_bytes().chunks(2).filter_map(HandledConstraint::decode);
        for ((at, value), HandledConstraint { column, comparison }) in values.iter().enumerate().zip(handled)
        {
            let number = match value.data_type() {
                Type::Text if column == KIND_COLUMN => {
                    let wanted: String = values.get(at)?;
                    // An unknown kind has no rows.
                    kinds &= K::KINDS.iter().position(|kind| *kind == wanted).map_or(0, |at| 1 << at);
                    continue;
                }
                Type::Text if column == K::TEXT_COLUMN => {
                    wanted_text = Some(values.get::<String>(at)?);
                    continue;
                }
                Type::Text if column != KIND_COLUMN => comparison_number(&values.get::<String>(at)?),
                // Blobs are greater than every number.
                Type::Blob if column != KIND_COLUMN && column != K::TEXT_COLUMN => f64::INFINITY,
                Type::Integer | Type::Real if column != KIND_COLUMN && column != K::TEXT_COLUMN => {
                    values.get::<f64>(at)?
                }
                // A comparison with NULL is never true.
                Type::Null => f64::NAN,
                // The kind column contains text, so no number is equal to a kind.
                _ if column == KIND_COLUMN => f64::NAN,
                _ => continue,
            };
            if number.is_nan() {
                days[1] = f64::NEG_INFINITY;
            }
            match (column, comparison) {
                (NUMBER_COLUMN, _) => self.row_number_filter = Some(number),
                (DAY_COLUMN, Comparison::Equal) => days = [days[0].max(number), days[1].min(number)],
                (DAY_COLUMN, Comparison::Greater | Comparison::AtLeast) => days[0] = days[0].max(number),
                (DAY_COLUMN, _) => days[1] = days[1].min(number),
                _ => kinds &= K::matching_kinds(column, comparison, number),
            }
        }
        let order = [RowOrder::Number, RowOrder::ByKind, RowOrder::DayAndKind];
        let order = order.into_iter().find(|row_order| *row_order as c_int == order_number);
        let order = order.unwrap_or(RowOrder::Number);
        self.passes = self.plan_passes(days, kinds, order);
        (self.pass, self.place) = (0, 0);
        if let (Some(text), RowOrder::Number, Some(first)) = (wanted_text, order, self.passes.first()) {
            let days = first.day..first.day + self.passes.len();
            let rows = K::days(&self.store)[days.clone()].iter().map(|day| day.len()).sum();
            let index = K::texts(&self.query_view).get(&days, rows, || self.text_rows(days.clone()));
            self.indexed_rows = index.map(|index| {
                let rows = index.row_range(&text);
                (index, rows)
            });
        }
        self.advance_to_match();
        Ok(())
    }

    fn next(&mut self) -> rusqlite::Result<()> {
        self.place += 1;
        self.advance_to_match();
        Ok(())
    }

    fn eof(&self) -> bool {
        self.pass >= self.passes.len()
    }

    fn column(&self, context: &mut Context, column: c_int) -> rusqlite::Result<()> {
        let (Some(day), Some(pass)) = (self.day(), self.passes.get(self.pass)) else { return Ok(()) };
        match column {
            NUMBER_COLUMN => context.set_result((day.first() + self.place) as i64),
            DAY_COLUMN => context.set_result(day.day()),
            KIND_COLUMN => context.set_result(K::KINDS[K::kind(day, self.place)]),
            other => match self.row_at(pass.day, self.place, self.kinds_to_read(pass)) {
                Some(row) if other == K::TEXT_COLUMN => context.set_result(&*K::text(&row)),
                Some(row) => K::column(&row, other, context),
                None => Ok(()),
            },
        }
    }

    fn rowid(&self) -> rusqlite::Result<i64> {
        Ok(self.day().map_or(0, |day| (day.first() + self.place) as i64))
    }
}

/// Returns the number to use when a numeric column is compared with `text`: the parsed value, or infinity if the text
/// is not a number.
pub(super) fn comparison_number(text: &str) -> f64 {
    let text = text.trim_matches([' ', '\t', '\n', '\r', '\u{b}', '\u{c}']);
    let is_number = text.bytes().all(|byte| byte.is_ascii_digit() || b"+-.eE".contains(&byte));
    text.parse().ok().filter(|_| is_number).unwrap_or(f64::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::super::notices::{Inbox, LEAD_LOST_INDEX, NoticeDay, RepeatedLoss};
    use super::super::packed_tables::register;
    use super::*;
    use novamind_world::events::LossCause;
    use rusqlite::Connection;

    /// Returns a connection to five days of notices: three types, losses that repeat from day 2 on, and a tool call on
    /// day 3.
    fn connection() -> Connection {
        let losses =
            (0..3).map(|at| RepeatedLoss { customer: 10 + at, message_day: 1, cause: LossCause::Silence });
        let (mut days, mut first) = (Vec::new(), 1);
        for number in 1..=5u32 {
            let mut day = NoticeDay::new(number, first);
            day.push(6, &format!("R&D of day {number}"));
            day.push(LEAD_LOST_INDEX, "lost");
            day.push(0, "won");
            day.set_repeats(number.saturating_sub(1).min(3));
            if number == 3 {
                day.push(5, "found");
            }
            first += day.len();
            days.push(Arc::new(day));
        }
        let inbox = Inbox { days: Arc::new(days), losses: Arc::new(losses.collect()) };
        let query_view = Arc::new(QueryView::default());
        query_view.set_store(BlockStore { inbox, ..BlockStore::default() });
        let connection = Connection::open_in_memory().expect("memory");
        register(&connection, &query_view).expect("a module");
        connection
    }

    #[test]
    fn queries_return_what_an_ordinary_table_returns() {
        let connection = connection();
        connection
            .execute_batch(
                "CREATE TEMP TABLE plain(notification_id INTEGER PRIMARY KEY, day INTEGER, type TEXT, message TEXT);
                 INSERT INTO plain SELECT * FROM notifications",
            )
            .expect("a copy");
        let count: i64 =
            connection.query_row("SELECT count(*) FROM plain", [], |row| row.get(0)).expect("rows");
        assert_eq!(
            count,
            15 + 1 + 2 + 3 + 3 + 1,
            "notices of the days, repeated ones of days 2 to 5, a call"
        );
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
            "message = 'lost'",
            "message = 'lost' AND type = 'deal_won'",
            "message = 'LOST' COLLATE NOCASE",
            "message = 7",
            "type = 'LEAD_LOST' COLLATE NOCASE",
            "type = x'00'",
            "type = 'deal_won' AND rowid = 3",
            "type = 'deal_won' AND rowid = 4",
            "day = '3x'",
            "day < 'x'",
            "day > x'00'",
            "day = x'00'",
            "day >= ' 2 '",
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
    fn count_by_type_or_day_needs_no_sort() {
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
    fn repeated_loss_shows_its_reason() {
        let sql = "SELECT message FROM notifications WHERE day = 2 AND message LIKE 'Customer%'";
        let text: String = connection().query_row(sql, [], |row| row.get(0)).expect("a row");
        assert_eq!(
            text,
            "Customer 10 did not answer our offer of day 1. The lead is lost; this repeats daily."
        );
    }

    #[test]
    fn day_tables_are_read_only() {
        assert!(connection().execute("DELETE FROM notifications", []).is_err());
    }
}
