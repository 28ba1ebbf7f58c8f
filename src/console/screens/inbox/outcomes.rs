//! Outcomes of new leads by week and first offer, from the library query.

use ratatui::layout::Rect;

use super::{Inbox, InboxPane};
use crate::action::{Action, Scope};
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_base::notation::grouped;
use novamind_database::{Rows, number_at, text_at};
use novamind_tui::canvas::Canvas;
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{Cell, Column, Table};
use novamind_worker::readings::Reading;

/// Readings that the screen needs while outcomes are shown.
pub const READINGS: [Reading; 5] = [
    Reading::EnterpriseTurns,
    Reading::Companies,
    Reading::Usage,
    Reading::LastLetters,
    Reading::FirstOffers,
];

/// A row of the query: first offers of one week to a group, with the same plans and a first price in the same
/// band.
#[derive(Debug, Clone, PartialEq)]
struct FirstOffers {
    group: String,
    plan: String,
    /// Lower bound in whole $ per seat and month, inclusive.
    price_from: f64,
    /// Upper bound, exclusive.
    price_below: f64,
    week: f64,
    threads: f64,
    signed: f64,
    lost: f64,
    waiting: f64,
    signed_percent: f64,
}

#[derive(Debug, Clone, Default)]
pub struct Outcomes {
    /// `None` until the result arrives.
    found: Option<Vec<FirstOffers>>,
    table: Table,
}

impl Outcomes {
    pub fn take(&mut self, rows: &Rows) {
        let found: Vec<FirstOffers> = rows.rows.iter().map(|row| outcome_of(row)).collect();
        self.table.set(columns(), found.iter().map(row_of).collect());
        self.found = Some(found);
    }

    fn here(&self) -> Option<&FirstOffers> {
        self.found.as_ref()?.get(self.table.selected()?)
    }
}

fn outcome_of(row: &[novamind_database::Cell]) -> FirstOffers {
    let number = |at| number_at(row, at);
    FirstOffers {
        group: text_at(row, 0).to_owned(),
        plan: text_at(row, 1).to_owned(),
        price_from: number(2),
        price_below: number(3),
        week: number(4),
        threads: number(5),
        signed: number(6),
        lost: number(7),
        waiting: number(8),
        signed_percent: number(9),
    }
}

/// Returns the columns; narrow windows drop the last ones.
fn columns() -> Vec<Column> {
    let mut columns = vec![Column::numbers("week"), Column::words("group"), Column::words("plan")];
    let numbers = ["$/seat", "threads", "signed", "share", "lost", "waiting"];
    columns.extend(numbers.map(Column::numbers));
    columns
}

fn row_of(own: &FirstOffers) -> Vec<Cell> {
    let count = |value: f64| Cell::number(value, grouped(value, 0));
    let prices = format!("{}–{}", grouped(own.price_from, 0), grouped(own.price_below - 0.01, 2));
    vec![
        count(own.week),
        Cell::words(&own.group).role(Role::Strong),
        Cell::words(&own.plan),
        Cell::number(own.price_from, prices),
        count(own.threads),
        count(own.signed),
        Cell::number(own.signed_percent, format!("{} %", grouped(own.signed_percent, 1))),
        count(own.lost),
        count(own.waiting),
    ]
}

/// Selects the threads of a row, oldest first.
fn statement(own: &FirstOffers) -> String {
    let FirstOffers { group, plan, price_from, price_below, week, .. } = own;
    format!(
        "SELECT t.thread_id, t.customer_id, t.day, t.offer_json, s.status,\n    EXISTS (\n        SELECT 1 FROM \
         enterprise_turns e WHERE e.thread_id = t.thread_id AND e.close_reason = 'accepted'\n    ) AS is_signed\n\
         FROM enterprise_turns t\nJOIN subscriptions s ON s.customer_id = t.customer_id\n\
         JOIN customers c ON c.customer_id = t.customer_id\n\
         WHERE t.thread_type = 'new_lead' AND t.turn_number = 1 AND t.sender = 'agent'\n    \
         AND c.group_id = '{group}' AND t.day / 7 + 1 = {week}\n    \
         AND json_extract(t.offer_json, '$[0].plan') || coalesce('+' || json_extract(t.offer_json, '$[1].plan'), '')\n        \
         || coalesce('+' || json_extract(t.offer_json, '$[2].plan'), '') = '{plan}'\n    \
         AND json_extract(t.offer_json, '$[0].price_per_seat') >= {price_from}\n    \
         AND json_extract(t.offer_json, '$[0].price_per_seat') < {price_below}\nORDER BY t.message_id"
    )
}

impl Inbox {
    /// Returns the pane in place of the list.
    pub(super) fn first_pane(&self) -> InboxPane {
        if self.outcomes.is_some() { InboxPane::Outcomes } else { InboxPane::List }
    }

    pub(super) fn close_outcomes(&mut self) {
        self.outcomes = None;
        self.focus = InboxPane::List;
    }

    /// Opens or closes the outcomes; returns `None` for unrelated actions.
    pub(super) fn turn_outcomes(&mut self, action: Action) -> Option<Vec<Effect>> {
        match (action, &self.outcomes) {
            (Action::InboxOutcomes, None) => {
                self.outcomes = Some(Outcomes::default());
                self.focus = InboxPane::Outcomes;
                return Some(vec![Effect::Read(Reading::FirstOffers)]);
            }
            (Action::InboxOutcomes | Action::OtherThreads, Some(_)) => self.close_outcomes(),
            // Marking needs the visible list.
            (Action::Mark | Action::MarkAll, Some(_)) => {
                return Some(vec![Effect::Complain("Close the outcomes (esc) to mark threads".to_owned())]);
            }
            _ => return None,
        }
        Some(Vec::new())
    }
}

pub struct OutcomesPane;

impl Pane<Inbox> for OutcomesPane {
    fn table<'a>(&self, inbox: &'a Inbox) -> Option<&'a Table> {
        inbox.outcomes.as_ref().map(|own| &own.table)
    }

    fn table_mut<'a>(&self, inbox: &'a mut Inbox) -> Option<&'a mut Table> {
        inbox.outcomes.as_mut().map(|own| &mut own.table)
    }

    fn scopes(&self, inbox: &Inbox) -> Vec<Scope> {
        match self.table(inbox).is_some_and(Table::is_typing) {
            true => vec![Scope::Field, Scope::List],
            false => vec![Scope::Inbox, Scope::List],
        }
    }

    fn hints(&self, inbox: &Inbox) -> Vec<Action> {
        if self.table(inbox).is_some_and(Table::is_typing) {
            return vec![Action::Commit, Action::Discard];
        }
        vec![Action::Open, Action::Rows, Action::Filter, Action::Sort, Action::Close]
    }

    fn figure(&self, inbox: &Inbox, _: &Look<'_>) -> Option<Figure> {
        let own = inbox.outcomes.as_ref()?.here()?;
        let title =
            format!("threads of {} with a first offer of {} in week {}", own.group, own.plan, own.week);
        Some(Figure { title, term: "offer", sql: Some(statement(own)), why: None })
    }

    fn act(&self, inbox: &mut Inbox, action: Action, look: &Look<'_>) -> Vec<Effect> {
        if action == Action::Open {
            return vec![Effect::RunSql(Reading::FirstOffers.sql().to_owned())];
        }
        let done = self.table_mut(inbox).is_some_and(|table| table.act(action, look.page));
        if action == Action::Close && !done {
            inbox.close_outcomes();
        }
        Vec::new()
    }

    fn border(&self, inbox: &Inbox, area: Rect, look: &Look<'_>) -> Border {
        let title = match area.width {
            ..72 => "By first offer and week",
            _ => "Outcome by first offer and week",
        };
        let note = match inbox.outcomes.as_ref().map(|own| own.table.note()) {
            Some(note) if !note.is_empty() => note,
            _ => "new leads".to_owned(),
        };
        let keys = look.hints(&[Action::Open, Action::Rows, Action::Filter, Action::Close]);
        Border { title: title.to_owned(), note, keys, ..Border::default() }
    }

    fn draw(&self, inbox: &Inbox, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        let Some(own) = &inbox.outcomes else { return };
        let text = match own.found.as_deref() {
            None => "reading …".to_owned(),
            Some([]) => {
                let send = look.keys.label(Action::SendOffer).unwrap_or_default();
                format!(
                    "No new lead has been sent an offer yet. Send one with {send} in the list of threads."
                )
            }
            Some(_) => return own.table.draw(canvas, seat.area, seat.focused, seat.number),
        };
        let lines = wrapped(&text, seat.area.width as usize);
        for (row, line) in novamind_tui::canvas::rows_of(seat.area).zip(lines) {
            canvas.text(row, &line, Role::Dim);
        }
    }
}
