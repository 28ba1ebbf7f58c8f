//! Usage per seat of a group, measured on the last day or estimated by the last market study.

use std::collections::BTreeMap;

use novamind_database::{QueryResult, number_at, text_at};
use novamind_session::identifiers::Group;

/// SQL query for the usage of the last day. Columns: group, plan, users, seats, units, dollars per month, days since
/// signing times seats.
pub const SEAT_USAGE_SQL: &str = include_str!("../../assets/readings/usage.sql");

/// Usage of the enterprises that used the product on the last day, by group.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SeatUsage(BTreeMap<String, MeasuredUsage>);

/// Usage of the enterprises of a group on the last day.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MeasuredUsage {
    seats: f64,
    units: f64,
    /// Sum over all seats of the days since their enterprise signed.
    seat_days: f64,
}

impl MeasuredUsage {
    /// Returns the units per seat on the last day.
    pub fn units_per_seat(&self) -> f64 {
        self.units / self.seats
    }

    /// Returns the mean number of days since the enterprises signed, weighted by seats.
    pub fn mean_days_since_signing(&self) -> f64 {
        self.seat_days / self.seats
    }
}

impl SeatUsage {
    /// Reads the rows of [`SEAT_USAGE_SQL`] and ignores groups of individuals.
    pub fn from_rows(rows: &QueryResult) -> SeatUsage {
        let mut groups: BTreeMap<String, MeasuredUsage> = BTreeMap::new();
        for row in &rows.rows {
            if Group::parse(text_at(row, 0)).is_some_and(Group::is_enterprise) {
                let usage = groups.entry(text_at(row, 0).to_owned()).or_default();
                usage.seats += number_at(row, 3);
                usage.units += number_at(row, 4);
                usage.seat_days += number_at(row, 6);
            }
        }
        SeatUsage(groups)
    }

    /// Returns the usage of a group, or `None` if no enterprise of the group used the product on the last day.
    pub fn measured_usage(&self, group: &str) -> Option<MeasuredUsage> {
        self.0.get(group).copied().filter(|usage| usage.seats > 0.0)
    }
}
