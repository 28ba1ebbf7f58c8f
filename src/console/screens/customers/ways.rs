//! Links from an open group to the forms of tools, its study and its customers.

use ratatui::layout::Rect;

use super::Customers;
use super::steps::moved;
use crate::action::Action;
use crate::context::{Look, ScreenId};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_session::identifiers::Group;
use novamind_tools::ToolId;
use novamind_tui::canvas::{Align, Canvas, Click, rows_of};
use novamind_tui::theme::Role;
use novamind_tui::widgets::table::first_row;

/// Tools with a setting for the group, and what each sets.
const TOOLS: [(ToolId, &str); 6] = [
    (ToolId::SetTargetedAdSpend, "ads"),
    (ToolId::SetTargetedDevSpend, "development"),
    (ToolId::SetTargetedOpsSpend, "operations"),
    (ToolId::SetPromotion, "discounts"),
    (ToolId::SetLeadPromotion, "for leads"),
    (ToolId::SetAdsStrength, "ads shown"),
];

/// Links that are not tools: the market study and the customers.
const OTHERS: [(&str, &str); 2] = [("Market", "order a study"), ("SQL", "its customers")];

pub const CHOICES: usize = TOOLS.len() + OTHERS.len();

fn choose(choice: usize, group: Group) -> Effect {
    match TOOLS.get(choice) {
        Some((tool, _)) => Effect::ShowCell(*tool, group.to_string()),
        None if choice == TOOLS.len() => Effect::ShowGroup(ScreenId::Market, group),
        None => Effect::EditSql(format!(
            "-- customers of {group}\nSELECT s.plan, s.status, count(*) AS customers, \
             round(avg(s.effective_price), 2) AS price\nFROM subscriptions s\n\
             JOIN customers c ON c.customer_id = s.customer_id\nWHERE c.group_id = '{group}'\n\
             GROUP BY 1, 2\nORDER BY 1, 2"
        )),
    }
}

pub struct WaysPane;

impl Pane<Customers> for WaysPane {
    fn hints(&self, _: &Customers) -> Vec<Action> {
        vec![Action::Open, Action::FocusNext, Action::Close]
    }

    fn act(&self, customers: &mut Customers, action: Action, look: &Look<'_>) -> Vec<Effect> {
        let Some(group) = customers.group(look.company) else { return Vec::new() };
        match action {
            Action::Open => return vec![choose(customers.opened.choice, group)],
            Action::Left => customers.turn_to(|open| open.saturating_sub(1), look.company),
            Action::Right => customers.turn_to(|open| open + 1, look.company),
            action => customers.opened.choice = moved(customers.opened.choice, CHOICES - 1, action),
        }
        Vec::new()
    }

    fn click(&self, customers: &mut Customers, row: usize, look: &Look<'_>) -> Vec<Effect> {
        let before = customers.opened.choice;
        customers.opened.choice = row.min(CHOICES - 1);
        if before == customers.opened.choice { self.act(customers, Action::Open, look) } else { Vec::new() }
    }

    fn border(&self, _: &Customers, _: Rect, _: &Look<'_>) -> Border {
        Border { title: "Go to".to_owned(), ..Border::default() }
    }

    fn draw(&self, customers: &Customers, canvas: &mut Canvas<'_>, seat: Seat, _: &Look<'_>) {
        let choice = customers.opened.choice;
        let from = first_row(choice, seat.area.height as usize, CHOICES);
        for (at, row) in (from..CHOICES).zip(rows_of(seat.area)) {
            let role = match (at == choice, seat.focused) {
                (true, true) => Role::Selection,
                (true, false) => Role::SelectionIdle,
                _ => Role::Text,
            };
            canvas.clear(row, role);
            let tools = TOOLS.iter().map(|(tool, purpose)| (tool.name(), *purpose));
            let (name, purpose) = tools.chain(OTHERS).nth(at).unwrap_or_default();
            canvas.text(row, name, role);
            let purpose_role = if at == choice { role } else { Role::Dim };
            let place = Rect { x: row.x + 23, width: row.width.saturating_sub(23), ..row };
            canvas.aligned(place, purpose, purpose_role, Align::Right);
            canvas.click(row, Click::Row(seat.number, at));
        }
    }
}
