//! Asks for the week that playback should seek to.

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::{Dialog, Outcome};
use crate::action::{Action, Scope};
use crate::context::Look;
use crate::effect::Effect;
use novamind_session::Goal;
use novamind_tui::canvas::{Canvas, centered};
use novamind_tui::theme::Role;
use novamind_tui::widgets::Field;

/// The dialog.
pub struct Seek {
    weeks: u32,
    field: Field,
    problem: Option<String>,
}

impl Seek {
    /// Opens it for a record of `weeks` weeks.
    pub fn new(weeks: u32) -> Seek {
        Seek { weeks, field: Field::default(), problem: None }
    }

    fn go(&mut self) -> Outcome {
        let typed = self.field.text().trim();
        match typed.parse::<u32>() {
            Ok(week) if week <= self.weeks => Outcome::close_with(vec![Effect::Go(Goal::Week(week))]),
            Ok(week) => {
                self.problem = Some(format!("week {week} was not recorded; the last week is {}", self.weeks));
                Outcome::stay()
            }
            Err(_) => {
                self.problem = Some(format!("enter a week from 0 to {}", self.weeks));
                Outcome::stay()
            }
        }
    }
}

impl Dialog for Seek {
    fn what(&self) -> String {
        "seek a week".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Field]
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::Commit, Action::Discard]
    }

    fn act(&mut self, action: Action, _: &Look<'_>) -> Outcome {
        match action {
            Action::Commit => self.go(),
            Action::Discard => Outcome::close(),
            _ => Outcome::stay(),
        }
    }

    fn key(&mut self, key: &KeyEvent, _: &Look<'_>) -> Outcome {
        self.problem = None;
        self.field.number_key(key);
        Outcome::stay()
    }

    fn paste(&mut self, text: &str, _: &Look<'_>) -> Outcome {
        self.field.insert(text.trim());
        Outcome::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let own = centered(area, 56, 6);
        canvas.clear(own, Role::Text);
        let inside = canvas.pane(own, "Go to week", &format!("0 to {}", self.weeks), true);
        let row = Rect {
            x: inside.x + 1,
            width: inside.width.saturating_sub(2),
            height: 1.min(inside.height),
            ..inside
        };
        canvas.text(row, "week", Role::Dim);
        let field = Rect { x: row.x + 6, width: 8.min(row.width.saturating_sub(6)), ..row };
        self.field.draw(canvas, field);
        let below = Rect { y: row.y + 2, ..row }.intersection(inside);
        match &self.problem {
            Some(problem) => canvas.text(below, problem, Role::Bad),
            None => canvas.text(below, "shows the end of that week", Role::Dim),
        }
        canvas.pane_keys(own, &look.hints(&[Action::Commit, Action::Discard]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::{company, in_dialog};

    #[test]
    fn only_a_recorded_week_is_gone_to() {
        let company = company();
        for (typed, goal) in [("0", Some(0)), ("12", Some(12)), ("13", None), ("", None), ("1.5", None)] {
            let mut dialog = Seek::new(12);
            dialog.field = Field::of(typed);
            let outcome = in_dialog(&mut dialog, Action::Commit, &company);
            match goal {
                Some(week) => {
                    assert!(outcome.close);
                    assert!(
                        matches!(outcome.effects[..], [Effect::Go(Goal::Week(own))] if own == week),
                        "{typed}"
                    );
                }
                None => assert!(!outcome.close && dialog.problem.is_some(), "{typed}"),
            }
        }
    }
}
