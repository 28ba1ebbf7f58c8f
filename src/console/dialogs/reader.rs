//! A text viewer: the dashboard, a full cell value, the changes of the week.

use ratatui::layout::Rect;
use ratatui::text::Line;

use super::{Dialog, Outcome};
use crate::action::{Action, Scope};
use crate::context::Look;
use novamind_tui::canvas::{Canvas, centered};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;

/// A text with a title.
pub struct Reader {
    title: String,
    text: String,
    from: usize,
}

impl Reader {
    /// Shows a text.
    pub fn new(title: impl Into<String>, text: impl Into<String>) -> Reader {
        Reader { title: title.into(), text: text.into(), from: 0 }
    }
}

impl Dialog for Reader {
    fn what(&self) -> String {
        format!("text {}", self.title)
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Dialog, Scope::List]
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::ScrollDown, Action::Cancel]
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Outcome {
        let last = self.text.lines().count().saturating_sub(1);
        match action {
            Action::Cancel | Action::Close => return Outcome::close(),
            Action::ScrollUp => self.from = self.from.saturating_sub(1),
            Action::ScrollDown => self.from = (self.from + 1).min(last),
            Action::PageUp => self.from = self.from.saturating_sub(look.page as usize),
            Action::PageDown => self.from = (self.from + look.page as usize).min(last),
            Action::First => self.from = 0,
            Action::Last => self.from = last,
            _ => {}
        }
        Outcome::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let width = area.width.saturating_sub(6).clamp(1, 110);
        let lines = wrapped(&self.text, width as usize);
        let own = centered(area, width + 4, (lines.len() as u16).saturating_add(2));
        canvas.clear(own, Role::Text);
        let inside = canvas.pane(own, &self.title, "", true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let from = self.from.min(lines.len().saturating_sub(inside.height as usize));
        canvas.page = inside.height.max(1);
        let shown = lines.iter().skip(from).take(inside.height as usize);
        let shown: Vec<Line<'_>> =
            shown.map(|line| Line::from(canvas.span(line.as_str(), Role::Text))).collect();
        canvas.lines(inside, &shown);
        let more = lines.len() > inside.height as usize;
        canvas.pane_keys(
            own,
            &if more { look.hints(&[Action::ScrollDown, Action::Cancel]) } else { look.hint(Action::Cancel) },
        );
    }
}
