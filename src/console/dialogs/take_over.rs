//! Taking over a playback: asks for the mode of the new run.

use ratatui::layout::Rect;

use super::{Dialog, Outcome};
use crate::action::{Action, Scope};
use crate::context::Look;
use crate::effect::Effect;
use novamind_record::mode::Mode;
use novamind_tui::canvas::{Canvas, Click, centered, rows_of};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_worker::request::Request;

/// A branch is never a baseline.
const MODES: [Mode; 2] = [Mode::Sandbox, Mode::Debug];

/// The dialog.
pub struct TakeOver {
    day: u32,
    week: u32,
    selected: usize,
}

impl TakeOver {
    /// Opens it for a branch at a day before a week.
    pub fn new(day: u32, week: u32) -> TakeOver {
        TakeOver { day, week, selected: 0 }
    }

    fn take(&self) -> Outcome {
        Outcome::close_with(vec![Effect::Request(Request::TakeOver(MODES[self.selected]))])
    }
}

impl Dialog for TakeOver {
    fn what(&self) -> String {
        "take over".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::List, Scope::Dialog]
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::Open, Action::Close]
    }

    fn act(&mut self, action: Action, _: &Look<'_>) -> Outcome {
        match action {
            Action::Open | Action::Confirm => return self.take(),
            Action::Close | Action::Cancel => return Outcome::close(),
            Action::Down | Action::Last => self.selected = (self.selected + 1).min(MODES.len() - 1),
            Action::Up | Action::First => self.selected = self.selected.saturating_sub(1),
            _ => {}
        }
        Outcome::stay()
    }

    fn click(&mut self, row: usize, _: &Look<'_>) -> Outcome {
        let again = self.selected == row;
        self.selected = row.min(MODES.len() - 1);
        if again { self.take() } else { Outcome::stay() }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let text = format!(
            "A new run starts here, on day {} before week {}, with everything done so far. The recorded run does not change.",
            self.day, self.week
        );
        let lines = wrapped(&text, 72);
        let own = centered(area, 78, lines.len() as u16 + MODES.len() as u16 + 4);
        canvas.clear(own, Role::Text);
        let inside = canvas.pane(own, "Take over", "", true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        for (row, line) in rows_of(inside).zip(&lines) {
            canvas.text(row, line, Role::Text);
        }
        let used = (lines.len() as u16 + 1).min(inside.height);
        let list = Rect { y: inside.y + used, height: inside.height - used, ..inside };
        for (at, (row, mode)) in rows_of(list).zip(MODES).enumerate() {
            let here = at == self.selected;
            let role = if here { Role::Selection } else { Role::Text };
            if here {
                canvas.clear(row, Role::Selection);
            }
            let mark = if here { "›" } else { " " };
            canvas.text(row, &format!("{mark} {:<8} {}", mode.id(), mode.purpose()), role);
            canvas.click(row, Click::Row(0, at));
        }
        let key = look.keys.label(Action::Open).unwrap_or_default();
        canvas.pane_keys(own, &format!("{key} start · {}", look.hint(Action::Close)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::{company, dialog_picture, in_dialog};

    #[test]
    fn the_mode_is_chosen_and_nothing_happens_without_a_yes() {
        let company = company();
        let mut dialog = TakeOver::new(84, 13);
        let picture = dialog_picture(&dialog, &company, 80, 24);
        assert!(picture.contains("on day 84 before week 13") && picture.contains("› sandbox"), "{picture}");
        assert!(in_dialog(&mut dialog, Action::Close, &company).effects.is_empty());
        let first = in_dialog(&mut dialog, Action::Open, &company);
        assert!(
            matches!(first.effects[..], [Effect::Request(Request::TakeOver(Mode::Sandbox))]) && first.close
        );
        in_dialog(&mut dialog, Action::Down, &company);
        let second = in_dialog(&mut dialog, Action::Confirm, &company);
        assert!(matches!(second.effects[..], [Effect::Request(Request::TakeOver(Mode::Debug))]));
    }
}
