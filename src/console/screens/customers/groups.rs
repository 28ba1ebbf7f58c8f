//! Table of all known groups.

use ratatui::layout::Rect;

use super::open_group::OpenGroupState;
use super::{Customers, columns};
use crate::action::Action;
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_tui::canvas::Canvas;
use novamind_tui::text::format_count;
use novamind_tui::widgets::Table;

pub struct CustomerGroupsPane;

impl Pane<Customers> for CustomerGroupsPane {
    fn table<'a>(&self, customers: &'a Customers) -> Option<&'a Table> {
        Some(&customers.table)
    }

    fn table_name(&self) -> Option<&'static str> {
        Some("customers.groups")
    }

    fn table_mut<'a>(&self, customers: &'a mut Customers) -> Option<&'a mut Table> {
        Some(&mut customers.table)
    }

    fn hints(&self, _: &Customers) -> Vec<Action> {
        vec![Action::Open, Action::Sort, Action::Filter]
    }

    fn figure(&self, customers: &Customers, context: &ScreenContext<'_>) -> Option<Figure> {
        let group = customers.group(context.company)?;
        columns::figure(group, customers.table.selected_column(), context.company)
    }

    fn handle_action(&self, customers: &mut Customers, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        if action == Action::Open {
            customers.open_group = customers.table.selected();
            customers.group_state = OpenGroupState::default();
        } else {
            customers.table.handle_action(action, context.page_rows);
        }
        customers.request_curve(context.company)
    }

    fn handle_click(&self, customers: &mut Customers, row: usize, context: &ScreenContext<'_>) -> Vec<Effect> {
        let before = customers.table.selected();
        customers.table.select_visible_row(row);
        match before == customers.table.selected() {
            true => self.handle_action(customers, Action::Open, context),
            false => customers.request_curve(context.company),
        }
    }

    fn border(&self, customers: &Customers, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let seen = &context.company.observation;
        let note = match customers.table.summary() {
            note if note.is_empty() => format!(
                "{} · {} · week {}",
                format_count(f64::from(seen.subscribers), "subscriber"),
                format_count(f64::from(seen.seats), "seat"),
                seen.week
            ),
            note => note,
        };
        let note = match &context.company.hidden_values {
            Some(hidden) => format!("x-ray: true values of day {} · {note}", hidden.day),
            None => note,
        };
        let mut keys = context.hints(&[Action::Open, Action::Sort, Action::Filter]);
        if context.company.can_inspect {
            keys = format!("{} · {keys}", context.hint(Action::HiddenValues));
        }
        PaneBorder { title: "Groups".to_owned(), note, keys, ..PaneBorder::default() }
    }

    fn draw(&self, customers: &Customers, canvas: &mut Canvas<'_>, placement: PanePlacement, _: &ScreenContext<'_>) {
        customers.table.draw(canvas, placement.area, placement.focused, placement.index);
    }
}
