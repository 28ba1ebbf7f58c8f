//! A page that asks for the path of a class folder or of a student's handout.

use std::path::PathBuf;

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use crate::effect::Effect;
use novamind_report::class::ClassDisplayOptions;
use novamind_tui::canvas::{Canvas, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::TextField;
use novamind_worker::request::Request;

const MAX_TEXT_WIDTH: u16 = 100;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PathPurpose {
    Class,
    Handout,
}

impl PathPurpose {
    fn title(self) -> &'static str {
        match self {
            PathPurpose::Class => "Class",
            PathPurpose::Handout => "Handout",
        }
    }

    fn prompt(self) -> &'static str {
        match self {
            PathPurpose::Class => "Class folder",
            PathPurpose::Handout => "Handout file",
        }
    }

    fn explanation(self) -> &'static str {
        match self {
            PathPurpose::Class => {
                "The folder that `novamind class new` created. `novamind class collect DIR PLACES` collects the submissions. This \
                 page shows the last collection: ranking, curves, decisions, guesses, pitfalls."
            }
            PathPurpose::Handout => {
                "The file that your instructor gave you, such as S07.nm. Enter starts the lesson, or continues the last unfinished try or part. After that, the start menu shows only your runs."
            }
        }
    }
}

pub(super) struct PathForm {
    purpose: PathPurpose,
    field: TextField,
    pub(super) rejection: Option<String>,
}

impl PathForm {
    pub(super) fn new(wanted: PathPurpose) -> PathForm {
        PathForm { purpose: wanted, field: TextField::default(), rejection: None }
    }

    pub(super) fn handle_key(&mut self, key: &KeyEvent) {
        self.rejection = None;
        self.field.handle_key(key);
    }

    pub(super) fn paste(&mut self, text: &str) {
        self.rejection = None;
        self.field.insert(text.trim());
    }

    pub(super) fn open_path(&self) -> Vec<Effect> {
        // Terminals put quotes around the paths of dropped files.
        let typed = self.field.text().trim().trim_matches(['\'', '"']);
        if typed.is_empty() {
            return vec![Effect::ShowError(format!("Type a path: {}", self.purpose.prompt().to_lowercase()))];
        }
        let path = PathBuf::from(typed);
        vec![Effect::Request(match self.purpose {
            PathPurpose::Class => Request::ReadClass(path, ClassDisplayOptions::default()),
            PathPurpose::Handout => Request::OpenHandout(path),
        })]
    }

    pub(super) fn draw(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let inside = canvas.draw_pane_frame(area, self.purpose.title(), "", true);
        let inside =
            Rect { x: inside.x + 1, width: inside.width.saturating_sub(2).min(MAX_TEXT_WIDTH), ..inside };
        let mut rows = row_rects(inside);
        if let Some(row) = rows.next() {
            canvas.draw_text(row, self.purpose.prompt(), Role::Strong);
        }
        if let Some(row) = rows.next() {
            self.field.draw(canvas, row);
        }
        rows.next();
        let (text, role) = match &self.rejection {
            Some(problem) => (format!("! {problem}"), Role::Bad),
            None => (self.purpose.explanation().to_owned(), Role::Text),
        };
        for (row, line) in rows.zip(wrap(&text, inside.width as usize)) {
            canvas.draw_text(row, &line, role);
        }
    }
}
