//! The tables of a study: runs, weeks, forecasts, queries, events, answers, notes and visits. Each column has a unit
//! and a meaning.
//!
//! Cells contain texts as people wrote them; [`novamind_base::notation::csv_cell`] escapes them when a file is
//! written.

mod answers;
pub(crate) mod column;
mod events;
mod forecasts;
mod notes;
mod place;
mod queries;
mod runs;
mod visits;
mod weeks;

use std::borrow::Borrow;

use serde::Serialize;

use super::logbook::Logbook;
use column::Column;
use novamind_record::trajectory::Line;
use novamind_session::ForecastScore;
use novamind_study::FoundVisit;

pub use column::Heading;

/// Returns a value that only the console records, or `None` for a run without a console session.
fn in_console<T>(run: &Logbook, value: T) -> Option<T> {
    (run.sittings.in_console > 0).then_some(value)
}

/// Returns a value about views of screens, which the console recorded before lines contained sessions.
fn seen<T>(run: &Logbook, value: T) -> Option<T> {
    if run.sittings.opened == 0 { Some(value) } else { in_console(run, value) }
}

/// Returns the columns of every table, in the order of the tables.
pub fn headings() -> Vec<(&'static str, Vec<Heading>)> {
    fn of<Row>(columns: Vec<Column<Row>>) -> Vec<Heading> {
        columns.into_iter().map(|column| column.heading).collect()
    }
    vec![
        ("runs", of(runs::columns())),
        ("weeks", of(weeks::columns())),
        ("forecasts", of(forecasts::columns())),
        ("queries", of(queries::columns())),
        ("events", of(events::columns())),
        ("answers", of(answers::columns())),
        ("notes", of(notes::columns())),
        ("visits", of(visits::columns())),
    ]
}

/// Returns table, column, unit and meaning of every column.
pub fn columns_table() -> Vec<Vec<String>> {
    let mut rows = vec![["table", "column", "unit", "meaning"].map(str::to_owned).to_vec()];
    for (table, columns) in headings() {
        rows.extend(
            columns.iter().map(|own| [table, &own.name, own.unit, own.meaning].map(str::to_owned).to_vec()),
        );
    }
    rows
}

/// The tables of several runs, filled run by run.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyTables {
    // Rows by table, starting with the header.
    tables: Vec<(&'static str, Vec<Vec<String>>)>,
}

impl Default for StudyTables {
    fn default() -> Self {
        let head = |columns: Vec<Heading>| columns.into_iter().map(|own| own.name.into_owned()).collect();
        let tables = headings().into_iter().map(|(name, columns)| (name, vec![head(columns)]));
        StudyTables { tables: tables.collect() }
    }
}

impl StudyTables {
    /// Adds a run from its logbook, its lines, and the lines recorded after its end.
    pub fn add(&mut self, book: &Logbook, lines: &[Line], afterwards: &[Line]) {
        let lines = place::placed(book, lines, afterwards);
        self.fill("runs", &runs::columns(), [book]);
        self.fill(
            "weeks",
            &weeks::columns(),
            book.weeks.iter().map(|week| weeks::WeekRow { run: book, week }),
        );
        self.fill("forecasts", &forecasts::columns(), forecasts::rows(book));
        self.fill("queries", &queries::columns(), queries::rows(&lines));
        self.fill("events", &events::columns(), events::rows(&lines));
        self.fill("answers", &answers::columns(), answers::rows(&lines));
        self.fill("notes", &notes::columns(), notes::rows(&lines));
    }

    /// Adds lines of visit lists.
    pub fn add_visits(&mut self, visits: &[FoundVisit]) {
        self.fill("visits", &visits::columns(), visits);
    }

    /// Adds a run that could not be read: only its name and the problem.
    pub fn add_unread(&mut self, run: &str, problem: &str) {
        let cell = |column: Column<Logbook>| match &*column.heading.name {
            "run" => run.to_owned(),
            "problem" => problem.to_owned(),
            _ => String::new(),
        };
        self.extend("runs", [runs::columns().into_iter().map(cell).collect()]);
    }

    /// Returns the name and rows of every table, each with a header. The last table describes the columns.
    pub fn into_files(self) -> Vec<(&'static str, Vec<Vec<String>>)> {
        let mut files = self.tables;
        files.push(("columns", columns_table()));
        files
    }

    fn fill<Row>(
        &mut self,
        name: &str,
        columns: &[Column<Row>],
        rows: impl IntoIterator<Item = impl Borrow<Row>>,
    ) {
        let cells = |row: &Row| columns.iter().map(|column| (column.cell)(row)).collect();
        self.extend(name, rows.into_iter().map(|row| cells(row.borrow())));
    }

    fn extend(&mut self, name: &str, rows: impl IntoIterator<Item = Vec<String>>) {
        if let Some((_, table)) = self.tables.iter_mut().find(|(own, _)| *own == name) {
            table.extend(rows);
        }
    }
}

/// Formats a number in the shortest form that parses to the same value.
fn number(value: f64) -> String {
    format!("{}", value + 0.0)
}

fn rounded(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}

fn flag(is: bool) -> String {
    u8::from(is).to_string()
}

/// Returns a word of an enumeration, as in the record.
fn word(value: &impl Serialize) -> String {
    match serde_json::to_value(value) {
        Ok(serde_json::Value::String(word)) => word,
        _ => String::new(),
    }
}

fn score(scores: &[ForecastScore], horizon_days: u32) -> Option<&ForecastScore> {
    scores.iter().find(|score| score.horizon_days == horizon_days && score.scored > 0)
}

/// Joins names and numbers in one cell: `cash=12.5;overview=3`.
fn pairs<N: AsRef<str>>(all: impl IntoIterator<Item = (N, f64)>) -> String {
    let one = |(name, value): (N, f64)| format!("{}={}", name.as_ref(), number(rounded(value)));
    all.into_iter().map(one).collect::<Vec<_>>().join(";")
}

fn tools(effort: &super::logbook::Effort) -> String {
    pairs(effort.tools.iter().map(|(tool, count)| (tool, f64::from(*count))))
}

fn screens(effort: &super::logbook::Effort) -> String {
    pairs(effort.screens.iter().map(|(screen, time)| (screen, time.active_seconds())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::{BTreeMap, BTreeSet};

    #[test]
    fn names_are_there_once_and_every_column_is_explained() {
        for (table, columns) in headings() {
            let names: BTreeSet<&str> = columns.iter().map(|column| &*column.name).collect();
            assert_eq!(names.len(), columns.len(), "{table}");
            for Heading { name, unit, meaning } in columns {
                assert!(!unit.is_empty() && meaning.len() > 5, "{table} {name}");
                assert!(name.bytes().all(|byte| matches!(byte, b'a'..=b'z' | b'0'..=b'9' | b'_')), "{name}");
            }
        }
    }

    fn named(rows: &[Vec<String>]) -> Vec<BTreeMap<&str, &str>> {
        let mut named = Vec::new();
        for row in &rows[1..] {
            assert_eq!(row.len(), rows[0].len());
            named.push(rows[0].iter().map(String::as_str).zip(row.iter().map(String::as_str)).collect());
        }
        named
    }

    #[test]
    fn cells_hold_what_the_logbook_says() {
        let (session, lines) = crate::test_kit::recorded();
        let book = Logbook::of(&session, &lines, &[]);
        let mut tables = StudyTables::default();
        tables.add(&book, &lines, &[]);
        tables.add_unread("0123abcd", "line 3 is damaged");
        let files: BTreeMap<&str, Vec<Vec<String>>> = tables.into_files().into_iter().collect();
        let runs = named(&files["runs"]);
        assert_eq!([runs[0]["participant"], runs[0]["weeks"], runs[0]["if_words"]], ["P 07", "2", "1"]);
        assert_eq!(runs[0]["cash"], number(book.cash));
        assert_eq!([runs[0]["forecasts_scored_7"], runs[0]["forecasts_scored_28"]], ["2", "0"]);
        assert_eq!([runs[0]["forecast_error_28"], runs[0]["truly_best_channel_share"]], ["", ""]);
        assert_eq!([runs[0]["note_versions"], runs[0]["note_words"]], ["1", "2"]);
        assert_eq!(
            [runs[1]["run"], runs[1]["cash"], runs[1]["problem"]],
            ["0123abcd", "", "line 3 is damaged"]
        );
        let weeks = named(&files["weeks"]);
        assert_eq!(weeks.len(), 2);
        assert!(weeks[0]["screens"].starts_with("cash="), "{}", weeks[0]["screens"]);
        assert_eq!(weeks[0]["tools"], "set_prices=1");
        assert_eq!(weeks[1]["cash"], number(session.cash_by_day()[14]));
        assert_eq!(weeks[0]["forecast_7_outcome"], number(session.cash_by_day()[7]));
        assert_eq!(weeks[0]["individual_subscribers"], session.weeks()[0].individual_subscribers.to_string());
        let forecasts = named(&files["forecasts"]);
        assert_eq!(forecasts.len(), 8);
        assert_eq!([forecasts[0]["horizon_days"], forecasts[0]["filled_naively"]], ["7", "1"]);
        assert_eq!(forecasts[0]["outcome"], weeks[0]["forecast_7_outcome"]);
        let queries = named(&files["queries"]);
        assert_eq!(queries.iter().map(|row| row["error"]).collect::<Vec<_>>(), ["", "sql_error"]);
        let events = named(&files["events"]);
        assert_eq!(events.len(), lines.len());
        assert_eq!((events[0]["kind"], events[0]["t"]), ("start", "0"));
        let notes = named(&files["notes"]);
        assert_eq!([notes[0]["text"], notes[0]["version"], notes[0]["week"]], ["watch costs", "1", "3"]);
    }
}
