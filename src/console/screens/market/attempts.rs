//! Market research attempts.

use ratatui::layout::Rect;

use super::Market;
use super::model::{Attempt, name_of};
use crate::action::{Action, Scope};
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_base::notation::dollars;
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{Cell, Column, Table};
use novamind_worker::company::Company;

/// Past attempts, and the cost of the next one.
pub struct AttemptsPane;

impl Pane<Market> for AttemptsPane {
    fn table<'a>(&self, market: &'a Market) -> Option<&'a Table> {
        Some(&market.attempts)
    }

    fn table_mut<'a>(&self, market: &'a mut Market) -> Option<&'a mut Table> {
        Some(&mut market.attempts)
    }

    fn scopes(&self, market: &Market) -> Vec<Scope> {
        super::scopes(&market.attempts)
    }

    fn hints(&self, _: &Market) -> Vec<Action> {
        vec![Action::FindGroup, Action::Sort, Action::Filter]
    }

    fn figure(&self, _: &Market, _: &Look<'_>) -> Option<Figure> {
        let sql = "SELECT day, cost, success, discovered_group_id FROM segment_discovery ORDER BY id DESC";
        let title = "market research attempts".to_owned();
        Some(Figure { title, term: "market-research", sql: Some(sql.to_owned()), why: None })
    }

    fn act(&self, market: &mut Market, action: Action, look: &Look<'_>) -> Vec<Effect> {
        super::walk(&mut market.attempts, action, look);
        Vec::new()
    }

    fn border(&self, market: &Market, _: Rect, look: &Look<'_>) -> Border {
        let next = dollars(look.company.terms.attempt_cost);
        let note = match market.facts.attempts.len() {
            0 => format!("next {next}"),
            count => format!(
                "{} of {count} found · {} · next {next}",
                market.facts.found(),
                dollars(market.facts.spent())
            ),
        };
        let keys = look.hint(Action::FindGroup);
        Border { title: "Attempts".to_owned(), note, keys, keys_always: true }
    }

    fn draw(&self, market: &Market, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        if market.facts.attempts.is_empty() {
            let key = look.keys.label(Action::FindGroup).unwrap_or_default();
            canvas.text(seat.area, &format!("No attempts yet. Pay for one with {key}."), Role::Dim);
        } else {
            market.attempts.draw(canvas, seat.area, seat.focused, seat.number);
        }
    }
}

pub fn columns() -> Vec<Column> {
    vec![Column::numbers("day"), Column::numbers("cost"), Column::words("found")]
}

pub fn row_of(attempt: &Attempt, company: &Company) -> Vec<Cell> {
    let found = match attempt.group {
        Some(group) => Cell::words(format!("{group} {}", name_of(company, group))).role(Role::Good),
        None => Cell::words("nothing").role(Role::Dim),
    };
    vec![
        Cell::number(f64::from(attempt.day), attempt.day.to_string()),
        Cell::number(attempt.cost, dollars(attempt.cost)),
        found,
    ]
}
