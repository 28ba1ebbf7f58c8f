//! Screen.

use ratatui::layout::Rect;

use super::{Look, Screen};
use crate::console::action::{Action, Scope};
use crate::console::canvas::Canvas;
use crate::console::effect::Effect;

/// The screen.
#[derive(Default)]
pub struct Customers;

impl Screen for Customers {
    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::List]
    }

    fn act(&mut self, _: Action, _: &Look<'_>) -> Vec<Effect> {
        Vec::new()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, _: &Look<'_>) {
        canvas.pane(area, "Customers", "", true);
    }
}
