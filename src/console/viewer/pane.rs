//! The pane with the decisions of the next week, next to the screen.

use ratatui::layout::Rect;

use super::Viewer;
use crate::action::Action;
use crate::context::Look;
use novamind_record::trajectory::Record;
use novamind_session::RecordView;
use novamind_tui::canvas::{Canvas, Click, rows_of};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;

const OF_SCREEN: u16 = 80;
/// Minimum and maximum columns of the pane.
const COLUMNS: (u16, u16) = (40, 60);

/// Which entries of the record the pane shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EntriesShown {
    /// Everything that was done.
    All,
    /// Only decisions, for the projector view.
    Decisions,
}

impl EntriesShown {
    fn holds(self, entry: &RecordView) -> bool {
        self == EntriesShown::All || !matches!(entry.record, Record::Query(_))
    }
}

impl Viewer {
    /// Returns the columns of the pane, or 0 if it is hidden or does not fit.
    pub fn columns(&self, area: Rect) -> u16 {
        let room = area.width.saturating_sub(OF_SCREEN);
        match self.shows_decisions && area.width >= Viewer::BESIDE {
            true => room.clamp(COLUMNS.0, COLUMNS.1),
            false => 0,
        }
    }

    /// Draws the decisions; those after the current position are dimmed.
    pub fn draw_decisions(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>, shown: EntriesShown) {
        let chapter = &self.place.chapter;
        let note = format!("{}/{} done", chapter.done, chapter.entries.len());
        let inside = canvas.pane(area, &super::told::title(chapter), &note, false);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let mut rows: Vec<(String, Role)> = Vec::new();
        // The row of the next action.
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
            rows.push(("nothing recorded after this moment".to_owned(), Role::Dim));
        }
        let height = inside.height as usize;
        let last = rows.len().saturating_sub(height);
        // The next action is centered.
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
