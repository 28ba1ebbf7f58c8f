//! The columns of the tables `ledger` and `notifications` over packed days.

use std::borrow::Cow;
use std::ffi::{CStr, c_int};
use std::sync::Arc;

use rusqlite::Connection;
use rusqlite::vtab::{Context, Module};

use super::blocks::{BlockStore, Seen};
use super::by_text::TextIndexes;
use super::day_table::{Comparison, DayKind, DayTable, RowAt};
use super::ledger::{
    CATEGORIES, INCOME, LEADS, LedgerDay, Movement, Movements, PAYMENTS, lead_note, payment_note,
};
use super::notices::{LEAD_LOST, NoticeDay, Place, TYPES};
use super::packing::Kinds;

/// Registers both tables on a connection.
pub(super) fn register(connection: &Connection, seen: &Arc<Seen>) -> rusqlite::Result<()> {
    const NOTICES: Module<'static, DayTable<Notifications>> = Module::eponymous_only_module();
    const LEDGER: Module<'static, DayTable<Ledger>> = Module::eponymous_only_module();
    connection.create_module(c"notifications", &NOTICES, Some(seen.clone()))?;
    connection.create_module(c"ledger", &LEDGER, Some(seen.clone()))
}

/// The table `ledger`.
pub(super) struct Ledger;

const AMOUNT: c_int = 3;

impl DayKind for Ledger {
    type Day = LedgerDay;
    type Unpacked = Movements;
    const DECLARATION: &'static CStr =
        c"CREATE TABLE x(id INTEGER NOT NULL, day INTEGER NOT NULL, category TEXT NOT NULL, amount REAL NOT NULL,
        note TEXT)";
    const KINDS: &'static [&'static str] = &CATEGORIES;

    fn days(store: &BlockStore) -> &[Arc<LedgerDay>] {
        &store.ledger
    }

    fn unpack(day: &LedgerDay, kinds: Kinds) -> Movements {
        match kinds & (1 << LEADS | 1 << PAYMENTS) {
            0 => Movements::default(),
            _ => Movements::unpack(&day.packed).unwrap_or_default(),
        }
    }

    fn kind(day: &LedgerDay, place: u64) -> usize {
        match day.at(place) {
            Movement::Lead(_) => LEADS,
            Movement::Payment(_) => PAYMENTS,
            Movement::Other(own) => own.category.into(),
        }
    }

    const TEXT: c_int = 4;

    fn text<'a>(row: &RowAt<'a, Self>) -> Cow<'a, str> {
        let Movements { leads, payments } = row.unpacked;
        match row.day.at(row.place) {
            Movement::Lead(at) => lead_note(leads[at]).into(),
            Movement::Payment(at) => payment_note(payments[at].0).into(),
            Movement::Other(own) => own.note.as_str().into(),
        }
    }

    fn texts(seen: &Seen) -> &TextIndexes {
        &seen.ledger_notes
    }

    fn column(row: &RowAt<'_, Self>, _: c_int, context: &mut Context) -> rusqlite::Result<()> {
        context.set_result(match row.day.at(row.place) {
            Movement::Lead(_) => row.day.lead_cost,
            Movement::Payment(at) => row.unpacked.payments[at].1,
            Movement::Other(own) => own.amount,
        })
    }

    fn kinds_where(column: c_int, comparison: Comparison, value: f64) -> Kinds {
        match comparison {
            _ if column != AMOUNT => Kinds::MAX,
            Comparison::Less if value <= 0.0 => !INCOME,
            Comparison::AtMost | Comparison::Equal if value < 0.0 => !INCOME,
            Comparison::Greater if value >= 0.0 => INCOME,
            Comparison::AtLeast | Comparison::Equal if value > 0.0 => INCOME,
            _ => Kinds::MAX,
        }
    }
}

/// The table `notifications`.
pub(super) struct Notifications;

impl DayKind for Notifications {
    type Day = NoticeDay;
    type Unpacked = ();
    const DECLARATION: &'static CStr =
        c"CREATE TABLE x(notification_id INTEGER NOT NULL, day INTEGER NOT NULL, type TEXT NOT NULL,
        message TEXT)";
    const KINDS: &'static [&'static str] = &TYPES;

    fn days(store: &BlockStore) -> &[Arc<NoticeDay>] {
        &store.inbox.days
    }

    fn unpack(_: &NoticeDay, _: Kinds) {}

    fn kind(day: &NoticeDay, place: u64) -> usize {
        match day.at(place) {
            Place::Own(at) => usize::from(day.type_at(at)),
            Place::Repeated(_) => usize::from(LEAD_LOST),
        }
    }

    const TEXT: c_int = 3;

    fn text<'a>(row: &RowAt<'a, Self>) -> Cow<'a, str> {
        match row.day.at(row.place) {
            Place::Own(at) => row.day.text_at(at).into(),
            Place::Repeated(at) => row.store.inbox.losses[at].words().into(),
        }
    }

    fn texts(seen: &Seen) -> &TextIndexes {
        &seen.notice_texts
    }
}
