//! Comparison of runs by their cash curves and current figures.

use ratatui::layout::Rect;

use super::StartMenu;
use super::runs::{draw_curves, loaded_preview, progress_label};
use novamind_base::formatting::{compact_number, dollars};
use novamind_record::folder::preview::RunPreview;
use novamind_record::folder::runs::RunSummary;
use novamind_record::mode::Mode;
use novamind_tui::canvas::{Align, Canvas, row_rects};
use novamind_tui::theme::Role;
use novamind_tui::widgets::sparkline::sparkline;

/// Title, width and alignment of each column. Narrow windows show only the first columns. The curve in each row
/// identifies a run on terminals without colors.
const COMPARISON_COLUMNS: [(&str, u16, Align); 8] = [
    ("", 3, Align::Left),
    ("run", 8, Align::Left),
    ("state", 16, Align::Left),
    ("cash", 12, Align::Right),
    ("subs", 7, Align::Right),
    ("seats", 7, Align::Right),
    ("revenue/mo", 12, Align::Right),
    ("mode", 8, Align::Left),
];

/// Number of columns in narrow windows, and the minimum window width for all columns.
const NARROW_LAYOUT: (usize, u16) = (5, 104);

impl StartMenu {
    pub(super) fn draw_compare(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let runs: Vec<&RunSummary> =
            self.marked.iter().filter_map(|id| self.runs().iter().find(|run| run.id == *id)).collect();
        let for_figures = (runs.len() as u16 + 3).min(area.height);
        let above = Rect { height: area.height - for_figures, ..area };
        let below = Rect { y: above.bottom(), height: for_figures, ..area };
        let previews: Vec<(usize, &RunPreview)> = runs
            .iter()
            .enumerate()
            .filter_map(|(at, run)| loaded_preview(&self.previews, &run.id).map(|preview| (at, preview)))
            .collect();
        if above.height >= 5 {
            let inside = canvas.draw_pane_frame(above, "Cash", &format!("{} runs", runs.len()), false);
            if previews.len() < runs.len() {
                canvas.draw_text(inside, " reading …", Role::Dim);
            } else {
                draw_curves(canvas, inside, &previews);
            }
        }
        let inside = canvas.draw_pane_frame(below, "Current figures", "", false);
        let mut rows = row_rects(inside);
        if let Some(head) = rows.next() {
            let titles = COMPARISON_COLUMNS.map(|(title, ..)| title.to_owned());
            draw_cells(canvas, head, &titles, |_| Role::Header);
            let rest = chart_area(head);
            canvas.draw_text(rest, "cash by week", Role::Header);
        }
        for (row, (at, run)) in rows.zip(runs.iter().enumerate()) {
            let preview = loaded_preview(&self.previews, &run.id);
            let cells = row_cells(at, run, preview);
            draw_cells(canvas, row, &cells, |column| if column == 0 { Role::Series(at) } else { Role::Text });
            let rest = chart_area(row);
            if let Some(preview) = preview {
                let values: Vec<f64> = preview.cash.iter().map(|point| point.1).collect();
                canvas.draw_text(
                    rest,
                    &sparkline(&downsample(&values, rest.width as usize), rest.width as usize),
                    Role::Series(at),
                );
            }
        }
    }
}

fn row_cells(at: usize, run: &RunSummary, preview: Option<&RunPreview>) -> [String; 8] {
    let figure = |read: fn(&RunPreview) -> f64| {
        preview.map_or("…".to_owned(), |preview| compact_number(read(preview)))
    };
    [
        format!("{}━", at + 1),
        run.id.clone(),
        progress_label(run),
        dollars(run.cash),
        figure(|preview| preview.subscribers as f64),
        figure(|preview| preview.seats as f64),
        preview.map_or("…".to_owned(), |preview| dollars(preview.recurring_revenue)),
        run.mode.map_or("", Mode::id).to_owned(),
    ]
}

fn draw_cells(canvas: &mut Canvas<'_>, row: Rect, cells: &[String; 8], role: impl Fn(usize) -> Role) {
    let mut x = row.x + 1;
    for (at, (cell, (_, width, align))) in
        cells.iter().zip(COMPARISON_COLUMNS).enumerate().take(visible_columns(row))
    {
        if x + width > row.right() {
            return;
        }
        canvas.draw_aligned(Rect { x, width, ..row }, cell, role(at), align);
        x += width + 1;
    }
}

fn visible_columns(row: Rect) -> usize {
    if row.width >= NARROW_LAYOUT.1 { COMPARISON_COLUMNS.len() } else { NARROW_LAYOUT.0 }
}

/// Returns the area of a row to the right of the columns.
fn chart_area(row: Rect) -> Rect {
    let shown = COMPARISON_COLUMNS.iter().take(visible_columns(row));
    let used = shown.map(|(_, width, _)| width + 1).sum::<u16>() + 2;
    Rect { x: row.x + used, width: row.width.saturating_sub(used + 1), ..row }
}

/// Returns at most `most` of the values, evenly spaced, including the last value.
fn downsample(values: &[f64], most: usize) -> Vec<f64> {
    if values.len() <= most || most == 0 {
        return values.to_vec();
    }
    (1..=most).map(|at| values[at * values.len() / most - 1]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn downsample_is_even_and_keeps_the_last_value() {
        let values: Vec<f64> = (0..10).map(f64::from).collect();
        assert_eq!(downsample(&values, 5), [1.0, 3.0, 5.0, 7.0, 9.0]);
        assert_eq!(downsample(&values, 3).last(), Some(&9.0));
        assert_eq!(downsample(&values, 20), values);
        assert_eq!(downsample(&[], 3), Vec::<f64>::new());
    }
}
