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

/// Returns the names of the columns.
pub fn column_names(plan: &StudyPlan) -> Vec<String> {
    let own: &[&str] = if plan.experiment.recorded.daily { &DAY_COLUMNS } else { &RUN_COLUMNS };
    let before = std::iter::once("run".to_owned()).chain(plan.factors.iter().cloned());
    before.chain(["seed".to_owned()]).chain(own.iter().map(|name| (*name).to_owned())).collect()
}

/// Returns the rows of a run, given its index. Numbers have the shortest form that parses to the same value.
pub fn rows(plan: &StudyPlan, number: usize, result: &RunResult) -> Vec<Vec<String>> {
    let (levels, seed) = plan.arm_and_seed(number);
    let mut before = vec![(number + 1).to_string()];
    before.extend(levels.iter().cloned());
    before.push(seed.to_string());
    let row = |own: Vec<String>| before.iter().cloned().chain(own).collect();
    if plan.experiment.recorded.daily {
        return result.daily.iter().map(day_cells).map(row).collect();
    }
    vec![row(run_cells(result))]
}

fn run_cells(own: &RunResult) -> Vec<String> {
    let ended = match own.ended {
        RunEnd::Horizon => "horizon",
        RunEnd::Until => "until",
        RunEnd::Bankruptcy => "bankruptcy",
    };
    vec![
        own.start_cash.to_string(),
        own.days.to_string(),
        own.day.to_string(),
        ended.to_owned(),
        own.cash.to_string(),
        own.subscribers.to_string(),
        own.seats.to_string(),
        own.peak_subscribers.to_string(),
        own.peak_day.to_string(),
        own.mrr.to_string(),
        own.state_hash.clone(),
    ]
}

fn day_cells(own: &DayPoint) -> Vec<String> {
    vec![
        own.day.to_string(),
        own.cash.to_string(),
        own.mrr.to_string(),
        own.subscribers.to_string(),
        own.seats.to_string(),
        own.individual_leads.to_string(),
        own.enterprise_leads.to_string(),
        own.new_subscribers.to_string(),
        own.cancellations.to_string(),
        own.payments.to_string(),
        own.running_costs.to_string(),
        own.other.to_string(),
        own.usage.to_string(),
    ]
}
