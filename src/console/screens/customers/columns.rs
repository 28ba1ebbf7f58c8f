//! Columns of the table of groups, and the queries for the source rows of each figure.

use super::true_values::TrueValue;
use super::model::{GroupFacts, CustomerData, total_ad_budget, development_budget};
use crate::context::Figure;
use crate::screens::market::model::{study_level, group_name};
use novamind_base::formatting::{dollars_and_cents, compact_number, dollars, grouped_number, percent};
use novamind_insight::WeekQuantity;
use novamind_record::figures::WeekFigure;
use novamind_session::identifiers::Group;
use novamind_session::true_value_range;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{TableCell, TableColumn, sparkline};
use novamind_worker::company::DisplayedCompany;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum GroupColumn {
    Group,
    GroupKind,
    TrueValue(TrueValue),
    StudyLevel,
    Customers,
    Seats,
    MarketShare,
    Leads,
    NewCustomers,
    Conversion,
    Cancellations,
    Churn,
    MonthlyRevenue,
    RevenuePerSeat,
    Usage,
    AdBudget,
    AcquisitionCost,
    DevelopmentBudget,
    Trend,
    Name,
}

/// Columns with headings and glossary terms, in display order.
static COLUMNS: [(GroupColumn, &str, &str); 23] = [
    (GroupColumn::Group, "group", "customer-group"),
    (GroupColumn::Name, "name", "customer-group"),
    (GroupColumn::GroupKind, "kind", "customer-group"),
    (GroupColumn::TrueValue(TrueValue::Satisfaction), "true sat.", "satisfaction"),
    (GroupColumn::TrueValue(TrueValue::Reputation), "true rep.", "reputation"),
    (GroupColumn::TrueValue(TrueValue::Leads), "true λ/day", "lead"),
    (GroupColumn::TrueValue(TrueValue::Market), "true market", "market-cap"),
    (GroupColumn::Customers, "subs", "subscriber"),
    (GroupColumn::Seats, "billed seats", "billed-seats"),
    (GroupColumn::Leads, "leads", "lead"),
    (GroupColumn::NewCustomers, "new", "new-customer"),
    (GroupColumn::Conversion, "conv.", "conversion"),
    (GroupColumn::Cancellations, "cancelled", "churn"),
    (GroupColumn::Churn, "churn 30d", "churn"),
    (GroupColumn::MonthlyRevenue, "billed/mo", "billed-seats"),
    (GroupColumn::RevenuePerSeat, "per seat", "arpu"),
    (GroupColumn::Usage, "use/day", "usage"),
    (GroupColumn::AdBudget, "ads/day", "set_targeted_ad_spend"),
    (GroupColumn::AcquisitionCost, "ad $/new", "cost-per-new-customer"),
    (GroupColumn::DevelopmentBudget, "dev/day", "set_targeted_dev_spend"),
    (GroupColumn::StudyLevel, "level", "info-level"),
    (GroupColumn::MarketShare, "mkt share", "market-cap"),
    (GroupColumn::Trend, "new by week", "new-customer"),
];

/// Returns the visible columns. Columns with true values are visible only while true values are shown.
fn visible_columns(company: &DisplayedCompany) -> impl Iterator<Item = &'static (GroupColumn, &'static str, &'static str)> {
    let has_hidden = company.hidden_values.is_some();
    COLUMNS.iter().filter(move |(what, ..)| has_hidden || !matches!(what, GroupColumn::TrueValue(_)))
}

/// Returns the index and the heading of the column with cancellations.
pub fn cancellations_column(company: &DisplayedCompany) -> (usize, &'static str) {
    let is_wanted = |(_, (what, ..)): &(usize, &(GroupColumn, &str, &str))| *what == GroupColumn::Cancellations;
    let found = visible_columns(company).enumerate().find(is_wanted);
    found.map_or((0, ""), |(index, (_, heading, _))| (index, *heading))
}

pub fn columns(company: &DisplayedCompany) -> Vec<TableColumn> {
    let column = |(what, head, _): &(GroupColumn, &str, &str)| match what {
        GroupColumn::Group | GroupColumn::GroupKind | GroupColumn::Trend => TableColumn::text(*head),
        GroupColumn::Name => TableColumn::text(*head).with_max_width(28).with_min_width(15),
        _ => TableColumn::numeric(*head),
    };
    visible_columns(company).map(column).collect()
}

/// Returns the lowest and highest market share of the company in a group, according to the market cap that the market
/// study estimated.
fn market_share(group: Group, facts: &GroupFacts, company: &DisplayedCompany) -> Option<(f64, f64)> {
    let (market, noise) = (company.insights.get(&group)?.estimates.market_cap, company.fit(group)?.max_relative_error);
    let (least, most) = true_value_range(market as f64, noise);
    let customers = facts.sum(|plan_subscribers| plan_subscribers.customers);
    (market > 0).then(|| (customers / most, customers / least))
}

pub fn group_row(group: Group, facts: &GroupFacts, company: &DisplayedCompany, market: &CustomerData) -> Vec<TableCell> {
    visible_columns(company).map(|(what, ..)| group_cell(*what, group, facts, company, market)).collect()
}

fn count_cell(value: f64) -> TableCell {
    match value {
        0.0 => TableCell::from_number(0.0, "–").with_role(Role::Dim),
        value => TableCell::from_number(value, grouped_number(value, 0)),
    }
}

fn optional_cell(value: Option<f64>, write: &dyn Fn(f64) -> String) -> TableCell {
    match value {
        Some(value) => TableCell::from_number(value, write(value)),
        None => TableCell::from_text("–").with_role(Role::Dim),
    }
}

fn group_cell(what: GroupColumn, group: Group, facts: &GroupFacts, company: &DisplayedCompany, market: &CustomerData) -> TableCell {
    let week = company.observation.week;
    let flow = facts.week(week);
    let budget = |value: f64| optional_cell((value > 0.0).then_some(value), &dollars);
    let large = group.is_enterprise();
    match what {
        GroupColumn::Group => TableCell::from_text(group.id()).with_role(Role::Strong),
        GroupColumn::TrueValue(value) => value.cell(group, company),
        GroupColumn::GroupKind => TableCell::from_text(if large { "ent." } else { "indiv." }).with_role(Role::Dim),
        GroupColumn::StudyLevel => {
            let level = study_level(company, group);
            let noise = company.tool_limits.study_level(level).map_or(0.0, |level| level.noise);
            TableCell::from_number(f64::from(level), format!("{level} ±{}", percent(noise, 0)))
        }
        GroupColumn::Customers => count_cell(facts.sum(|plan_subscribers| plan_subscribers.customers)),
        GroupColumn::Seats => optional_cell(large.then(|| facts.sum(|subscribers| subscribers.seats)), &|seats| grouped_number(seats, 0)),
        GroupColumn::MarketShare => match market_share(group, facts, company) {
            Some((least, most)) => {
                TableCell::from_number(most, format!("{:.1} to {}", least * 100.0, percent(most.min(1.0), 1)))
            }
            None => TableCell::from_text("–").with_role(Role::Dim),
        },
        GroupColumn::Leads => count_cell(flow.leads),
        GroupColumn::NewCustomers => new_customers_cell(facts, week),
        // Enterprises sign weeks after they arrive, so the conversion of one week's leads is meaningless.
        GroupColumn::Conversion => {
            let converted = (flow.leads > 0.0 && !large).then(|| flow.signups / flow.leads);
            optional_cell(converted, &|share| percent(share, 1))
        }
        GroupColumn::Cancellations => count_cell(flow.cancellations),
        GroupColumn::Churn => optional_cell(facts.churn(), &|share| percent(share, 1)),
        GroupColumn::MonthlyRevenue => {
            let monthly = facts.sum(|held| held.monthly_revenue);
            optional_cell((monthly > 0.0).then_some(monthly), &dollars)
        }
        GroupColumn::RevenuePerSeat => optional_cell(facts.revenue_per_seat(), &dollars_and_cents),
        GroupColumn::Usage => optional_cell(facts.usage(), &|units| compact_number(units.round())),
        GroupColumn::AdBudget => budget(total_ad_budget(company, group)),
        GroupColumn::AcquisitionCost => {
            let (spend, signed) = (market.ad_spend(group), facts.sum_of_last_weeks(week, 4, |flow| flow.signups));
            optional_cell((spend > 0.0 && signed > 0.0).then(|| spend / signed), &dollars_and_cents)
        }
        GroupColumn::DevelopmentBudget => budget(development_budget(company, group)),
        GroupColumn::Trend => {
            let trend: Vec<f64> =
                facts.weekly_values(week, |flow| flow.signups).into_iter().map(|(_, new)| new).collect();
            let some = trend.iter().any(|new| *new > 0.0);
            TableCell::from_text(if some { sparkline(&trend, 12) } else { String::new() }).with_role(Role::Series(0))
        }
        GroupColumn::Name => TableCell::from_text(group_name(company, group)).with_role(Role::Dim),
    }
}

fn new_customers_cell(facts: &GroupFacts, week: u32) -> TableCell {
    let now = facts.week(week).signups;
    let change = now - facts.week(week.saturating_sub(1)).signups;
    let (glyph, role) = match change {
        change if change > 0.0 => ("▲ ", Role::Good),
        change if change < 0.0 => ("▼ ", Role::Bad),
        _ => ("", Role::Text),
    };
    TableCell::from_number(now, format!("{glyph}{}", grouped_number(now, 0))).with_role(role)
}

/// Returns the figure of a group in a column, with a query for its source rows.
pub fn figure(group: Group, column: usize, company: &DisplayedCompany) -> Option<Figure> {
    let (what, head, term) = *visible_columns(company).nth(column)?;
    let week = company.observation.week;
    let name = match what {
        GroupColumn::Group | GroupColumn::GroupKind | GroupColumn::Name => "customers",
        GroupColumn::Customers if group.is_enterprise() => "enterprises",
        GroupColumn::Customers => "subscribers",
        GroupColumn::NewCustomers | GroupColumn::Trend => "new customers",
        GroupColumn::Cancellations => "cancellations",
        GroupColumn::Leads if group.is_enterprise() => "enterprises (with and without an offer request)",
        GroupColumn::Leads => "leads",
        GroupColumn::TrueValue(value) => value.title(),
        _ => head,
    };
    let title = match what {
        GroupColumn::Leads | GroupColumn::NewCustomers | GroupColumn::Cancellations | GroupColumn::Conversion => {
            format!("{name} of {group} in week {week}")
        }
        _ => format!("{group}: {name}"),
    };
    let figure = Figure { title, term, sql: source_rows_query(what, group, week, company.observation.day), week_quantity: None };
    Some(figure.with_week_quantity(week_quantity(what, group), week))
}

/// Returns the weekly quantity that a column shows for a group. For columns that contain names, returns the number of
/// subscribers.
fn week_quantity(what: GroupColumn, group: Group) -> Option<WeekQuantity> {
    let figure = match what {
        GroupColumn::Group | GroupColumn::GroupKind | GroupColumn::Name | GroupColumn::Customers => WeekFigure::Subscribers,
        GroupColumn::Leads => WeekFigure::Leads,
        GroupColumn::NewCustomers | GroupColumn::Trend => WeekFigure::NewSubscribers,
        GroupColumn::Conversion if !group.is_enterprise() => WeekFigure::Conversion,
        GroupColumn::Cancellations => WeekFigure::Cancellations,
        GroupColumn::Churn => WeekFigure::Churn,
        GroupColumn::Usage => WeekFigure::Usage,
        _ => return None,
    };
    WeekQuantity::for_group(figure, group)
}

/// Returns a query for the customers of a group, with their subscriptions, that meet a condition. Enterprises that
/// requested no offer have no subscription.
fn customers_statement(group: Group, condition: &str) -> String {
    format!(
        "SELECT c.customer_id, c.acquisition_source, c.created_day, s.plan, s.status, s.seat_count, s.effective_price,\n    \
         s.effective_price * s.seat_count AS amount, s.start_day, s.end_day\nFROM customers c\n\
         LEFT JOIN subscriptions s ON s.customer_id = c.customer_id\nWHERE c.group_id = '{group}' AND {condition}"
    )
}

/// Returns a query for the signups in a range of days. Individuals sign up on the day of arrival, enterprises on the
/// day of their deal.
fn signups_statement(group: Group, (from, to): (u32, u32)) -> String {
    let day = if group.is_enterprise() { "s.start_day" } else { "c.created_day" };
    customers_statement(
        group,
        &format!("{day} BETWEEN {from} AND {to}\n    AND s.status IN ('subscribed', 'cancelled')"),
    )
}

/// Returns a query for the leads, new customers or cancellations of a week.
pub fn flow_statement(flow: usize, group: Group, week: u32) -> String {
    let days = ((7 * week).saturating_sub(6), 7 * week);
    match flow {
        0 => customers_statement(group, &format!("c.created_day BETWEEN {} AND {}", days.0, days.1)),
        1 => signups_statement(group, days),
        _ => customers_statement(
            group,
            &format!(
                "s.status = 'cancelled'\n    AND min(s.end_day, (SELECT max(day) FROM service_day)) BETWEEN {} AND {}",
                days.0, days.1
            ),
        ),
    }
}

fn source_rows_query(what: GroupColumn, group: Group, week: u32, day: u32) -> Option<String> {
    let month = day.saturating_sub(27);
    Some(match what {
        GroupColumn::TrueValue(_) => return None,
        GroupColumn::Group | GroupColumn::GroupKind | GroupColumn::Name => customers_statement(group, "TRUE"),
        GroupColumn::Customers | GroupColumn::Seats | GroupColumn::MonthlyRevenue | GroupColumn::RevenuePerSeat => {
            customers_statement(group, "s.status = 'subscribed'")
        }
        GroupColumn::Leads | GroupColumn::Conversion => flow_statement(0, group, week),
        GroupColumn::NewCustomers => flow_statement(1, group, week),
        GroupColumn::Trend => signups_statement(group, ((7 * week).saturating_sub(83), 7 * week)),
        GroupColumn::Cancellations => flow_statement(2, group, week),
        GroupColumn::Churn => customers_statement(
            group,
            &format!(
                "s.start_day <= {}\n    AND (s.status = 'subscribed' OR s.status = 'cancelled' AND s.end_day > {})",
                day.saturating_sub(30),
                day.saturating_sub(30)
            ),
        ),
        GroupColumn::Usage => format!(
            "SELECT u.customer_id, s.plan, s.seat_count, u.usage_units\nFROM daily_usage u\nCROSS JOIN subscriptions s\n\
             CROSS JOIN customers c\nWHERE u.day = {day} AND s.customer_id = u.customer_id AND s.status = 'subscribed'\n    \
             AND c.customer_id = u.customer_id AND c.group_id = '{group}'"
        ),
        GroupColumn::AdBudget | GroupColumn::AcquisitionCost => format!(
            "SELECT day, channel_id, leads_generated, spend\nFROM ad_channel_leads\n\
             WHERE group_id = '{group}' AND day BETWEEN {month} AND {day}\nORDER BY day DESC"
        ),
        GroupColumn::StudyLevel | GroupColumn::MarketShare => {
            format!("SELECT *\nFROM group_info_levels\nWHERE group_id = '{group}'")
        }
        GroupColumn::DevelopmentBudget => "SELECT day, tool_name, settings_json\nFROM config_overrides\n\
                              WHERE tool_name = 'set_targeted_dev_spend'\nORDER BY day DESC"
            .to_owned(),
    })
}

pub fn figure_with_heading(head: &str, group: Group, company: &DisplayedCompany) -> Option<Figure> {
    let column = visible_columns(company).position(|(_, text, _)| *text == head)?;
    figure(group, column, company)
}
