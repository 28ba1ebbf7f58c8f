//! Text rows that link to a screen, used for action items and news.

use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use crate::action::Action;
use crate::context::ScreenId;
use crate::screens::panes::PanePlacement;
use novamind_tui::canvas::{Align, Canvas, Click};
use novamind_tui::text::{wrap, wrap_sentences};
use novamind_tui::theme::Role;

pub fn move_selection(selected: &mut usize, rows: usize, action: Action) {
    let last = rows.saturating_sub(1);
    *selected = match action {
        Action::Up => selected.saturating_sub(1),
        Action::Down => (*selected + 1).min(last),
        Action::First => 0,
        Action::Last => last,
        _ => *selected,
    };
}

/// A text row that links to a screen.
pub struct LinkedRow {
    text: String,
    urgent: bool,
    destination: String,
}

impl LinkedRow {
    pub fn new(screen: ScreenId, text: String, urgent: bool) -> LinkedRow {
        LinkedRow { text, urgent, destination: format!("→ {}", screen.action().entry().title) }
    }

    /// Returns the wrapped text. Each line leaves space for the name of the linked screen.
    pub fn lines(&self, width: u16) -> Vec<String> {
        wrap(&self.text, self.text_width(width))
    }

    fn text_width(&self, width: u16) -> usize {
        (width as usize).saturating_sub(self.destination.width() + 4).max(12)
    }
}

/// Draws rows, scrolled so that the selected row is completely visible.
pub fn draw(canvas: &mut Canvas<'_>, placement: PanePlacement, rows: &[LinkedRow], selected: usize) {
    let area = placement.area;
    let all: Vec<Vec<String>> = rows.iter().map(|row| row.lines(area.width)).collect();
    let mut from = 0;
    let height = |from: usize| all[from..].iter().take(selected + 1 - from).map(Vec::len).sum::<usize>();
    while from < selected && height(from) > area.height as usize {
        from += 1;
    }
    let mut y = area.y;
    for (at, lines) in all.iter().enumerate().skip(from) {
        if y >= area.bottom() {
            break;
        }
        let room = lines.len().min((area.bottom() - y) as usize);
        let shown = wrap_sentences(&rows[at].text, rows[at].text_width(area.width), room);
        // If a text is cut after a sentence, the next row starts directly below the cut text.
        let place = Rect { y, height: shown.len() as u16, ..area };
        draw_row(canvas, place, &rows[at], &shown, placement.focused && at == selected);
        canvas.register_click(place, Click::Row(placement.index, at));
        y += place.height;
    }
}

fn draw_row(canvas: &mut Canvas<'_>, area: Rect, row: &LinkedRow, lines: &[String], selected: bool) {
    let role = match (selected, row.urgent) {
        (true, _) => Role::Selection,
        (false, true) => Role::Warning,
        (false, false) => Role::Text,
    };
    canvas.clear(area, if selected { role } else { Role::Text });
    for (at, (line, y)) in lines.iter().zip(area.top()..area.bottom()).enumerate() {
        let mark = match (at, row.urgent) {
            (0, true) => "!",
            (0, false) => "·",
            _ => " ",
        };
        canvas.draw_text(Rect { y, height: 1, ..area }, &format!("{mark} {line}"), role);
    }
    let way = if selected { role } else { Role::Dim };
    canvas.draw_aligned(Rect { height: area.height.min(1), ..area }, &row.destination, way, Align::Right);
}
