//! Several attempts of one program, and the selected one by the rule of the published table.

use super::{FinishedRun, best_of};
use crate::exhibit::{Column, Datum, Exhibit, Measure, Tabulation};
use novamind_base::statistics::Sample;

/// A new run for a program.
#[derive(Debug, Clone, PartialEq)]
pub struct Try {
    /// Number, from 1.
    pub number: u32,
    /// Name of the run.
    pub run: String,
    /// Number of starts of the program.
    pub attempts: u32,
    /// Exit code of the last start; `None` if a signal ended it.
    pub exit_code: Option<i32>,
    /// Last simulated day.
    pub day: u32,
    /// Result of the run; `None` if it is unfinished.
    pub result: Option<FinishedRun>,
}

/// Returns a table of the attempts under a title that names the program.
pub fn tries_exhibit(title: String, tries: &[Try]) -> Exhibit {
    let columns = vec![
        Column::numbers("try", "try", Measure::Count),
        Column::words("run", "run"),
        Column::words("end", "end"),
        Column::numbers("day", "day", Measure::Days),
        Column::numbers("cash", "cash", Measure::Dollars),
        Column::numbers("calls_per_week", "calls a week", Measure::Number(2)),
        Column::numbers("attempts", "starts", Measure::Count),
        Column::numbers("exit_code", "exit code", Measure::Count),
        Column::words("selected", "selected"),
    ];
    let finished: Vec<&FinishedRun> = tries.iter().filter_map(|own| own.result.as_ref()).collect();
    let best = best_of(&finished).map(|run| run.run.clone());
    let rows = tries.iter().map(|own| cells(own, best.as_deref())).collect();
    let mut exhibit = Exhibit::of(title, Tabulation { rows, ..Tabulation::new("tries", "", columns) });
    exhibit.notes.push(
        "Selected: the run with the most final cash; if all runs went bankrupt, the one with the longest life.".to_owned(),
    );
    let unfinished = tries.len() - finished.len();
    if unfinished > 0 {
        exhibit.notes.push(format!("Unfinished runs, not selected: {unfinished}."));
    }
    if !finished.is_empty() {
        let bankrupt = finished.iter().filter(|run| run.is_bankrupt).count();
        let lives: Vec<f64> = finished.iter().map(|run| f64::from(run.survival_days)).collect();
        exhibit.notes.push(format!(
            "Bankrupt: {bankrupt} of {}; mean life {:.1} days. `novamind lab table` compares runs that have the published length and starting \
             cash with published ones.",
            finished.len(),
            Sample::of(&lives).mean
        ));
    }
    exhibit
}

fn cells(own: &Try, best: Option<&str>) -> Vec<Datum> {
    let end = match &own.result {
        None => "unfinished",
        Some(run) if run.is_bankrupt => "bankrupt",
        Some(_) => "last day",
    };
    vec![
        Datum::Number(f64::from(own.number)),
        Datum::words(&*own.run),
        Datum::words(end),
        Datum::Number(f64::from(own.day)),
        Datum::number(own.result.as_ref().map(|run| run.score)),
        Datum::number(own.result.as_ref().map(|run| run.calls_per_week)),
        Datum::Number(f64::from(own.attempts)),
        Datum::number(own.exit_code.map(f64::from)),
        Datum::words(if best == Some(own.run.as_str()) { "yes" } else { "" }),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn own(number: u32, result: Option<(f64, u32)>) -> Try {
        let run = format!("r{number}");
        let result = result.map(|(score, days)| FinishedRun {
            run: run.clone(),
            participant: None,
            policy: None,
            seed: 42,
            score,
            is_bankrupt: score == 0.0,
            survival_days: days,
            calls_per_week: 1.0,
        });
        let day = result.as_ref().map_or(14, |run| run.survival_days);
        Try { number, run, attempts: 1, exit_code: Some(0), day, result }
    }

    fn selected(tries: &[Try]) -> Vec<String> {
        let exhibit = tries_exhibit("x".to_owned(), tries);
        let rows = &exhibit.tables[0].rows;
        let is_selected = |row: &&Vec<Datum>| row.last() == Some(&Datum::words("yes"));
        rows.iter().filter(is_selected).map(|row| format!("{:?}", row[1])).collect()
    }

    #[test]
    fn the_most_cash_counts_and_else_the_longest_life() {
        let name = |run: &str| vec![format!("{:?}", Datum::words(run))];
        assert_eq!(selected(&[own(1, Some((0.0, 400))), own(2, Some((5.0, 500))), own(3, None)]), name("r2"));
        assert_eq!(selected(&[own(1, Some((0.0, 120))), own(2, Some((0.0, 131)))]), name("r2"));
        assert!(selected(&[own(1, None)]).is_empty());
    }
}
