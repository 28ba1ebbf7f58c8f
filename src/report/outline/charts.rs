//! Charts of a run report.

use crate::bankruptcy::{COST_CATEGORIES, INCOME_CATEGORIES};
use crate::formatting::{format_money, format_whole, pluralize};
use crate::page::{Band, Block, Chart, Curve, Plot, StackSeries};
use crate::run_report::RunReport;
use novamind_session::ScoredForecast;

const MAX_GROUPS: usize = 6;

/// Returns the chart of cash by day, including the last forecasts if they are not due yet.
pub fn cash_chart(report: &RunReport) -> Option<Block> {
    let points: Vec<(f64, f64)> =
        report.cash_by_day.iter().enumerate().map(|(day, cash)| (day as f64, *cash)).collect();
    if points.len() < 2 {
        return None;
    }
    // Purchases on day 0 reduce the cash of this day below the starting cash. The range includes both values.
    let low = report.cash_by_day.iter().copied().fold(report.start_cash, f64::min);
    let high = report.cash_by_day.iter().copied().fold(report.start_cash, f64::max);
    let mut curves = vec![Curve { name: "cash".to_owned(), points }];
    let fan = pending_forecast_fan(report);
    let band = fan.map(|(band, expected)| {
        curves.push(expected);
        band
    });
    let summary = format!(
        "Cash starts at {}, ranges from {} to {}, and is {} on day {}.",
        format_money(report.start_cash),
        format_money(low),
        format_money(high),
        format_money(report.observation.cash),
        report.observation.day
    );
    let reach = (high - low).max(1.0);
    Some(Block::Chart(Chart {
        title: "Cash by day".to_owned(),
        summary,
        x_label: "day",
        is_in_dollars: true,
        y_limits: band.as_ref().map(|_| (low.min(0.0), high + reach)),
        plot: Plot::Lines { curves, band },
    }))
}

/// Returns the intervals of the forecasts that are not due yet, as a fan that starts at today's cash, and the predicted
/// values. Returns `None` if the run has ended.
fn pending_forecast_fan(report: &RunReport) -> Option<(Band, Curve)> {
    let filed_last = report.forecasts.last().filter(|_| report.observation.ended.is_none())?.day;
    let (day, cash) = (f64::from(report.observation.day), report.observation.cash);
    let open = || {
        let last = report.forecasts.iter().filter(move |filed| filed.day == filed_last);
        last.filter(|filed| filed.due_day() > report.observation.day)
    };
    let (mut band, mut expected) = (vec![(day, cash, cash)], vec![(day, cash)]);
    band.extend(open().map(|filed| (f64::from(filed.due_day()), filed.forecast.lower, filed.forecast.upper)));
    expected.extend(open().map(|filed| (f64::from(filed.due_day()), filed.forecast.point)));
    (band.len() > 1).then(|| {
        let band = Band { name: "95 % interval of the last forecasts".to_owned(), points: band };
        (band, Curve { name: "predicted".to_owned(), points: expected })
    })
}

fn cash_by_category(report: &RunReport) -> Vec<StackSeries> {
    let weeks: Vec<u32> = report.database.ledger.keys().copied().filter(|week| *week > 0).collect();
    let of = |week: u32, held: &[&str]| -> f64 {
        let amounts = report.database.ledger.get(&week);
        amounts.map_or(0.0, |amounts| held.iter().filter_map(|name| amounts.get(*name)).sum())
    };
    let part = |(name, held): &(&str, &[&str])| StackSeries {
        name: (*name).to_owned(),
        values: weeks.iter().map(|week| of(*week, held)).collect(),
    };
    let parts = INCOME_CATEGORIES.iter().chain(COST_CATEGORIES.iter()).map(part);
    parts.filter(|part| part.values.iter().any(|value| *value != 0.0)).collect()
}

pub fn income_and_cost_chart(report: &RunReport) -> Option<Block> {
    let at: Vec<f64> =
        report.database.ledger.keys().filter(|week| **week > 0).map(|week| f64::from(*week)).collect();
    let parts = cash_by_category(report);
    if at.is_empty() || parts.is_empty() {
        return None;
    }
    let sum = |positive: bool| -> f64 {
        parts.iter().flat_map(|part| &part.values).filter(|value| (**value > 0.0) == positive).sum()
    };
    let summary = format!(
        "In {}, income was {} and costs {}.",
        pluralize(at.len() as u32, "week"),
        format_money(sum(true)),
        format_money(-sum(false))
    );
    Some(Block::Chart(Chart {
        title: "Income and costs by week".to_owned(),
        summary,
        x_label: "week",
        is_in_dollars: true,
        y_limits: None,
        plot: Plot::Stacks { positions: at, series: parts },
    }))
}

pub fn subscriber_chart(report: &RunReport) -> Option<Block> {
    if report.weeks.len() < 2 {
        return None;
    }
    let through = |figure: fn(&novamind_record::figures::WeekFigures) -> u32| -> Vec<(f64, f64)> {
        report.weeks.iter().map(|week| (f64::from(week.day) / 7.0, f64::from(figure(week)))).collect()
    };
    let mut curves =
        vec![Curve { name: "subscribers".to_owned(), points: through(|week| week.individual_subscribers) }];
    let seats = through(|week| week.enterprise_seats);
    if seats.iter().any(|(_, seats)| *seats > 0.0) {
        curves.push(Curve { name: "enterprise seats".to_owned(), points: seats });
    }
    let summary = curves.iter().map(|curve| {
        let (week, max) = highest_point(&curve.points);
        format!(
            "{}: peak {} in week {week:.0}, {} at the end.",
            curve.name,
            format_whole(max),
            format_whole(last_point(&curve.points))
        )
    });
    Some(Block::Chart(Chart {
        title: "Subscribers and seats by week".to_owned(),
        summary: summary.collect::<Vec<_>>().join(" "),
        x_label: "week",
        is_in_dollars: false,
        y_limits: None,
        plot: Plot::Lines { curves, band: None },
    }))
}

fn highest_point(points: &[(f64, f64)]) -> (f64, f64) {
    points.iter().copied().rev().max_by(|left, right| left.1.total_cmp(&right.1)).unwrap_or((0.0, 0.0))
}

fn last_point(points: &[(f64, f64)]) -> f64 {
    points.last().map_or(0.0, |point| point.1)
}

/// Returns the chart of customers by week for the largest groups, or `None` if fewer than two groups have customers.
pub fn group_chart(report: &RunReport) -> Option<Block> {
    let weight = |active: &[f64]| active.iter().copied().fold(0.0, f64::max);
    let mut largest: Vec<_> = report
        .database
        .groups
        .iter()
        .filter(|book| weight(&book.active) > 0.0 && book.active.len() > 2)
        .collect();
    largest.sort_by(|left, right| weight(&right.active).total_cmp(&weight(&left.active)));
    largest.truncate(MAX_GROUPS);
    // Omit groups that are too small to be visible in the chart.
    let max = largest.first().map_or(0.0, |book| weight(&book.active));
    largest.retain(|book| weight(&book.active) >= 0.01 * max);
    if largest.len() < 2 {
        return None;
    }
    let curve = |book: &&super::super::database_figures::GroupHistory| Curve {
        name: book.group.to_string(),
        points: book.active.iter().enumerate().map(|(week, active)| (week as f64, *active)).collect(),
    };
    let curves: Vec<Curve> = largest.iter().map(curve).collect();
    let summary =
        curves.iter().map(|curve| format!("{} {}", curve.name, format_whole(last_point(&curve.points))));
    Some(Block::Chart(Chart {
        title: "Customers by group and week".to_owned(),
        summary: format!("At the end: {}.", summary.collect::<Vec<_>>().join(", ")),
        x_label: "week",
        is_in_dollars: false,
        y_limits: None,
        plot: Plot::Lines { curves, band: None },
    }))
}

pub fn forecast_charts(report: &RunReport) -> Vec<Block> {
    let horizons = report.measures.forecasts.iter().map(|score| score.horizon_days);
    horizons.filter_map(|horizon| forecast_chart(report, horizon)).collect()
}

fn forecast_chart(report: &RunReport, horizon: u32) -> Option<Block> {
    let due: Vec<&ScoredForecast> = report
        .forecasts
        .iter()
        .filter(|filed| filed.forecast.horizon_days == horizon && filed.outcome.is_some())
        .collect();
    if due.len() < 2 {
        return None;
    }
    let through = |value: &dyn Fn(&ScoredForecast) -> f64| -> Vec<(f64, f64)> {
        due.iter().map(|filed| (f64::from(filed.due_day()), value(filed))).collect()
    };
    let actual = through(&|filed| filed.outcome.unwrap_or(filed.forecast.point));
    let band = due
        .iter()
        .map(|filed| (f64::from(filed.due_day()), filed.forecast.lower, filed.forecast.upper))
        .collect();
    let inside = due.iter().filter(|filed| filed.is_covered());
    let ahead = pluralize(horizon / 7, "week");
    let summary = format!(
        "{} forecasts made {ahead} ahead came due; {} of their intervals contain the outcome.",
        due.len(),
        inside.count()
    );
    // The limits of the axis follow the outcomes, because outliers among the forecasts would flatten the curve.
    let low = actual.iter().map(|point| point.1).fold(f64::INFINITY, f64::min);
    let high = actual.iter().map(|point| point.1).fold(f64::NEG_INFINITY, f64::max);
    let reach = (high - low).max(0.1 * high.abs()).max(1.0);
    Some(Block::Chart(Chart {
        title: format!("Cash forecast {ahead} ahead, and the outcome"),
        summary,
        x_label: "day",
        is_in_dollars: true,
        y_limits: Some((low - reach, high + reach)),
        plot: Plot::Lines {
            curves: vec![
                Curve { name: "actual".to_owned(), points: actual },
                Curve { name: "forecast".to_owned(), points: through(&|filed| filed.forecast.point) },
            ],
            band: Some(Band { name: "95 % interval".to_owned(), points: band }),
        },
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::finished_run;

    #[test]
    fn subscriber_chart_points_are_at_week_ends() {
        let session = finished_run();
        let Some(Block::Chart(chart)) = subscriber_chart(&RunReport::from_session(&session)) else {
            panic!("a chart")
        };
        let Plot::Lines { curves, .. } = &chart.plot else { panic!("{chart:?}") };
        let expected: Vec<(f64, f64)> = (1..)
            .zip(session.weeks())
            .map(|(week, week_figures)| (f64::from(week), f64::from(week_figures.individual_subscribers)))
            .collect();
        assert_eq!(curves[0].points, expected);
        let (week, max) =
            expected.iter().rev().max_by(|one, other| one.1.total_cmp(&other.1)).expect("weeks");
        let peak = format!("subscribers: peak {} in week {week:.0},", format_whole(*max));
        assert!(*max > 0.0 && chart.summary.starts_with(&peak), "{}", chart.summary);
    }
}
