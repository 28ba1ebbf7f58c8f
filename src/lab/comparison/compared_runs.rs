//! Figures of several runs for comparison.

use serde::Serialize;

use crate::lab_report::Measure;
use novamind_record::trajectory::record::RunEndReason;
use novamind_report::ranking::{PublishedAgent, published_results};

/// One figure for all runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparisonRow {
    /// Name.
    pub figure: String,
    /// Group, horizon in days, or day; empty for the whole run.
    pub of: String,
    /// Unit.
    pub unit: &'static str,
    /// Values in the order of the runs; `None` if a run has no value.
    pub values: Vec<Option<f64>>,
    /// Published range, if any.
    pub published: Option<PublishedRange>,
}

impl ComparisonRow {
    /// Returns the measure of its values.
    pub(super) fn measure(&self) -> Measure {
        measure_for_unit(self.unit)
    }
}

/// Returns the measure for a unit.
pub fn measure_for_unit(unit: &str) -> Measure {
    match unit {
        "dollars" => Measure::Dollars,
        "share" => Measure::Share,
        "count" => Measure::Count,
        "days" => Measure::Days,
        _ => Measure::Number(1),
    }
}

/// Range of published figures.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PublishedRange {
    /// Minimum.
    pub least: f64,
    /// Maximum.
    pub most: f64,
    /// Description, because definitions differ.
    pub what: &'static str,
}

/// A comparison of runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Names of the runs.
    pub runs: Vec<String>,
    /// Players.
    pub participants: Vec<Option<String>>,
    /// Indices into `runs`, best result first.
    pub order: Vec<usize>,
    /// Last simulated day and end of each run.
    pub ends: Vec<(u32, Option<RunEndReason>)>,
    /// Figures.
    pub figures: Vec<ComparisonRow>,
    /// Cash at the end of each week, dollars; `of` is the day.
    pub cash: Vec<ComparisonRow>,
    /// Decisions before each week by run.
    pub decisions: Vec<ComparedDecisions>,
    /// Limits of comparability among the runs and with published ones.
    pub caveats: Vec<String>,
}

/// Decisions of one week.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedDecisions {
    /// Decision day.
    pub day: u32,
    /// Descriptions in the order of the runs.
    pub by_run: Vec<Vec<String>>,
}

/// Returns the range of a figure over the published agents.
pub(super) fn published_range(
    what: &'static str,
    of: impl Fn(&PublishedAgent) -> Option<f64>,
) -> Option<PublishedRange> {
    let values: Vec<f64> = published_results().agent.iter().filter_map(of).collect();
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (!values.is_empty()).then_some(PublishedRange { least, most, what })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_ranges_match_the_paper() {
        let turns = published_range("turns", |agent| Some(agent.turns_per_week)).expect("they are published");
        assert_eq!((turns.least, turns.most), (7.82, 98.66));
        let shares =
            published_range("shares", |agent| agent.targeted_development_share).expect("some are published");
        assert_eq!((shares.least, shares.most), (0.11, 0.88));
        assert_eq!(published_range("none", |_| None), None);
    }
}
