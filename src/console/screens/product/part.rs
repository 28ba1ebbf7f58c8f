//! Shared behavior of the panes: rows that open something, and a one-line summary for small windows.

use ratatui::layout::Rect;

use super::{Product, ProductPane};
use crate::action::Action;
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_tools::ToolId;
use novamind_tui::canvas::Canvas;
use novamind_worker::company::Company;

pub trait ProductPart: Pane<Product> {
    fn name(&self) -> ProductPane;

    /// Returns the number of selectable rows.
    fn rows(&self, _: &Product, _: &Company) -> usize {
        1
    }

    /// Returns a one-line summary in at most `width` columns.
    fn summary(&self, product: &Product, company: &Company, width: usize) -> String;

    /// Returns the text at the right of the border.
    fn note(&self, product: &Product, company: &Company, width: usize) -> String {
        self.summary(product, company, width)
    }

    /// Returns the name of the destination that the selected row opens.
    fn destination(&self, product: &Product) -> &'static str;

    /// Opens the selected object: its cell, or its form with a value filled in.
    fn open(&self, product: &Product, company: &Company) -> Effect;

    fn selected(&self, product: &Product, company: &Company) -> Option<Figure>;

    /// Moves sideways in the selected row; returns false if the key should lead to the next pane.
    fn turn(&self, _: &mut Product, _: Action) -> bool {
        false
    }

    fn paint(&self, product: &Product, canvas: &mut Canvas<'_>, seat: Seat, company: &Company);
}

impl<P: ProductPart> Pane<Product> for P {
    fn hints(&self, _: &Product) -> Vec<Action> {
        vec![Action::FocusNext, Action::Open]
    }

    fn figure(&self, product: &Product, look: &Look<'_>) -> Option<Figure> {
        self.selected(product, look.company)
    }

    fn act(&self, product: &mut Product, action: Action, look: &Look<'_>) -> Vec<Effect> {
        let last = self.rows(product, look.company).saturating_sub(1);
        let page = look.page.max(1) as usize;
        let place = product.place_mut(self.name());
        match action {
            Action::Up => *place = place.saturating_sub(1),
            Action::Down => *place = (*place + 1).min(last),
            Action::PageUp => *place = place.saturating_sub(page),
            Action::PageDown => *place = (*place + page).min(last),
            Action::First => *place = 0,
            Action::Last => *place = last,
            Action::Left | Action::Right if !self.turn(product, action) => {
                product.move_focus(action == Action::Right);
            }
            Action::Open => return vec![self.open(product, look.company)],
            _ => {}
        }
        Vec::new()
    }

    fn click(&self, product: &mut Product, row: usize, look: &Look<'_>) -> Vec<Effect> {
        let place = product.place_mut(self.name());
        let again = *place == row;
        *place = row;
        if again { self.act(product, Action::Open, look) } else { Vec::new() }
    }

    fn border(&self, product: &Product, area: Rect, look: &Look<'_>) -> Border {
        let open = look.keys.label(Action::Open).unwrap_or_default();
        let title = self.name().title();
        // Corners, the blanks around title and note, and a piece of border between them.
        let width = (area.width as usize).saturating_sub(title.len() + 9);
        Border {
            title: title.to_owned(),
            note: self.note(product, look.company, width),
            keys: format!("{open} {}", self.destination(product)),
            ..Border::default()
        }
    }

    fn draw(&self, product: &Product, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        self.paint(product, canvas, seat, look.company);
    }
}

/// Opens the form of a tool, at the cell of an object if given.
pub fn cell(tool: ToolId, of: Option<String>) -> Effect {
    match of {
        Some(of) => Effect::ShowCell(tool, of),
        None => Effect::ShowTool(tool),
    }
}

/// Opens the form of a tool with a tier filled in.
pub fn tier(tool: ToolId, tier: Option<u32>) -> Effect {
    match tier {
        Some(tier) => Effect::Prefill { tool, arguments: serde_json::json!({ "tier": tier }) },
        None => Effect::ShowTool(tool),
    }
}
