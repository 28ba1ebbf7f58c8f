//! `forecasts.csv`: a row for each filed forecast.

use super::column::{Column, columns};
use crate::logbook::{Logbook, WeekRecord};
use novamind_session::ScoredForecast;

pub(super) struct FiledForecastRow<'a> {
    logbook: &'a Logbook,
    week: &'a WeekRecord,
    scored: &'a ScoredForecast,
    is_naive: bool,
}

pub(super) fn columns<'a>() -> Vec<Column<FiledForecastRow<'a>>> {
    columns! { row: FiledForecastRow<'a>;
        "run", "name", "name of the run" => row.logbook.run;
        "participant", "label", "label of the participant" => row.logbook.participant;
        "week", "number", "week before which the forecast was filed, from 1" => row.week.week;
        "decision_day", "day", "day on which the forecast was filed" => row.week.decision_day;
        "inherited", "0 or 1", "1: filed in the parent run" => row.week.inherited;
        "horizon_days", "days", "days from filing to the predicted day" => row.scored.forecast.horizon_days;
        "due_day", "day", "day for which cash was predicted" => row.scored.due_day();
        "point", "dollars", "predicted cash" => row.scored.forecast.point;
        "lower", "dollars", "lower end of the 95 % interval" => row.scored.forecast.lower;
        "upper", "dollars", "upper end of the 95 % interval" => row.scored.forecast.upper;
        "filled_naively", "0 or 1", "1: the naive forecast was used, in whole or in part" => row.is_naive;
        "outcome", "dollars", "cash at the end of the week that ends on the predicted day, before later purchases on that day; this and the following columns are empty if the run did not reach that day"
            => row.scored.outcome;
        "error", "share", "(point - outcome) / max(|outcome|, 1): positive if the forecast was too high" => row.scored.relative_error();
        "absolute_error", "share", "absolute value of error" => row.scored.relative_error().map(f64::abs);
        "covered", "0 or 1", "1: lower <= outcome <= upper" => row.scored.interval_position().map(|_| row.scored.is_covered());
        "verdict", "word", "position of the outcome relative to the interval: below, inside or above"
            => row.scored.interval_position().map(|verdict| verdict.as_str());
        "width", "share", "(upper - lower) / max(|outcome|, 1)" => row.scored.sharpness();
    }
}

pub(super) fn rows(book: &Logbook) -> impl Iterator<Item = FiledForecastRow<'_>> {
    book.weeks.iter().flat_map(move |week| {
        let filed = week.forecasts.iter().zip(&week.naive_forecasts);
        filed.map(move |(scored, naive)| FiledForecastRow { logbook: book, week, scored, is_naive: *naive })
    })
}
