//! Outcomes of new leads by week and first offer, computed by a query of the query library.

use ratatui::layout::Rect;

use super::{Inbox, InboxPane};
use crate::action::{Action, Scope};
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_base::formatting::grouped_number;
use novamind_database::{QueryResult, number_at, text_at};
use novamind_tui::canvas::Canvas;
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{TableCell, TableColumn, Table};
use novamind_worker::screen_queries::Reading;

/// Screen queries whose results the inbox needs while outcomes are shown.
pub const OUTCOME_QUERIES: [Reading; 5] = [
    Reading::EnterpriseTurns,
    Reading::Companies,
    Reading::Usage,
    Reading::LastLetters,
    Reading::FirstOffers,
];

/// First offers that were sent to one group in one week, with the same plans and prices in the same range.
#[derive(Debug, Clone, PartialEq)]
struct FirstOfferOutcome {
    group: String,
    plan: String,
    /// Inclusive lower bound of the price range, in whole $ per seat per month.
    price_from: f64,
    /// Exclusive upper bound of the price range, in whole $ per seat per month.
    price_below: f64,
    week: f64,
    threads: f64,
    deals: f64,
    lost: f64,
    waiting: f64,
    deal_percent: f64,
}

#[derive(Debug, Clone, Default)]
pub struct FirstOfferOutcomes {
    /// Rows of the query result, or `None` until the result arrives.
    rows: Option<Vec<FirstOfferOutcome>>,
    table: Table,
}

impl FirstOfferOutcomes {
    pub fn set_rows(&mut self, rows: &QueryResult) {
        let found: Vec<FirstOfferOutcome> = rows.rows.iter().map(|row| parse_outcome(row)).collect();
        self.table.set_columns_and_rows(columns(), found.iter().map(outcome_row).collect());
        self.rows = Some(found);
    }

    fn selected(&self) -> Option<&FirstOfferOutcome> {
        self.rows.as_ref()?.get(self.table.selected()?)
    }
}

fn parse_outcome(row: &[novamind_database::Cell]) -> FirstOfferOutcome {
    let number = |at| number_at(row, at);
    FirstOfferOutcome {
        group: text_at(row, 0).to_owned(),
        plan: text_at(row, 1).to_owned(),
        price_from: number(2),
        price_below: number(3),
        week: number(4),
        threads: number(5),
        deals: number(6),
        lost: number(7),
        waiting: number(8),
        deal_percent: number(9),
    }
}

/// Returns the columns of the outcomes table. Narrow windows omit the last columns.
fn columns() -> Vec<TableColumn> {
    let mut columns = vec![TableColumn::numeric("week"), TableColumn::text("group"), TableColumn::text("plan")];
    let numbers = ["$/seat", "threads", "signed", "share", "lost", "waiting"];
    columns.extend(numbers.map(TableColumn::numeric));
    columns
}

fn outcome_row(offer_outcome: &FirstOfferOutcome) -> Vec<TableCell> {
    let count = |value: f64| TableCell::from_number(value, grouped_number(value, 0));
    let prices = format!("{}–{}", grouped_number(offer_outcome.price_from, 0), grouped_number(offer_outcome.price_below - 0.01, 2));
    vec![
        count(offer_outcome.week),
        TableCell::from_text(&offer_outcome.group).with_role(Role::Strong),
        TableCell::from_text(&offer_outcome.plan),
        TableCell::from_number(offer_outcome.price_from, prices),
        count(offer_outcome.threads),
        count(offer_outcome.deals),
        TableCell::from_number(offer_outcome.deal_percent, format!("{} %", grouped_number(offer_outcome.deal_percent, 1))),
        count(offer_outcome.lost),
        count(offer_outcome.waiting),
    ]
}

/// Returns a query for the threads of a row, the oldest first.
fn threads_query(offer_outcome: &FirstOfferOutcome) -> String {
    let FirstOfferOutcome { group, plan, price_from, price_below, week, .. } = offer_outcome;
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
    /// Returns the pane on the left: the outcomes or the list of threads.
    pub(super) fn left_pane(&self) -> InboxPane {
        if self.outcomes.is_some() { InboxPane::Outcomes } else { InboxPane::List }
    }

    pub(super) fn close_outcomes(&mut self) {
        self.outcomes = None;
        self.focus = InboxPane::List;
    }

    /// Handles actions that open, close or conflict with the outcomes. Returns `None` for other actions.
    pub(super) fn handle_outcomes_action(&mut self, action: Action) -> Option<Vec<Effect>> {
        match (action, &self.outcomes) {
            (Action::InboxOutcomes, None) => {
                self.outcomes = Some(FirstOfferOutcomes::default());
                self.focus = InboxPane::Outcomes;
                return Some(vec![Effect::Read(Reading::FirstOffers)]);
            }
            (Action::InboxOutcomes | Action::NextThreadView, Some(_)) => self.close_outcomes(),
            // Threads can be marked only in the list.
            (Action::Mark | Action::MarkAll, Some(_)) => {
                return Some(vec![Effect::ShowError("Close the outcomes (esc) to mark threads".to_owned())]);
            }
            _ => return None,
        }
        Some(Vec::new())
    }
}

pub struct OutcomesPane;

impl Pane<Inbox> for OutcomesPane {
    fn table<'a>(&self, inbox: &'a Inbox) -> Option<&'a Table> {
        inbox.outcomes.as_ref().map(|offer_outcomes| &offer_outcomes.table)
    }

    fn table_name(&self) -> Option<&'static str> {
        Some("inbox.outcomes")
    }

    fn table_mut<'a>(&self, inbox: &'a mut Inbox) -> Option<&'a mut Table> {
        inbox.outcomes.as_mut().map(|offer_outcomes| &mut offer_outcomes.table)
    }

    fn scopes(&self, inbox: &Inbox) -> Vec<Scope> {
        match self.table(inbox).is_some_and(Table::is_filter_open) {
            true => vec![Scope::Field, Scope::List],
            false => vec![Scope::Inbox, Scope::List],
        }
    }

    fn hints(&self, inbox: &Inbox) -> Vec<Action> {
        if self.table(inbox).is_some_and(Table::is_filter_open) {
            return vec![Action::Commit, Action::Discard];
        }
        vec![Action::Open, Action::Rows, Action::Filter, Action::Sort, Action::Close]
    }

    fn figure(&self, inbox: &Inbox, _: &ScreenContext<'_>) -> Option<Figure> {
        let offer_outcome = inbox.outcomes.as_ref()?.selected()?;
        let title =
            format!("threads of {} with a first offer of {} in week {}", offer_outcome.group, offer_outcome.plan, offer_outcome.week);
        Some(Figure { title, term: "offer", sql: Some(threads_query(offer_outcome)), week_quantity: None })
    }

    fn handle_action(&self, inbox: &mut Inbox, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        if action == Action::Open {
            return vec![Effect::RunSql(Reading::FirstOffers.sql().to_owned())];
        }
        let done = self.table_mut(inbox).is_some_and(|table| table.handle_action(action, context.page_rows));
        if action == Action::Close && !done {
            inbox.close_outcomes();
        }
        Vec::new()
    }

    fn border(&self, inbox: &Inbox, area: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let title = match area.width {
            ..72 => "By first offer and week",
            _ => "Outcome by first offer and week",
        };
        let note = match inbox.outcomes.as_ref().map(|offer_outcomes| offer_outcomes.table.summary()) {
            Some(note) if !note.is_empty() => note,
            _ => "new leads".to_owned(),
        };
        let keys = context.hints(&[Action::Open, Action::Rows, Action::Filter, Action::Close]);
        PaneBorder { title: title.to_owned(), note, keys, ..PaneBorder::default() }
    }

    fn draw(&self, inbox: &Inbox, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let Some(offer_outcomes) = &inbox.outcomes else { return };
        let text = match offer_outcomes.rows.as_deref() {
            None => "reading …".to_owned(),
            Some([]) => {
                let send = context.keys.label(Action::SendOffer).unwrap_or_default();
                format!(
                    "No new lead has been sent an offer yet. Send one with {send} in the list of threads."
                )
            }
            Some(_) => return offer_outcomes.table.draw(canvas, placement.area, placement.focused, placement.index),
        };
        let lines = wrap(&text, placement.area.width as usize);
        for (row, line) in novamind_tui::canvas::row_rects(placement.area).zip(lines) {
            canvas.draw_text(row, &line, Role::Dim);
        }
    }
}
