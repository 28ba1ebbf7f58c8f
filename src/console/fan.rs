//! Chart of past cash and the forecasts of a day.

use ratatui::layout::Rect;

use novamind_tools::Forecast;
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::Unit;
use novamind_tui::widgets::chart::{Axis, Band, Line, Plot, Side, zero_if_near};
use novamind_worker::company::Company;

/// Returns the forecasts with a horizon of at most half of the past, so that the chart keeps space for the past.
pub fn near(company: &Company, forecasts: &[Forecast]) -> Vec<Forecast> {
    let reach = (company.seen.day / 2).max(7);
    forecasts.iter().copied().filter(|forecast| forecast.horizon_days <= reach).collect()
}

/// Draws cash and the forecasts made on a day.
pub fn draw_fan(canvas: &mut Canvas<'_>, area: Rect, company: &Company, filed: u32, forecasts: &[Forecast]) {
    let start = company.cash_by_day.get(filed as usize).copied().unwrap_or(company.seen.cash);
    let day = |forecast: &Forecast| f64::from(filed + forecast.horizon_days);
    let first = (f64::from(filed), start);
    let expected = forecasts.iter().map(|forecast| (day(forecast), forecast.point));
    let ends = forecasts.iter().map(|forecast| (day(forecast), forecast.lower, forecast.upper));
    let band = Band { ends: std::iter::once((first.0, start, start)).chain(ends).collect(), name: "95 %" };
    let reach = forecasts.last().map_or(0, |forecast| forecast.horizon_days) as usize;
    // Limits the past so that the future keeps space.
    let from = (filed as usize).saturating_sub(3 * reach.max(28));
    let cash = company.cash_by_day.iter().enumerate().skip(from);
    let cash: Vec<(f64, f64)> = cash.map(|(day, cash)| (day as f64, *cash)).collect();
    let values = cash.iter().map(|point| point.1).chain(forecasts.iter().map(|forecast| forecast.lower));
    let zero = zero_if_near(values);
    let lines = [
        Line::through(std::iter::once(first).chain(expected).collect(), Role::Series(1)).named("expected"),
        Line::through(cash, Role::Series(0)).named("cash"),
    ];
    let plot = Plot {
        lines: &lines,
        band: Some(&band).filter(|_| !forecasts.is_empty()),
        mark: None,
        x: &Axis { write: &|day| format!("day {day:.0}"), holds: &[] },
        y: &Side { unit: Unit::Dollars, holds: zero },
    };
    plot.draw(canvas, area);
}
