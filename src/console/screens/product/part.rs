//! What the panes of this screen have in common: a list whose rows lead somewhere, and one line for small windows.

use ratatui::layout::Rect;

use super::{Product, ProductPane};
use crate::action::Action;
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use crate::context::{Figure, Look};
use novamind_tools::ToolId;
use novamind_tui::canvas::Canvas;
use novamind_worker::company::Company;

/// One of the panes.
pub trait ProductPart: Pane<Product> {
    /// Which.
    fn name(&self) -> ProductPane;

    /// Rows that can be selected.
    fn rows(&self, _: &Product, _: &Company) -> usize {
        1
    }

    /// All of it in one line, in as many words as some columns hold.
    fn summary(&self, product: &Product, company: &Company, width: usize) -> String;

    /// What stands at the right of its border.
    fn note(&self, product: &Product, company: &Company, width: usize) -> String {
        self.summary(product, company, width)
    }

    /// What opening the selected row leads to, in a word.
    fn destination(&self, product: &Product) -> &'static str;

    /// Leads to the very object that is selected: its cell, or the form with it proposed.
    fn open(&self, product: &Product, company: &Company) -> Effect;

    /// The figure that is selected.
    fn selected(&self, product: &Product, company: &Company) -> Option<Figure>;

    /// Moves sideways in the selected row; false where that leads to the next pane.
    fn turn(&self, _: &mut Product, _: Action) -> bool {
        false
    }

    /// Draws its inside.
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

/// Leads to the cell of a tool that is for something, or to its form.
pub fn cell(tool: ToolId, of: Option<String>) -> Effect {
    match of {
        Some(of) => Effect::ShowCell(tool, of),
        None => Effect::ShowTool(tool),
    }
}

/// Leads to the form of a tool with a tier typed into it.
pub fn tier(tool: ToolId, tier: Option<u32>) -> Effect {
    match tier {
        Some(tier) => Effect::Prefill { tool, arguments: serde_json::json!({ "tier": tier }) },
        None => Effect::ShowTool(tool),
    }
}
