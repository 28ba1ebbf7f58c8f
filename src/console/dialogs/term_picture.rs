//! Charts for glossary terms, from figures of the open company.

use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use novamind_base::notation::{compact, dollars};
pub use novamind_report::term_picture::has_picture;
use novamind_report::term_picture::{Across, SeenFigures, TermDrawing, TermLines, TermPicture, term_picture};
use novamind_tui::canvas::{Align, Canvas, rows_of};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::{Axis, Band, Line, Plot, Side, Sign};
use novamind_tui::widgets::scale::Unit;
use novamind_worker::company::Company;

/// Minimum height, in rows.
pub const LEAST_ROWS: u16 = 7;
const LEAST_COLUMNS: u16 = 20;
/// Maximum height, in rows.
pub const MOST_ROWS: u16 = 11;
/// Width next to a text, in columns.
pub const COLUMNS: u16 = 44;
const CAPTION: usize = 3;

/// Draws the chart of a term, if it has one.
pub fn draw(canvas: &mut Canvas<'_>, area: Rect, term: &str, company: &Company) {
    let seen = SeenFigures {
        weeks: &company.weeks,
        group_weeks: &company.group_weeks,
        fits: &company.fits,
        quality: &company.quality,
        quality_base: company.quality_base,
        numbers: &company.numbers,
    };
    let Some(TermPicture { caption, drawing }) = term_picture(term, &seen) else { return };
    if area.height < LEAST_ROWS || area.width < LEAST_COLUMNS {
        return;
    }
    let words = wrapped(&caption, area.width as usize);
    for (row, line) in rows_of(area).zip(words.iter().take(CAPTION)) {
        canvas.text(row, line, Role::Dim);
    }
    let taken = (words.len().min(CAPTION) as u16).min(area.height);
    let rest = Rect { y: area.y + taken, height: area.height - taken, ..area };
    match drawing {
        Some(TermDrawing::Lines(own)) => draw_lines(canvas, rest, &own),
        Some(TermDrawing::Bars(bars)) => draw_bars(canvas, rest, &bars),
        None => {}
    }
}

fn draw_lines(canvas: &mut Canvas<'_>, area: Rect, own: &TermLines) {
    let named = own.lines.iter().enumerate();
    let lines: Vec<Line> = named
        .map(|(at, (name, points))| Line::through(points.clone(), Role::Series(at)).named(name))
        .collect();
    let band = Band { ends: own.band.clone(), name: "" };
    let write = |value: f64| match own.across {
        Across::Dollars => dollars(value),
        Across::Weeks => format!("wk {value:.0}"),
        Across::Share => compact(value),
    };
    let x = Axis { write: &write, holds: &[] };
    let y = Side { unit: Unit::Number, holds: &[0.0] };
    let sign = |(plan, x, y): &(novamind_session::identifiers::Plan, f64, f64)| Sign {
        x: *x,
        y: *y,
        text: plan.id(),
        role: Role::Strong,
    };
    let signs: Vec<Sign> = own.plans.iter().map(sign).collect();
    let band = (!own.band.is_empty()).then_some(&band);
    Plot { lines: &lines, band, mark: None, x: &x, y: &y }.draw_with(canvas, area, &signs);
}

fn draw_bars(canvas: &mut Canvas<'_>, area: Rect, bars: &[(String, f64)]) {
    let most = bars.iter().map(|bar| bar.1).fold(0.0, f64::max);
    let names = bars.iter().map(|bar| bar.0.width()).max().unwrap_or(0) as u16;
    for (row, (name, value)) in rows_of(area).zip(bars) {
        canvas.text(Rect { width: names.min(row.width), ..row }, name, Role::Text);
        let after =
            |x: u16, width: u16| Rect { x: row.x + x, width: width.min(row.width.saturating_sub(x)), ..row };
        canvas.aligned(after(names + 1, 7), &compact(*value), Role::Text, Align::Right);
        let room = row.width.saturating_sub(names + 9);
        let cells = if most > 0.0 { (value.max(0.0) / most * f64::from(room)).round() as usize } else { 0 };
        canvas.text(after(names + 9, room), &"█".repeat(cells), Role::Series(0));
    }
}
