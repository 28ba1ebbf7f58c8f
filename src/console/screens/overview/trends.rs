//! Small charts of the weeks for large windows.

use ratatui::layout::Rect;

use super::figures::{METRICS, Metric};
use crate::screens::product::model::Day;
use novamind_base::notation::{compact, percent};
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::{note_room, summary, zero_if_near};
use novamind_tui::widgets::{Axis, Line, Side, Unit, chart};
use novamind_worker::company::Company;

/// Minimum height of a small chart with its border.
const LEAST: u16 = 8;
const MOST: u16 = 16;

/// Figures with charts and their titles, most informative first.
static SHOWN: [(&str, &str); 6] = [
    ("subscribers", "Subscribers"),
    ("recurring revenue", "Recurring revenue"),
    ("individual leads", "Individual leads"),
    ("cancellations", "Cancellations"),
    ("payments", "Payments"),
    ("running costs", "Running costs"),
];

/// Draws as many charts as fit, two per row.
pub fn draw(canvas: &mut Canvas<'_>, area: Rect, company: &Company) {
    let rows = (area.height / LEAST).min(SHOWN.len() as u16 / 2);
    if rows == 0 || area.width < 40 {
        return;
    }
    let found = |(name, title): &(&str, &'static str)| {
        METRICS.iter().find(|metric| metric.name == *name).map(|metric| (metric, *title))
    };
    let metrics = SHOWN.iter().filter_map(found);
    for (at, (metric, title)) in metrics.take(2 * rows as usize).enumerate() {
        let (row, column) = (at as u16 / 2, at as u16 % 2);
        let (top, below) = (area.height * row / rows, area.height * (row + 1) / rows);
        let half = area.width / 2;
        let width = if column == 0 { half } else { area.width - half };
        let place = Rect { x: area.x + column * half, y: area.y + top, width, height: below - top };
        draw_one(canvas, place, metric, title, company);
    }
}

/// Returns the height that the charts take from the free rows.
pub fn height(room: u16) -> u16 {
    if room < LEAST { 0 } else { room.min(3 * MOST) }
}

fn draw_one(canvas: &mut Canvas<'_>, area: Rect, metric: &Metric, title: &str, company: &Company) {
    let weeks: Vec<(f64, f64)> =
        company.weeks.iter().map(|week| (f64::from(week.day) / 7.0, (metric.read)(week))).collect();
    let values: Vec<f64> = weeks.iter().map(|point| point.1).collect();
    let dollar = matches!(metric.name, "recurring revenue" | "payments" | "running costs");
    let write = move |value: f64| {
        if dollar { novamind_base::notation::short_dollars(value) } else { compact(value) }
    };
    let unit = if dollar { Unit::Dollars } else { Unit::Number };
    let words = summary(&values, &write, note_room(area, title));
    let inside = canvas.pane(area, title, &words, false);
    let zero = zero_if_near(values.iter().copied());
    let x = Axis { write: &|week| format!("wk {week:.0}"), holds: &[] };
    chart(canvas, inside, &[Line::through(weeks, Role::Series(0))], &x, &Side { unit, holds: zero });
}

pub fn draw_usage(canvas: &mut Canvas<'_>, area: Rect, days: &[Day]) {
    let title = "Usage against capacity, units a day";
    let words = match days.last() {
        Some(last) => format!(
            "{} of {} · {} used",
            compact(last.usage),
            compact(last.capacity),
            percent(last.utilisation(), 0)
        ),
        None => String::new(),
    };
    let inside = canvas.pane(area, title, &words, false);
    let points = |value: fn(&Day) -> f64| days.iter().map(|day| (f64::from(day.day), value(day))).collect();
    let lines = [
        Line::through(points(|day| day.capacity), Role::Warning).named("capacity"),
        Line::through(points(|day| day.usage), Role::Series(0)).named("usage"),
    ];
    let x = Axis { write: &|day| format!("day {day:.0}"), holds: &[] };
    chart(canvas, inside, &lines, &x, &Side { unit: Unit::Number, holds: &[0.0] });
}
