//! What is compared: figures of runs beside each other.

use serde::Serialize;

use crate::exhibit::Measure;
use novamind_record::trajectory::record::Ended;
use novamind_report::ranking::{Agent, published};

/// A figure of all runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Name.
    pub figure: String,
    /// Of what: a group, a horizon in days, a day; empty if of the whole run.
    pub of: String,
    /// Unit.
    pub unit: &'static str,
    /// Values in the order of the runs; none where there is none.
    pub values: Vec<Option<f64>>,
    /// What the paper published to compare with.
    pub published: Option<Range>,
}

impl Row {
    /// What its values measure.
    pub(super) fn measure(&self) -> Measure {
        measure_of(self.unit)
    }
}

/// What figures of a unit measure.
pub fn measure_of(unit: &str) -> Measure {
    match unit {
        "dollars" => Measure::Dollars,
        "share" => Measure::Share,
        "count" => Measure::Count,
        "days" => Measure::Days,
        _ => Measure::Number(1),
    }
}

/// Least and most of published figures.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Range {
    /// Least.
    pub least: f64,
    /// Most.
    pub most: f64,
    /// What they are, for they are not always quite the same.
    pub what: &'static str,
}

/// Runs side by side.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Names of the runs.
    pub runs: Vec<String>,
    /// Who played them.
    pub participants: Vec<Option<String>>,
    /// The runs by their results: places in `runs`, the best first.
    pub order: Vec<usize>,
    /// Last simulated day of each, and how it ended.
    pub ends: Vec<(u32, Option<Ended>)>,
    /// Figures.
    pub figures: Vec<Row>,
    /// Cash at the ends of weeks, dollars; `of` is the day.
    pub cash: Vec<Row>,
    /// What was decided before each week, run by run.
    pub decisions: Vec<Decided>,
    /// What differs between the runs, and between them and the published ones.
    pub caveats: Vec<String>,
}

/// What was decided in one week.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Decided {
    /// Decision day.
    pub day: u32,
    /// In words, in the order of the runs.
    pub by_run: Vec<Vec<String>>,
}

/// Range of a figure of the published agents.
pub(super) fn range(what: &'static str, of: impl Fn(&Agent) -> Option<f64>) -> Option<Range> {
    let values: Vec<f64> = published().agent.iter().filter_map(of).collect();
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (!values.is_empty()).then_some(Range { least, most, what })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_ranges_are_those_of_the_paper() {
        let turns = range("turns", |agent| Some(agent.turns_per_week)).expect("they are published");
        assert_eq!((turns.least, turns.most), (7.82, 98.66));
        let shares = range("shares", |agent| agent.targeted_development_share).expect("some are published");
        assert_eq!((shares.least, shares.most), (0.11, 0.88));
        assert_eq!(range("none", |_| None), None);
    }
}
