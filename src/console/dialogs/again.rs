//! Confirmation for retrying a step of a lesson: the current one or an earlier one. The default is to cancel.

use ratatui::layout::Rect;
use ratatui::text::Line;

use super::{Dialog, Outcome};
use crate::action::{Action, Scope};
use crate::context::Look;
use crate::effect::Effect;
use novamind_tui::canvas::{Canvas, centered};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_worker::request::{LessonRequest, Request};

/// The dialog.
pub struct TryAgain {
    /// Counted from 0.
    step: usize,
    last: usize,
}

impl TryAgain {
    /// Asks for a step from the first to `last`, which is selected initially.
    pub fn new(last: usize) -> TryAgain {
        TryAgain { step: last, last }
    }

    fn text(&self) -> String {
        let step = self.step + 1;
        let first = "in a new run. Tries are counted, your first guess counts, and this run does not change.";
        match self.last {
            0 => format!("Step {step} starts again {first}"),
            last => format!("Step {step} of {} starts again {first}", last + 1),
        }
    }
}

impl Dialog for TryAgain {
    fn what(&self) -> String {
        "confirm Try again".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Dialog]
    }

    fn hints(&self) -> Vec<Action> {
        match self.last {
            0 => vec![Action::Confirm, Action::Cancel],
            _ => vec![Action::Confirm, Action::Cancel, Action::ScrollUp, Action::ScrollDown],
        }
    }

    fn act(&mut self, action: Action, _: &Look<'_>) -> Outcome {
        match action {
            Action::Confirm => {
                let again = Effect::Request(Request::Lesson(LessonRequest::TryAgain(self.step)));
                return Outcome::close_with(vec![Effect::CloseDialogs, again]);
            }
            Action::Cancel => return Outcome::close(),
            Action::ScrollUp => self.step = self.step.saturating_sub(1),
            Action::ScrollDown => self.step = (self.step + 1).min(self.last),
            _ => {}
        }
        Outcome::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let mut lines = wrapped(&self.text(), 56);
        if self.last > 0 {
            lines.push(String::new());
            let keys = [Action::ScrollUp, Action::ScrollDown]
                .map(|action| look.keys.label(action).unwrap_or_default());
            lines.push(format!("{} {}  another step", keys[0], keys[1]));
        }
        lines.push(String::new());
        lines.push(look.hints(&[Action::Confirm, Action::Cancel]));
        let own = centered(area, 60, lines.len() as u16 + 2);
        canvas.clear(own, Role::Text);
        let inside = canvas.pane(own, "Try again", "", true);
        let shown: Vec<Line<'_>> =
            lines.iter().map(|line| Line::from(canvas.span(line.as_str(), Role::Text))).collect();
        canvas.lines(Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside }, &shown);
    }
}
