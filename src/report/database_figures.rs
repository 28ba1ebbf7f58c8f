//! Data for reports. Amounts by category and week come from the ledger. Groups by week and leads by channel come from
//! guarded queries of the visible tables. If a query fails, its data is omitted and the query is listed in `missing`.

use std::collections::BTreeMap;

use serde::Serialize;

use novamind_database::{Cell, QueryResult, number_at, text_at};
use novamind_record::figures::CategoryTotals;
use novamind_session::Session;
use novamind_session::identifiers::Group;

// A deal that was cancelled early can end after the last day in the table. Its cancellation is counted on the last day.
const GROUP_FLOW_SQL: &str = "SELECT (s.start_day + 6) / 7 AS week, c.group_id, count(*), sum(s.seat_count)
FROM subscriptions s CROSS JOIN customers c
WHERE c.customer_id = s.customer_id AND s.status IN ('subscribed', 'cancelled') GROUP BY 1, 2
UNION ALL
SELECT (min(s.end_day, (SELECT max(day) FROM service_day)) + 6) / 7, c.group_id, -count(*), -sum(s.seat_count)
FROM subscriptions s CROSS JOIN customers c
WHERE c.customer_id = s.customer_id AND s.status = 'cancelled' GROUP BY 1, 2";

// Customer 1 is excluded: it is the market observer, the author of news.
const GROUP_LEADS_SQL: &str = "SELECT group_id, count(*) FROM customers WHERE customer_id > 1 GROUP BY 1";

const GROUP_REVENUE_SQL: &str = "SELECT c.group_id, sum(s.effective_price * s.seat_count)
FROM subscriptions s CROSS JOIN customers c
WHERE c.customer_id = s.customer_id AND s.status = 'subscribed' GROUP BY 1";

const CHANNEL_SQL: &str =
    "SELECT group_id, channel_id, sum(leads_generated), sum(spend) FROM ad_channel_leads GROUP BY 1, 2";

const OUTAGE_SQL: &str =
    "SELECT day, downtime_minutes FROM service_day WHERE downtime_minutes > 0 ORDER BY day";

/// Advertising results of one channel for one group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelRow {
    /// ID of the advertised group.
    pub group: String,
    /// Name of the channel.
    pub channel: String,
    /// Number of the group's leads that arrived through this channel.
    pub leads: f64,
    /// Advertising spending for the group in this channel, dollars.
    pub spend: f64,
}

/// Leads, subscriptions and revenue of a group over the run.
#[derive(Debug, Clone, PartialEq)]
pub struct GroupHistory {
    /// Group that the other fields describe.
    pub group: Group,
    /// Number of leads over the whole run.
    pub leads: f64,
    /// Number of active subscriptions at the end of each week, week 0 first.
    pub active: Vec<f64>,
    /// Number of seats at the end of each week, week 0 first.
    pub seats: Vec<f64>,
    /// Monthly revenue from the group at the end of the run, dollars.
    pub revenue: f64,
}

/// Data that is read from the tables and the ledger of a run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DatabaseFigures {
    /// Groups with at least one lead, in the fixed order of groups.
    pub groups: Vec<GroupHistory>,
    /// Advertising results by group and channel.
    pub channels: Vec<ChannelRow>,
    /// Amounts in dollars by week and ledger category. Costs are negative. Excludes the starting cash.
    pub ledger: BTreeMap<u32, BTreeMap<&'static str, f64>>,
    /// Day and duration in minutes of each outage.
    pub outages: Vec<(u32, u32)>,
    /// Queries that failed, and their errors.
    pub missing: Vec<String>,
}

impl DatabaseFigures {
    /// Reads the database of a run. The queries are not recorded.
    pub fn load(session: &Session) -> DatabaseFigures {
        let connection = session.wait_for_database().and_then(|()| session.database().open_connection());
        let connection = match connection {
            Ok(connection) => connection,
            Err(rejection) => {
                let missing = vec![format!("groups and channels: {rejection}")];
                return DatabaseFigures {
                    ledger: ledger_by_week(session),
                    missing,
                    ..DatabaseFigures::default()
                };
            }
        };
        let mut missing = Vec::new();
        let mut ask = |what: &str, sql: &str| match connection.query(sql, session.company().query_limits()) {
            Ok(rows) => rows,
            Err(error) => {
                missing.push(format!("{what}: {}", error.message));
                QueryResult::default()
            }
        };
        let weeks = session.company().observe().week;
        let flows = ask("groups", GROUP_FLOW_SQL);
        let (leads, revenue) = (ask("leads", GROUP_LEADS_SQL), ask("revenue", GROUP_REVENUE_SQL));
        let groups = group_histories(&flows, &number_by_group(&leads), &number_by_group(&revenue), weeks);
        let channels = ask("channels", CHANNEL_SQL).rows.iter().map(|row| channel_row(row)).collect();
        let outage = |row: &Vec<Cell>| (number_at(row, 0) as u32, number_at(row, 1) as u32);
        let outages = ask("outages", OUTAGE_SQL).rows.iter().map(outage).collect();
        DatabaseFigures { groups, channels, ledger: ledger_by_week(session), outages, missing }
    }

    /// Reads only the advertising results, and returns an empty list if the query fails.
    pub fn load_channels(session: &Session) -> Vec<ChannelRow> {
        let connection = session.wait_for_database().and_then(|()| session.database().open_connection()).ok();
        let rows = connection
            .and_then(|connection| connection.query(CHANNEL_SQL, session.company().query_limits()).ok());
        rows.map(|rows| rows.rows.iter().map(|row| channel_row(row)).collect()).unwrap_or_default()
    }

    /// Returns the total amount of each ledger category over the whole run, dollars.
    pub fn totals_by_category(&self) -> BTreeMap<&str, f64> {
        let mut totals = BTreeMap::new();
        for (category, amount) in self.ledger.values().flatten() {
            *totals.entry(*category).or_default() += amount;
        }
        totals
    }
}

fn group_histories(
    flows: &QueryResult,
    leads: &BTreeMap<String, f64>,
    revenue: &BTreeMap<String, f64>,
    weeks: u32,
) -> Vec<GroupHistory> {
    let known = Group::all().filter(|group| leads.contains_key(group.id()));
    let book = |group: Group| {
        let (mut active, mut seats) = (vec![0.0; weeks as usize + 1], vec![0.0; weeks as usize + 1]);
        for row in flows.rows.iter().filter(|row| text_at(row, 1) == group.id()) {
            let week = (number_at(row, 0) as usize).min(weeks as usize);
            active[week] += number_at(row, 2);
            seats[week] += number_at(row, 3);
        }
        for week in 1..=weeks as usize {
            active[week] += active[week - 1];
            seats[week] += seats[week - 1];
        }
        let of = |map: &BTreeMap<String, f64>| map.get(group.id()).copied().unwrap_or(0.0);
        GroupHistory { group, leads: of(leads), active, seats, revenue: of(revenue) }
    };
    known.map(book).collect()
}

fn number_by_group(rows: &QueryResult) -> BTreeMap<String, f64> {
    rows.rows.iter().map(|row| (text_at(row, 0).to_owned(), number_at(row, 1))).collect()
}

fn channel_row(row: &[Cell]) -> ChannelRow {
    ChannelRow {
        group: text_at(row, 0).to_owned(),
        channel: text_at(row, 1).to_owned(),
        leads: number_at(row, 2),
        spend: number_at(row, 3),
    }
}

/// Returns the ledger amounts by week. The days after the last complete week form another week.
fn ledger_by_week(session: &Session) -> BTreeMap<u32, BTreeMap<&'static str, f64>> {
    let since = session.company().observe().booked_since;
    let weeks = session.weeks().iter().map(|week| week.booked).chain([since]);
    let entries = |booked: CategoryTotals| {
        booked.nonzero_totals().map(|(category, dollars)| (category.id(), dollars)).collect()
    };
    (1..).zip(weeks.map(entries)).filter(|(_, entries): &(u32, BTreeMap<_, _>)| !entries.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit;
    use novamind_session::LEDGER_WEEK_SQL;

    #[test]
    fn database_figures_match_week_figures() {
        let session = test_kit::play_weeks(5);
        let figures = DatabaseFigures::load(&session);
        assert_eq!(figures.missing, Vec::<String>::new());
        let seen = session.company().observe();
        let people = figures.groups.iter().filter(|book| !book.group.is_enterprise());
        let last: f64 = people.filter_map(|book| book.active.last()).sum();
        assert!(last > 0.0);
        assert_eq!(last, f64::from(seen.subscribers));
        for (at, week) in session.weeks().iter().enumerate() {
            let people = figures.groups.iter().filter(|book| !book.group.is_enterprise());
            let then: f64 = people.map(|book| book.active[at + 1]).sum();
            assert_eq!(then, f64::from(week.individual_subscribers), "week {}", at + 1);
        }
        let total: f64 = figures.totals_by_category().values().sum::<f64>() + session.cash_by_day()[0];
        assert!((total - seen.cash).abs() < 0.01, "{total} is not {}", seen.cash);
        let connection = session.database().open_connection().expect("a connection");
        let sql = format!(
            "SELECT {LEDGER_WEEK_SQL}, category, sum(amount) FROM ledger WHERE day > 0 GROUP BY 1, 2"
        );
        for row in connection.query(&sql, session.company().query_limits()).expect("the ledger").rows {
            let (week, category) = (number_at(&row, 0) as u32, text_at(&row, 1));
            let booked =
                figures.ledger.get(&week).and_then(|week| week.get(category)).copied().unwrap_or(0.0);
            assert!((booked - number_at(&row, 2)).abs() < 0.01, "week {week}: {category} {booked}");
        }
        assert!(
            figures
                .channels
                .iter()
                .any(|row| row.channel == "content_marketing" && row.spend == 5.0 * 5250.0)
        );
        assert!(session.company().query_history().is_empty(), "reports record no queries");
    }

    #[test]
    fn cancellations_count_in_the_week_of_the_last_day() {
        let session = test_kit::play_weeks(9);
        let figures = DatabaseFigures::load(&session);
        let mut left_before_the_end = 0;
        for book in figures.groups.iter().filter(|book| !book.group.is_enterprise()) {
            let mut active = 0.0;
            for (at, week) in session.company().group_weeks().iter().enumerate() {
                let group_week = &week[book.group];
                active += f64::from(group_week.signed) - f64::from(group_week.left);
                assert_eq!(book.active[at + 1], active, "{} in week {}", book.group, at + 1);
                assert_eq!(book.seats[at + 1], active, "an individual has one seat");
                left_before_the_end += if at < 8 { group_week.left } else { 0 };
            }
            let leads: u32 = session.company().group_weeks().iter().map(|week| week[book.group].leads).sum();
            assert_eq!(book.leads, f64::from(leads), "{}", book.group);
        }
        assert!(left_before_the_end > 0, "no one cancelled, so the test checked nothing");
    }
}
