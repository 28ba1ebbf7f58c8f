//! Asks for the week that playback should seek to.

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::{Dialog, DialogResponse};
use crate::action::{Action, Scope};
use crate::context::ScreenContext;
use crate::effect::Effect;
use novamind_session::SeekTarget;
use novamind_tui::canvas::{Canvas, centered_rect};
use novamind_tui::theme::Role;
use novamind_tui::widgets::TextField;

/// The dialog that asks for a week.
pub struct SeekWeekDialog {
    weeks: u32,
    field: TextField,
    problem: Option<String>,
}

impl SeekWeekDialog {
    /// Opens the dialog for a record of `weeks` weeks.
    pub fn new(weeks: u32) -> SeekWeekDialog {
        SeekWeekDialog { weeks, field: TextField::default(), problem: None }
    }

    fn seek_week(&mut self) -> DialogResponse {
        let typed = self.field.text().trim();
        match typed.parse::<u32>() {
            Ok(week) if week <= self.weeks => {
                DialogResponse::confirm_with(vec![Effect::Seek(SeekTarget::Week(week))])
            }
            Ok(week) => {
                self.problem = Some(format!("week {week} was not recorded; the last week is {}", self.weeks));
                DialogResponse::stay()
            }
            Err(_) => {
                self.problem = Some(format!("enter a week from 0 to {}", self.weeks));
                DialogResponse::stay()
            }
        }
    }
}

impl Dialog for SeekWeekDialog {
    fn record_name(&self) -> String {
        "seek a week".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Field]
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::Commit, Action::Discard]
    }

    fn handle_action(&mut self, action: Action, _: &ScreenContext<'_>) -> DialogResponse {
        match action {
            Action::Commit => self.seek_week(),
            Action::Discard => DialogResponse::close(),
            _ => DialogResponse::stay(),
        }
    }

    fn handle_key(&mut self, key: &KeyEvent, _: &ScreenContext<'_>) -> DialogResponse {
        self.problem = None;
        self.field.handle_number_key(key);
        DialogResponse::stay()
    }

    fn paste(&mut self, text: &str, _: &ScreenContext<'_>) -> DialogResponse {
        self.problem = self.field.paste_number(text).err();
        DialogResponse::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let dialog_area = centered_rect(area, 56, 6);
        canvas.clear(dialog_area, Role::Text);
        let inside = canvas.draw_pane_frame(dialog_area, "Go to week", &format!("0 to {}", self.weeks), true);
        let row = Rect {
            x: inside.x + 1,
            width: inside.width.saturating_sub(2),
            height: 1.min(inside.height),
            ..inside
        };
        canvas.draw_text(row, "week", Role::Dim);
        let field = Rect { x: row.x + 6, width: 8.min(row.width.saturating_sub(6)), ..row };
        self.field.draw(canvas, field);
        let below = Rect { y: row.y + 2, ..row }.intersection(inside);
        match &self.problem {
            Some(problem) => canvas.draw_text(below, problem, Role::Bad),
            None => canvas.draw_text(below, "shows the end of that week", Role::Dim),
        }
        canvas.draw_pane_keys(dialog_area, &context.hints(&[Action::Commit, Action::Discard]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::{dialog_action, new_company};

    #[test]
    fn seek_accepts_only_recorded_weeks() {
        let company = new_company();
        for (typed, goal) in [("0", Some(0)), ("12", Some(12)), ("13", None), ("", None), ("1.5", None)] {
            let mut dialog = SeekWeekDialog::new(12);
            dialog.field = TextField::with_text(typed);
            let outcome = dialog_action(&mut dialog, Action::Commit, &company);
            match goal {
                Some(week) => {
                    assert!(outcome.closes);
                    assert!(
                        matches!(outcome.effects[..], [Effect::Seek(SeekTarget::Week(number))] if number == week),
                        "{typed}"
                    );
                }
                None => assert!(!outcome.closes && dialog.problem.is_some(), "{typed}"),
            }
        }
    }
}
