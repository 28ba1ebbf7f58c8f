//! The projector view: four figures, the cash curve and the decisions of a followed run.

use ratatui::layout::Rect;

use super::context::Look;
use super::viewer::{EntriesShown, Viewer};
use novamind_base::notation::{compact, short_dollars};
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::zero_if_near;
use novamind_tui::widgets::large::{LETTER, PointSize, draw_large};
use novamind_tui::widgets::{Axis, Line, Side, Unit, chart};
use novamind_worker::company::Company;

/// Characters of the longest figure: `-$12.3M`.
const LONGEST: u16 = 7;
/// Columns of four figures side by side at one column per point.
const SIDE_BY_SIDE: u16 = 4 * (LONGEST * LETTER + 1);

/// Draws the view.
pub fn draw(canvas: &mut Canvas<'_>, area: Rect, viewer: &Viewer, look: &Look<'_>) {
    let size = match area.width >= 2 * SIDE_BY_SIDE - 36 && area.height >= 30 {
        true => PointSize::Large,
        false => PointSize::Small,
    };
    let beside = if area.width >= SIDE_BY_SIDE * size.columns() - 36 { 4 } else { 2 };
    // Label and digits.
    let tall = size.rows() + 1;
    let gap = u16::from(area.height >= 24);
    for (at, (label, figure, role)) in (0u16..).zip(figures(look.company)) {
        let place = Rect {
            x: area.x + at % beside * (area.width / beside),
            y: area.y + at / beside * (tall + gap),
            width: area.width / beside,
            height: tall,
        };
        canvas.text(
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
        draw_large(canvas, letters, &figure, role, size);
    }
    let used = 4 / beside * (tall + gap);
    let below = Rect { y: area.y + used, height: area.height.saturating_sub(used), ..area };
    let left = Rect { width: below.width * 3 / 5, ..below };
    draw_cash(canvas, left, look.company);
    let right = Rect { x: left.right(), width: below.width - left.width, ..below };
    viewer.draw_decisions(canvas, right, look, EntriesShown::Decisions);
}

fn figures(company: &Company) -> [(&'static str, String, Role); 4] {
    let seen = &company.seen;
    let change = company.weeks.last().map_or(0.0, |week| week.cash_change);
    let sign = if change > 0.0 { "+" } else { "" };
    let role = |value: f64| if value < 0.0 { Role::Bad } else { Role::Good };
    [
        ("day", seen.day.to_string(), Role::Strong),
        ("cash", short_dollars(seen.cash), role(seen.cash)),
        ("cash, last week", format!("{sign}{}", short_dollars(change)), role(change)),
        ("subscribers", compact(f64::from(seen.subscribers)), Role::Strong),
    ]
}

fn draw_cash(canvas: &mut Canvas<'_>, area: Rect, company: &Company) {
    let inside = canvas.pane(area, "Cash", &format!("of {} days", company.seen.last_day), false);
    let points = (0u32..).zip(&company.cash_by_day).map(|(day, cash)| (f64::from(day), *cash)).collect();
    let x = Axis { write: &|day| format!("day {day:.0}"), holds: &[0.0] };
    let y = Side { unit: Unit::Dollars, holds: zero_if_near(company.cash_by_day.iter().copied()) };
    chart(canvas, inside, &[Line::through(points, Role::Series(0))], &x, &y);
}
