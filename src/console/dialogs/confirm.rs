//! Confirmation before an irreversible action. The default is to cancel.

use ratatui::layout::Rect;
use ratatui::text::Line;

use super::{Dialog, Outcome};
use crate::action::{Action, Scope};
use crate::context::Look;
use crate::effect::Effect;
use novamind_tui::canvas::{Canvas, Click, centered};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;

/// A confirmation.
pub struct Confirm {
    title: String,
    text: String,
    effects: Vec<Effect>,
    /// A third answer and its effects.
    other: Option<(Action, Vec<Effect>)>,
}

impl Confirm {
    /// Asks whether to execute effects.
    pub fn new(title: impl Into<String>, text: impl Into<String>, effects: Vec<Effect>) -> Confirm {
        Confirm { title: title.into(), text: text.into(), effects, other: None }
    }

    /// Adds a third answer, an action of lessons.
    pub fn or(self, action: Action, effects: Vec<Effect>) -> Confirm {
        Confirm { other: Some((action, effects)), ..self }
    }

    fn answers(&self) -> Vec<Action> {
        let other = self.other.iter().map(|(action, _)| *action);
        std::iter::once(Action::Confirm).chain(other).chain([Action::Cancel]).collect()
    }
}

impl Dialog for Confirm {
    fn what(&self) -> String {
        format!("confirm {}", self.title)
    }

    fn scopes(&self) -> Vec<Scope> {
        match self.other {
            Some(_) => vec![Scope::Dialog, Scope::Lesson],
            None => vec![Scope::Dialog],
        }
    }

    fn hints(&self) -> Vec<Action> {
        self.answers()
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Outcome {
        match (action, &mut self.other) {
            (Action::Confirm, _) => Outcome::close_with(std::mem::take(&mut self.effects)),
            // Tells a user who mistook the key that nothing happened.
            (Action::Cancel, _) => {
                let yes = look.keys.label(Action::Confirm).unwrap_or_default();
                let said = format!("{}: cancelled; {yes} confirms", self.title);
                Outcome::leave_with(vec![Effect::Say(said)])
            }
            (action, Some((other, effects))) if action == *other => {
                Outcome::close_with(std::mem::take(effects))
            }
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
        for (at, action) in self.answers().into_iter().enumerate() {
            let place = Rect { x: row.x + at as u16 * 14, width: 12.min(row.width), ..row };
            canvas.text(place.intersection(row), &look.hint(action), Role::Key);
            canvas.click(place, Click::Do(action.into()));
        }
    }
}
