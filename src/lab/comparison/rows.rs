//! Comparison of many runs: one row per run, best result first.

use super::compared::{Comparison, Row};
use crate::exhibit::{Column, Datum, Exhibit, Measure, Tabulation, column_name};
use novamind_base::notation::grouped;
use novamind_record::trajectory::record::Ended;

/// Columns: figure, horizon, heading; the most important first.
const COLUMNS: [(&str, &str, &str); 10] = [
    ("final cash", "", "cash"),
    ("calls that act, a week", "", "calls a week"),
    ("ad spend on the truly best channel", "", "ads on best channel"),
    ("targeted share of development", "", "targeted dev."),
    ("forecast error", "28", "4-week error"),
    ("words of planning in 100", "", "planning in 100 words"),
    ("queries, a week", "", "queries a week"),
    ("evenness of tools", "", "evenness of tools"),
    ("minutes played", "", "minutes"),
    ("forecast coverage", "28", "4-week coverage"),
];

/// Returns a table with a row per run.
pub(super) fn one_a_row(beside: &Comparison) -> Exhibit {
    let figures: Vec<(&Row, &str)> = COLUMNS
        .iter()
        .filter_map(|(figure, of, heading)| {
            let row = beside.figures.iter().find(|row| row.figure == *figure && row.of == *of)?;
            Some((row, *heading))
        })
        .collect();
    let has_labels = beside.participants.iter().any(Option::is_some);
    let mut columns = vec![Column::words("run", "run"), Column::numbers("place", "#", Measure::Count)];
    columns.extend(has_labels.then(|| Column::words("participant", "who")));
    columns.push(Column::words("end", "end"));
    columns.extend(
        figures
            .iter()
            .map(|(row, heading)| Column::numbers(&column_name(&row.figure), heading, row.measure())),
    );
    let row = |(place, run): (usize, &usize)| {
        let mut cells = vec![Datum::words(&*beside.runs[*run]), Datum::Number((place + 1) as f64)];
        cells.extend(has_labels.then(|| Datum::words(label(beside.participants[*run].as_deref()))));
        cells.push(Datum::words(end_in_words(beside.ends[*run])));
        cells.extend(figures.iter().map(|(row, _)| Datum::number(row.values[*run])));
        cells
    };
    let rows = beside.order.iter().enumerate().map(row).collect();
    let table = Tabulation { rows, ..Tabulation::new("runs", "", columns) };
    let exhibit = Exhibit::of(format!("{} runs, best result first", beside.runs.len()), table);
    exhibit.with_note("Use --csv for cash by week and all figures, --json for decisions as well.")
}

/// Characters of a label that are shown, so that a row fits on one line.
const LABEL: usize = 12;

fn label(participant: Option<&str>) -> String {
    match participant {
        None => "–".to_owned(),
        Some(who) if who.chars().count() <= LABEL => who.to_owned(),
        Some(who) => who.chars().take(LABEL - 1).chain(['…']).collect(),
    }
}

fn end_in_words((day, ended): (u32, Option<Ended>)) -> String {
    let day = grouped(f64::from(day), 0);
    match ended {
        Some(Ended::Horizon) => format!("day {day}"),
        Some(Ended::Bankruptcy) => format!("bankrupt {day}"),
        Some(Ended::Abandoned) => format!("given up {day}"),
        Some(Ended::Lesson) => format!("lesson {day}"),
        None => format!("at day {day}"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{as_text, beside};
    use novamind_report::{Logbook, logbook_of_tests};

    /// Returns thirty runs with different names, players and results.
    fn thirty() -> Vec<Logbook> {
        let book = logbook_of_tests();
        let named = |at: u32| {
            let mut own = book.clone();
            own.run = format!("{:08x}", 0x1a2b_3c00 + at);
            own.participant = Some(format!("participant-{at:02}"));
            own.cash = f64::from(at * 7919 % 30) * 1e5;
            own
        };
        (0..30).map(named).collect()
    }

    #[test]
    fn thirty_runs_fit_a_terminal_the_best_first() {
        let books = thirty();
        for width in [80, 100, 120, 200] {
            let text = as_text(&beside(&books), width);
            assert!(text.lines().all(|line| line.chars().count() <= width), "{width}:\n{text}");
            let row = |cash: [&str; 2]| {
                let told = |line: &str| line.split_whitespace().any(|word| cash.contains(&word));
                text.lines().position(told).expect("a row")
            };
            assert_eq!(row(["$0", "$0"]) - row(["$2.90M", "$2,900,000"]), 29, "{text}");
        }
    }

    #[test]
    fn two_runs_stand_side_by_side_where_they_have_room() {
        let books = &thirty()[..2];
        let wide = as_text(&beside(books), 400);
        assert!(wide.contains("Decisions") && wide.contains("cash on day 7"), "{wide}");
        let narrow = as_text(&beside(books), 80);
        assert!(!narrow.contains("cash on day") && narrow.contains("at day 14"), "{narrow}");
    }

    #[test]
    fn every_column_is_a_figure() {
        for (figure, of, _) in super::COLUMNS {
            assert!(super::super::figure_of(figure, of).is_some(), "{figure}");
        }
    }
}
