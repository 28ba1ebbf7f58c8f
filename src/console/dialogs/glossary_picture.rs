//! Charts for glossary terms, from figures of the open company.

use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use novamind_base::formatting::{compact_number, dollars};
pub use novamind_report::term_picture::has_picture;
use novamind_report::term_picture::{
    TermDrawing, TermLines, TermPicture, TermXAxis, VisibleFigures, term_picture,
};
use novamind_tui::canvas::{Align, Canvas, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::{Band, Curve, Plot, PointLabel, XAxis, YAxis};
use novamind_tui::widgets::scale::AxisUnit;
use novamind_worker::company::DisplayedCompany;

/// Minimum height of a picture, in rows.
pub const MIN_ROWS: u16 = 7;
const MIN_COLUMNS: u16 = 20;
/// Maximum height of a picture, in rows.
pub const MAX_ROWS: u16 = 11;
/// Width of a picture that is drawn next to a text, in columns.
pub const SIDE_COLUMNS: u16 = 44;
const MAX_CAPTION_ROWS: usize = 3;

/// Draws the chart of a term, if the term has a chart.
pub fn draw(canvas: &mut Canvas<'_>, area: Rect, term: &str, company: &DisplayedCompany) {
    let seen = VisibleFigures {
        weeks: &company.weeks,
        group_weeks: &company.group_weeks,
        fits: &company.fits,
        quality: &company.quality,
        quality_base: company.quality_base,
        numbers: &company.numbers,
    };
    let Some(TermPicture { caption, drawing }) = term_picture(term, &seen) else { return };
    if area.height < MIN_ROWS || area.width < MIN_COLUMNS {
        return;
    }
    let words = wrap(&caption, area.width as usize);
    for (row, line) in row_rects(area).zip(words.iter().take(MAX_CAPTION_ROWS)) {
        canvas.draw_text(row, line, Role::Dim);
    }
    let taken = (words.len().min(MAX_CAPTION_ROWS) as u16).min(area.height);
    let rest = Rect { y: area.y + taken, height: area.height - taken, ..area };
    match drawing {
        Some(TermDrawing::Lines(term_lines)) => draw_lines(canvas, rest, &term_lines),
        Some(TermDrawing::Bars(bars)) => draw_bars(canvas, rest, &bars),
        None => {}
    }
}

fn draw_lines(canvas: &mut Canvas<'_>, area: Rect, term_lines: &TermLines) {
    let named = term_lines.lines.iter().enumerate();
    let lines: Vec<Curve> = named
        .map(|(at, (name, points))| Curve::from_points(points.clone(), Role::Series(at)).with_name(name))
        .collect();
    let band = Band { bounds: term_lines.band.clone(), name: "" };
    let write = |value: f64| match term_lines.x_axis {
        TermXAxis::Dollars => dollars(value),
        TermXAxis::Weeks => format!("wk {value:.0}"),
        TermXAxis::Share => compact_number(value),
    };
    let x = XAxis { format: &write, required_values: &[] };
    let y = YAxis { unit: AxisUnit::Number, required_values: &[0.0] };
    let sign = |(plan, x, y): &(novamind_session::identifiers::Plan, f64, f64)| PointLabel {
        x: *x,
        y: *y,
        text: plan.id(),
        role: Role::Strong,
    };
    let signs: Vec<PointLabel> = term_lines.plans.iter().map(sign).collect();
    let band = (!term_lines.band.is_empty()).then_some(&band);
    Plot { curves: &lines, band, marked_x: None, x: &x, y: &y }.draw_with_labels(canvas, area, &signs);
}

fn draw_bars(canvas: &mut Canvas<'_>, area: Rect, bars: &[(String, f64)]) {
    let max = bars.iter().map(|bar| bar.1).fold(0.0, f64::max);
    let names = bars.iter().map(|bar| bar.0.width()).max().unwrap_or(0) as u16;
    for (row, (name, value)) in row_rects(area).zip(bars) {
        canvas.draw_text(Rect { width: names.min(row.width), ..row }, name, Role::Text);
        let after =
            |x: u16, width: u16| Rect { x: row.x + x, width: width.min(row.width.saturating_sub(x)), ..row };
        canvas.draw_aligned(after(names + 1, 7), &compact_number(*value), Role::Text, Align::Right);
        let room = row.width.saturating_sub(names + 9);
        let cells = if max > 0.0 { (value.max(0.0) / max * f64::from(room)).round() as usize } else { 0 };
        canvas.draw_text(after(names + 9, room), &"█".repeat(cells), Role::Series(0));
    }
}
