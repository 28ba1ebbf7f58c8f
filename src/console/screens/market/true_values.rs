//! True values of competitors, drift and the economy, shown above the public figures if the x-ray is open.

use ratatui::layout::Rect;

use novamind_base::formatting::grouped_number;
use novamind_insight::{HiddenValues, NextCompetitorMove};
use novamind_tui::canvas::{Canvas, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;

/// Returns the lines on competitors: quality that they have not copied yet, and their next move.
pub fn competitor_lines(hidden: &HiddenValues) -> Vec<String> {
    let bank_texts: Vec<String> =
        hidden.group_banks.iter().map(|(group, bank)| format!("{group} {}", grouped_number(*bank, 4))).collect();
    let bank_text = if bank_texts.is_empty() { String::new() } else { format!(", by group {}", bank_texts.join(", ")) };
    vec![
        format!("x-ray, day {}: uncopied quality {}{bank_text}", hidden.day, grouped_number(hidden.shared_bank, 4)),
        next_move_text(hidden.next_competitor_move.as_ref()),
    ]
}

fn next_move_text(next: Option<&NextCompetitorMove>) -> String {
    let Some(next) = next else { return "x-ray: competitors make no move before the end".to_owned() };
    match &next.outcome {
        Some(made) => {
            format!(
                "x-ray: the next move, on day {}, raised expectations by {}",
                next.day,
                grouped_number(made.boost, 4)
            )
        }
        None => format!(
            "x-ray: next move on day {}: {}, or {} of the uncopied quality if that is more",
            next.day,
            grouped_number(next.sampled_size, 4),
            novamind_base::formatting::percent(next.copied_share, 0)
        ),
    }
}

/// Returns the lines on the economy and drift.
pub fn economy_lines(hidden: &HiddenValues) -> Vec<String> {
    let drift = match hidden.next_drift_day {
        Some(day) => format!("next drift on day {day}"),
        None => "no drift before the end".to_owned(),
    };
    vec![format!(
        "x-ray, day {}: PMI {}; expectations are {} higher than on day 0; {drift}",
        hidden.day,
        grouped_number(hidden.pmi, 2),
        grouped_number(hidden.common_expectation, 4)
    )]
}

/// Draws the lines in at most the upper half of an area; returns the rest.
pub fn draw_lines_above(canvas: &mut Canvas<'_>, area: Rect, texts: &[String]) -> Rect {
    let lines: Vec<String> =
        texts.iter().flat_map(|line| wrap(line, usize::from(area.width.max(1)))).collect();
    let height = (lines.len() as u16).min(area.height / 2);
    for (row, line) in row_rects(Rect { height, ..area }).zip(&lines) {
        canvas.draw_text(row, line, Role::Changed);
    }
    Rect { y: area.y + height, height: area.height - height, ..area }
}
