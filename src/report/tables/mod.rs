//! The tables of a study: runs, weeks, forecasts, queries, events, answers, notes and visits. Each column has a unit
//! and a meaning.
//!
//! Cells contain texts as people wrote them; [`novamind_base::formatting::escape_csv_cell`] escapes them when a file is
//! written.

mod answers;
pub(crate) mod column;
mod events;
mod forecasts;
mod located_line;
mod notes;
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

pub use column::ColumnHeading;

/// Returns a value that only the console records, or `None` if the run was never open in the console.
fn console_only<T>(run: &Logbook, value: T) -> Option<T> {
    (run.sittings.in_console > 0).then_some(value)
}

/// Returns a value about screen views, or `None` if the lines of the run contain sessions but no console session. Old
/// versions of the console recorded screen views but no sessions.
fn screen_views_only_if_recorded<T>(run: &Logbook, value: T) -> Option<T> {
    if run.sittings.opened == 0 { Some(value) } else { console_only(run, value) }
}

/// Returns the columns of every table, in the order of the tables.
pub fn table_headings() -> Vec<(&'static str, Vec<ColumnHeading>)> {
    fn heading_list<Row>(columns: Vec<Column<Row>>) -> Vec<ColumnHeading> {
        columns.into_iter().map(|column| column.heading).collect()
    }
    vec![
        ("runs", heading_list(runs::columns())),
        ("weeks", heading_list(weeks::columns())),
        ("forecasts", heading_list(forecasts::columns())),
        ("queries", heading_list(queries::columns())),
        ("events", heading_list(events::columns())),
        ("answers", heading_list(answers::columns())),
        ("notes", heading_list(notes::columns())),
        ("visits", heading_list(visits::columns())),
    ]
}

/// Returns the table, name, unit and meaning of every column.
pub fn column_descriptions() -> Vec<Vec<String>> {
    let mut rows = vec![["table", "column", "unit", "meaning"].map(str::to_owned).to_vec()];
    for (table, columns) in table_headings() {
        rows.extend(columns.iter().map(|column_heading| {
            [table, &column_heading.name, column_heading.unit, column_heading.meaning]
                .map(str::to_owned)
                .to_vec()
        }));
    }
    rows
}

/// The tables of a study, to which runs are added one by one.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyTables {
    // For each table, its rows, starting with the header.
    tables: Vec<(&'static str, Vec<Vec<String>>)>,
}

impl Default for StudyTables {
    fn default() -> Self {
        let head = |columns: Vec<ColumnHeading>| {
            columns.into_iter().map(|column_heading| column_heading.name.into_owned()).collect()
        };
        let tables = table_headings().into_iter().map(|(name, columns)| (name, vec![head(columns)]));
        StudyTables { tables: tables.collect() }
    }
}

impl StudyTables {
    /// Adds a run: its logbook, its lines, and the lines that were recorded after its end.
    pub fn add(&mut self, book: &Logbook, lines: &[Line], afterwards: &[Line]) {
        let lines = located_line::locate_lines(book, lines, afterwards);
        self.append_rows("runs", &runs::columns(), [book]);
        self.append_rows(
            "weeks",
            &weeks::columns(),
            book.weeks.iter().map(|week| weeks::WeekRow { run: book, week }),
        );
        self.append_rows("forecasts", &forecasts::columns(), forecasts::rows(book));
        self.append_rows("queries", &queries::columns(), queries::rows(&lines));
        self.append_rows("events", &events::columns(), events::rows(&lines));
        self.append_rows("answers", &answers::columns(), answers::rows(&lines));
        self.append_rows("notes", &notes::columns(), notes::rows(&lines));
    }

    /// Adds visits, which are the lines of the visit lists.
    pub fn add_visits(&mut self, visits: &[FoundVisit]) {
        self.append_rows("visits", &visits::columns(), visits);
    }

    /// Adds a row for a run that cannot be read. The row contains only the name of the run and the problem.
    pub fn add_unreadable_run(&mut self, run: &str, problem: &str) {
        let cell = |column: Column<Logbook>| match &*column.heading.name {
            "run" => run.to_owned(),
            "problem" => problem.to_owned(),
            _ => String::new(),
        };
        self.extend("runs", [runs::columns().into_iter().map(cell).collect()]);
    }

    /// Returns the name and the rows of every table. The first row is the header. The last table describes the columns.
    pub fn into_files(self) -> Vec<(&'static str, Vec<Vec<String>>)> {
        let mut files = self.tables;
        files.push(("columns", column_descriptions()));
        files
    }

    fn append_rows<Row>(
        &mut self,
        name: &str,
        columns: &[Column<Row>],
        rows: impl IntoIterator<Item = impl Borrow<Row>>,
    ) {
        let cells = |row: &Row| columns.iter().map(|column| (column.cell)(row)).collect();
        self.extend(name, rows.into_iter().map(|row| cells(row.borrow())));
    }

    fn extend(&mut self, name: &str, rows: impl IntoIterator<Item = Vec<String>>) {
        if let Some((_, table)) = self.tables.iter_mut().find(|(text, _)| *text == name) {
            table.extend(rows);
        }
    }
}

/// Formats a number in the shortest form that parses to the same value.
fn format_number(value: f64) -> String {
    format!("{}", value + 0.0)
}

fn rounded(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}

fn format_flag(is: bool) -> String {
    u8::from(is).to_string()
}

/// Returns the name of an enum variant as it is written in the record.
fn serialized_name(value: &impl Serialize) -> String {
    match serde_json::to_value(value) {
        Ok(serde_json::Value::String(word)) => word,
        _ => String::new(),
    }
}

fn score_at_horizon(scores: &[ForecastScore], horizon_days: u32) -> Option<&ForecastScore> {
    scores.iter().find(|score| score.horizon_days == horizon_days && score.scored > 0)
}

/// Joins pairs of names and numbers in one cell: `cash=12.5;overview=3`.
fn format_pairs<N: AsRef<str>>(all: impl IntoIterator<Item = (N, f64)>) -> String {
    let one = |(name, value): (N, f64)| format!("{}={}", name.as_ref(), format_number(rounded(value)));
    all.into_iter().map(one).collect::<Vec<_>>().join(";")
}

fn format_tool_counts(effort: &super::logbook::PlayerEffort) -> String {
    format_pairs(effort.tools.iter().map(|(tool, count)| (tool, f64::from(*count))))
}

fn format_screen_seconds(effort: &super::logbook::PlayerEffort) -> String {
    format_pairs(effort.screens.iter().map(|(screen, time)| (screen, time.active_seconds())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::{BTreeMap, BTreeSet};

    #[test]
    fn column_names_are_unique_and_described() {
        for (table, columns) in table_headings() {
            let names: BTreeSet<&str> = columns.iter().map(|column| &*column.name).collect();
            assert_eq!(names.len(), columns.len(), "{table}");
            for ColumnHeading { name, unit, meaning } in columns {
                assert!(!unit.is_empty() && meaning.len() > 5, "{table} {name}");
                assert!(name.bytes().all(|byte| matches!(byte, b'a'..=b'z' | b'0'..=b'9' | b'_')), "{name}");
            }
        }
    }

    fn rows_by_column(rows: &[Vec<String>]) -> Vec<BTreeMap<&str, &str>> {
        let mut named = Vec::new();
        for row in &rows[1..] {
            assert_eq!(row.len(), rows[0].len());
            named.push(rows[0].iter().map(String::as_str).zip(row.iter().map(String::as_str)).collect());
        }
        named
    }

    #[test]
    fn table_cells_match_the_logbook() {
        let (session, lines) = crate::test_kit::recorded_run();
        let book = Logbook::new(&session, &lines, &[]);
        let mut tables = StudyTables::default();
        tables.add(&book, &lines, &[]);
        tables.add_unreadable_run("0123abcd", "line 3 is damaged");
        let files: BTreeMap<&str, Vec<Vec<String>>> = tables.into_files().into_iter().collect();
        let runs = rows_by_column(&files["runs"]);
        assert_eq!([runs[0]["participant"], runs[0]["weeks"], runs[0]["if_words"]], ["P 07", "2", "1"]);
        assert_eq!(runs[0]["cash"], format_number(book.cash));
        assert_eq!([runs[0]["forecasts_scored_7"], runs[0]["forecasts_scored_28"]], ["2", "0"]);
        assert_eq!([runs[0]["forecast_error_28"], runs[0]["truly_best_channel_share"]], ["", ""]);
        assert_eq!([runs[0]["note_versions"], runs[0]["note_words"]], ["1", "2"]);
        assert_eq!(
            [runs[1]["run"], runs[1]["cash"], runs[1]["problem"]],
            ["0123abcd", "", "line 3 is damaged"]
        );
        let weeks = rows_by_column(&files["weeks"]);
        assert_eq!(weeks.len(), 2);
        assert!(weeks[0]["screens"].starts_with("cash="), "{}", weeks[0]["screens"]);
        assert_eq!(weeks[0]["tools"], "set_prices=1");
        assert_eq!(weeks[1]["cash"], format_number(session.cash_by_day()[14]));
        assert_eq!(weeks[0]["forecast_7_outcome"], format_number(session.cash_by_day()[7]));
        assert_eq!(weeks[0]["individual_subscribers"], session.weeks()[0].individual_subscribers.to_string());
        let forecasts = rows_by_column(&files["forecasts"]);
        assert_eq!(forecasts.len(), 8);
        assert_eq!([forecasts[0]["horizon_days"], forecasts[0]["filled_naively"]], ["7", "1"]);
        assert_eq!(forecasts[0]["outcome"], weeks[0]["forecast_7_outcome"]);
        let queries = rows_by_column(&files["queries"]);
        assert_eq!(queries.iter().map(|row| row["error"]).collect::<Vec<_>>(), ["", "sql_error"]);
        let events = rows_by_column(&files["events"]);
        assert_eq!(events.len(), lines.len());
        assert_eq!((events[0]["kind"], events[0]["t"]), ("start", "0"));
        let notes = rows_by_column(&files["notes"]);
        assert_eq!([notes[0]["text"], notes[0]["version"], notes[0]["week"]], ["watch costs", "1", "3"]);
    }
}
