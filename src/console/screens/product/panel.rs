//! Behavior that all panes of the product screen share: rows that open another screen, and a one-line summary for
//! small windows.

use ratatui::layout::Rect;

use super::{Product, ProductPane};
use crate::action::Action;
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_tools::ToolId;
use novamind_tui::canvas::Canvas;
use novamind_worker::company::DisplayedCompany;

pub trait ProductPanel: Pane<Product> {
    fn id(&self) -> ProductPane;

    /// Returns the number of selectable rows.
    fn row_count(&self, _: &Product, _: &DisplayedCompany) -> usize {
        1
    }

    /// Returns a one-line summary of the pane in at most `width` columns.
    fn summary(&self, product: &Product, company: &DisplayedCompany, width: usize) -> String;

    /// Returns the text at the right of the border.
    fn note(&self, product: &Product, company: &DisplayedCompany, width: usize) -> String {
        self.summary(product, company, width)
    }

    /// Returns the name of the destination that the selected row opens.
    fn destination(&self, product: &Product) -> &'static str;

    /// Returns the effect that opens the form of the selected row, at its cell or with a value filled in.
    fn open_effect(&self, product: &Product, company: &DisplayedCompany) -> Effect;

    fn selected_figure(&self, product: &Product, company: &DisplayedCompany) -> Option<Figure>;

    /// Moves to another cell of the selected row. Returns false if the action should move the focus to another pane.
    fn move_sideways(&self, _: &mut Product, _: Action) -> bool {
        false
    }

    fn draw_content(&self, product: &Product, canvas: &mut Canvas<'_>, placement: PanePlacement, company: &DisplayedCompany);
}

impl<P: ProductPanel> Pane<Product> for P {
    fn hints(&self, _: &Product) -> Vec<Action> {
        vec![Action::FocusNext, Action::Open]
    }

    fn figure(&self, product: &Product, context: &ScreenContext<'_>) -> Option<Figure> {
        self.selected_figure(product, context.company)
    }

    fn handle_action(&self, product: &mut Product, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        let last = self.row_count(product, context.company).saturating_sub(1);
        let page = context.page_rows.max(1) as usize;
        let place = product.selected_row_mut(self.id());
        match action {
            Action::Up => *place = place.saturating_sub(1),
            Action::Down => *place = (*place + 1).min(last),
            Action::PageUp => *place = place.saturating_sub(page),
            Action::PageDown => *place = (*place + page).min(last),
            Action::First => *place = 0,
            Action::Last => *place = last,
            Action::Left | Action::Right if !self.move_sideways(product, action) => {
                product.move_focus(action == Action::Right);
            }
            Action::Open => return vec![self.open_effect(product, context.company)],
            _ => {}
        }
        Vec::new()
    }

    fn handle_click(&self, product: &mut Product, row: usize, context: &ScreenContext<'_>) -> Vec<Effect> {
        let place = product.selected_row_mut(self.id());
        let again = *place == row;
        *place = row;
        if again { self.handle_action(product, Action::Open, context) } else { Vec::new() }
    }

    fn border(&self, product: &Product, area: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let open = context.keys.label(Action::Open).unwrap_or_default();
        let title = self.id().title();
        // The corners, the spaces around the title and the note, and a segment of the border between the title and the
        // note need nine columns.
        let width = (area.width as usize).saturating_sub(title.len() + 9);
        PaneBorder {
            title: title.to_owned(),
            note: self.note(product, context.company, width),
            keys: format!("{open} {}", self.destination(product)),
            ..PaneBorder::default()
        }
    }

    fn draw(&self, product: &Product, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        self.draw_content(product, canvas, placement, context.company);
    }
}

/// Returns the effect that opens the form of a tool, at the cell for a key if given.
pub fn show_cell_effect(tool: ToolId, of: Option<String>) -> Effect {
    match of {
        Some(of) => Effect::ShowCell(tool, of),
        None => Effect::ShowTool(tool),
    }
}

/// Returns the effect that opens the form of a tool with a tier filled in.
pub fn prefill_tier_effect(tool: ToolId, tier: Option<u32>) -> Effect {
    match tier {
        Some(tier) => Effect::Prefill { tool, arguments: serde_json::json!({ "tier": tier }) },
        None => Effect::ShowTool(tool),
    }
}
