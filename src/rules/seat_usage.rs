//! Usage per seat of a group, measured on the last day or estimated by the last market study.

use std::collections::BTreeMap;

use novamind_database::{QueryResult, number_at, text_at};
use novamind_session::identifiers::Group;

/// SQL query for the usage of the last day. Columns: group, plan, users, seats, units.
pub const SEAT_USAGE_SQL: &str = include_str!("../../assets/readings/usage.sql");

/// Seats of the enterprises that used the product on the last day, and the units used, by group.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SeatUsage(BTreeMap<String, (f64, f64)>);

impl SeatUsage {
    /// Reads the rows of [`SEAT_USAGE_SQL`], without individuals.
    pub fn from_rows(rows: &QueryResult) -> SeatUsage {
        let mut groups: BTreeMap<String, (f64, f64)> = BTreeMap::new();
        for row in &rows.rows {
            if Group::parse(text_at(row, 0)).is_some_and(Group::is_enterprise) {
                let usage = groups.entry(text_at(row, 0).to_owned()).or_default();
                *usage = (usage.0 + number_at(row, 3), usage.1 + number_at(row, 4));
            }
        }
        SeatUsage(groups)
    }

    /// Returns the usage of a group in units per seat per day, or `None` if no enterprise of the group used the
    /// product on the last day.
    pub fn measured_usage(&self, group: &str) -> Option<f64> {
        self.0.get(group).filter(|(seats, _)| *seats > 0.0).map(|(seats, units)| units / seats)
    }
}
