//! Links from an open group to the forms of tools, its study and its customers.

use ratatui::layout::Rect;

use super::Customers;
use super::selection::move_index;
use crate::action::Action;
use crate::context::{ScreenContext, ScreenId};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_session::identifiers::Group;
use novamind_tools::ToolId;
use novamind_tui::canvas::{Align, Canvas, Click, row_rects};
use novamind_tui::theme::Role;

/// Tools that have a setting for the group, and labels of these settings.
const GROUP_TOOLS: [(ToolId, &str); 6] = [
    (ToolId::SetTargetedAdSpend, "ads"),
    (ToolId::SetTargetedDevSpend, "development"),
    (ToolId::SetTargetedOpsSpend, "operations"),
    (ToolId::SetPromotion, "discounts"),
    (ToolId::SetLeadPromotion, "for leads"),
    (ToolId::SetAdsStrength, "ads shown"),
];

/// Links that do not open a tool: the group's market study and its customers.
const OTHER_ACTIONS: [(&str, &str); 2] = [("Market", "order a study"), ("SQL", "customers")];

pub const ACTION_COUNT: usize = GROUP_TOOLS.len() + OTHER_ACTIONS.len();

fn action_effect(choice: usize, group: Group) -> Effect {
    match GROUP_TOOLS.get(choice) {
        Some((tool, _)) => Effect::ShowCell(*tool, group.to_string()),
        None if choice == GROUP_TOOLS.len() => Effect::ShowGroup(ScreenId::Market, group),
        None => Effect::EditSql(format!(
            "-- customers of {group}\nSELECT s.plan, s.status, count(*) AS customers, \
             round(avg(s.effective_price), 2) AS price\nFROM subscriptions s\n\
             JOIN customers c ON c.customer_id = s.customer_id\nWHERE c.group_id = '{group}'\n\
             GROUP BY 1, 2\nORDER BY 1, 2"
        )),
    }
}

pub struct GroupActionsPane;

impl Pane<Customers> for GroupActionsPane {
    fn hints(&self, _: &Customers) -> Vec<Action> {
        vec![Action::Open, Action::FocusNext, Action::Close]
    }

    fn handle_action(&self, customers: &mut Customers, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        let Some(group) = customers.group(context.company) else { return Vec::new() };
        match action {
            Action::Open => return vec![action_effect(customers.group_state.action, group)],
            Action::Left | Action::Right => {
                let step = |open: usize| if action == Action::Left { open.saturating_sub(1) } else { open + 1 };
                customers.change_group(step, context.company);
                return customers.request_curve(context.company);
            }
            action => customers.group_state.action = move_index(customers.group_state.action, ACTION_COUNT - 1, action),
        }
        Vec::new()
    }

    fn handle_click(&self, customers: &mut Customers, row: usize, context: &ScreenContext<'_>) -> Vec<Effect> {
        let before = customers.group_state.action;
        customers.group_state.action = row.min(ACTION_COUNT - 1);
        if before == customers.group_state.action { self.handle_action(customers, Action::Open, context) } else { Vec::new() }
    }

    fn border(&self, _: &Customers, _: Rect, _: &ScreenContext<'_>) -> PaneBorder {
        PaneBorder { title: "Go to".to_owned(), ..PaneBorder::default() }
    }

    fn draw(&self, customers: &Customers, canvas: &mut Canvas<'_>, placement: PanePlacement, _: &ScreenContext<'_>) {
        let choice = customers.group_state.action;
        let from = canvas.scroll_to_row(placement.area, choice, ACTION_COUNT);
        for (at, row) in (from..ACTION_COUNT).zip(row_rects(placement.area)) {
            let role = match (at == choice, placement.focused) {
                (true, true) => Role::Selection,
                (true, false) => Role::InactiveSelection,
                _ => Role::Text,
            };
            canvas.clear(row, role);
            let tools = GROUP_TOOLS.iter().map(|(tool, purpose)| (tool.name(), *purpose));
            let (name, purpose) = tools.chain(OTHER_ACTIONS).nth(at).unwrap_or_default();
            canvas.draw_text(row, name, role);
            let purpose_role = if at == choice { role } else { Role::Dim };
            let place = Rect { x: row.x + 23, width: row.width.saturating_sub(23), ..row };
            canvas.draw_aligned(place, purpose, purpose_role, Align::Right);
            canvas.register_click(row, Click::Row(placement.index, at));
        }
    }
}
