//! Market figures collected from the readings: groups, market research attempts, and the index of the
//! economy.

use std::collections::BTreeMap;

use novamind_database::{Cell, Rows, number_at, text_at};
use novamind_session::RunningStudy;
use novamind_session::identifiers::Group;
use novamind_worker::company::Company;
use novamind_worker::readings::Reading;

/// Study level of a group, with dates.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Known {
    /// Study level; 0 if the group has not been found.
    pub level: u8,
    /// Day on which it was found; 0 for the initial groups.
    pub found: Option<u32>,
    /// Day on which the level last rose.
    pub studied: Option<u32>,
}

/// A market research attempt.
#[derive(Debug, Clone, PartialEq)]
pub struct Attempt {
    /// Day of the attempt.
    pub day: u32,
    /// Cost in dollars.
    pub cost: f64,
    /// Group that was found.
    pub group: Option<Group>,
}

/// A published measurement of the economy.
#[derive(Debug, Clone, PartialEq)]
pub struct Published {
    /// Day of the measurement.
    pub day: u32,
    /// Value of the index.
    pub value: f64,
    /// Change since the previous measurement.
    pub change: f64,
    /// Trend and phase.
    pub words: String,
    /// Description.
    pub text: String,
}

/// All figures from the readings.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MarketFacts {
    /// Study levels by group.
    pub known: BTreeMap<Group, Known>,
    /// Attempts, newest first.
    pub attempts: Vec<Attempt>,
    /// Measurements of the economy, oldest first.
    pub economy: Vec<Published>,
}

impl MarketFacts {
    /// Replaces a reading.
    pub fn take(&mut self, reading: Reading, rows: &Rows) {
        let rows = rows.rows.iter();
        match reading {
            Reading::Knowledge => {
                self.known =
                    rows.filter_map(|row| Some((Group::parse(text_at(row, 0))?, known(row)))).collect();
            }
            Reading::Attempts => self.attempts = rows.map(|row| attempt(row)).collect(),
            Reading::Economy => self.economy = rows.map(|row| published(row)).collect(),
            _ => {}
        }
    }

    /// Returns the dollars spent on all attempts.
    pub fn spent(&self) -> f64 {
        self.attempts.iter().map(|attempt| attempt.cost).sum()
    }

    /// Returns the number of attempts that found a group.
    pub fn found(&self) -> usize {
        self.attempts.iter().filter(|attempt| attempt.group.is_some()).count()
    }
}

fn day_at(row: &[Cell], at: usize) -> Option<u32> {
    matches!(row.get(at), Some(Cell::Integer(_))).then(|| number_at(row, at) as u32)
}

fn known(row: &[Cell]) -> Known {
    Known { level: number_at(row, 1) as u8, found: day_at(row, 2), studied: day_at(row, 3) }
}

fn attempt(row: &[Cell]) -> Attempt {
    let group = Group::parse(text_at(row, 3)).filter(|_| number_at(row, 2) > 0.0);
    Attempt { day: number_at(row, 0) as u32, cost: number_at(row, 1), group }
}

fn published(row: &[Cell]) -> Published {
    Published {
        day: number_at(row, 0) as u32,
        value: number_at(row, 1),
        change: number_at(row, 3),
        words: format!("{} · {}", text_at(row, 2), text_at(row, 4)),
        text: text_at(row, 5).to_owned(),
    }
}

/// Returns the running study of a group.
pub fn study_of(company: &Company, group: Group) -> Option<&RunningStudy> {
    company.studies.iter().find(|study| study.group == group)
}

/// Returns the study level of a known group, from its insight report.
pub fn level_of(company: &Company, group: Group) -> u8 {
    company.insights.get(&group).map_or(0, |insights| insights.info_level)
}

/// Returns the name of a known group.
pub fn name_of(company: &Company, group: Group) -> &str {
    company.insights.get(&group).map_or("", |insights| &insights.group_name)
}

/// Returns the number of groups that have not been found, as in `get_market_overview`.
pub fn undiscovered(company: &Company) -> usize {
    company.market.undiscovered_count
}

/// Returns the level of the next study: the chosen one if it is allowed, otherwise the next level.
pub fn target_of(company: &Company, group: Group, chosen: Option<u8>) -> u8 {
    let (least, most) = company.terms.targets;
    let now = level_of(company, group);
    let lowest = now.max(least).min(most);
    chosen.unwrap_or(now.saturating_add(1)).clamp(lowest, most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_miss_something_are_taken_for_what_they_say() {
        let text = |text: &str| Cell::Text(text.to_owned());
        let rows = |row: Vec<Cell>| Rows { rows: vec![row], ..Rows::default() };
        let mut facts = MarketFacts::default();
        facts.take(Reading::Knowledge, &rows(vec![text("D_S01"), Cell::Integer(0), Cell::Null, Cell::Null]));
        facts.take(
            Reading::Attempts,
            &rows(vec![Cell::Integer(7), Cell::Real(25_000.0), Cell::Integer(0), Cell::Null]),
        );
        assert_eq!(facts.known.values().next(), Some(&Known::default()));
        assert_eq!((facts.spent(), facts.found()), (25_000.0, 0));
        facts.take(Reading::Attempts, &Rows::default());
        assert!(facts.attempts.is_empty());
    }
}
