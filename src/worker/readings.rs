//! What screens ask the database for. Every reading is one guarded query over the visible tables, the same a
//! person could ask; its words are in `assets/readings`, or in `assets/queries` where the library asks the same.

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
                match self { $(Reading::$variant => include_str!(concat!("../../assets/", $file, ".sql")),)* }
            }
        }
    };
}

readings! {
    Subscribers "readings/subscribers" "Who is there: group, plan, customers, seats, dollars a month, there for 30 days."
    Usage "readings/usage" "Usage of the last day: group, plan, users, seats, units."
    Arrivals "readings/arrivals" "Leads of the last weeks: week, group, source, leads, those who signed."
    Departures "readings/departures" "Who left in the last weeks: week, group, cancelled, of those there 30 days ago."
    LeadsByChannel "readings/leads_by_channel" "Leads of the last four weeks: channel, group, leads, spend."
    Service "readings/service" "The service by day: day, usage, capacity, tier, latency, errors, minutes of outage."
    OpenIssues "readings/open_issues" "Open issues: group, and a count for each of four ages."
    EnterpriseTurns "readings/enterprise_turns" "Turns of negotiations, the newest first: thread, company, kind, turn, sender, words, offer, day, seats, end."
    LastLetters "readings/last_letters" "The newest letter of each company that named a price or a plan in the last eight days: thread, words, and the plan it has where it named no price."
    Companies "readings/companies" "The companies of these negotiations: profile and subscription."
    Research "readings/research" "R&D projects: id, tier, status, started, expected, boost; the newest first."
    OwnPosts "readings/own_posts" "Our posts, the newest first: number, day, text, post it answers, views, numbers of comments."
    Knowledge "readings/knowledge" "What is known of all groups: group, level, found on, studied on."
    Attempts "readings/attempts" "Attempts at market research, the newest first: day, cost, found, group."
    WeekNotices "readings/week_notices" "Notices of the last week, the newest first: day, type, message."
    Cohorts "readings/cohorts" "Subscribers by group, week of signing and week of leaving (0 if none): group, week, week, customers."
    Economy "readings/economy" "The published index: day measured, value, trend, change, phase, description."
    FirstOffers "queries/first-offers" "Outcome by first offer and week, as the library asks it: group, plan, price band, week, threads and what became of them."
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::played;

    #[test]
    fn every_statement_is_answered_before_the_first_week_and_after_the_second() {
        for weeks in [0, 2] {
            let mut session = played(weeks);
            for reading in Reading::ALL {
                let rows =
                    session.query(reading.sql()).unwrap_or_else(|problem| panic!("{reading:?}: {problem}"));
                assert!(!rows.truncated, "{reading:?}");
            }
        }
    }
}
