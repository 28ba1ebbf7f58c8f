//! True values of competitors, drift and the economy, shown above the public figures. A key shows and hides true
//! values.

use ratatui::layout::Rect;

use novamind_base::formatting::grouped_number;
use novamind_insight::{HiddenValues, NextCompetitorMove};
use novamind_tui::canvas::{Canvas, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;

/// Returns the lines about competitors: the quality that competitors have not copied yet, and their next move.
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
    let Some(next) = next else { return "x-ray: no competitor move before the run ends".to_owned() };
    match &next.outcome {
        Some(made) => {
            format!(
                "x-ray: next move on day {}: raised expectations by {}",
                next.day,
                grouped_number(made.boost, 4)
            )
        }
        None => format!(
            "x-ray: next move on day {}: raises expectations by the larger of {} and {} of the uncopied quality",
            next.day,
            grouped_number(next.sampled_size, 4),
            novamind_base::formatting::percent(next.copied_share, 0)
        ),
    }
}

/// Returns the lines about the economy and drift.
pub fn economy_lines(hidden: &HiddenValues) -> Vec<String> {
    let drift = match hidden.next_drift_day {
        Some(day) => format!("next drift on day {day}"),
        None => "no drift until the end".to_owned(),
    };
    vec![format!(
        "x-ray, day {}: PMI {}; expectations +{} since day 0; {drift}",
        hidden.day,
        grouped_number(hidden.pmi, 2),
        grouped_number(hidden.common_expectation, 4)
    )]
}

/// Draws lines in at most the upper half of an area. Returns the remaining area.
pub fn draw_lines_above(canvas: &mut Canvas<'_>, area: Rect, texts: &[String]) -> Rect {
    let lines: Vec<String> =
        texts.iter().flat_map(|line| wrap(line, usize::from(area.width.max(1)))).collect();
    let height = (lines.len() as u16).min(area.height / 2);
    for (row, line) in row_rects(Rect { height, ..area }).zip(&lines) {
        canvas.draw_text(row, line, Role::Changed);
    }
    Rect { y: area.y + height, height: area.height - height, ..area }
}
