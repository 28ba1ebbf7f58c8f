//! The pane with the decisions of the next week, next to the screen.

use ratatui::layout::Rect;

use super::PlaybackViewer;
use crate::action::Action;
use crate::context::ScreenContext;
use novamind_record::trajectory::Record;
use novamind_session::RecordView;
use novamind_tui::canvas::{Canvas, Click, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;

const MIN_SCREEN_WIDTH: u16 = 80;
/// Minimum and maximum width of the pane, in columns.
const DECISIONS_WIDTH: (u16, u16) = (40, 60);

/// Filter for the entries of the record that the pane shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EntryFilter {
    /// All recorded entries.
    All,
    /// Only decisions, for the projector view.
    Decisions,
}

impl EntryFilter {
    fn includes(self, entry: &RecordView) -> bool {
        self == EntryFilter::All || !matches!(entry.record, Record::Query(_))
    }
}

impl PlaybackViewer {
    /// Returns the width of the pane in columns, or 0 if the pane is hidden or does not fit.
    pub fn columns(&self, area: Rect) -> u16 {
        let room = area.width.saturating_sub(MIN_SCREEN_WIDTH);
        match self.shows_decisions && area.width >= PlaybackViewer::MIN_WIDTH_FOR_DECISIONS {
            true => room.clamp(DECISIONS_WIDTH.0, DECISIONS_WIDTH.1),
            false => 0,
        }
    }

    /// Draws the pane with the decisions. Decisions after the current position are dimmed.
    pub fn draw_decisions(
        &self,
        canvas: &mut Canvas<'_>,
        area: Rect,
        context: &ScreenContext<'_>,
        entry_filter: EntryFilter,
    ) {
        let chapter = &self.position.chapter;
        let note = format!("{}/{} done", chapter.applied_entries, chapter.entries.len());
        let inside = canvas.draw_pane_frame(area, &super::entry_text::chapter_title(chapter), &note, false);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let mut rows: Vec<(String, Role)> = Vec::new();
        // Row of the next action to replay.
        let mut next = None;
        for (at, entry) in
            chapter.entries.iter().enumerate().filter(|(_, entry)| entry_filter.includes(entry))
        {
            let done = at < chapter.applied_entries;
            if at == chapter.applied_entries {
                next = Some(rows.len());
            }
            for (part, (text, role)) in
                super::entry_text::entry_summary(entry, &context.company.enterprise_names)
                    .into_iter()
                    .enumerate()
            {
                let mark = match (part, done) {
                    (0, true) => "✓ ",
                    (0, false) if at == chapter.applied_entries => "▸ ",
                    (0, false) => "· ",
                    _ => "  ",
                };
                let lines = wrap(&text, inside.width.saturating_sub(2) as usize);
                for (number, line) in lines.into_iter().enumerate() {
                    let mark = if number == 0 { mark } else { "  " };
                    rows.push((format!("{mark}{line}"), if done { role } else { Role::Dim }));
                }
            }
        }
        if rows.is_empty() {
            rows.push(("no actions recorded after this point".to_owned(), Role::Dim));
        }
        let height = inside.height as usize;
        let last = rows.len().saturating_sub(height);
        // The next action is centered.
        let from = next.unwrap_or(rows.len()).saturating_sub(height / 2).min(last);
        let from = (from as i32 + self.scroll).clamp(0, last as i32) as usize;
        for (row, (text, role)) in row_rects(inside).zip(rows.iter().skip(from)) {
            canvas.draw_text(row, text, *role);
        }
        let [back, on, whole] = [Action::LineBack, Action::LineForward, Action::DecisionsInFull]
            .map(|action| context.keys.label(action).unwrap_or_default());
        canvas.draw_pane_keys(area, &format!("{back} {on} step by action · {whole} in full"));
        canvas.register_click(area, Click::Command(Action::DecisionsInFull.into()));
    }
}
