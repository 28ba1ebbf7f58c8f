//! Queries of the screens. Each reading is a guarded query over the public tables, as a user could run it. The SQL is
//! in `assets/readings`, or in `assets/queries` if the query library has it too.

macro_rules! readings {
    ($($variant:ident $file:literal $doc:literal)*) => {
        /// A query of a screen.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Reading { $(#[doc = $doc] $variant,)* }

        impl Reading {
            /// All readings.
            pub const ALL: &'static [Reading] = &[$(Reading::$variant,)*];

            /// Returns the SQL statement.
            pub fn sql(self) -> &'static str {
                match self { $(Reading::$variant => include_str!(concat!("../../assets/", $file, ".sql")),)* }
            }
        }
    };
}

readings! {
    Subscribers "readings/subscribers" "Active subscriptions: group, plan, customers, seats, dollars per month, active for 30 days."
    Usage "readings/usage" "Usage of the last day: group, plan, users, seats, units."
    Arrivals "readings/arrivals" "Leads of the last weeks: week, group, source, leads, conversions."
    Departures "readings/departures" "Cancellations of the last weeks: week, group, cancelled, cancelled of those active 30 days ago."
    LeadsByChannel "readings/leads_by_channel" "Leads of the last four weeks: channel, group, leads, spend."
    Service "readings/service" "The service by day: day, usage, capacity, tier, latency, errors, minutes of outage."
    OpenIssues "readings/open_issues" "Open issues: group, and counts for four age ranges."
    EnterpriseTurns "readings/enterprise_turns" "Turns of negotiations, the newest first: thread, enterprise, kind, turn, sender, text, offer, day, seats, end."
    LastLetters "readings/last_letters" "The newest message of each enterprise that named a price or a plan in the last eight days: thread, text, and its current plan if it named no price."
    Companies "readings/companies" "The enterprises of these negotiations: profile and subscription."
    Research "readings/research" "R&D projects: id, tier, status, started, expected, boost; the newest first."
    OwnPosts "readings/own_posts" "Our posts, the newest first: number, day, text, post it replies to, views, numbers of comments."
    Knowledge "readings/knowledge" "Knowledge of all groups: group, study level, day discovered, day studied."
    Attempts "readings/attempts" "Market research attempts, the newest first: day, cost, success, group."
    WeekNotices "readings/week_notices" "Notices of the last week, the newest first: day, type, message."
    Cohorts "readings/cohorts" "Subscribers by group, signup week and cancellation week (0 if none): group, week, week, customers."
    Economy "readings/economy" "The published index: day measured, value, trend, change, phase, description."
    FirstOffers "queries/first-offers" "Outcome by first offer and week, also a query of the library: group, plan, price range, week, threads and their outcomes."
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::played_session;

    #[test]
    fn readings_run_before_and_after_the_first_week() {
        for weeks in [0, 2] {
            let mut session = played_session(weeks);
            for reading in Reading::ALL {
                let rows =
                    session.query(reading.sql()).unwrap_or_else(|problem| panic!("{reading:?}: {problem}"));
                assert!(!rows.truncated, "{reading:?}");
            }
        }
    }
}
