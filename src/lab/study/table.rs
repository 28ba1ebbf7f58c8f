//! The rows of a study: one per run, or one per run and day.

use super::StudyPlan;
use crate::experiment::{DayPoint, RunResult};
use crate::runner::RunEnd;

const RUN_COLUMNS: [&str; 11] = [
    "start_cash",
    "days",
    "day",
    "ended",
    "cash",
    "subscribers",
    "seats",
    "peak_subscribers",
    "peak_day",
    "mrr",
    "state_hash",
];

const DAY_COLUMNS: [&str; 13] = [
    "day",
    "cash",
    "mrr",
    "subscribers",
    "seats",
    "individual_leads",
    "enterprise_leads",
    "new_subscribers",
    "cancellations",
    "payments",
    "running_costs",
    "other",
    "usage",
];

/// Returns the names of the columns in the table of a study.
pub fn column_names(plan: &StudyPlan) -> Vec<String> {
    let texts: &[&str] = if plan.experiment.recorded.daily { &DAY_COLUMNS } else { &RUN_COLUMNS };
    let before = std::iter::once("run".to_owned()).chain(plan.factors.iter().cloned());
    before.chain(["seed".to_owned()]).chain(texts.iter().map(|name| (*name).to_owned())).collect()
}

/// Returns the table rows of the run with a given index. Numbers have the shortest form that parses to the same value.
pub fn rows(plan: &StudyPlan, number: usize, result: &RunResult) -> Vec<Vec<String>> {
    let (levels, seed) = plan.arm_and_seed(number);
    let mut before = vec![(number + 1).to_string()];
    before.extend(levels.iter().cloned());
    before.push(seed.to_string());
    let row = |texts: Vec<String>| before.iter().cloned().chain(texts).collect();
    if plan.experiment.recorded.daily {
        return result.daily.iter().map(day_cells).map(row).collect();
    }
    vec![row(run_cells(result))]
}

fn run_cells(run_result: &RunResult) -> Vec<String> {
    let ended = match run_result.ended {
        RunEnd::Horizon => "horizon",
        RunEnd::Until => "until",
        RunEnd::Bankruptcy => "bankruptcy",
    };
    vec![
        run_result.start_cash.to_string(),
        run_result.days.to_string(),
        run_result.day.to_string(),
        ended.to_owned(),
        run_result.cash.to_string(),
        run_result.subscribers.to_string(),
        run_result.seats.to_string(),
        run_result.peak_subscribers.to_string(),
        run_result.peak_day.to_string(),
        run_result.mrr.to_string(),
        run_result.state_hash.clone(),
    ]
}

fn day_cells(day_point: &DayPoint) -> Vec<String> {
    vec![
        day_point.day.to_string(),
        day_point.cash.to_string(),
        day_point.mrr.to_string(),
        day_point.subscribers.to_string(),
        day_point.seats.to_string(),
        day_point.individual_leads.to_string(),
        day_point.enterprise_leads.to_string(),
        day_point.new_subscribers.to_string(),
        day_point.cancellations.to_string(),
        day_point.payments.to_string(),
        day_point.running_costs.to_string(),
        day_point.other.to_string(),
        day_point.usage.to_string(),
    ]
}
