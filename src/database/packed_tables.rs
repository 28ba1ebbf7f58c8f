//! The columns of the tables `ledger` and `notifications` over packed days.

use std::borrow::Cow;
use std::ffi::{CStr, c_int};
use std::sync::Arc;

use rusqlite::Connection;
use rusqlite::vtab::{Context, Module};

use super::blocks::{BlockStore, QueryView};
use super::day_table::{Comparison, DayRow, DayTable, DayTableDefinition};
use super::ledger::{
    CATEGORIES, INCOME_CATEGORIES, LEAD_COST_CATEGORY, LeadsAndPayments, LedgerDay, LedgerRow,
    PAYMENT_CATEGORY, lead_note, payment_note,
};
use super::notices::{LEAD_LOST_INDEX, NOTICE_TYPES, NoticeDay, NoticeSlot};
use super::packing::KindSet;
use super::text_index::TextIndexes;

/// Registers the tables `ledger` and `notifications` on a connection.
pub(super) fn register(connection: &Connection, query_view: &Arc<QueryView>) -> rusqlite::Result<()> {
    const NOTICES: Module<'static, DayTable<Notifications>> = Module::eponymous_only_module();
    const LEDGER: Module<'static, DayTable<Ledger>> = Module::eponymous_only_module();
    connection.create_module(c"notifications", &NOTICES, Some(query_view.clone()))?;
    connection.create_module(c"ledger", &LEDGER, Some(query_view.clone()))
}

/// Definition of the table `ledger`.
pub(super) struct Ledger;

const AMOUNT_COLUMN: c_int = 3;

impl DayTableDefinition for Ledger {
    type Day = LedgerDay;
    type Unpacked = LeadsAndPayments;
    const DECLARATION: &'static CStr =
        c"CREATE TABLE x(id INTEGER NOT NULL, day INTEGER NOT NULL, category TEXT NOT NULL, amount REAL NOT NULL,
        note TEXT)";
    const KINDS: &'static [&'static str] = &CATEGORIES;

    fn days(store: &BlockStore) -> &[Arc<LedgerDay>] {
        &store.ledger
    }

    fn unpack(day: &LedgerDay, kinds: KindSet) -> LeadsAndPayments {
        match kinds & (1 << LEAD_COST_CATEGORY | 1 << PAYMENT_CATEGORY) {
            0 => LeadsAndPayments::default(),
            _ => LeadsAndPayments::unpack(&day.packed).unwrap_or_default(),
        }
    }

    fn kind(day: &LedgerDay, place: u64) -> usize {
        match day.entry_at(place) {
            LedgerRow::Lead(_) => LEAD_COST_CATEGORY,
            LedgerRow::Payment(_) => PAYMENT_CATEGORY,
            LedgerRow::Other(other_entry) => other_entry.category.into(),
        }
    }

    const TEXT_COLUMN: c_int = 4;

    fn text<'a>(row: &DayRow<'a, Self>) -> Cow<'a, str> {
        let LeadsAndPayments { leads, payments } = row.unpacked;
        match row.day.entry_at(row.place) {
            LedgerRow::Lead(at) => lead_note(leads[at]).into(),
            LedgerRow::Payment(at) => payment_note(payments[at].0).into(),
            LedgerRow::Other(other_entry) => other_entry.note.as_str().into(),
        }
    }

    fn texts(query_view: &QueryView) -> &TextIndexes {
        &query_view.ledger_notes
    }

    fn column(row: &DayRow<'_, Self>, _: c_int, context: &mut Context) -> rusqlite::Result<()> {
        context.set_result(match row.day.entry_at(row.place) {
            LedgerRow::Lead(_) => row.day.lead_cost,
            LedgerRow::Payment(at) => row.unpacked.payments[at].1,
            LedgerRow::Other(other_entry) => other_entry.amount,
        })
    }

    fn matching_kinds(column: c_int, comparison: Comparison, value: f64) -> KindSet {
        match comparison {
            _ if column != AMOUNT_COLUMN => KindSet::MAX,
            Comparison::Less if value <= 0.0 => !INCOME_CATEGORIES,
            Comparison::AtMost | Comparison::Equal if value < 0.0 => !INCOME_CATEGORIES,
            Comparison::Greater if value >= 0.0 => INCOME_CATEGORIES,
            Comparison::AtLeast | Comparison::Equal if value > 0.0 => INCOME_CATEGORIES,
            _ => KindSet::MAX,
        }
    }
}

/// Definition of the table `notifications`.
pub(super) struct Notifications;

impl DayTableDefinition for Notifications {
    type Day = NoticeDay;
    type Unpacked = ();
    const DECLARATION: &'static CStr =
        c"CREATE TABLE x(notification_id INTEGER NOT NULL, day INTEGER NOT NULL, type TEXT NOT NULL,
        message TEXT)";
    const KINDS: &'static [&'static str] = &NOTICE_TYPES;

    fn days(store: &BlockStore) -> &[Arc<NoticeDay>] {
        &store.inbox.days
    }

    fn unpack(_: &NoticeDay, _: KindSet) {}

    fn kind(day: &NoticeDay, place: u64) -> usize {
        match day.notice_at(place) {
            NoticeSlot::Stored(at) => usize::from(day.type_at(at)),
            NoticeSlot::Repeated(_) => usize::from(LEAD_LOST_INDEX),
        }
    }

    const TEXT_COLUMN: c_int = 3;

    fn text<'a>(row: &DayRow<'a, Self>) -> Cow<'a, str> {
        match row.day.notice_at(row.place) {
            NoticeSlot::Stored(at) => row.day.text_at(at).into(),
            NoticeSlot::Repeated(at) => row.store.inbox.losses[at].text().into(),
        }
    }

    fn texts(query_view: &QueryView) -> &TextIndexes {
        &query_view.notice_texts
    }
}
