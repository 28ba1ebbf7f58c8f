//! The index of the economy as it was published, with the days that are measured but not told yet.

use ratatui::layout::Rect;

use super::model::Published;
use crate::console::canvas::{Canvas, rows_of};
use crate::console::company::Company;
use crate::console::text::wrapped;
use crate::console::theme::Role;
use crate::console::widgets::{Axis, Line, chart};
use crate::notation::grouped;
use crate::session::Terms;

/// Day on which the next measurement is published.
pub fn next_day(economy: &[Published], terms: &Terms) -> u32 {
    let measured = economy.last().map_or(1, |last| last.day + terms.economy_every_days);
    measured + terms.economy_lag_days
}

/// Draws the pane.
pub fn draw(canvas: &mut Canvas<'_>, area: Rect, company: &Company, economy: &[Published]) {
    let terms = &company.terms;
    let Some(last) = economy.last() else {
        let inside = canvas.pane(area, "Economy", "", false);
        let words = format!(
            "no index yet: the one of day 1 is published on day {}, {} days after it was measured",
            next_day(economy, terms),
            terms.economy_lag_days
        );
        for (row, line) in rows_of(inside).zip(wrapped(&words, inside.width as usize)) {
            canvas.text(row, &line, Role::Dim);
        }
        return;
    };
    let sign = if last.change < 0.0 { '-' } else { '+' };
    let figures = format!("PMI {} ({sign}{})", grouped(last.value, 1), grouped(last.change.abs(), 1));
    let inside = canvas.pane(area, "Economy", &format!("{figures} · {}", last.words), false);
    let lag = format!(
        "measured on day {}, told on day {}; next on day {}",
        last.day,
        last.day + terms.economy_lag_days,
        next_day(economy, terms)
    );
    let mut words = wrapped(&last.text, inside.width as usize);
    words.push(lag);
    let room = (inside.height / 2) as usize;
    let words = &words[words.len().saturating_sub(room.max(1))..];
    let above = inside.height.saturating_sub(words.len() as u16);
    draw_curve(canvas, Rect { height: above, ..inside }, company, economy, last);
    let below = Rect { y: inside.y + above, height: inside.height - above, ..inside };
    for (row, line) in rows_of(below).zip(words) {
        canvas.text(row, line, Role::Dim);
    }
}

fn draw_curve(
    canvas: &mut Canvas<'_>,
    area: Rect,
    company: &Company,
    economy: &[Published],
    last: &Published,
) {
    let points = economy.iter().map(|own| (f64::from(own.day), own.value)).collect();
    // Dots run on at the last value over the days of which nothing is told yet.
    let silent = (last.day..=company.seen.day).step_by(4).map(|day| (f64::from(day), last.value)).collect();
    let lines = [
        Line { scattered: true, ..Line::through(silent, Role::Dim) },
        Line::through(points, Role::Series(0)),
    ];
    let today = [f64::from(company.seen.day)];
    let x = Axis { write: &|day| format!("day {day:.0}"), holds: &today };
    chart(canvas, area, &lines, &x, &Axis { write: &|value| grouped(value, 1), holds: &[50.0] });
}
