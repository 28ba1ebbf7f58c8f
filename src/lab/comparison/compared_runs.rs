//! Figures of several runs for comparison.

use serde::Serialize;

use crate::lab_report::Measure;
use novamind_record::trajectory::record::RunEndReason;
use novamind_report::ranking::{PublishedAgent, published_results};
use novamind_world::params::{HorizonRule, Interface};

/// A row of the comparison: one figure with a value for each run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparisonRow {
    /// Name of the compared figure.
    pub figure: String,
    /// Group, horizon in days, or day of the row; empty for a figure of the whole run.
    pub of: String,
    /// Unit of the values, for example `dollars` or `share`.
    pub unit: &'static str,
    /// Values in the order of the runs; `None` if a run has no value.
    pub values: Vec<Option<f64>>,
    /// Range of the published values; `None` if no values are published.
    pub published: Option<PublishedRange>,
}

impl ComparisonRow {
    /// Returns the measure that formats values in the unit of the row.
    pub(super) fn measure(&self) -> Measure {
        measure_for_unit(self.unit)
    }
}

/// Returns the measure that formats values in a unit.
pub fn measure_for_unit(unit: &str) -> Measure {
    match unit {
        "dollars" => Measure::Dollars,
        "share" => Measure::Share,
        "count" => Measure::Count,
        "days" => Measure::Days,
        _ => Measure::Number(1),
    }
}

/// A range of published values.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PublishedRange {
    /// Lowest published value.
    pub least: f64,
    /// Highest published value.
    pub most: f64,
    /// Description of the published values, whose definition can differ from the definition of the figure.
    pub what: &'static str,
}

/// A comparison of several runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Names of the compared runs.
    pub runs: Vec<String>,
    /// Participant of each run; `None` if the run has no label.
    pub participants: Vec<Option<String>>,
    /// Scenario of each run.
    pub scenarios: Vec<String>,
    /// Generation of the released simulator whose rules each run uses.
    pub generations: Vec<Interface>,
    /// Last day of each run, and the rule that derived the last day.
    pub horizons: Vec<(u32, HorizonRule)>,
    /// Whether all runs have the same generation. Runs of different generations are not ranked.
    pub is_ranked: bool,
    /// Indices into `runs`, sorted by result, best first; in the order of `runs` if the runs are not ranked.
    pub order: Vec<usize>,
    /// Last simulated day of each run, with the reason for the end; `None` if the run is unfinished.
    pub ends: Vec<(u32, Option<RunEndReason>)>,
    /// Figures of the whole run or of a group.
    pub figures: Vec<ComparisonRow>,
    /// Cash at the end of each week, dollars. `of` is the last day of the week.
    pub cash: Vec<ComparisonRow>,
    /// Decisions of all runs before each week.
    pub decisions: Vec<ComparedDecisions>,
    /// Reasons why the figures of the runs are not comparable with each other or with published figures.
    pub caveats: Vec<String>,
}

/// The decisions of all runs before one week.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedDecisions {
    /// Decision day before the week.
    pub day: u32,
    /// Descriptions of the decisions, by run.
    pub by_run: Vec<Vec<String>>,
}

/// Returns the range of a figure among the published agents.
pub(super) fn published_range(
    what: &'static str,
    of: impl Fn(&PublishedAgent) -> Option<f64>,
) -> Option<PublishedRange> {
    let values: Vec<f64> = published_results().paper().agent.iter().filter_map(of).collect();
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
