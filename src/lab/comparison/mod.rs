//! Runs side by side: result, cash by week, decisions and behaviour, beside what the paper published.

mod figures;
mod table;

use serde::Serialize;

pub use figures::FIGURES;
pub use table::{as_rows, as_text};

use crate::report::Logbook;
use crate::report::ranking::{Agent, published};

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

/// Puts runs side by side.
pub fn beside(runs: &[Logbook]) -> Comparison {
    let mut figures: Vec<Row> = FIGURES.iter().map(|figure| figure.row(runs)).collect();
    figures.extend(figures::by_group(runs));
    Comparison {
        runs: runs.iter().map(|run| run.run.clone()).collect(),
        participants: runs.iter().map(|run| run.participant.clone()).collect(),
        figures,
        cash: figures::cash(runs),
        decisions: decisions(runs),
        caveats: caveats(runs),
    }
}

fn decisions(runs: &[Logbook]) -> Vec<Decided> {
    let mut days: Vec<u32> =
        runs.iter().flat_map(|run| run.weeks.iter().map(|week| week.decision_day)).collect();
    days.sort_unstable();
    days.dedup();
    let of = |run: &Logbook, day: u32| {
        let weeks = run.weeks.iter().filter(|week| week.decision_day == day);
        weeks.flat_map(|week| week.decisions.iter().cloned()).collect::<Vec<_>>()
    };
    let decided =
        days.iter().map(|day| Decided { day: *day, by_run: runs.iter().map(|run| of(run, *day)).collect() });
    decided.filter(|decided| decided.by_run.iter().any(|own| !own.is_empty())).collect()
}

/// What keeps runs from being compared figure by figure.
fn caveats(runs: &[Logbook]) -> Vec<String> {
    let Some(first) = runs.first() else { return Vec::new() };
    let mut caveats = Vec::new();
    let mut note = |differ: bool, what: &str| {
        if differ {
            caveats.push(format!("The runs differ in their {what}."));
        }
    };
    let any = |differs: &dyn Fn(&Logbook, &Logbook) -> bool| runs.iter().any(|run| differs(run, first));
    note(any(&|own, first| own.seed != first.seed), "seed");
    note(any(&|own, first| own.days != first.days), "days");
    note(any(&|own, first| own.start_cash != first.start_cash), "cash at the start");
    note(any(&|own, first| own.parameters_digest != first.parameters_digest), "parameters");
    note(any(&|own, first| own.mode != first.mode), "mode");
    let as_published = |book: &Logbook| book.seed == 42 && book.days == 500 && book.start_cash == 1e6;
    if runs.iter().any(|run| !as_published(run)) {
        caveats.push("The published runs have seed 42, 500 days and $1,000,000 at the start.".to_owned());
    }
    caveats
}

/// Range of a figure of the published agents.
fn range(what: &'static str, of: impl Fn(&Agent) -> Option<f64>) -> Option<Range> {
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
