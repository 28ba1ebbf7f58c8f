//! Comparison of many runs: one row per run, best result first.

use super::compared_runs::{Comparison, ComparisonRow};
use super::table::describe_horizon;
use crate::lab_report::{CellValue, Column, LabReport, LabTable, Measure, column_name};
use novamind_base::formatting::grouped_number;
use novamind_record::trajectory::record::RunEndReason;

/// Columns, most important first: name of the figure, horizon and heading.
const COLUMNS: [(&str, &str, &str); 10] = [
    ("final cash", "", "cash"),
    ("calls that act, a week", "", "calls a week"),
    ("ad spend on the truly best channel", "", "ads on best channel"),
    ("targeted share of development", "", "targeted dev."),
    ("forecast error", "28", "4-week error"),
    ("words of planning in 100", "", "planning words per 100"),
    ("queries, a week", "", "queries a week"),
    ("evenness of tools", "", "evenness of tool use"),
    ("minutes played", "", "minutes"),
    ("forecast coverage", "28", "4-week coverage"),
];

/// Returns a report with one row per run, best result first.
pub(super) fn row_per_run_report(comparison: &Comparison) -> LabReport {
    let figures: Vec<(&ComparisonRow, &str)> = COLUMNS
        .iter()
        .filter_map(|(figure, of, heading)| {
            let row = comparison.figures.iter().find(|row| row.figure == *figure && row.of == *of)?;
            Some((row, *heading))
        })
        .collect();
    let has_labels = comparison.participants.iter().any(Option::is_some);
    let mut columns = vec![Column::text("run", "run"), Column::number("place", "#", Measure::Count)];
    columns.extend(has_labels.then(|| Column::text("participant", "who")));
    columns.push(Column::text("end", "end"));
    columns.push(Column::text("generation", "generation"));
    columns.push(Column::text("last_day", "last day"));
    columns.extend(
        figures
            .iter()
            .map(|(row, heading)| Column::number(&column_name(&row.figure), heading, row.measure())),
    );
    // Runs of different generations have no place.
    let place_cell = |place: usize| match comparison.is_ranked {
        true => CellValue::Number((place + 1) as f64),
        false => CellValue::Missing,
    };
    let row = |(place, run): (usize, &usize)| {
        let mut cells = vec![CellValue::text(&*comparison.runs[*run]), place_cell(place)];
        cells.extend(
            has_labels.then(|| CellValue::text(short_label(comparison.participants[*run].as_deref()))),
        );
        cells.push(CellValue::text(describe_end(comparison.ends[*run])));
        cells.push(CellValue::text(comparison.generations[*run].name()));
        cells.push(CellValue::text(describe_horizon(&comparison.horizons[*run])));
        cells.extend(figures.iter().map(|(row, _)| CellValue::number(row.values[*run])));
        cells
    };
    let rows = comparison.order.iter().enumerate().map(row).collect();
    let table = LabTable { rows, ..LabTable::new("runs", "", columns) };
    let order = if comparison.is_ranked { "best result first" } else { "not ranked" };
    let exhibit = LabReport::with_table(format!("{} runs, {order}", comparison.runs.len()), table);
    exhibit.with_note("Use --csv for cash by week and all figures, --json to add decisions.")
}

/// Maximum number of characters in a label. With longer labels, a row would not fit on one line.
const LABEL_WIDTH: usize = 12;

fn short_label(participant: Option<&str>) -> String {
    match participant {
        None => "–".to_owned(),
        Some(who) if who.chars().count() <= LABEL_WIDTH => who.to_owned(),
        Some(who) => who.chars().take(LABEL_WIDTH - 1).chain(['…']).collect(),
    }
}

fn describe_end((day, ended): (u32, Option<RunEndReason>)) -> String {
    let day = grouped_number(f64::from(day), 0);
    match ended {
        Some(RunEndReason::Horizon) => format!("day {day}"),
        Some(RunEndReason::Bankruptcy) => format!("bankrupt {day}"),
        Some(RunEndReason::Abandoned) => format!("given up {day}"),
        Some(RunEndReason::Lesson) => format!("lesson {day}"),
        None => format!("at day {day}"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{compare_runs, comparison_to_text};
    use novamind_report::{Logbook, sample_logbook};
    use novamind_session::Generation;

    /// Returns thirty runs with different names, players and results.
    fn thirty_runs() -> Vec<Logbook> {
        let book = sample_logbook();
        let named = |at: u32| {
            let mut logbook = book.clone();
            logbook.run = format!("{:08x}", 0x1a2b_3c00 + at);
            logbook.participant = Some(format!("participant-{at:02}"));
            logbook.cash = f64::from(at * 7919 % 30) * 1e5;
            logbook
        };
        (0..30).map(named).collect()
    }

    #[test]
    fn thirty_runs_fit_a_terminal_sorted_by_result() {
        let logbooks = thirty_runs();
        for width in [80, 100, 120, 200] {
            let text = comparison_to_text(&compare_runs(&logbooks), width);
            assert!(text.lines().all(|line| line.chars().count() <= width), "{width}:\n{text}");
            let row = |cash: [&str; 2]| {
                let has_cash = |line: &str| line.split_whitespace().any(|word| cash.contains(&word));
                text.lines().position(has_cash).expect("a row")
            };
            assert_eq!(row(["$0", "$0"]) - row(["$2.90M", "$2,900,000"]), 29, "{text}");
        }
    }

    #[test]
    fn two_runs_are_side_by_side_if_they_fit() {
        let logbooks = &thirty_runs()[..2];
        let wide = comparison_to_text(&compare_runs(logbooks), 400);
        assert!(wide.contains("Decisions") && wide.contains("cash on day 7"), "{wide}");
        let narrow = comparison_to_text(&compare_runs(logbooks), 80);
        assert!(!narrow.contains("cash on day") && narrow.contains("at day 14"), "{narrow}");
    }

    #[test]
    fn run_columns_are_known_figures() {
        for (figure, of, _) in super::COLUMNS {
            assert!(super::super::find_figure(figure, of).is_some(), "{figure}");
        }
    }

    #[test]
    fn runs_of_different_generations_are_not_ranked() {
        let mut logbooks = thirty_runs()[..2].to_vec();
        logbooks[0].cash = 1.0;
        let ranked = compare_runs(&logbooks);
        assert_eq!((ranked.is_ranked, ranked.order.as_slice()), (true, &[1, 0][..]));
        assert!(ranked.figures.iter().any(|row| row.published.is_some()));
        logbooks[0].generation = Generation::Release2;
        let mixed = compare_runs(&logbooks);
        assert_eq!((mixed.is_ranked, mixed.order.as_slice()), (false, &[0, 1][..]));
        let (wide, narrow) = (comparison_to_text(&mixed, 400), comparison_to_text(&mixed, 80));
        for text in [&wide, &narrow] {
            let sentence =
                "The runs are of release 1 and of release 2: they are shown side by side and are not ranked.";
            let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(words.contains(sentence) && words.contains("release 2"), "{text}");
        }
        assert!(narrow.contains("2 runs, not ranked"), "{narrow}");
        logbooks[1].generation = Generation::Release2;
        let second = compare_runs(&logbooks);
        assert!(second.is_ranked && second.figures.iter().all(|row| row.published.is_none()));
    }
}
