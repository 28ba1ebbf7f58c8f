//! Asks for the reason of a pause, if the study requires one.

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::{Dialog, Outcome};
use crate::action::{Action, Scope};
use crate::context::Look;
use crate::effect::Effect;
use novamind_tui::canvas::{Canvas, centered};
use novamind_tui::theme::Role;
use novamind_tui::widgets::Field;

/// The dialog.
#[derive(Default)]
pub struct PauseReason {
    reason: Field,
    empty: bool,
}

impl Dialog for PauseReason {
    fn what(&self) -> String {
        "reason for stopping the clock".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Field]
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::Commit, Action::Discard]
    }

    fn act(&mut self, action: Action, _: &Look<'_>) -> Outcome {
        match action {
            Action::Commit if self.reason.text().trim().is_empty() => {
                self.empty = true;
                Outcome::stay()
            }
            Action::Commit => {
                let reason = self.reason.text().trim().to_owned();
                Outcome::close_with(vec![Effect::StopClock(Some(reason))])
            }
            Action::Discard => Outcome::close(),
            _ => Outcome::stay(),
        }
    }

    fn key(&mut self, key: &KeyEvent, _: &Look<'_>) -> Outcome {
        self.reason.key(key);
        self.empty = false;
        Outcome::stay()
    }

    fn paste(&mut self, text: &str, _: &Look<'_>) -> Outcome {
        self.reason.insert(text.trim());
        Outcome::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let own = centered(area, 64, 6);
        canvas.clear(own, Role::Text);
        let inside = canvas.pane(own, "Stop the clock", "", true);
        let row = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), height: 1, ..inside };
        canvas.text(row, "Why do you stop? The time counts until you answer.", Role::Text);
        self.reason.draw(canvas, Rect { y: row.y + 1, ..row });
        if self.empty {
            canvas.text(Rect { y: row.y + 2, ..row }, "! a reason is required", Role::Bad);
        }
        canvas.pane_keys(own, &look.hints(&[Action::Commit, Action::Discard]));
    }
}
