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
    // Nothing is drawn after the last day of the run.
    let in_run = |forecast: &&Forecast| filed + forecast.horizon_days <= company.observation.last_day;
    let forecasts: Vec<Forecast> = forecasts.iter().filter(in_run).copied().collect();
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
    let expected = Curve::from_points(std::iter::once(first).chain(expected).collect(), Role::Series(1));
    let expected = Some(expected.with_name("expected")).filter(|_| !forecasts.is_empty());
    let cash = Curve::from_points(cash, Role::Series(0)).with_name("cash");
    let lines: Vec<Curve> = expected.into_iter().chain([cash]).collect();
    let plot = Plot {
        curves: &lines,
        band: Some(&band).filter(|_| !forecasts.is_empty()),
        marked_x: None,
        x: &XAxis { format: &|day| format!("day {day:.0}"), required_values: &[] },
        y: &YAxis { unit: AxisUnit::Dollars, required_values: zero },
    };
    plot.draw(canvas, area);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::{new_company, render_rows};

    #[test]
    fn fan_ends_with_the_run() {
        let mut company = new_company();
        company.cash_by_day = (0..=84).map(|day| 1e6 + 1e3 * f64::from(day)).collect();
        (company.observation.day, company.observation.last_day) = (84, 84);
        let forecast = |horizon_days| Forecast { horizon_days, point: 1.1e6, lower: 1e6, upper: 1.2e6 };
        let rows = |filed| {
            let forecasts = [forecast(7), forecast(28)];
            render_rows(80, 12, |canvas, area| draw_fan(canvas, area, &company, filed, &forecasts)).join("\n")
        };
        assert!(rows(77).contains("expected") && !rows(77).contains("day 100"), "{}", rows(77));
        assert!(!rows(84).contains("expected"), "{}", rows(84));
    }
}
