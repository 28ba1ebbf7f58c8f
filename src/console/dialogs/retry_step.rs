//! Confirmation for retrying the current step or an earlier step of a lesson. The default is to cancel.

use ratatui::layout::Rect;
use ratatui::text::Line;

use super::{Dialog, DialogResponse};
use crate::action::{Action, Scope};
use crate::context::ScreenContext;
use crate::effect::Effect;
use novamind_tui::canvas::{Canvas, centered_rect};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_worker::request::{LessonRequest, Request};

/// The dialog that confirms a retry of a step.
pub struct RetryStepDialog {
    /// Index of the selected step, counted from 0.
    selected_step: usize,
    last_step: usize,
}

impl RetryStepDialog {
    /// Opens the dialog for the steps from 0 to `last`. Initially, `last` is selected.
    pub fn new(last: usize) -> RetryStepDialog {
        RetryStepDialog { selected_step: last, last_step: last }
    }

    fn text(&self) -> String {
        let step = self.selected_step + 1;
        let first =
            "in a new run. Tries are counted, your first guess is kept, and this run does not change.";
        match self.last_step {
            0 => format!("Step {step} starts again {first}"),
            last => format!("Step {step} of {} starts again {first}", last + 1),
        }
    }
}

impl Dialog for RetryStepDialog {
    fn record_name(&self) -> String {
        "confirm Try again".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Dialog]
    }

    fn hints(&self) -> Vec<Action> {
        match self.last_step {
            0 => vec![Action::Confirm, Action::Cancel],
            _ => vec![Action::Confirm, Action::Cancel, Action::ScrollUp, Action::ScrollDown],
        }
    }

    fn handle_action(&mut self, action: Action, _: &ScreenContext<'_>) -> DialogResponse {
        match action {
            Action::Confirm => {
                let effect = Effect::Request(Request::Lesson(LessonRequest::RetryStep(self.selected_step)));
                return DialogResponse::confirm_with(vec![Effect::CloseDialogs, effect]);
            }
            Action::Cancel => return DialogResponse::close(),
            Action::ScrollUp => self.selected_step = self.selected_step.saturating_sub(1),
            Action::ScrollDown => self.selected_step = (self.selected_step + 1).min(self.last_step),
            _ => {}
        }
        DialogResponse::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let mut lines = wrap(&self.text(), 56);
        if self.last_step > 0 {
            lines.push(String::new());
            let keys = [Action::ScrollUp, Action::ScrollDown]
                .map(|action| context.keys.label(action).unwrap_or_default());
            lines.push(format!("{} {}  another step", keys[0], keys[1]));
        }
        lines.push(String::new());
        lines.push(context.hints(&[Action::Confirm, Action::Cancel]));
        let dialog_area = centered_rect(area, 60, lines.len() as u16 + 2);
        canvas.clear(dialog_area, Role::Text);
        let inside = canvas.draw_pane_frame(dialog_area, "Try again", "", true);
        let shown: Vec<Line<'_>> =
            lines.iter().map(|line| Line::from(canvas.span(line.as_str(), Role::Text))).collect();
        canvas.draw_lines(Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside }, &shown);
    }
}
