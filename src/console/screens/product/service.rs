//! The service pane: latency, error rate and outages by day, and the last outages.

use ratatui::layout::Rect;

use super::model::ServiceDay;
use super::panel::ProductPanel;
use super::{Product, ProductPane};
use crate::context::{Figure, NO_DATA};
use crate::effect::Effect;
use crate::screens::panes::PanePlacement;
use novamind_base::formatting::{grouped_number, percent};
use novamind_insight::WeekQuantity;
use novamind_record::figures::WeekFigure;
use novamind_tui::canvas::{Align, Canvas, row_rects};
use novamind_tui::text::{first_fitting, format_number};
use novamind_tui::theme::Role;
use novamind_tui::widgets::sparkline;
use novamind_worker::company::DisplayedCompany;

pub struct ServicePane;

impl ProductPanel for ServicePane {
    fn id(&self) -> ProductPane {
        ProductPane::Service
    }

    fn summary(&self, product: &Product, _: &DisplayedCompany, width: usize) -> String {
        first_fitting(summary(&product.days), width)
    }

    fn destination(&self, _: &Product) -> &'static str {
        "service_day"
    }

    fn open_effect(&self, _: &Product, _: &DisplayedCompany) -> Effect {
        Effect::EditSql("SELECT * FROM service_day ORDER BY day DESC".to_owned())
    }

    fn selected_figure(&self, _: &Product, company: &DisplayedCompany) -> Option<Figure> {
        let sql = "SELECT day, p95_ms, error_rate, downtime_minutes, total_usage_units, capacity_units\n\
                   FROM service_day ORDER BY day DESC LIMIT 28";
        let title = "service, 28 days".to_owned();
        let figure = Figure { title, term: "outage", sql: Some(sql.to_owned()), week_quantity: None };
        Some(figure.with_week_quantity(WeekQuantity::for_company(WeekFigure::Outage), company.observation.week))
    }

    fn draw_content(&self, product: &Product, canvas: &mut Canvas<'_>, placement: PanePlacement, _: &DisplayedCompany) {
        draw(canvas, placement.area, &product.days);
    }
}

/// Name, accessor, format and aggregation of a service measure.
type ServiceMeasure = (&'static str, fn(&ServiceDay) -> f64, fn(f64) -> String, fn(&[f64]) -> f64);

static SERVICE_MEASURES: [ServiceMeasure; 4] = [
    ("utilization, max", ServiceDay::utilization, |share| percent(share, 0), max_value),
    ("p95 ms, max", |day| day.latency_ms, |value| grouped_number(value, 0), max_value),
    ("error rate, max", |day| day.error_rate, |share| percent(share, 2), max_value),
    ("outage, minutes", |day| day.downtime_minutes, format_number, |days| days.iter().sum()),
];

fn max_value(days: &[f64]) -> f64 {
    days.iter().copied().fold(0.0, f64::max)
}

/// Returns one-line summaries of the service, the longest first.
pub fn summary(days: &[ServiceDay]) -> Vec<String> {
    let Some(last) = days.last() else { return vec![NO_DATA.to_owned()] };
    let minutes: f64 = days.iter().rev().take(28).map(|day| day.downtime_minutes).sum();
    let (latency, errors) = (grouped_number(last.latency_ms, 0), percent(last.error_rate, 2));
    let outage = format!("outage {} min", format_number(minutes));
    vec![
        format!("p95 {latency} ms · errors {errors} · {outage} in 28 days"),
        format!("p95 {latency} ms · errors {errors} · {outage}/28 d"),
    ]
}

/// Draws the service measures by day, followed by the last outages.
pub fn draw(canvas: &mut Canvas<'_>, area: Rect, days: &[ServiceDay]) {
    let head = format!("{:<16}{:>8}{:>9}{:>9}  ", "", "last", "7-day", "28-day");
    canvas.draw_text(area, &head, Role::Header);
    let trend = area.width.saturating_sub(44);
    canvas.draw_text(
        Rect { x: area.x + 44.min(area.width), width: trend, ..area },
        &format!("last {} days", (trend as usize).min(days.len())),
        Role::Header,
    );
    let rows = row_rects(Rect { y: area.y + 1, height: area.height.saturating_sub(1), ..area });
    let figures = SERVICE_MEASURES.iter().map(Some).chain(std::iter::once(None));
    for (row, measure) in rows.zip(figures) {
        match measure {
            Some(measure) => draw_measure(canvas, row, measure, days),
            None => draw_outages(canvas, row, days),
        }
    }
}

fn draw_measure(canvas: &mut Canvas<'_>, row: Rect, (name, read, write, together): &ServiceMeasure, days: &[ServiceDay]) {
    let values: Vec<f64> = days.iter().map(read).collect();
    let aggregate_days = |count: usize| match &values[values.len().saturating_sub(count)..] {
        [] => "–".to_owned(),
        last => write(together(last)),
    };
    let last = values.last().map_or("–".to_owned(), |value| write(*value));
    let text = format!("{name:<16}{last:>8}{:>9}{:>9}", aggregate_days(7), aggregate_days(28));
    canvas.draw_text(row, &text, Role::Text);
    if row.width > 44 {
        let room = row.width - 44;
        let place = Rect { x: row.x + 44, width: room, ..row };
        canvas.draw_text(place, &sparkline(&values, room as usize), Role::Series(0));
    }
    let overloaded = *name == "utilization, max" && values.last().is_some_and(|value| *value > 1.0);
    if overloaded {
        canvas.draw_aligned(Rect { width: 43.min(row.width), ..row }, "!", Role::Bad, Align::Right);
    }
}

fn draw_outages(canvas: &mut Canvas<'_>, row: Rect, days: &[ServiceDay]) {
    let outages: Vec<String> = days
        .iter()
        .rev()
        .filter(|day| day.downtime_minutes > 0.0)
        .take(6)
        .map(|day| format!("day {} {} min", day.day, format_number(day.downtime_minutes)))
        .collect();
    let text = match outages.is_empty() {
        true => "No outages.".to_owned(),
        false => format!("outages: {}", outages.join(" · ")),
    };
    canvas.draw_text(row, &text, Role::Dim);
}
