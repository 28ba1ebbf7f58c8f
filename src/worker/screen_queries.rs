//! SQL queries of the screens. Each query is guarded and reads only public tables, so the user could also run it. The
//! SQL is in `assets/readings`, or in `assets/queries` if the query library also contains the query.

macro_rules! readings {
    ($($variant:ident $file:literal $doc:literal)*) => {
        /// An SQL query that a screen runs to read its data.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Reading { $(#[doc = $doc] $variant,)* }

        impl Reading {
            /// All queries of the screens.
            pub const ALL: &'static [Reading] = &[$(Reading::$variant,)*];

            /// Returns the SQL statement of the query.
            pub fn sql(self) -> &'static str {
                match self { $(Reading::$variant => include_str!(concat!("../../assets/", $file, ".sql")),)* }
            }
        }
    };
}

readings! {
    Subscribers "readings/subscribers" "Active subscriptions: group, plan, customers, seats, dollars per month, \
         customers active for 30 days."
    Usage "readings/usage" "Usage of the last day: group, plan, users, seats, units, dollars per month, days since signing times \
         seats."
    Arrivals "readings/arrivals" "Leads in recent weeks: week, group, source, leads, conversions."
    Departures "readings/departures" "Cancellations in recent weeks: week, group, cancellations, cancellations of \
         customers active 30 days before."
    LeadsByChannel "readings/leads_by_channel" "Leads in the last four weeks: channel, group, leads, spending."
    Service "readings/service" "Service by day: day, usage, capacity, tier, latency, error rate, outage minutes."
    OpenIssues "readings/open_issues" "Open issues: group, and counts for four age ranges."
    EnterpriseTurns "readings/enterprise_turns" "Turns of negotiations, newest first: thread, enterprise, kind, turn, \
         sender, text, offer, day, seats, end."
    LastLetters "readings/last_letters" "Newest message of each enterprise that named a price or a plan in the last \
         eight days: thread, text, current plan if the message names no price."
    Companies "readings/companies" "Enterprises in negotiations: profile and subscription."
    Research "readings/research" "R&D projects, newest first: id, tier, status, start day, expected day, quality gain."
    OwnPosts "readings/own_posts" "The player's posts, newest first: number, day, text, replied-to post, views, \
         numbers of comments."
    Knowledge "readings/knowledge" "Study state of all groups: group, study level, day of discovery, day of the last study."
    Attempts "readings/attempts" "Market research attempts, newest first: day, cost, success, group."
    WeekNotices "readings/week_notices" "Notifications of the last week, newest first: day, type, message."
    Cohorts "readings/cohorts" "Subscribers by group, signup week and cancellation week: group, signup week, \
         cancellation week (0 if active), customers."
    Economy "readings/economy" "Published PMI: measurement day, value, trend, change, phase, description."
    FirstOffers "queries/first-offers" "Outcomes by first offer and week, also in the query library: group, plan, \
         price range, week, threads, outcomes of the threads."
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::played_session_of;

    #[test]
    fn readings_run_before_and_after_the_first_week() {
        for (scenario, weeks) in [("default", 0), ("default", 2), ("release-2", 0), ("release-2", 2)] {
            let mut session = played_session_of(scenario, weeks);
            for reading in Reading::ALL {
                let rows =
                    session.query(reading.sql()).unwrap_or_else(|problem| panic!("{reading:?}: {problem}"));
                assert!(!rows.truncated, "{reading:?}");
            }
        }
    }
}
