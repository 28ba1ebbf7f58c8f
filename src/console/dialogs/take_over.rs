//! Taking over a playback: asks for the mode of the new run.

use ratatui::layout::Rect;

use super::{Dialog, DialogResponse};
use crate::action::{Action, Scope};
use crate::context::ScreenContext;
use crate::effect::Effect;
use novamind_record::mode::Mode;
use novamind_tui::canvas::{Canvas, Click, centered_rect, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_worker::request::Request;

/// A branch is never a baseline run.
const BRANCH_MODES: [Mode; 2] = [Mode::Sandbox, Mode::Debug];

/// The dialog that starts a new run from a position in a playback.
pub struct TakeOverDialog {
    day: u32,
    week: u32,
    selected: usize,
}

impl TakeOverDialog {
    /// Opens the dialog for a branch that starts on `day`, before `week` begins.
    pub fn new(day: u32, week: u32) -> TakeOverDialog {
        TakeOverDialog { day, week, selected: 0 }
    }

    fn confirm_branch(&self) -> DialogResponse {
        DialogResponse::confirm_with(vec![Effect::Request(Request::TakeOver(BRANCH_MODES[self.selected]))])
    }
}

impl Dialog for TakeOverDialog {
    fn record_name(&self) -> String {
        "take over".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::List, Scope::Dialog]
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::Open, Action::Close]
    }

    fn handle_action(&mut self, action: Action, _: &ScreenContext<'_>) -> DialogResponse {
        match action {
            Action::Open | Action::Confirm => return self.confirm_branch(),
            Action::Close | Action::Cancel => return DialogResponse::close(),
            Action::Down | Action::Last => self.selected = (self.selected + 1).min(BRANCH_MODES.len() - 1),
            Action::Up | Action::First => self.selected = self.selected.saturating_sub(1),
            _ => {}
        }
        DialogResponse::stay()
    }

    fn handle_click(&mut self, row: usize, _: &ScreenContext<'_>) -> DialogResponse {
        let again = self.selected == row;
        self.selected = row.min(BRANCH_MODES.len() - 1);
        if again { self.confirm_branch() } else { DialogResponse::stay() }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let text = format!(
            "A new run starts here, on day {} before week {}, with all actions up to this position. The recorded run does not change.",
            self.day, self.week
        );
        let lines = wrap(&text, 72);
        let dialog_area = centered_rect(area, 78, lines.len() as u16 + BRANCH_MODES.len() as u16 + 4);
        canvas.clear(dialog_area, Role::Text);
        let inside = canvas.draw_pane_frame(dialog_area, "Take over", "", true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        for (row, line) in row_rects(inside).zip(&lines) {
            canvas.draw_text(row, line, Role::Text);
        }
        let used = (lines.len() as u16 + 1).min(inside.height);
        let list = Rect { y: inside.y + used, height: inside.height - used, ..inside };
        for (at, (row, mode)) in row_rects(list).zip(BRANCH_MODES).enumerate() {
            let here = at == self.selected;
            let role = if here { Role::Selection } else { Role::Text };
            if here {
                canvas.clear(row, Role::Selection);
            }
            let mark = if here { "›" } else { " " };
            canvas.draw_text(row, &format!("{mark} {:<8} {}", mode.id(), mode.purpose()), role);
            canvas.register_click(row, Click::Row(0, at));
        }
        let key = context.keys.label(Action::Open).unwrap_or_default();
        canvas.draw_pane_keys(dialog_area, &format!("{key} start · {}", context.hint(Action::Close)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::{dialog_action, dialog_text, new_company};

    #[test]
    fn take_over_starts_with_the_chosen_mode() {
        let company = new_company();
        let mut dialog = TakeOverDialog::new(84, 13);
        let picture = dialog_text(&dialog, &company, 80, 24);
        assert!(picture.contains("on day 84 before week 13") && picture.contains("› sandbox"), "{picture}");
        assert!(dialog_action(&mut dialog, Action::Close, &company).effects.is_empty());
        let first = dialog_action(&mut dialog, Action::Open, &company);
        assert!(
            matches!(first.effects[..], [Effect::Request(Request::TakeOver(Mode::Sandbox))]) && first.closes
        );
        dialog_action(&mut dialog, Action::Down, &company);
        let second = dialog_action(&mut dialog, Action::Confirm, &company);
        assert!(matches!(second.effects[..], [Effect::Request(Request::TakeOver(Mode::Debug))]));
    }
}
