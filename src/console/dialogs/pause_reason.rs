//! Asks for the reason for a pause, if the study requires a reason.

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::{Dialog, DialogResponse};
use crate::action::{Action, Scope};
use crate::context::ScreenContext;
use crate::effect::Effect;
use novamind_tui::canvas::{Canvas, centered_rect};
use novamind_tui::theme::Role;
use novamind_tui::widgets::TextField;

/// The dialog that asks for the reason for a pause.
#[derive(Default)]
pub struct PauseReasonDialog {
    reason: TextField,
    is_rejected_empty: bool,
}

impl Dialog for PauseReasonDialog {
    fn record_name(&self) -> String {
        "reason for stopping the clock".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Field]
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::Commit, Action::Discard]
    }

    fn handle_action(&mut self, action: Action, _: &ScreenContext<'_>) -> DialogResponse {
        match action {
            Action::Commit if self.reason.text().trim().is_empty() => {
                self.is_rejected_empty = true;
                DialogResponse::stay()
            }
            Action::Commit => {
                let reason = self.reason.text().trim().to_owned();
                DialogResponse::confirm_with(vec![Effect::StopClock(Some(reason))])
            }
            Action::Discard => DialogResponse::close(),
            _ => DialogResponse::stay(),
        }
    }

    fn handle_key(&mut self, key: &KeyEvent, _: &ScreenContext<'_>) -> DialogResponse {
        self.reason.handle_key(key);
        self.is_rejected_empty = false;
        DialogResponse::stay()
    }

    fn paste(&mut self, text: &str, _: &ScreenContext<'_>) -> DialogResponse {
        self.reason.insert(text.trim());
        DialogResponse::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let dialog_area = centered_rect(area, 64, 6);
        canvas.clear(dialog_area, Role::Text);
        let inside = canvas.draw_pane_frame(dialog_area, "Stop the clock", "", true);
        let row = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), height: 1, ..inside };
        canvas.draw_text(row, "Why do you stop the clock? Time counts until you answer.", Role::Text);
        self.reason.draw(canvas, Rect { y: row.y + 1, ..row });
        if self.is_rejected_empty {
            canvas.draw_text(Rect { y: row.y + 2, ..row }, "! a reason is required", Role::Bad);
        }
        canvas.draw_pane_keys(dialog_area, &context.hints(&[Action::Commit, Action::Discard]));
    }
}
