//! Service measures by day, and outages.

use ratatui::layout::Rect;

use super::model::Day;
use super::part::ProductPart;
use super::{Product, ProductPane};
use crate::context::{Figure, NO_DATA};
use crate::effect::Effect;
use crate::screens::panes::Seat;
use novamind_base::notation::{grouped, percent};
use novamind_insight::WeekQuantity;
use novamind_record::figures::WeekFigure;
use novamind_tui::canvas::{Align, Canvas, rows_of};
use novamind_tui::text::{fitting, number};
use novamind_tui::theme::Role;
use novamind_tui::widgets::spark;
use novamind_worker::company::Company;

pub struct Service;

impl ProductPart for Service {
    fn name(&self) -> ProductPane {
        ProductPane::Service
    }

    fn summary(&self, product: &Product, _: &Company, width: usize) -> String {
        fitting(summary(&product.days), width)
    }

    fn destination(&self, _: &Product) -> &'static str {
        "service_day"
    }

    fn open(&self, _: &Product, _: &Company) -> Effect {
        Effect::EditSql("SELECT * FROM service_day ORDER BY day DESC".to_owned())
    }

    fn selected(&self, _: &Product, company: &Company) -> Option<Figure> {
        let sql = "SELECT day, p95_ms, error_rate, downtime_minutes, total_usage_units, capacity_units\n\
                   FROM service_day ORDER BY day DESC LIMIT 28";
        let title = "service, 28 days".to_owned();
        let figure = Figure { title, term: "outage", sql: Some(sql.to_owned()), why: None };
        Some(figure.of_week(WeekQuantity::of_company(WeekFigure::Outage), company.seen.week))
    }

    fn paint(&self, product: &Product, canvas: &mut Canvas<'_>, seat: Seat, _: &Company) {
        draw(canvas, seat.area, &product.days);
    }
}

/// Name, reader, format and aggregation of a measure.
type Measure = (&'static str, fn(&Day) -> f64, fn(f64) -> String, fn(&[f64]) -> f64);

static MEASURES: [Measure; 4] = [
    ("utilization", Day::utilisation, |share| percent(share, 0), peak),
    ("latency p95, ms", |day| day.latency, |value| grouped(value, 0), peak),
    ("error rate", |day| day.errors, |share| percent(share, 2), peak),
    ("outage, minutes", |day| day.downtime, number, |days| days.iter().sum()),
];

fn peak(days: &[f64]) -> f64 {
    days.iter().copied().fold(0.0, f64::max)
}

/// Returns one line on the service, longest wording first.
pub fn summary(days: &[Day]) -> Vec<String> {
    let Some(last) = days.last() else { return vec![NO_DATA.to_owned()] };
    let minutes: f64 = days.iter().rev().take(28).map(|day| day.downtime).sum();
    let (latency, errors) = (grouped(last.latency, 0), percent(last.errors, 2));
    let outage = format!("outage {} min", number(minutes));
    vec![
        format!("p95 {latency} ms · errors {errors} · {outage} in 28 days"),
        format!("p95 {latency} ms · errors {errors} · {outage}/28 d"),
    ]
}

/// Draws the measures by day, then the last outages.
pub fn draw(canvas: &mut Canvas<'_>, area: Rect, days: &[Day]) {
    let head = format!("{:<16}{:>8}{:>9}{:>9}  ", "", "last", "7-day", "28-day");
    canvas.text(area, &head, Role::Header);
    let trend = area.width.saturating_sub(44);
    canvas.text(
        Rect { x: area.x + 44.min(area.width), width: trend, ..area },
        &format!("last {} days", (trend as usize).min(days.len())),
        Role::Header,
    );
    let rows = rows_of(Rect { y: area.y + 1, height: area.height.saturating_sub(1), ..area });
    let figures = MEASURES.iter().map(Some).chain(std::iter::once(None));
    for (row, measure) in rows.zip(figures) {
        match measure {
            Some(measure) => draw_measure(canvas, row, measure, days),
            None => draw_outages(canvas, row, days),
        }
    }
}

fn draw_measure(canvas: &mut Canvas<'_>, row: Rect, (name, read, write, together): &Measure, days: &[Day]) {
    let values: Vec<f64> = days.iter().map(read).collect();
    let of_days = |count: usize| match &values[values.len().saturating_sub(count)..] {
        [] => "–".to_owned(),
        last => write(together(last)),
    };
    let last = values.last().map_or("–".to_owned(), |value| write(*value));
    let text = format!("{name:<16}{last:>8}{:>9}{:>9}", of_days(7), of_days(28));
    canvas.text(row, &text, Role::Text);
    if row.width > 44 {
        let room = row.width - 44;
        let place = Rect { x: row.x + 44, width: room, ..row };
        canvas.text(place, &spark(&values, room as usize), Role::Series(0));
    }
    let overloaded = *name == "utilization" && values.last().is_some_and(|value| *value > 1.0);
    if overloaded {
        canvas.aligned(Rect { width: 43.min(row.width), ..row }, "!", Role::Bad, Align::Right);
    }
}

fn draw_outages(canvas: &mut Canvas<'_>, row: Rect, days: &[Day]) {
    let outages: Vec<String> = days
        .iter()
        .rev()
        .filter(|day| day.downtime > 0.0)
        .take(6)
        .map(|day| format!("day {} {} min", day.day, number(day.downtime)))
        .collect();
    let text = match outages.is_empty() {
        true => "No outages so far. 7-day and 28-day figures are peaks.".to_owned(),
        false => format!("outages: {}", outages.join(" · ")),
    };
    canvas.text(row, &text, Role::Dim);
}
