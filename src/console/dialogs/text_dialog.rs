//! A text viewer for the dashboard, the full value of a cell, and the changes of the week.

use ratatui::layout::Rect;
use ratatui::text::Line;

use super::{Dialog, DialogResponse};
use crate::action::{Action, Scope};
use crate::context::ScreenContext;
use novamind_tui::canvas::{Canvas, centered_rect};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;

/// A dialog that shows a text with a title.
pub struct TextDialog {
    title: String,
    text: String,
    first_line: usize,
}

impl TextDialog {
    /// Opens the dialog with a title and a text.
    pub fn new(title: impl Into<String>, text: impl Into<String>) -> TextDialog {
        TextDialog { title: title.into(), text: text.into(), first_line: 0 }
    }
}

impl Dialog for TextDialog {
    fn record_name(&self) -> String {
        format!("text {}", self.title)
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Dialog, Scope::List]
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::ScrollDown, Action::Cancel]
    }

    fn handle_action(&mut self, action: Action, context: &ScreenContext<'_>) -> DialogResponse {
        let last = self.text.lines().count().saturating_sub(1);
        match action {
            Action::Cancel | Action::Close | Action::Open => return DialogResponse::close(),
            Action::ScrollUp => self.first_line = self.first_line.saturating_sub(1),
            Action::ScrollDown => self.first_line = (self.first_line + 1).min(last),
            Action::PageUp => self.first_line = self.first_line.saturating_sub(context.page_rows as usize),
            Action::PageDown => self.first_line = (self.first_line + context.page_rows as usize).min(last),
            Action::First => self.first_line = 0,
            Action::Last => self.first_line = last,
            _ => {}
        }
        DialogResponse::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let width = area.width.saturating_sub(6).clamp(1, 110);
        let lines = wrap(&self.text, width as usize);
        let dialog_area = centered_rect(area, width + 4, (lines.len() as u16).saturating_add(2));
        canvas.clear(dialog_area, Role::Text);
        let inside = canvas.draw_pane_frame(dialog_area, &self.title, "", true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let from = self.first_line.min(lines.len().saturating_sub(inside.height as usize));
        canvas.page_rows = inside.height.max(1);
        let shown = lines.iter().skip(from).take(inside.height as usize);
        let shown: Vec<Line<'_>> =
            shown.map(|line| Line::from(canvas.span(line.as_str(), Role::Text))).collect();
        canvas.draw_lines(inside, &shown);
        let more = lines.len() > inside.height as usize;
        canvas.draw_pane_keys(
            dialog_area,
            &if more {
                context.hints(&[Action::ScrollDown, Action::Cancel])
            } else {
                context.hint(Action::Cancel)
            },
        );
    }
}
