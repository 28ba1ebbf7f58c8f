//! Small charts of figures by week, shown in large windows.

use ratatui::layout::Rect;

use super::figures::{METRICS, Metric};
use crate::screens::product::model::ServiceDay;
use novamind_base::formatting::{compact_number, percent};
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::{note_width, summary, zero_if_near};
use novamind_tui::widgets::{XAxis, Curve, YAxis, AxisUnit, draw_chart};
use novamind_worker::company::DisplayedCompany;

/// Minimum height of a small chart with its border.
const MIN_CHART_HEIGHT: u16 = 8;
const MAX_CHART_HEIGHT: u16 = 16;

/// Names of figures with charts and the titles of the charts, the most informative first.
static CHARTS: [(&str, &str); 6] = [
    ("subscribers", "Subscribers"),
    ("recurring revenue", "Recurring revenue"),
    ("individual leads", "Individual leads"),
    ("cancellations", "Cancellations"),
    ("payments", "Payments"),
    ("running costs", "Running costs without lead costs"),
];

/// Draws as many charts as fit, two per row.
pub fn draw(canvas: &mut Canvas<'_>, area: Rect, company: &DisplayedCompany) {
    let rows = (area.height / MIN_CHART_HEIGHT).min(CHARTS.len() as u16 / 2);
    if rows == 0 || area.width < 40 {
        return;
    }
    let found = |(name, title): &(&str, &'static str)| {
        METRICS.iter().find(|metric| metric.name == *name).map(|metric| (metric, *title))
    };
    let metrics = CHARTS.iter().filter_map(found);
    for (at, (metric, title)) in metrics.take(2 * rows as usize).enumerate() {
        let (row, column) = (at as u16 / 2, at as u16 % 2);
        let (top, below) = (area.height * row / rows, area.height * (row + 1) / rows);
        let half = area.width / 2;
        let width = if column == 0 { half } else { area.width - half };
        let place = Rect { x: area.x + column * half, y: area.y + top, width, height: below - top };
        draw_metric_chart(canvas, place, metric, title, company);
    }
}

/// Returns the height of the charts if `room` rows are free.
pub fn charts_height(room: u16) -> u16 {
    if room < MIN_CHART_HEIGHT { 0 } else { room.min(3 * MAX_CHART_HEIGHT) }
}

fn draw_metric_chart(canvas: &mut Canvas<'_>, area: Rect, metric: &Metric, title: &str, company: &DisplayedCompany) {
    let weeks: Vec<(f64, f64)> =
        company.weeks.iter().map(|week| (f64::from(week.day) / 7.0, (metric.read)(week))).collect();
    let values: Vec<f64> = weeks.iter().map(|point| point.1).collect();
    let dollar = matches!(metric.name, "recurring revenue" | "payments" | "running costs");
    let write = move |value: f64| {
        if dollar { novamind_base::formatting::short_dollars(value) } else { compact_number(value) }
    };
    let unit = if dollar { AxisUnit::Dollars } else { AxisUnit::Number };
    let words = summary(&values, &write, note_width(area, title));
    let inside = canvas.draw_pane_frame(area, title, &words, false);
    let zero = zero_if_near(values.iter().copied());
    let x = XAxis { format: &|week| format!("wk {week:.0}"), required_values: &[] };
    draw_chart(canvas, inside, &[Curve::from_points(weeks, Role::Series(0))], &x, &YAxis { unit, required_values: zero });
}

pub fn draw_usage(canvas: &mut Canvas<'_>, area: Rect, days: &[ServiceDay]) {
    let title = "Usage and capacity, units per day";
    let words = match days.last() {
        Some(last) => format!(
            "{} of {} · {} used",
            compact_number(last.usage),
            compact_number(last.capacity),
            percent(last.utilization(), 0)
        ),
        None => String::new(),
    };
    let inside = canvas.draw_pane_frame(area, title, &words, false);
    let points = |value: fn(&ServiceDay) -> f64| days.iter().map(|day| (f64::from(day.day), value(day))).collect();
    let lines = [
        Curve::from_points(points(|day| day.capacity), Role::Warning).with_name("capacity"),
        Curve::from_points(points(|day| day.usage), Role::Series(0)).with_name("usage"),
    ];
    let x = XAxis { format: &|day| format!("day {day:.0}"), required_values: &[] };
    draw_chart(canvas, inside, &lines, &x, &YAxis { unit: AxisUnit::Number, required_values: &[0.0] });
}
