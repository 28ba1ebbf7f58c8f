//! Chart of past cash and of the forecasts made on one day.

use ratatui::layout::Rect;

use novamind_tools::Forecast;
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::AxisUnit;
use novamind_tui::widgets::chart::{Band, Curve, Plot, XAxis, YAxis, zero_if_near};
use novamind_worker::company::DisplayedCompany;

/// Returns the forecasts whose horizon is at most half of the days that have passed, so that the chart keeps space for
/// past cash.
pub fn within_fan_horizon(company: &DisplayedCompany, forecasts: &[Forecast]) -> Vec<Forecast> {
    let reach = (company.observation.day / 2).max(7);
    forecasts.iter().copied().filter(|forecast| forecast.horizon_days <= reach).collect()
}

/// Draws past cash and the forecasts made on a day.
pub fn draw_fan(
    canvas: &mut Canvas<'_>,
    area: Rect,
    company: &DisplayedCompany,
    filed: u32,
    forecasts: &[Forecast],
) {
    let start = company.cash_by_day.get(filed as usize).copied().unwrap_or(company.observation.cash);
    let day = |forecast: &Forecast| f64::from(filed + forecast.horizon_days);
    let first = (f64::from(filed), start);
    let expected = forecasts.iter().map(|forecast| (day(forecast), forecast.point));
    let ends = forecasts.iter().map(|forecast| (day(forecast), forecast.lower, forecast.upper));
    let band = Band { bounds: std::iter::once((first.0, start, start)).chain(ends).collect(), name: "95 %" };
    let reach = forecasts.last().map_or(0, |forecast| forecast.horizon_days) as usize;
    // The past is limited so that the forecasts keep space.
    let from = (filed as usize).saturating_sub(3 * reach.max(28));
    let cash = company.cash_by_day.iter().enumerate().skip(from);
    let cash: Vec<(f64, f64)> = cash.map(|(day, cash)| (day as f64, *cash)).collect();
    let values = cash.iter().map(|point| point.1).chain(forecasts.iter().map(|forecast| forecast.point));
    let zero = zero_if_near(values);
    let lines = [
        Curve::from_points(std::iter::once(first).chain(expected).collect(), Role::Series(1))
            .with_name("expected"),
        Curve::from_points(cash, Role::Series(0)).with_name("cash"),
    ];
    let plot = Plot {
        curves: &lines,
        band: Some(&band).filter(|_| !forecasts.is_empty()),
        marked_x: None,
        x: &XAxis { format: &|day| format!("day {day:.0}"), required_values: &[] },
        y: &YAxis { unit: AxisUnit::Dollars, required_values: zero },
    };
    plot.draw(canvas, area);
}
