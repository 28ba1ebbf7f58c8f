//! Market figures that are collected from query results: groups, market research attempts and the PMI.

use std::collections::BTreeMap;

use novamind_database::{Cell, QueryResult, number_at, text_at};
use novamind_session::RunningStudy;
use novamind_session::identifiers::Group;
use novamind_worker::company::DisplayedCompany;
use novamind_worker::screen_queries::Reading;

/// Study level of a group, with the days of discovery and of the last study.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct GroupKnowledge {
    /// Study level, or 0 if the group has not been found.
    pub level: u8,
    /// Day on which the group was found, or 0 for the initial groups.
    pub found_day: Option<u32>,
    /// Day on which the study level last increased.
    pub studied_day: Option<u32>,
}

/// A market research attempt.
#[derive(Debug, Clone, PartialEq)]
pub struct ResearchAttempt {
    /// Day of the attempt.
    pub day: u32,
    /// Cost of the attempt in dollars.
    pub cost: f64,
    /// Group that the attempt found, if any.
    pub group: Option<Group>,
}

/// A published measurement of the economy.
#[derive(Debug, Clone, PartialEq)]
pub struct EconomyMeasurement {
    /// Day of the measurement.
    pub day: u32,
    /// Measured value of the PMI.
    pub value: f64,
    /// Change in the PMI since the previous measurement.
    pub change: f64,
    /// Trend and phase of the economy.
    pub phase: String,
    /// Published description of the economy.
    pub text: String,
}

/// All market figures from query results.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MarketFacts {
    /// Study level and dates by group.
    pub known: BTreeMap<Group, GroupKnowledge>,
    /// Market research attempts, the newest first.
    pub attempts: Vec<ResearchAttempt>,
    /// PMI measurements, the oldest first.
    pub economy: Vec<EconomyMeasurement>,
}

impl MarketFacts {
    /// Replaces the figures that are computed from a screen query.
    pub fn apply_rows(&mut self, reading: Reading, rows: &QueryResult) {
        let rows = rows.rows.iter();
        match reading {
            Reading::Knowledge => {
                self.known =
                    rows.filter_map(|row| Some((Group::parse(text_at(row, 0))?, parse_knowledge(row)))).collect();
            }
            Reading::Attempts => self.attempts = rows.map(|row| parse_attempt(row)).collect(),
            Reading::Economy => self.economy = rows.map(|row| parse_measurement(row)).collect(),
            _ => {}
        }
    }

    /// Returns the total cost of all market research attempts in dollars.
    pub fn research_cost(&self) -> f64 {
        self.attempts.iter().map(|attempt| attempt.cost).sum()
    }

    /// Returns the number of market research attempts that found a group.
    pub fn found_count(&self) -> usize {
        self.attempts.iter().filter(|attempt| attempt.group.is_some()).count()
    }
}

fn day_at(row: &[Cell], at: usize) -> Option<u32> {
    matches!(row.get(at), Some(Cell::Integer(_))).then(|| number_at(row, at) as u32)
}

fn parse_knowledge(row: &[Cell]) -> GroupKnowledge {
    GroupKnowledge { level: number_at(row, 1) as u8, found_day: day_at(row, 2), studied_day: day_at(row, 3) }
}

fn parse_attempt(row: &[Cell]) -> ResearchAttempt {
    let group = Group::parse(text_at(row, 3)).filter(|_| number_at(row, 2) > 0.0);
    ResearchAttempt { day: number_at(row, 0) as u32, cost: number_at(row, 1), group }
}

fn parse_measurement(row: &[Cell]) -> EconomyMeasurement {
    EconomyMeasurement {
        day: number_at(row, 0) as u32,
        value: number_at(row, 1),
        change: number_at(row, 3),
        phase: format!("{} · {}", text_at(row, 2), text_at(row, 4)),
        text: text_at(row, 5).to_owned(),
    }
}

/// Returns the market study of a group that is in progress.
pub fn running_study(company: &DisplayedCompany, group: Group) -> Option<&RunningStudy> {
    company.running_studies.iter().find(|study| study.group == group)
}

/// Returns the study level of a known group, from its insight report.
pub fn study_level(company: &DisplayedCompany, group: Group) -> u8 {
    company.insights.get(&group).map_or(0, |insights| insights.info_level)
}

/// Returns the name of a known group.
pub fn group_name(company: &DisplayedCompany, group: Group) -> &str {
    company.insights.get(&group).map_or("", |insights| &insights.group_name)
}

/// Returns the number of groups that have not been found, as in `get_market_overview`.
pub fn undiscovered_count(company: &DisplayedCompany) -> usize {
    company.market.undiscovered_count
}

/// Returns the level of the next study: the chosen level if that level is allowed, otherwise the next level.
pub fn target_level(company: &DisplayedCompany, group: Group, chosen: Option<u8>) -> u8 {
    let (least, most) = company.tool_limits.targets;
    let now = study_level(company, group);
    let lowest = now.max(least).min(most);
    chosen.unwrap_or(now.saturating_add(1)).clamp(lowest, most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn incomplete_rows_are_parsed() {
        let text = |text: &str| Cell::Text(text.to_owned());
        let rows = |row: Vec<Cell>| QueryResult { rows: vec![row], ..QueryResult::default() };
        let mut facts = MarketFacts::default();
        facts.apply_rows(Reading::Knowledge, &rows(vec![text("D_S01"), Cell::Integer(0), Cell::Null, Cell::Null]));
        facts.apply_rows(
            Reading::Attempts,
            &rows(vec![Cell::Integer(7), Cell::Real(25_000.0), Cell::Integer(0), Cell::Null]),
        );
        assert_eq!(facts.known.values().next(), Some(&GroupKnowledge::default()));
        assert_eq!((facts.research_cost(), facts.found_count()), (25_000.0, 0));
        facts.apply_rows(Reading::Attempts, &QueryResult::default());
        assert!(facts.attempts.is_empty());
    }
}
