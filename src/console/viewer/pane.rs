//! What was decided before the next week, beside the screen.

use ratatui::layout::Rect;

use super::Viewer;
use crate::action::Action;
use crate::context::Look;
use novamind_record::trajectory::Record;
use novamind_session::RecordView;
use novamind_tui::canvas::{Canvas, Click, rows_of};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;

/// Columns a screen needs beside the decisions.
const OF_SCREEN: u16 = 80;
/// Columns of the decisions.
const COLUMNS: (u16, u16) = (40, 60);

/// What of the record is told beside the figures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EntriesShown {
    /// Everything that was done.
    All,
    /// What was decided: from far away nobody reads what was asked.
    Decisions,
}

impl EntriesShown {
    fn holds(self, entry: &RecordView) -> bool {
        self == EntriesShown::All || !matches!(entry.record, Record::Query(_))
    }
}

impl Viewer {
    /// Columns that the decisions take from the screen; none where they are hidden or there is no room.
    pub fn columns(&self, area: Rect) -> u16 {
        let room = area.width.saturating_sub(OF_SCREEN);
        match self.shows_decisions && area.width >= Viewer::BESIDE {
            true => room.clamp(COLUMNS.0, COLUMNS.1),
            false => 0,
        }
    }

    /// Draws the decisions; what was not done yet at this moment is dim.
    pub fn draw_decisions(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>, shown: EntriesShown) {
        let chapter = &self.place.chapter;
        let note = format!("{}/{} done", chapter.done, chapter.entries.len());
        let inside = canvas.pane(area, &super::told::title(chapter), &note, false);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let mut rows: Vec<(String, Role)> = Vec::new();
        // The row at which the next action stands.
        let mut next = None;
        for (at, entry) in chapter.entries.iter().enumerate().filter(|(_, entry)| shown.holds(entry)) {
            let done = at < chapter.done;
            if at == chapter.done {
                next = Some(rows.len());
            }
            for (part, (text, role)) in super::told::brief(entry, &look.company.names).into_iter().enumerate()
            {
                let mark = match (part, done) {
                    (0, true) => "✓ ",
                    (0, false) if at == chapter.done => "▸ ",
                    (0, false) => "· ",
                    _ => "  ",
                };
                let lines = wrapped(&text, inside.width.saturating_sub(2) as usize);
                for (number, line) in lines.into_iter().enumerate() {
                    let mark = if number == 0 { mark } else { "  " };
                    rows.push((format!("{mark}{line}"), if done { role } else { Role::Dim }));
                }
            }
        }
        if rows.is_empty() {
            rows.push(("nothing was recorded after this moment".to_owned(), Role::Dim));
        }
        let height = inside.height as usize;
        let last = rows.len().saturating_sub(height);
        // The next action stands in the middle.
        let from = next.unwrap_or(rows.len()).saturating_sub(height / 2).min(last);
        let from = (from as i32 + self.scroll).clamp(0, last as i32) as usize;
        for (row, (text, role)) in rows_of(inside).zip(rows.iter().skip(from)) {
            canvas.text(row, text, *role);
        }
        let [back, on, whole] = [Action::LineBack, Action::LineForward, Action::DecisionsWhole]
            .map(|action| look.keys.label(action).unwrap_or_default());
        canvas.pane_keys(area, &format!("{back} {on} single actions · {whole} in full"));
        canvas.click(area, Click::Do(Action::DecisionsWhole.into()));
    }
}
