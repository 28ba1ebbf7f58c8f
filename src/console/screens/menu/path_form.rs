//! A page that asks for a path: the folder of a class, or a student's handout.

use std::path::PathBuf;

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use crate::effect::Effect;
use novamind_report::class::Shown;
use novamind_tui::canvas::{Canvas, rows_of};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_tui::widgets::Field;
use novamind_worker::request::Request;

const WIDEST: u16 = 100;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PathWanted {
    Class,
    Handout,
}

impl PathWanted {
    fn title(self) -> &'static str {
        match self {
            PathWanted::Class => "Class",
            PathWanted::Handout => "Handout",
        }
    }

    fn asked(self) -> &'static str {
        match self {
            PathWanted::Class => "Class folder",
            PathWanted::Handout => "Handout file",
        }
    }

    fn explained(self) -> &'static str {
        match self {
            PathWanted::Class => {
                "The folder that `novamind class new` created. `novamind class collect DIR PLACES` collects the submissions. This \
                 page shows the last collection: ranking, curves, decisions, guesses, pitfalls."
            }
            PathWanted::Handout => {
                "The file that your instructor gave you, such as S07.nm. Enter starts it, or continues the last unfinished try or \
                 part. From then on the start menu shows your runs only."
            }
        }
    }
}

pub(super) struct PathForm {
    wanted: PathWanted,
    field: Field,
    pub(super) refused: Option<String>,
}

impl PathForm {
    pub(super) fn new(wanted: PathWanted) -> PathForm {
        PathForm { wanted, field: Field::default(), refused: None }
    }

    pub(super) fn key(&mut self, key: &KeyEvent) {
        self.refused = None;
        self.field.key(key);
    }

    pub(super) fn paste(&mut self, text: &str) {
        self.refused = None;
        self.field.insert(text.trim());
    }

    pub(super) fn enter(&self) -> Vec<Effect> {
        // Terminals quote dropped files.
        let typed = self.field.text().trim().trim_matches(['\'', '"']);
        if typed.is_empty() {
            return vec![Effect::Complain(format!("Type a path: {}", self.wanted.asked().to_lowercase()))];
        }
        let path = PathBuf::from(typed);
        vec![Effect::Request(match self.wanted {
            PathWanted::Class => Request::ReadClass(path, Shown::default()),
            PathWanted::Handout => Request::OpenHandout(path),
        })]
    }

    pub(super) fn draw(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let inside = canvas.pane(area, self.wanted.title(), "", true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2).min(WIDEST), ..inside };
        let mut rows = rows_of(inside);
        if let Some(row) = rows.next() {
            canvas.text(row, self.wanted.asked(), Role::Strong);
        }
        if let Some(row) = rows.next() {
            self.field.draw(canvas, row);
        }
        rows.next();
        let (text, role) = match &self.refused {
            Some(problem) => (format!("! {problem}"), Role::Bad),
            None => (self.wanted.explained().to_owned(), Role::Text),
        };
        for (row, line) in rows.zip(wrapped(&text, inside.width as usize)) {
            canvas.text(row, &line, role);
        }
    }
}
