//! Several attempts by one program, one of which is selected by the rule of the published table.

use super::{FinishedRun, best_run};
use crate::lab_report::{CellValue, Column, LabReport, LabTable, Measure};
use novamind_base::statistics::SampleStatistics;

/// An attempt by a program, which plays a new run.
#[derive(Debug, Clone, PartialEq)]
pub struct AttemptResult {
    /// Number of the attempt, from 1.
    pub number: u32,
    /// Name of the attempt's run.
    pub run: String,
    /// Number of times that the program was started.
    pub starts: u32,
    /// Exit code of the program after its last start; `None` if a signal ended the program.
    pub exit_code: Option<i32>,
    /// Last simulated day of the attempt's run.
    pub day: u32,
    /// Result of the run; `None` if the run is unfinished.
    pub result: Option<FinishedRun>,
}

/// Returns a report on the attempts. `title` names the program.
pub fn attempts_report(title: String, tries: &[AttemptResult]) -> LabReport {
    let columns = vec![
        Column::number("try", "try", Measure::Count),
        Column::text("run", "run"),
        Column::text("end", "end"),
        Column::number("day", "day", Measure::Days),
        Column::number("cash", "cash", Measure::Dollars),
        Column::number("calls_per_week", "calls a week", Measure::Number(2)),
        Column::number("attempts", "starts", Measure::Count),
        Column::number("exit_code", "exit code", Measure::Count),
        Column::text("selected", "selected"),
    ];
    let finished: Vec<&FinishedRun> =
        tries.iter().filter_map(|attempt_result| attempt_result.result.as_ref()).collect();
    let best = best_run(&finished).map(|run| run.run.clone());
    let rows = tries.iter().map(|result| row_cells(result, best.as_deref())).collect();
    let mut exhibit = LabReport::with_table(title, LabTable { rows, ..LabTable::new("tries", "", columns) });
    exhibit.notes.push(
        "Selected: the run with the most final cash; if all runs went bankrupt, the run that survived longest.".to_owned(),
    );
    let unfinished = tries.len() - finished.len();
    if unfinished > 0 {
        exhibit.notes.push(format!("Unfinished runs, not selected: {unfinished}."));
    }
    if !finished.is_empty() {
        let bankrupt = finished.iter().filter(|run| run.is_bankrupt).count();
        let survival_times: Vec<f64> = finished.iter().map(|run| f64::from(run.survival_days)).collect();
        exhibit.notes.push(format!(
            "Bankrupt: {bankrupt} of {}; mean survival {:.1} days. `novamind lab table` compares runs that have the published length and starting cash with published runs.",
            finished.len(),
            SampleStatistics::from_values(&survival_times).mean
        ));
    }
    exhibit
}

fn row_cells(attempt_result: &AttemptResult, best: Option<&str>) -> Vec<CellValue> {
    let end = match &attempt_result.result {
        None => "unfinished",
        Some(run) if run.is_bankrupt => "bankrupt",
        Some(_) => "last day",
    };
    vec![
        CellValue::Number(f64::from(attempt_result.number)),
        CellValue::text(&*attempt_result.run),
        CellValue::text(end),
        CellValue::Number(f64::from(attempt_result.day)),
        CellValue::number(attempt_result.result.as_ref().map(|run| run.score)),
        CellValue::number(attempt_result.result.as_ref().map(|run| run.calls_per_week)),
        CellValue::Number(f64::from(attempt_result.starts)),
        CellValue::number(attempt_result.exit_code.map(f64::from)),
        CellValue::text(if best == Some(attempt_result.run.as_str()) { "yes" } else { "" }),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample_attempt(number: u32, result: Option<(f64, u32)>) -> AttemptResult {
        let run = format!("r{number}");
        let result = result.map(|(score, days)| FinishedRun {
            run: run.clone(),
            participant: None,
            policy: None,
            seed: 42,
            generation: novamind_session::Generation::Release1,
            days: 500,
            score,
            is_bankrupt: score == 0.0,
            survival_days: days,
            calls_per_week: 1.0,
        });
        let day = result.as_ref().map_or(14, |run| run.survival_days);
        AttemptResult { number, run, starts: 1, exit_code: Some(0), day, result }
    }

    fn selected_attempts(tries: &[AttemptResult]) -> Vec<String> {
        let exhibit = attempts_report("x".to_owned(), tries);
        let rows = &exhibit.tables[0].rows;
        let is_selected = |row: &&Vec<CellValue>| row.last() == Some(&CellValue::text("yes"));
        rows.iter().filter(is_selected).map(|row| format!("{:?}", row[1])).collect()
    }

    #[test]
    fn best_attempt_has_most_cash_then_longest_survival() {
        let name = |run: &str| vec![format!("{:?}", CellValue::text(run))];
        assert_eq!(
            selected_attempts(&[
                sample_attempt(1, Some((0.0, 400))),
                sample_attempt(2, Some((5.0, 500))),
                sample_attempt(3, None)
            ]),
            name("r2")
        );
        assert_eq!(
            selected_attempts(&[sample_attempt(1, Some((0.0, 120))), sample_attempt(2, Some((0.0, 131)))]),
            name("r2")
        );
        assert!(selected_attempts(&[sample_attempt(1, None)]).is_empty());
    }
}
