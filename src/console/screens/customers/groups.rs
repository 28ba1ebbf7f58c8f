//! Table of all known groups.

use ratatui::layout::Rect;

use super::opened::Opened;
use super::{Customers, columns};
use crate::action::Action;
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_tui::canvas::Canvas;
use novamind_tui::text::count;
use novamind_tui::widgets::Table;

pub struct CustomerGroupsPane;

impl Pane<Customers> for CustomerGroupsPane {
    fn table<'a>(&self, customers: &'a Customers) -> Option<&'a Table> {
        Some(&customers.table)
    }

    fn table_mut<'a>(&self, customers: &'a mut Customers) -> Option<&'a mut Table> {
        Some(&mut customers.table)
    }

    fn hints(&self, _: &Customers) -> Vec<Action> {
        vec![Action::Open, Action::Sort, Action::Filter]
    }

    fn figure(&self, customers: &Customers, look: &Look<'_>) -> Option<Figure> {
        let group = customers.group(look.company)?;
        columns::figure(group, customers.table.selected_column(), look.company)
    }

    fn act(&self, customers: &mut Customers, action: Action, look: &Look<'_>) -> Vec<Effect> {
        if action == Action::Open {
            customers.open = customers.table.selected();
            customers.opened = Opened::default();
        } else {
            customers.table.act(action, look.page);
        }
        Vec::new()
    }

    fn border(&self, customers: &Customers, _: Rect, look: &Look<'_>) -> Border {
        let seen = &look.company.seen;
        let note = match customers.table.note() {
            note if note.is_empty() => format!(
                "{} · {} · week {}",
                count(f64::from(seen.subscribers), "subscriber"),
                count(f64::from(seen.seats), "seat"),
                seen.week
            ),
            note => note,
        };
        let note = match &look.company.hidden {
            Some(hidden) => format!("x-ray: true values of day {} · {note}", hidden.day),
            None => note,
        };
        let mut keys = look.hints(&[Action::Open, Action::Sort, Action::Filter]);
        if look.company.may_look_inside {
            keys = format!("{} · {keys}", look.hint(Action::HiddenValues));
        }
        Border { title: "Groups".to_owned(), note, keys, ..Border::default() }
    }

    fn draw(&self, customers: &Customers, canvas: &mut Canvas<'_>, seat: Seat, _: &Look<'_>) {
        customers.table.draw(canvas, seat.area, seat.focused, seat.number);
    }
}
