//! One question before something that cannot be taken back. The default is to leave it.

use ratatui::layout::Rect;
use ratatui::text::Line;

use super::{Dialog, Outcome};
use crate::console::action::{Action, Scope};
use crate::console::canvas::{Canvas, Click, centered};
use crate::console::effect::Effect;
use crate::console::screens::Look;
use crate::console::text::wrapped;
use crate::console::theme::Role;

/// A question.
pub struct Confirm {
    title: String,
    text: String,
    effects: Vec<Effect>,
}

impl Confirm {
    /// Asks whether to let effects follow.
    pub fn new(title: impl Into<String>, text: impl Into<String>, effects: Vec<Effect>) -> Confirm {
        Confirm { title: title.into(), text: text.into(), effects }
    }
}

impl Dialog for Confirm {
    fn what(&self) -> String {
        format!("confirm {}", self.title)
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Dialog]
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::Confirm, Action::Cancel]
    }

    fn act(&mut self, action: Action, _: &Look<'_>) -> Outcome {
        match action {
            Action::Confirm => Outcome::close_with(std::mem::take(&mut self.effects)),
            Action::Cancel => Outcome::close(),
            _ => Outcome::stay(),
        }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let lines = wrapped(&self.text, 56);
        let own = centered(area, 60, lines.len() as u16 + 4);
        canvas.clear(own, Role::Text);
        let inside = canvas.pane(own, &self.title, "", true);
        let shown: Vec<Line<'_>> =
            lines.iter().map(|line| Line::from(canvas.span(line.as_str(), Role::Text))).collect();
        canvas.lines(Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside }, &shown);
        let row = Rect {
            y: inside.bottom().saturating_sub(1),
            height: 1,
            x: inside.x + 1,
            width: inside.width.saturating_sub(2),
        };
        for (at, action) in [Action::Confirm, Action::Cancel].into_iter().enumerate() {
            let place = Rect { x: row.x + at as u16 * 14, width: 12.min(row.width), ..row };
            canvas.text(place.intersection(row), &look.hint(action), Role::Key);
            canvas.click(place, Click::Do(action));
        }
    }
}
