//! The playback bar below the screen, which shows the position and the state of the playback.

use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::PlaybackViewer;
use crate::action::Action;
use novamind_tui::canvas::{Canvas, Click};
use novamind_tui::theme::Role;

const MIN_BAR_WIDTH: u16 = 8;

impl PlaybackViewer {
    /// Draws the playback bar.
    pub fn draw_status_line(&self, canvas: &mut Canvas<'_>, row: Rect) {
        canvas.clear(row, Role::InactiveSelection);
        let place = &self.position;
        let wide = row.width >= 100;
        let state = match (self.playing, place.is_at_end, place.is_following) {
            (true, ..) => format!("playing, {}", self.speed_label()),
            (false, true, true) => "live".to_owned(),
            (false, false, true) => "paused; more is being recorded".to_owned(),
            (false, true, false) => "end of the record".to_owned(),
            (false, false, false) => "paused".to_owned(),
        };
        let back = if place.line > 1 { Role::Key } else { Role::Dim };
        let on = if place.is_at_end { Role::Dim } else { Role::Key };
        let chapter = &place.chapter;
        let action = format!("action {}/{}", chapter.applied_entries, chapter.entries.len());
        let pieces: [(String, Role, Option<Action>); 6] = [
            (" ◂ ".to_owned(), back, Some(Action::WeekBack)),
            (format!("week {}/{}", place.week, place.weeks), Role::Strong, Some(Action::SeekWeek)),
            (" ▸ ".to_owned(), on, Some(Action::WeekForward)),
            (format!(" day {} ", place.day), Role::Text, None),
            (if wide { format!(" {action} ") } else { String::new() }, Role::Dim, None),
            (
                format!(" {state} "),
                if self.playing { Role::Good } else { Role::Warning },
                Some(Action::PlayPause),
            ),
        ];
        let mut left = row;
        for (text, role, action) in pieces {
            let width = text.width() as u16;
            if width > left.width {
                break;
            }
            let area = Rect { width, ..left };
            // The status line keeps its background and uses the foreground color of the role.
            let style = canvas.style(role);
            canvas.draw_text(area, &text, Role::InactiveSelection);
            if let Some(colour) = style.fg {
                canvas.buffer.set_style(
                    area,
                    ratatui::style::Style::new().fg(colour).add_modifier(style.add_modifier),
                );
            }
            action.iter().for_each(|action| canvas.register_click(area, Click::Command((*action).into())));
            left = Rect { x: left.x + width, width: left.width - width, ..left };
        }
        if left.width > MIN_BAR_WIDTH + 2 {
            let bar_area = Rect { x: left.x + 1, width: left.width - 2, ..left };
            canvas.draw_text(
                bar_area,
                &position_bar(place.line, place.lines, bar_area.width),
                Role::InactiveSelection,
            );
        }
    }
}

/// Formats the position between the first and the last line of the record as a bar: `━━━━●────`.
fn position_bar(line: usize, lines: usize, width: u16) -> String {
    let room = width.max(1) as usize - 1;
    let before = match lines {
        0 | 1 => 0,
        _ => line.saturating_sub(1).min(lines - 1) * room / (lines - 1),
    };
    format!("{}●{}", "━".repeat(before), "─".repeat(room - before))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn position_bar_is_full_only_at_the_end() {
        assert_eq!(position_bar(1, 5, 5), "●────");
        assert_eq!(position_bar(3, 5, 5), "━━●──");
        assert_eq!(position_bar(4, 5, 5), "━━━●─");
        assert_eq!(position_bar(5, 5, 5), "━━━━●");
        assert_eq!(position_bar(0, 0, 3), "●──");
        assert_eq!(position_bar(9, 5, 1), "●");
    }
}
