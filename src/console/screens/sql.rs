//! Screen.

use ratatui::layout::Rect;

use super::{Look, Screen};
use crate::console::action::{Action, Scope};
use crate::console::canvas::Canvas;
use crate::console::effect::Effect;

/// The screen.
#[derive(Default)]
pub struct Sql;

impl Screen for Sql {
    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::List]
    }

    fn act(&mut self, _: Action, _: &Look<'_>) -> Vec<Effect> {
        Vec::new()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, _: &Look<'_>) {
        canvas.pane(area, "Sql", "", true);
    }
}

impl Sql {
    /// Puts a statement into the editor.
    pub fn edit(&mut self, _: &str) {}
}
