//! Figures of the week: how each is read, formatted and judged, and the query for its rows.

use crate::context::Figure;
use novamind_base::notation::{dollars, grouped, percent};
use novamind_insight::WeekQuantity;
use novamind_record::figures::{WeekFigure, WeekFigures};
use novamind_session::{WEEK_OF_ENTRY, entries_of_weeks};
use novamind_tui::text::arrow;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{Cell, Column, spark};
use novamind_worker::company::Company;

/// A figure of the week.
pub struct Metric {
    /// Name on the screen.
    pub name: &'static str,
    /// Glossary term.
    pub term: &'static str,
    /// Reads the value.
    pub read: fn(&WeekFigures) -> f64,
    /// Formats the value.
    pub write: fn(f64) -> String,
    /// Whether a higher value is better.
    pub more_is_better: bool,
    /// Source of its rows.
    source: RowsSource,
}

/// Source of the rows behind a figure.
enum RowsSource {
    /// All ledger entries up to the end of the week.
    Cash,
    /// Ledger entries that meet a condition.
    Ledger(&'static str),
    /// Currently active subscriptions that meet a condition; available for the last week only.
    Active(&'static str),
    /// Customers and subscriptions, by a column with a day and a condition.
    Customers(&'static str, &'static str),
    /// A column of the daily service.
    Service(&'static str),
    /// Threads that enterprises started.
    Leads,
    /// No table contains them.
    None,
}

const fn metric(
    name: &'static str,
    term: &'static str,
    read: fn(&WeekFigures) -> f64,
    write: fn(f64) -> String,
    more_is_better: bool,
    source: RowsSource,
) -> Metric {
    Metric { name, term, read, write, more_is_better, source }
}

fn whole(value: f64) -> String {
    grouped(value, 0)
}

fn share_or_none(value: f64) -> String {
    if value.is_nan() { "–".to_owned() } else { percent(value, 1) }
}

fn none_or_percent(value: f64) -> String {
    if value > 0.0 { percent(value, 1) } else { "none".to_owned() }
}

const SMALL: &str = "c.customer_type = 'small'";
const SIGNED: &str = "c.customer_type = 'small' AND s.status IN ('subscribed', 'cancelled')";
const LEFT: &str = "c.customer_type = 'small' AND s.status = 'cancelled'";
const DEALS: &str = "c.customer_type = 'large' AND s.status IN ('subscribed', 'cancelled')";

/// All figures in display order.
pub static METRICS: [Metric; 22] = [
    metric("cash at week's end", "cash", |week| week.cash, dollars, true, RowsSource::Cash),
    metric(
        "recurring revenue",
        "mrr",
        |week| week.recurring_revenue,
        dollars,
        true,
        RowsSource::Active("TRUE"),
    ),
    metric(
        "payments",
        "payments",
        |week| week.payments,
        dollars,
        true,
        RowsSource::Ledger("category = 'subscription_payment'"),
    ),
    metric(
        "running costs",
        "running-costs",
        |week| week.costs,
        dollars,
        false,
        RowsSource::Ledger("category IN ('compute', 'capacity', 'operations', 'development', 'advertising')"),
    ),
    metric(
        "subscribers",
        "subscriber",
        |week| f64::from(week.individual_subscribers),
        whole,
        true,
        RowsSource::Active(SMALL),
    ),
    metric(
        "individual leads",
        "lead",
        |week| f64::from(week.new_individual_leads),
        whole,
        true,
        RowsSource::Customers("c.created_day", SMALL),
    ),
    metric(
        "new subscribers",
        "conversion",
        |week| f64::from(week.new_individual_subscribers),
        whole,
        true,
        RowsSource::Customers("c.created_day", SIGNED),
    ),
    metric(
        "conversion",
        "conversion",
        WeekFigures::conversion,
        share_or_none,
        true,
        RowsSource::Customers("c.created_day", SMALL),
    ),
    metric(
        "cancellations",
        "churn",
        |week| f64::from(week.cancellations),
        whole,
        false,
        RowsSource::Customers("s.end_day", LEFT),
    ),
    metric("upgrades", "upgrade", |week| f64::from(week.upgrades), whole, true, RowsSource::None),
    metric("downgrades", "upgrade", |week| f64::from(week.downgrades), whole, false, RowsSource::None),
    metric(
        "seats",
        "seats",
        |week| f64::from(week.enterprise_seats),
        whole,
        true,
        RowsSource::Active("c.customer_type = 'large'"),
    ),
    metric(
        "enterprise leads",
        "thread",
        |week| f64::from(week.new_enterprise_leads),
        whole,
        true,
        RowsSource::Leads,
    ),
    metric(
        "new seats",
        "seats",
        |week| f64::from(week.new_enterprise_seats),
        whole,
        true,
        RowsSource::Customers("s.start_day", DEALS),
    ),
    metric("seats lost", "churn", |week| f64::from(week.seats_lost), whole, false, RowsSource::None),
    metric(
        "usage, units",
        "usage",
        |week| week.usage as f64,
        whole,
        true,
        RowsSource::Service("total_usage_units"),
    ),
    metric(
        "overload, peak",
        "overload",
        |week| week.overload_peak,
        none_or_percent,
        false,
        RowsSource::Service("max(0.0, 1.0 * total_usage_units / capacity_units - 1) AS overload"),
    ),
    metric(
        "outage, minutes",
        "outage",
        |week| f64::from(week.downtime_minutes),
        whole,
        false,
        RowsSource::Service("downtime_minutes"),
    ),
    metric(
        "latency, peak ms",
        "latency",
        |week| week.p95_ms_peak,
        whole,
        false,
        RowsSource::Service("p95_ms"),
    ),
    metric(
        "error rate, peak",
        "error-rate",
        |week| week.error_rate_peak,
        |value| percent(value, 2),
        false,
        RowsSource::Service("error_rate"),
    ),
    metric("open issues", "issue", |week| f64::from(week.open_issues), whole, false, RowsSource::None),
    metric(
        "enterprises lost",
        "churn",
        |week| f64::from(week.companies_lost),
        whole,
        false,
        RowsSource::None,
    ),
];

/// Returns the columns of the table; narrow windows drop the last ones first.
pub fn columns() -> Vec<Column> {
    let numbers = ["this week", "change"].map(Column::numbers);
    let last = ["last week", "4-wk mean"].map(Column::numbers);
    let name = [Column::words("figure")];
    name.into_iter().chain(numbers).chain([Column::words("trend")]).chain(last).collect()
}

/// Returns the weeks that a column covers, as distances from the last week, farthest first.
fn weeks_of(column: usize) -> (u32, u32) {
    match column {
        2 => (1, 0),
        3 => (11, 0),
        4 => (1, 1),
        5 => (3, 0),
        _ => (0, 0),
    }
}

/// Returns the row of a figure.
pub fn row_of(metric: &Metric, company: &Company) -> Vec<Cell> {
    let trend = company.trend(12, metric.read);
    let now = trend.last().copied();
    // Only cash has a value before the first week.
    let opening = matches!(metric.source, RowsSource::Cash).then_some(company.seen.starting_cash);
    let before = trend.len().checked_sub(2).map(|at| trend[at]).or(opening.filter(|_| now.is_some()));
    let cell = |value: Option<f64>| match value {
        Some(value) => Cell::number(value, (metric.write)(value)),
        None => Cell::words("–"),
    };
    let change = now.zip(before).map(|(now, before)| now - before).filter(|change| !change.is_nan());
    let moved = match change {
        Some(change) => {
            let tone = match change {
                0.0 => Role::Dim,
                change if (change > 0.0) == metric.more_is_better => Role::Good,
                _ => Role::Bad,
            };
            let size = change.abs();
            let size = if size == 0.0 { String::new() } else { (metric.write)(size) };
            // Changes of shares are in percentage points.
            let size = size.strip_suffix('%').map_or(size.clone(), |points| format!("{points} pt"));
            Cell::number(change, arrow(change, &size)).role(tone)
        }
        None => Cell::words("–").role(Role::Dim),
    };
    vec![
        Cell::words(metric.name),
        cell(now).role(Role::Strong),
        moved,
        Cell::words(spark(&trend, 12)).role(Role::Series(0)),
        cell(before).role(Role::Dim),
        cell(company.mean_of_four(metric.read)).role(Role::Dim),
    ]
}

/// Returns the figure in a column, with a query for its rows.
pub fn figure(metric: &Metric, column: usize, company: &Company) -> Figure {
    let week = company.seen.week;
    let (from, to) = weeks_of(column);
    let (from, to) = (week.saturating_sub(from).max(1.min(week)), week.saturating_sub(to));
    let weeks = if from == to { format!("week {to}") } else { format!("weeks {from} to {to}") };
    let now = to == week;
    let quantity = WeekFigure::named(metric.name).and_then(WeekQuantity::of_company);
    Figure {
        title: format!("{}, {weeks}", metric.name),
        term: metric.term,
        sql: statement(&metric.source, (from, to), now),
        why: None,
    }
    .of_week(quantity, to)
}

/// Returns the query for the rows of some weeks; `None` if only current rows exist and the weeks are past.
fn statement(source: &RowsSource, weeks: (u32, u32), now: bool) -> Option<String> {
    let (from, to) = ((7 * weeks.0).saturating_sub(6), 7 * weeks.1);
    let between = |day: &str| format!("{day} BETWEEN {from} AND {to}");
    Some(match source {
        RowsSource::Cash => format!(
            "SELECT {WEEK_OF_ENTRY} AS week, category, sum(amount) AS amount\nFROM ledger\nWHERE {}\nGROUP BY 1, 2\n\
             ORDER BY 1 DESC, 3 DESC",
            entries_of_weeks(0, weeks.1)
        ),
        RowsSource::Ledger(condition) => format!(
            "SELECT day, category, amount, note\nFROM ledger\nWHERE {} AND {condition}\nORDER BY id",
            entries_of_weeks(weeks.0, weeks.1)
        ),
        RowsSource::Active(condition) if now => format!(
            "SELECT s.customer_id, c.group_id, s.plan, s.seat_count, s.effective_price,\n    \
             s.effective_price * s.seat_count AS amount, s.start_day\nFROM subscriptions s\n\
             CROSS JOIN customers c\nWHERE s.status = 'subscribed' AND c.customer_id = s.customer_id AND {condition}"
        ),
        RowsSource::Customers(day, condition) => format!(
            "SELECT c.customer_id, c.group_id, c.acquisition_source, c.created_day, s.plan, s.status, s.seat_count,\n    \
             s.effective_price, s.start_day, s.end_day\nFROM customers c\n\
             JOIN subscriptions s ON s.customer_id = c.customer_id\nWHERE {} AND {condition}",
            between(day)
        ),
        RowsSource::Service(column) => {
            format!("SELECT day, {column}\nFROM service_day\nWHERE {}\nORDER BY day", between("day"))
        }
        RowsSource::Leads => format!(
            "SELECT customer_id, day, seat_count\nFROM enterprise_turns\n\
             WHERE thread_type = 'new_lead' AND turn_number = 0 AND {}",
            between("day")
        ),
        RowsSource::Active(_) | RowsSource::None => return None,
    })
}
