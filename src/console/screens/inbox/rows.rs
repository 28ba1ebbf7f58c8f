//! The list of threads: its columns, and a thread as a row.

use super::View;
use super::model::{State, Thread};
use super::offer::in_words;
use crate::console::theme::Role;
use crate::console::widgets::{Cell, Column};
use crate::notation::grouped;

/// Columns of the list.
pub(super) fn columns(view: View) -> Vec<Column> {
    let day = if view == View::Waiting { "left" } else { "since" };
    vec![
        Column::words("✓"),
        Column::numbers(day),
        Column::numbers("company"),
        Column::words("group"),
        Column::words("kind"),
        Column::numbers("seats"),
        Column::numbers("they ask"),
        Column::words(if view == View::Over { "end" } else { "you offered" }).at_most(34),
    ]
}

/// A thread in the list.
pub(super) fn row_of(thread: &Thread, marked: bool) -> Vec<Cell> {
    let day = match (thread.state, thread.turns.last()) {
        (State::Waiting(left), _) => {
            let (mark, role) = match left {
                0..=2 => ("! ", Role::Bad),
                3..=5 => ("", Role::Warning),
                _ => ("", Role::Text),
            };
            Cell::number(f64::from(left), format!("{mark}{left} d")).role(role)
        }
        (_, Some(turn)) => Cell::number(f64::from(turn.day), format!("day {}", turn.day)).role(Role::Dim),
        (_, None) => Cell::words("–").role(Role::Dim),
    };
    let asked = match thread.asked() {
        Some((plan, price)) => {
            let plan = plan.map_or(String::new(), |plan| format!("{plan} "));
            Cell::number(price, format!("{plan}${}", grouped(price, 2)))
        }
        None => Cell::words("–").role(Role::Dim),
    };
    let end = match thread.state {
        state if !state.is_open() => {
            let role = if state == State::Accepted { Role::Good } else { Role::Dim };
            Cell::words(state.words()).role(role)
        }
        _ if thread.offered().is_empty() => Cell::words("–").role(Role::Dim),
        _ => Cell::words(in_words(thread.offered())),
    };
    vec![
        Cell::words(if marked { "●" } else { "" }).role(Role::Changed),
        day,
        Cell::number(f64::from(thread.customer), format!("#{}", thread.customer)),
        Cell::words(&thread.group).role(Role::Strong),
        Cell::words(thread.kind_in_words()),
        Cell::number(thread.seats, grouped(thread.seats, 0)),
        asked,
        end,
    ]
}
