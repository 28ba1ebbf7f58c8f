//! What screens ask the database for. Every reading is one guarded query over the visible tables, the same a
//! person could ask; its words are in `assets/readings`.

use crate::session::Cell;

macro_rules! readings {
    ($($variant:ident $file:literal $doc:literal)*) => {
        /// A question of a screen.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Reading { $(#[doc = $doc] $variant,)* }

        impl Reading {
            /// All readings.
            pub const ALL: &'static [Reading] = &[$(Reading::$variant,)*];

            /// The statement.
            pub fn sql(self) -> &'static str {
                match self { $(Reading::$variant => include_str!(concat!("../../assets/readings/", $file, ".sql")),)* }
            }
        }
    };
}

readings! {
    LedgerByWeek "ledger_by_week" "Dollars by week and category, without payments and lead costs: week, category, amount."
    Subscribers "subscribers" "Who is there: group, plan, customers, seats, dollars a month, there for 30 days."
    Usage "usage" "Usage of the last day: group, plan, users, seats, units."
    Arrivals "arrivals" "Leads of the last weeks: week, group, source, leads, those who signed."
    Departures "departures" "Who left in the last weeks: week, group, cancelled, of those there 30 days ago."
    LeadsByChannel "leads_by_channel" "Leads of the last four weeks: channel, group, leads, spend."
    Service "service" "The service by day: day, usage, capacity, tier, latency, errors, minutes of outage."
    OpenIssues "open_issues" "Open issues: group, and a count for each of four ages."
    Research "research" "R&D projects: id, tier, status, started, expected, boost; the newest first."
}

/// A cell of a row as a number; 0 if it holds none.
pub fn number_at(row: &[Cell], at: usize) -> f64 {
    match row.get(at) {
        Some(Cell::Integer(number)) => *number as f64,
        Some(Cell::Real(number)) => *number,
        _ => 0.0,
    }
}

/// A cell of a row as text; empty if it holds none.
pub fn text_at(row: &[Cell], at: usize) -> &str {
    match row.get(at) {
        Some(Cell::Text(text)) => text,
        _ => "",
    }
}
