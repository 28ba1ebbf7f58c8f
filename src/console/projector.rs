//! The projector view: four figures, the cash curve and the decisions of a followed run.

use ratatui::layout::Rect;

use super::context::ScreenContext;
use super::playback::{EntryFilter, PlaybackViewer};
use novamind_base::formatting::{compact_number, short_dollars};
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::zero_if_near;
use novamind_tui::widgets::large_text::{LETTER_WIDTH_POINTS, PointSize, draw_large_text};
use novamind_tui::widgets::{AxisUnit, Curve, XAxis, YAxis, draw_chart};
use novamind_worker::company::DisplayedCompany;

/// Number of characters of the longest figure, for example `-$12.3M`.
const MAX_FIGURE_LETTERS: u16 = 7;
/// Width of four figures next to each other, in columns, if a point of a digit is one column wide.
const SINGLE_ROW_WIDTH: u16 = 4 * (MAX_FIGURE_LETTERS * LETTER_WIDTH_POINTS + 1);

/// Draws the projector view.
pub fn draw(canvas: &mut Canvas<'_>, area: Rect, viewer: &PlaybackViewer, context: &ScreenContext<'_>) {
    let size = match area.width >= 2 * SINGLE_ROW_WIDTH - 36 && area.height >= 30 {
        true => PointSize::Large,
        false => PointSize::Small,
    };
    let columns_per_row = if area.width >= SINGLE_ROW_WIDTH * size.columns() - 36 { 4 } else { 2 };
    // A figure consists of a label line and the digits.
    let tall = size.rows() + 1;
    let gap = u16::from(area.height >= 24);
    for (at, (label, figure, role)) in (0u16..).zip(headline_figures(context.company)) {
        let place = Rect {
            x: area.x + at % columns_per_row * (area.width / columns_per_row),
            y: area.y + at / columns_per_row * (tall + gap),
            width: area.width / columns_per_row,
            height: tall,
        };
        canvas.draw_text(
            Rect { x: place.x + 1, width: place.width.saturating_sub(1), height: 1, ..place },
            label,
            Role::Dim,
        );
        let letters = Rect {
            x: place.x + 1,
            y: place.y + 1,
            width: place.width.saturating_sub(1),
            height: size.rows(),
        };
        draw_large_text(canvas, letters, &figure, role, size);
    }
    let used = 4 / columns_per_row * (tall + gap);
    let below = Rect { y: area.y + used, height: area.height.saturating_sub(used), ..area };
    let left = Rect { width: below.width * 3 / 5, ..below };
    draw_cash(canvas, left, context.company);
    let right = Rect { x: left.right(), width: below.width - left.width, ..below };
    viewer.draw_decisions(canvas, right, context, EntryFilter::Decisions);
}

fn headline_figures(company: &DisplayedCompany) -> [(&'static str, String, Role); 4] {
    let seen = &company.observation;
    let change = company.weeks.last().map_or(0.0, |week| week.cash_change);
    let sign = if change > 0.0 { "+" } else { "" };
    let role = |value: f64| if value < 0.0 { Role::Bad } else { Role::Good };
    [
        ("day", seen.day.to_string(), Role::Strong),
        ("cash", short_dollars(seen.cash), role(seen.cash)),
        ("cash, last week", format!("{sign}{}", short_dollars(change)), role(change)),
        ("subscribers", compact_number(f64::from(seen.subscribers)), Role::Strong),
    ]
}

fn draw_cash(canvas: &mut Canvas<'_>, area: Rect, company: &DisplayedCompany) {
    let inside =
        canvas.draw_pane_frame(area, "Cash", &format!("of {} days", company.observation.last_day), false);
    let points = (0u32..).zip(&company.cash_by_day).map(|(day, cash)| (f64::from(day), *cash)).collect();
    let x = XAxis { format: &|day| format!("day {day:.0}"), required_values: &[0.0] };
    let y =
        YAxis { unit: AxisUnit::Dollars, required_values: zero_if_near(company.cash_by_day.iter().copied()) };
    draw_chart(canvas, inside, &[Curve::from_points(points, Role::Series(0))], &x, &y);
}
