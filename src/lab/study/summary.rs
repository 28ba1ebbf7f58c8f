//! Summary of a study by arm.

use super::StudyPlan;
use crate::experiment::{Experiment, RunResult, group_equal_items};
use crate::lab_report::{
    AxisScale, CellValue, Column, Graph, GraphAxis, GraphForm, LabReport, LabTable, Measure, Series,
};
use novamind_base::statistics::{
    CONFIDENCE_LEVEL, Interval, MIN_SAMPLE_SIZE, Quartiles, RESAMPLE_COUNT, median,
};
use novamind_record::error::RunError;
use novamind_record::folder::configuration::Configuration;
use novamind_report::pluralize;

/// Maximum number of arms that the graph shows.
const MAX_CURVES: usize = 8;
const MAX_NAMES: usize = 6;

/// Returns a report on the final figures of each arm. `results` contains all runs in order.
pub fn study_summary(plan: &StudyPlan, results: &[RunResult]) -> LabReport {
    let seeds = plan.experiment.seeds.len();
    let by_arm: Vec<&[RunResult]> = results.chunks(seeds).collect();
    let mut columns: Vec<Column> = plan.factors.iter().map(|name| Column::text(name, name)).collect();
    let start = |runs: &[RunResult]| runs.first().map(|run| run.start_cash);
    let differs = by_arm.iter().any(|runs| start(runs) != start(by_arm[0]));
    columns.extend(differs.then(|| Column::number("start_cash", "cash on day 0", Measure::Dollars)));
    columns.extend([
        Column::number("alive", "not bankrupt", Measure::Share),
        Column::number("cash_lower_quartile", "lower quartile", Measure::Dollars),
        Column::number("cash_median", "median final cash", Measure::Dollars),
        Column::number("cash_upper_quartile", "upper quartile", Measure::Dollars),
        Column::interval("cash_median_interval", "median, 95 % interval", Measure::Dollars),
        Column::number("peak_subscribers_median", "median peak subscribers", Measure::Count),
    ]);
    let mut table = LabTable::new("arms", "", columns);
    for (levels, runs) in plan.levels.iter().zip(&by_arm) {
        let cash: Vec<f64> = runs.iter().map(|run| run.cash).collect();
        let peaks: Vec<f64> = runs.iter().map(|run| f64::from(run.peak_subscribers)).collect();
        let alive = runs.iter().filter(|run| !run.is_bankrupt()).count() as f64;
        let middle = Quartiles::from_values(&cash);
        let mut row: Vec<CellValue> = levels.iter().map(CellValue::text).collect();
        row.extend(differs.then(|| CellValue::number(start(runs))));
        row.extend([
            CellValue::number(alive / runs.len().max(1) as f64),
            CellValue::number(middle.map(|quartiles| quartiles.lower)),
            CellValue::number(middle.map(|quartiles| quartiles.median)),
            CellValue::number(middle.map(|quartiles| quartiles.upper)),
            CellValue::interval(Interval::for_median(&cash)),
            CellValue::number(median(&peaks)),
        ]);
        table.rows.push(row);
    }
    let mut exhibit = LabReport::with_table(format!("{}: {}", plan.name, describe_size(plan)), table);
    exhibit.graphs.push(cash_graph(plan, &by_arm));
    let luck = match plan.replays_a_record {
        false => "Common seeds: runs with the same seed have the same random draws in every arm.",
        true => {
            "Common seeds: runs with the same seed have the same random draws, except in scenarios that replay recorded draws. The seeds of such a scenario differ only in draws that are not recorded."
        }
    };
    let interval = format!(
        "Intervals: percentile bootstrap over {MIN_SAMPLE_SIZE} seeds or more, {RESAMPLE_COUNT} resamples, {:.0} %. Final cash is the cash of a run on its \
         last day or in bankruptcy.",
        CONFIDENCE_LEVEL * 100.0
    );
    if differs {
        exhibit.notes.push(
            "The arms start with different cash, so final cash does not compare their earnings.".to_owned(),
        );
    }
    exhibit.notes.extend(equal_outcome_warnings(plan, results));
    exhibit.with_note(luck).with_note(interval)
}

/// Returns a warning for each group of arms with the same policy, parameters, days and cash.
///
/// # Errors
/// Fails if a scenario is unknown or a parameter is invalid.
pub fn equal_arm_warnings(plan: &StudyPlan, configuration: &Configuration) -> Result<Vec<String>, RunError> {
    let warning = |arms: &Vec<usize>| format!("these arms are identical: {}", arm_names(plan, arms));
    Ok(plan.experiment.find_equal_arms(configuration)?.iter().map(warning).collect())
}

/// Returns a warning for each group of arms whose runs ended in the same state for every seed. `results` contains all
/// runs in order.
pub fn equal_outcome_warnings(plan: &StudyPlan, results: &[RunResult]) -> Vec<String> {
    let states = |runs: &[RunResult]| runs.iter().map(|run| run.state_hash.clone()).collect::<Vec<_>>();
    let by_arm = results.chunks(plan.experiment.seeds.len().max(1)).map(states).collect();
    let warning = |arms: &Vec<usize>| {
        format!(
            "These arms ended in the same state with every seed, so their differences had no effect: {}.",
            arm_names(plan, arms)
        )
    };
    group_equal_items(by_arm).iter().map(warning).collect()
}

/// Lists the names of the first arms and the number of the remaining arms.
fn arm_names(plan: &StudyPlan, arms: &[usize]) -> String {
    let names: Vec<String> = arms.iter().take(MAX_NAMES).map(|arm| plan.levels[*arm].join(" / ")).collect();
    let more = arms.len() - names.len();
    let more = if more > 0 { format!("; and {more} more") } else { String::new() };
    format!("{}{more}", names.join("; "))
}

/// Describes the size of a study: `2 arms by 24 seeds`.
pub fn describe_size(plan: &StudyPlan) -> String {
    let Experiment { arms, seeds, .. } = &plan.experiment;
    format!("{} by {}", pluralize(arms.len() as u32, "arm"), pluralize(seeds.len() as u32, "seed"))
}

/// Returns the arms that the graph shows: the arms with the highest final cash, in the order of the study.
fn arms_to_plot(by_arm: &[&[RunResult]]) -> Vec<usize> {
    let middle = |arm: &usize| {
        let cash: Vec<f64> = by_arm[*arm].iter().map(|run| run.cash).collect();
        median(&cash).unwrap_or(f64::NEG_INFINITY)
    };
    let mut arms: Vec<usize> = (0..by_arm.len()).collect();
    arms.sort_by(|one, other| middle(other).total_cmp(&middle(one)));
    arms.truncate(MAX_CURVES);
    arms.sort_unstable();
    arms
}

fn cash_graph(plan: &StudyPlan, by_arm: &[&[RunResult]]) -> Graph {
    let series = arms_to_plot(by_arm).into_iter().map(|arm| {
        let (runs, arm) = (by_arm[arm], &plan.experiment.arms[arm]);
        let mut days: Vec<u32> = runs.iter().flat_map(|run| run.weeks.iter().map(|week| week.day)).collect();
        days.sort_unstable();
        days.dedup();
        let cash = |day: u32| -> Vec<f64> {
            // A run that ended early keeps its final cash.
            let at = |run: &RunResult| run.weeks.iter().rfind(|week| week.day <= day).map(|week| week.cash);
            runs.iter().filter_map(at).collect()
        };
        let points = days.into_iter().filter_map(|day| Some((f64::from(day), median(&cash(day))?)));
        Series { name: arm.name.clone(), points: points.collect() }
    });
    Graph {
        title: match by_arm.len() <= MAX_CURVES {
            true => "Median cash by week".to_owned(),
            false => format!("Median cash by week, the {MAX_CURVES} arms with the most final cash"),
        },
        summary: "Median over seeds of the cash at the end of each week, by arm.".to_owned(),
        x_axis: GraphAxis { label: "day", scale: AxisScale::Whole },
        y_axis: GraphAxis { label: "dollars", scale: AxisScale::Linear },
        series: series.collect(),
        form: GraphForm::Lines,
    }
}
