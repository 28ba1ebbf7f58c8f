//! Figures of the week: accessor, format, direction of improvement and source rows of each figure.

use crate::context::Figure;
use novamind_base::formatting::{dollars, grouped_number, percent};
use novamind_insight::WeekQuantity;
use novamind_record::figures::{WeekFigure, WeekFigures};
use novamind_report::{figure_label, figure_name};
use novamind_session::{LEDGER_WEEK_SQL, ledger_weeks_condition_sql};
use novamind_tui::text::format_change;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{TableCell, TableColumn, sparkline};
use novamind_worker::company::DisplayedCompany;

/// A figure of the week.
pub struct Metric {
    /// Name of the figure in the table.
    pub name: &'static str,
    /// Glossary term that explains the figure.
    pub term: &'static str,
    /// Returns the value of the figure in a week.
    pub read: fn(&WeekFigures) -> f64,
    /// Formats a value of the figure.
    pub write: fn(f64) -> String,
    /// Whether a higher value of the figure is better.
    pub more_is_better: bool,
    /// Source rows of the figure.
    rows_source: RowsSource,
}

impl Metric {
    /// Describes what the figure includes if its name does not say it.
    pub fn scope(&self) -> Option<&'static str> {
        match self.name {
            "running costs" => Some("no lead costs or purchases"),
            "enterprise leads" => Some("by ads and word of mouth"),
            _ => None,
        }
    }
}

/// Source rows of a figure.
enum RowsSource {
    /// All ledger entries up to the end of the week.
    Cash,
    /// Ledger entries that meet a condition.
    Ledger(&'static str),
    /// Currently active subscriptions that meet a condition. These rows are available only for the last week.
    ActiveSubscriptions(&'static str),
    /// Customers with their subscriptions. The strings are the column that contains the day and a condition.
    Customers(&'static str, &'static str),
    /// A column of the daily service data.
    Service(&'static str),
    /// Threads that enterprises started.
    Leads,
    /// No source rows: no table contains the figure.
    None,
}

const fn new_metric(
    name: &'static str,
    term: &'static str,
    read: fn(&WeekFigures) -> f64,
    write: fn(f64) -> String,
    more_is_better: bool,
    source: RowsSource,
) -> Metric {
    Metric { name, term, read, write, more_is_better, rows_source: source }
}

fn format_whole(value: f64) -> String {
    grouped_number(value, 0)
}

fn format_share(value: f64) -> String {
    if value.is_nan() { "–".to_owned() } else { percent(value, 1) }
}

fn format_percent(value: f64) -> String {
    if value > 0.0 { percent(value, 1) } else { "none".to_owned() }
}

const INDIVIDUALS_SQL: &str = "c.customer_type = 'small'";
const SIGNUPS_SQL: &str = "c.customer_type = 'small' AND s.status IN ('subscribed', 'cancelled')";
const CANCELLATIONS_SQL: &str = "c.customer_type = 'small' AND s.status = 'cancelled'";
const DEALS_SQL: &str = "c.customer_type = 'large' AND s.status IN ('subscribed', 'cancelled')";

/// All figures of the week in display order.
pub static METRICS: [Metric; 22] = [
    new_metric("cash at week's end", "cash", |week| week.cash, dollars, true, RowsSource::Cash),
    new_metric(
        "recurring revenue",
        "mrr",
        |week| week.recurring_revenue,
        dollars,
        true,
        RowsSource::ActiveSubscriptions("TRUE"),
    ),
    new_metric(
        "payments",
        "payments",
        |week| week.payments,
        dollars,
        true,
        RowsSource::Ledger("category = 'subscription_payment'"),
    ),
    new_metric(
        "running costs",
        "running-costs",
        |week| week.costs,
        dollars,
        false,
        RowsSource::Ledger("category IN ('compute', 'capacity', 'operations', 'development', 'advertising')"),
    ),
    new_metric(
        "subscribers",
        "subscriber",
        |week| f64::from(week.individual_subscribers),
        format_whole,
        true,
        RowsSource::ActiveSubscriptions(INDIVIDUALS_SQL),
    ),
    new_metric(
        "individual leads",
        "lead",
        |week| f64::from(week.new_individual_leads),
        format_whole,
        true,
        RowsSource::Customers("c.created_day", INDIVIDUALS_SQL),
    ),
    new_metric(
        "new subscribers",
        "new-customer",
        |week| f64::from(week.new_individual_subscribers),
        format_whole,
        true,
        RowsSource::Customers("c.created_day", SIGNUPS_SQL),
    ),
    new_metric(
        "conversion",
        "conversion",
        WeekFigures::conversion,
        format_share,
        true,
        RowsSource::Customers("c.created_day", INDIVIDUALS_SQL),
    ),
    new_metric(
        "cancellations",
        "churn",
        |week| f64::from(week.cancellations),
        format_whole,
        false,
        RowsSource::Customers("s.end_day", CANCELLATIONS_SQL),
    ),
    new_metric("upgrades", "upgrade", |week| f64::from(week.upgrades), format_whole, true, RowsSource::None),
    new_metric("downgrades", "upgrade", |week| f64::from(week.downgrades), format_whole, false, RowsSource::None),
    new_metric(
        "seats",
        "seats",
        |week| f64::from(week.enterprise_seats),
        format_whole,
        true,
        RowsSource::ActiveSubscriptions("c.customer_type = 'large'"),
    ),
    new_metric(
        "enterprise leads",
        "enterprise-lead",
        |week| f64::from(week.new_enterprise_leads),
        format_whole,
        true,
        RowsSource::Leads,
    ),
    new_metric(
        "new seats",
        "seats",
        |week| f64::from(week.new_enterprise_seats),
        format_whole,
        true,
        RowsSource::Customers("s.start_day", DEALS_SQL),
    ),
    new_metric("seats lost", "churn", |week| f64::from(week.seats_lost), format_whole, false, RowsSource::None),
    new_metric(
        "usage, units",
        "usage",
        |week| week.usage as f64,
        format_whole,
        true,
        RowsSource::Service("total_usage_units"),
    ),
    new_metric(
        "overload, peak",
        "overload",
        |week| week.overload_peak,
        format_percent,
        false,
        RowsSource::Service("max(0.0, 1.0 * total_usage_units / capacity_units - 1) AS overload"),
    ),
    new_metric(
        "outage, minutes",
        "outage",
        |week| f64::from(week.downtime_minutes),
        format_whole,
        false,
        RowsSource::Service("downtime_minutes"),
    ),
    new_metric(
        "latency, peak ms",
        "latency",
        |week| week.p95_ms_peak,
        format_whole,
        false,
        RowsSource::Service("p95_ms"),
    ),
    new_metric(
        "error rate, peak",
        "error-rate",
        |week| week.error_rate_peak,
        |value| percent(value, 2),
        false,
        RowsSource::Service("error_rate"),
    ),
    new_metric("open issues", "issue", |week| f64::from(week.open_issues), format_whole, false, RowsSource::None),
    new_metric(
        "enterprises lost",
        "churn",
        |week| f64::from(week.companies_lost),
        format_whole,
        false,
        RowsSource::None,
    ),
];

/// Number of weeks in a sparkline.
const TREND_WEEKS: usize = 10;

/// Returns the columns of the table. In narrow windows, the last columns are omitted first.
pub fn columns() -> Vec<TableColumn> {
    let numbers = ["this week", "change"].map(TableColumn::numeric);
    let last = ["last week", "4-wk mean"].map(TableColumn::numeric);
    let name = [TableColumn::text("figure")];
    name.into_iter().chain(numbers).chain([TableColumn::text("trend").indivisible()]).chain(last).collect()
}

/// Returns the first and the last week that a column covers, as numbers of weeks before the last week.
fn column_weeks(column: usize) -> (u32, u32) {
    match column {
        2 => (1, 0),
        3 => (11, 0),
        4 => (1, 1),
        5 => (3, 0),
        _ => (0, 0),
    }
}

/// Returns the table row of a figure.
pub fn metric_row(metric: &Metric, company: &DisplayedCompany) -> Vec<TableCell> {
    let trend = company.recent_values(12, metric.read);
    let now = trend.last().copied();
    // Only cash has a value before the first week.
    let opening = matches!(metric.rows_source, RowsSource::Cash).then_some(company.observation.starting_cash);
    let before = trend.len().checked_sub(2).map(|at| trend[at]).or(opening.filter(|_| now.is_some()));
    let cell = |value: Option<f64>| match value {
        Some(value) => TableCell::from_number(value, (metric.write)(value)),
        None => TableCell::from_text("–"),
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
            TableCell::from_number(change, format_change(change, &size)).with_role(tone)
        }
        None => TableCell::from_text("–").with_role(Role::Dim),
    };
    vec![
        TableCell::from_text(figure_label(metric.name)),
        cell(now).with_role(Role::Strong),
        moved,
        TableCell::from_text(sparkline(&trend, TREND_WEEKS)).with_role(Role::Series(0)),
        cell(before).with_role(Role::Dim),
        cell(company.four_week_mean(metric.read)).with_role(Role::Dim),
    ]
}

/// Returns the figure that a column shows, with a query for its source rows.
pub fn figure(metric: &Metric, column: usize, company: &DisplayedCompany) -> Figure {
    let week = company.observation.week;
    let (from, to) = column_weeks(column);
    let (from, to) = (week.saturating_sub(from).max(1.min(week)), week.saturating_sub(to));
    let weeks = if from == to { format!("week {to}") } else { format!("weeks {from} to {to}") };
    let now = to == week;
    let quantity = WeekFigure::parse_label(metric.name).and_then(WeekQuantity::for_company);
    Figure {
        title: match metric.scope() {
            Some(scope) => format!("{} ({scope}), {weeks}", figure_name(metric.name)),
            None => format!("{}, {weeks}", figure_name(metric.name)),
        },
        term: metric.term,
        sql: source_rows_query(&metric.rows_source, (from, to), now),
        week_quantity: None,
    }
    .with_week_quantity(quantity, to)
}

/// Returns the query for the source rows of a range of weeks. Returns `None` if no rows exist for these weeks.
fn source_rows_query(source: &RowsSource, weeks: (u32, u32), now: bool) -> Option<String> {
    let (from, to) = ((7 * weeks.0).saturating_sub(6), 7 * weeks.1);
    let between = |day: &str| format!("{day} BETWEEN {from} AND {to}");
    Some(match source {
        RowsSource::Cash => format!(
            "SELECT {LEDGER_WEEK_SQL} AS week, category, sum(amount) AS amount\nFROM ledger\nWHERE {}\nGROUP BY 1, 2\n\
             ORDER BY 1 DESC, 3 DESC",
            ledger_weeks_condition_sql(0, weeks.1)
        ),
        RowsSource::Ledger(condition) => format!(
            "SELECT day, category, amount, note\nFROM ledger\nWHERE {} AND {condition}\nORDER BY id",
            ledger_weeks_condition_sql(weeks.0, weeks.1)
        ),
        RowsSource::ActiveSubscriptions(condition) if now => format!(
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
        RowsSource::ActiveSubscriptions(_) | RowsSource::None => return None,
    })
}
