//! What a seat of a group uses: measured on the last day, otherwise what the last study estimates.

use std::collections::BTreeMap;

use novamind_database::{Rows, number_at, text_at};
use novamind_session::identifiers::Group;

/// The statement that measures it: group, plan, users, seats, units of the last day.
pub const SEAT_USAGE: &str = include_str!("../../assets/readings/usage.sql");

/// Seats of companies that used the product on the last day, and their units, by group.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SeatUsage(BTreeMap<String, (f64, f64)>);

impl SeatUsage {
    /// Reads the answer to [`SEAT_USAGE`]; individuals are left out.
    pub fn read(rows: &Rows) -> SeatUsage {
        let mut groups: BTreeMap<String, (f64, f64)> = BTreeMap::new();
        for row in &rows.rows {
            if Group::parse(text_at(row, 0)).is_some_and(Group::is_enterprise) {
                let own = groups.entry(text_at(row, 0).to_owned()).or_default();
                *own = (own.0 + number_at(row, 3), own.1 + number_at(row, 4));
            }
        }
        SeatUsage(groups)
    }

    /// Units a day and seat of a group; none where nobody in it used the product on the last day.
    pub fn measured(&self, group: &str) -> Option<f64> {
        self.0.get(group).filter(|(seats, _)| *seats > 0.0).map(|(seats, units)| units / seats)
    }
}
