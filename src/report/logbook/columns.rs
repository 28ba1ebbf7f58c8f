//! The tables `runs.csv` and `weeks.csv`: every column with its unit, its meaning and where its values come from.

mod runs;
mod weeks;

use serde::Serialize;

use super::{Logbook, WeekLog};
use crate::session::ForecastScore;

pub use runs::RUNS;
pub use weeks::WEEKS;

/// A column of a table.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Column<F> {
    /// Name, as it stands in the first line.
    pub name: &'static str,
    /// Unit or kind of its values.
    pub unit: &'static str,
    /// What they mean.
    pub meaning: &'static str,
    /// Where they come from.
    #[serde(skip)]
    pub cell: F,
}

/// A column of the table of runs.
pub type RunColumn = Column<fn(&Logbook) -> String>;

/// A column of the table of weeks.
pub type WeekColumn = Column<fn(&Logbook, &WeekLog) -> String>;

/// A run of the table, or why it could not be read.
#[derive(Debug, Clone, PartialEq)]
pub struct Unread {
    /// Run.
    pub run: String,
    /// Why.
    pub problem: String,
}

/// `runs.csv`: a line for each run. Runs that could not be read have their name and the reason, nothing else.
pub fn runs_table(runs: &[Result<Logbook, Unread>]) -> Vec<Vec<String>> {
    let mut table = vec![RUNS.iter().map(|column| column.name.to_owned()).collect()];
    for run in runs {
        table.push(match run {
            Ok(run) => RUNS.iter().map(|column| (column.cell)(run)).collect(),
            Err(unread) => RUNS.iter().map(|column| unread.cell(column.name)).collect(),
        });
    }
    table
}

/// `weeks.csv`: a line for each week of each run.
pub fn weeks_table<'a>(runs: impl IntoIterator<Item = &'a Logbook>) -> Vec<Vec<String>> {
    let mut table = vec![WEEKS.iter().map(|column| column.name.to_owned()).collect()];
    for run in runs {
        table.extend(
            run.weeks.iter().map(|week| WEEKS.iter().map(|column| (column.cell)(run, week)).collect()),
        );
    }
    table
}

impl Unread {
    fn cell(&self, column: &str) -> String {
        match column {
            "run" => self.run.clone(),
            "problem" => self.problem.clone(),
            _ => String::new(),
        }
    }
}

/// A number in the shortest form that reads back to the same one.
fn number(value: impl Into<f64>) -> String {
    let value: f64 = value.into();
    format!("{}", value + 0.0)
}

/// A number that may not exist: an empty cell.
fn maybe(value: Option<f64>) -> String {
    value.map(number).unwrap_or_default()
}

/// A number with few decimals, for what is measured in seconds or as a mean.
fn rounded(value: f64) -> String {
    number((value * 1000.0).round() / 1000.0)
}

/// The score of a horizon, if a forecast of it has come due.
fn score(run: &Logbook, horizon_days: u32) -> Option<&ForecastScore> {
    run.measures.forecasts.iter().find(|score| score.horizon_days == horizon_days && score.scored > 0)
}

/// Names with numbers in one cell: `cash=12.5;overview=3`.
fn pairs<'a, V: Into<f64> + Copy + 'a>(all: impl IntoIterator<Item = (&'a String, &'a V)>) -> String {
    let one = |(name, value): (&String, &V)| format!("{name}={}", rounded((*value).into()));
    all.into_iter().map(one).collect::<Vec<_>>().join(";")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn names_are_there_once_and_every_column_is_explained() {
        let runs = RUNS.iter().map(|column| (column.name, column.unit, column.meaning)).collect::<Vec<_>>();
        let weeks = WEEKS.iter().map(|column| (column.name, column.unit, column.meaning)).collect::<Vec<_>>();
        for table in [runs, weeks] {
            let names: BTreeSet<&str> = table.iter().map(|column| column.0).collect();
            assert_eq!(names.len(), table.len());
            for (name, unit, meaning) in table {
                assert!(!unit.is_empty() && meaning.len() > 5, "{name}");
                assert!(name.bytes().all(|byte| matches!(byte, b'a'..=b'z' | b'0'..=b'9' | b'_')), "{name}");
            }
        }
    }

    #[test]
    fn cells_hold_what_the_logbook_says() {
        let (session, lines) = super::super::tests::played();
        let book = Logbook::of(&session, &lines);
        let unread = Unread { run: "0123abcd".to_owned(), problem: "line 3 is damaged".to_owned() };
        let table = runs_table(&[Ok(book.clone()), Err(unread)]);
        let cell = |row: usize, name: &str| {
            let at = table[0].iter().position(|column| column == name).expect(name);
            table[row][at].clone()
        };
        assert_eq!([cell(1, "participant"), cell(1, "weeks"), cell(1, "if_words")], ["P 07", "2", "1"]);
        assert_eq!(cell(1, "cash"), number(book.cash));
        assert_eq!([cell(1, "forecasts_scored_7"), cell(1, "forecasts_scored_28")], ["2", "0"]);
        assert_eq!(cell(1, "forecast_error_28"), "");
        assert_eq!(
            [cell(2, "run"), cell(2, "cash"), cell(2, "problem")],
            ["0123abcd", "", "line 3 is damaged"]
        );
        let weeks = weeks_table([&book]);
        assert_eq!(weeks.len(), 3);
        let at = |name: &str| weeks[0].iter().position(|column| column == name).expect(name);
        assert_eq!(weeks[1][at("screens")], "cash=2");
        assert_eq!(weeks[1][at("tools")], "set_prices=1");
        assert_eq!(weeks[2][at("cash")], number(session.cash_by_day()[14]));
        assert_eq!(weeks[1][at("forecast_7_outcome")], number(session.cash_by_day()[7]));
        assert_eq!(
            weeks[1][at("individual_subscribers")],
            session.weeks()[0].individual_subscribers.to_string()
        );
    }
}
