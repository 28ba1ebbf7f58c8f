//! The pane of market research attempts.

use ratatui::layout::Rect;

use super::Market;
use super::model::{ResearchAttempt, group_name};
use crate::action::{Action, Scope};
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_base::formatting::dollars;
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{TableCell, TableColumn, Table};
use novamind_worker::company::DisplayedCompany;

/// Pane with past market research attempts and the cost of the next attempt.
pub struct AttemptsPane;

impl Pane<Market> for AttemptsPane {
    fn table<'a>(&self, market: &'a Market) -> Option<&'a Table> {
        Some(&market.attempts)
    }

    fn table_name(&self) -> Option<&'static str> {
        Some("market.studies")
    }

    fn table_mut<'a>(&self, market: &'a mut Market) -> Option<&'a mut Table> {
        Some(&mut market.attempts)
    }

    fn scopes(&self, market: &Market) -> Vec<Scope> {
        super::table_scopes(&market.attempts)
    }

    fn hints(&self, _: &Market) -> Vec<Action> {
        vec![Action::FindGroup, Action::Sort, Action::Filter]
    }

    fn figure(&self, _: &Market, _: &ScreenContext<'_>) -> Option<Figure> {
        let sql = "SELECT day, cost, success, discovered_group_id FROM segment_discovery ORDER BY id DESC";
        let title = "market research attempts".to_owned();
        Some(Figure { title, term: "market-research", sql: Some(sql.to_owned()), week_quantity: None })
    }

    fn handle_action(&self, market: &mut Market, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        super::move_in_table(&mut market.attempts, action, context);
        Vec::new()
    }

    fn border(&self, market: &Market, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let next = dollars(context.company.tool_limits.attempt_cost);
        let note = match market.facts.attempts.len() {
            0 => format!("next {next}"),
            count => format!(
                "{} of {count} found · {} · next {next}",
                market.facts.found_count(),
                dollars(market.facts.research_cost())
            ),
        };
        let keys = context.hint(Action::FindGroup);
        PaneBorder { title: "Attempts".to_owned(), note, keys, shows_keys_always: true }
    }

    fn draw(&self, market: &Market, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        if market.facts.attempts.is_empty() {
            let key = context.keys.label(Action::FindGroup).unwrap_or_default();
            canvas.draw_text(placement.area, &format!("No attempts yet. Pay for one with {key}."), Role::Dim);
        } else {
            market.attempts.draw(canvas, placement.area, placement.focused, placement.index);
        }
    }
}

pub fn columns() -> Vec<TableColumn> {
    vec![TableColumn::numeric("day"), TableColumn::numeric("cost"), TableColumn::text("found")]
}

pub fn attempt_row(attempt: &ResearchAttempt, company: &DisplayedCompany) -> Vec<TableCell> {
    let found = match attempt.group {
        Some(group) => TableCell::from_text(format!("{group} {}", group_name(company, group))).with_role(Role::Good),
        None => TableCell::from_text("nothing").with_role(Role::Dim),
    };
    vec![
        TableCell::from_number(f64::from(attempt.day), attempt.day.to_string()),
        TableCell::from_number(attempt.cost, dollars(attempt.cost)),
        found,
    ]
}
