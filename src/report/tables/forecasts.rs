//! `forecasts.csv`: a row for each forecast that was filed.

use super::{Heading, flag, heading, maybe, number};
use crate::logbook::{Logbook, WeekLog};
use novamind_session::ScoredForecast;

/// The columns.
pub(super) const HEADINGS: [Heading; 17] = [
    heading("run", "name", "name of the run"),
    heading("participant", "label", "who played"),
    heading("week", "number", "number of the week before which it was filed, from 1"),
    heading("decision_day", "day", "day on which it was filed"),
    heading("inherited", "0 or 1", "1: filed in the run that this one branched from"),
    heading("horizon_days", "days", "days ahead"),
    heading("due_day", "day", "day whose cash it speaks of"),
    heading("point", "dollars", "most likely cash"),
    heading("lower", "dollars", "lower end of the 95 % interval"),
    heading("upper", "dollars", "upper end of it"),
    heading("filled_naively", "0 or 1", "1: the naive projection stands in it, whole or in part"),
    heading(
        "outcome",
        "dollars",
        "cash on that day; this and what follows is empty if the run did not reach it",
    ),
    heading("error", "share", "(point - outcome) / max(|outcome|, 1): positive where too much was expected"),
    heading("absolute_error", "share", "its size"),
    heading("covered", "0 or 1", "1: lower <= outcome <= upper"),
    heading("verdict", "word", "where the outcome lies beside the interval: below, inside or above"),
    heading("width", "share", "(upper - lower) / max(|outcome|, 1)"),
];

/// The rows of a run.
pub(super) fn rows(book: &Logbook) -> Vec<Vec<String>> {
    let weeks = book.weeks.iter();
    let filed =
        weeks.flat_map(|week| week.forecasts.iter().zip(&week.naive_forecasts).map(move |it| (week, it)));
    filed.map(|(week, (scored, naive))| row(book, week, scored, *naive)).collect()
}

fn row(book: &Logbook, week: &WeekLog, scored: &ScoredForecast, naive: bool) -> Vec<String> {
    let forecast = &scored.forecast;
    let cells: [String; HEADINGS.len()] = [
        book.run.clone(),
        book.participant.clone().unwrap_or_default(),
        week.week.to_string(),
        week.decision_day.to_string(),
        flag(week.inherited),
        forecast.horizon_days.to_string(),
        scored.due().to_string(),
        number(forecast.point),
        number(forecast.lower),
        number(forecast.upper),
        flag(naive),
        maybe(scored.outcome),
        maybe(scored.error()),
        maybe(scored.error().map(f64::abs)),
        scored.verdict().map(|_| flag(scored.is_inside())).unwrap_or_default(),
        scored.verdict().map(|verdict| verdict.word().to_owned()).unwrap_or_default(),
        maybe(scored.sharpness()),
    ];
    cells.to_vec()
}
