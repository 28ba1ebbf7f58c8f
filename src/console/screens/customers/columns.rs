//! Columns of the table of groups, and the rows behind each figure.

use super::hidden::TrueValue;
use super::model::{CustomerFacts, MarketRows, ad_budgets, development_budget};
use crate::context::Figure;
use crate::screens::market::model::{level_of, name_of};
use novamind_base::notation::{cents, compact, dollars, grouped, percent};
use novamind_insight::WeekQuantity;
use novamind_record::figures::WeekFigure;
use novamind_session::identifiers::Group;
use novamind_session::truth_behind;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{Cell, Column, spark};
use novamind_worker::company::Company;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum What {
    Group,
    Segment,
    True(TrueValue),
    Level,
    Customers,
    Seats,
    Market,
    Leads,
    New,
    Conversion,
    Left,
    Churn,
    Monthly,
    PerSeat,
    Usage,
    Ads,
    CostOfNew,
    Development,
    Trend,
    Name,
}

/// Columns with headings and glossary terms, most used first.
static COLUMNS: [(What, &str, &str); 23] = [
    (What::Group, "group", "customer-group"),
    (What::Segment, "kind", "customer-group"),
    (What::True(TrueValue::Satisfaction), "true sat.", "satisfaction"),
    (What::True(TrueValue::Reputation), "true rep.", "reputation"),
    (What::True(TrueValue::Leads), "true λ/day", "lead"),
    (What::True(TrueValue::Market), "true market", "market-cap"),
    (What::Customers, "subs", "subscribers"),
    (What::Seats, "billed seats", "billed-seats"),
    (What::Leads, "leads", "lead"),
    (What::New, "new", "conversion"),
    (What::Conversion, "conv.", "conversion"),
    (What::Left, "left", "churn"),
    (What::Churn, "churn 30d", "churn"),
    (What::Monthly, "billed/mo", "billed-seats"),
    (What::PerSeat, "per seat", "arpu"),
    (What::Usage, "use/day", "usage"),
    (What::Ads, "ads/day", "set_targeted_ad_spend"),
    (What::CostOfNew, "ad $/new", "cost-per-new-customer"),
    (What::Development, "dev/day", "set_targeted_dev_spend"),
    (What::Level, "level", "info-level"),
    (What::Market, "of market", "market-cap"),
    (What::Trend, "new by week", "conversion"),
    (What::Name, "name", "customer-group"),
];

/// Returns the visible columns; those with true values need an open x-ray.
fn shown(company: &Company) -> impl Iterator<Item = &'static (What, &'static str, &'static str)> {
    let has_hidden = company.hidden.is_some();
    COLUMNS.iter().filter(move |(what, ..)| has_hidden || !matches!(what, What::True(_)))
}

pub fn columns(company: &Company) -> Vec<Column> {
    let column = |(what, head, _): &(What, &str, &str)| match what {
        What::Group | What::Segment | What::Trend => Column::words(*head),
        What::Name => Column::words(*head).at_most(28),
        _ => Column::numbers(*head),
    };
    shown(company).map(column).collect()
}

/// Returns the lowest and highest market share by the group's market study: individuals for individual
/// groups, enterprises otherwise.
fn of_market(group: Group, facts: &CustomerFacts, company: &Company) -> Option<(f64, f64)> {
    let (market, noise) = (company.insights.get(&group)?.estimates.market_cap, company.fit(group)?.noise);
    let (least, most) = truth_behind(market as f64, noise);
    let customers = facts.sum(|held| held.customers);
    (market > 0).then(|| (customers / most, customers / least))
}

pub fn row_of(group: Group, facts: &CustomerFacts, company: &Company, market: &MarketRows) -> Vec<Cell> {
    shown(company).map(|(what, ..)| cell_of(*what, group, facts, company, market)).collect()
}

fn count(value: f64) -> Cell {
    match value {
        0.0 => Cell::number(0.0, "–").role(Role::Dim),
        value => Cell::number(value, grouped(value, 0)),
    }
}

fn optional(value: Option<f64>, write: &dyn Fn(f64) -> String) -> Cell {
    match value {
        Some(value) => Cell::number(value, write(value)),
        None => Cell::words("–").role(Role::Dim),
    }
}

fn cell_of(what: What, group: Group, facts: &CustomerFacts, company: &Company, market: &MarketRows) -> Cell {
    let week = company.seen.week;
    let flow = facts.week(week);
    let budget = |value: f64| optional((value > 0.0).then_some(value), &dollars);
    let large = group.is_enterprise();
    match what {
        What::Group => Cell::words(group.id()).role(Role::Strong),
        What::True(value) => value.cell(group, company),
        What::Segment => Cell::words(if large { "comp." } else { "indiv." }).role(Role::Dim),
        What::Level => {
            let level = level_of(company, group);
            let noise = company.terms.level(level).map_or(0.0, |level| level.noise);
            Cell::number(f64::from(level), format!("{level} ±{}", percent(noise, 0)))
        }
        What::Customers => count(facts.sum(|held| held.customers)),
        What::Seats => optional(large.then(|| facts.sum(|held| held.seats)), &|seats| grouped(seats, 0)),
        What::Market => match of_market(group, facts, company) {
            Some((least, most)) => {
                Cell::number(most, format!("{:.1} to {}", least * 100.0, percent(most.min(1.0), 1)))
            }
            None => Cell::words("–").role(Role::Dim),
        },
        What::Leads => count(flow.leads),
        What::New => new_cell(facts, week),
        // Enterprises sign weeks after they arrive, so a conversion of this week's leads is meaningless.
        What::Conversion => {
            let converted = (flow.leads > 0.0 && !large).then(|| flow.signed / flow.leads);
            optional(converted, &|share| percent(share, 1))
        }
        What::Left => count(flow.cancelled),
        What::Churn => optional(facts.churn(), &|share| percent(share, 1)),
        What::Monthly => {
            let monthly = facts.sum(|held| held.monthly);
            optional((monthly > 0.0).then_some(monthly), &dollars)
        }
        What::PerSeat => optional(facts.revenue_per_seat(), &cents),
        What::Usage => optional(facts.usage(), &compact),
        What::Ads => budget(ad_budgets(company, group)),
        What::CostOfNew => {
            let (spend, signed) = (market.ad_spend(group), facts.last(week, 4, |flow| flow.signed));
            optional((spend > 0.0 && signed > 0.0).then(|| spend / signed), &cents)
        }
        What::Development => budget(development_budget(company, group)),
        What::Trend => {
            let trend: Vec<f64> =
                facts.trend(week, |flow| flow.signed).into_iter().map(|(_, new)| new).collect();
            let some = trend.iter().any(|new| *new > 0.0);
            Cell::words(if some { spark(&trend, 12) } else { String::new() }).role(Role::Series(0))
        }
        What::Name => Cell::words(name_of(company, group)).role(Role::Dim),
    }
}

fn new_cell(facts: &CustomerFacts, week: u32) -> Cell {
    let now = facts.week(week).signed;
    let change = now - facts.week(week.saturating_sub(1)).signed;
    let (glyph, role) = match change {
        change if change > 0.0 => ("▲ ", Role::Good),
        change if change < 0.0 => ("▼ ", Role::Bad),
        _ => ("", Role::Text),
    };
    Cell::number(now, format!("{glyph}{}", grouped(now, 0))).role(role)
}

/// Returns the figure of a group in a column, with a query for its rows.
pub fn figure(group: Group, column: usize, company: &Company) -> Option<Figure> {
    let (what, head, term) = *shown(company).nth(column)?;
    let week = company.seen.week;
    let name = match what {
        What::Group | What::Segment | What::Name => "customers",
        What::Customers if group.is_enterprise() => "enterprises",
        What::Customers => "subscribers",
        What::New | What::Trend => "new customers",
        What::Left => "cancellations",
        What::Leads => "leads",
        What::True(value) => value.title(),
        _ => head,
    };
    let title = match what {
        What::Leads | What::New | What::Left | What::Conversion => {
            format!("{name} of {group} in week {week}")
        }
        _ => format!("{name} of {group}"),
    };
    let figure = Figure { title, term, sql: statement(what, group, week, company.seen.day), why: None };
    Some(figure.of_week(quantity(what, group), week))
}

/// Returns the weekly figure that a column shows for a group; for the name columns, the number of customers.
fn quantity(what: What, group: Group) -> Option<WeekQuantity> {
    let figure = match what {
        What::Group | What::Segment | What::Name | What::Customers => WeekFigure::Subscribers,
        What::Leads => WeekFigure::Leads,
        What::New | What::Trend => WeekFigure::NewSubscribers,
        What::Conversion if !group.is_enterprise() => WeekFigure::Conversion,
        What::Left => WeekFigure::Cancellations,
        What::Churn => WeekFigure::Churn,
        What::Usage => WeekFigure::Usage,
        _ => return None,
    };
    WeekQuantity::of_group(figure, group)
}

/// Selects customers with their subscriptions by a condition.
fn customers(group: Group, condition: &str) -> String {
    format!(
        "SELECT c.customer_id, c.acquisition_source, c.created_day, s.plan, s.status, s.seat_count, s.effective_price,\n    \
         s.effective_price * s.seat_count AS amount, s.start_day, s.end_day\nFROM customers c\n\
         JOIN subscriptions s ON s.customer_id = c.customer_id\nWHERE c.group_id = '{group}' AND {condition}"
    )
}

/// Selects sign-ups in a range of days: individuals by arrival, enterprises by the day of their deal.
fn signed(group: Group, (from, to): (u32, u32)) -> String {
    let day = if group.is_enterprise() { "s.start_day" } else { "c.created_day" };
    customers(
        group,
        &format!("{day} BETWEEN {from} AND {to}\n    AND s.status IN ('subscribed', 'cancelled')"),
    )
}

/// Selects the leads, new customers or cancellations of a week.
pub fn flow_statement(flow: usize, group: Group, week: u32) -> String {
    let days = ((7 * week).saturating_sub(6), 7 * week);
    match flow {
        0 => customers(group, &format!("c.created_day BETWEEN {} AND {}", days.0, days.1)),
        1 => signed(group, days),
        _ => customers(
            group,
            &format!(
                "s.status = 'cancelled'\n    AND min(s.end_day, (SELECT max(day) FROM service_day)) BETWEEN {} AND {}",
                days.0, days.1
            ),
        ),
    }
}

fn statement(what: What, group: Group, week: u32, day: u32) -> Option<String> {
    let month = day.saturating_sub(27);
    Some(match what {
        What::True(_) => return None,
        What::Group | What::Segment | What::Name => customers(group, "TRUE"),
        What::Customers | What::Seats | What::Monthly | What::PerSeat => {
            customers(group, "s.status = 'subscribed'")
        }
        What::Leads | What::Conversion => flow_statement(0, group, week),
        What::New => flow_statement(1, group, week),
        What::Trend => signed(group, ((7 * week).saturating_sub(83), 7 * week)),
        What::Left => flow_statement(2, group, week),
        What::Churn => customers(
            group,
            &format!(
                "s.start_day <= {}\n    AND (s.status = 'subscribed' OR s.status = 'cancelled' AND s.end_day > {})",
                day.saturating_sub(30),
                day.saturating_sub(30)
            ),
        ),
        What::Usage => format!(
            "SELECT u.customer_id, s.plan, s.seat_count, u.usage_units\nFROM daily_usage u\nCROSS JOIN subscriptions s\n\
             CROSS JOIN customers c\nWHERE u.day = {day} AND s.customer_id = u.customer_id AND s.status = 'subscribed'\n    \
             AND c.customer_id = u.customer_id AND c.group_id = '{group}'"
        ),
        What::Ads | What::CostOfNew => format!(
            "SELECT day, channel_id, leads_generated, spend\nFROM ad_channel_leads\n\
             WHERE group_id = '{group}' AND day BETWEEN {month} AND {day}\nORDER BY day DESC"
        ),
        What::Level | What::Market => {
            format!("SELECT *\nFROM group_info_levels\nWHERE group_id = '{group}'")
        }
        What::Development => "SELECT day, tool_name, settings_json\nFROM config_overrides\n\
                              WHERE tool_name = 'set_targeted_dev_spend'\nORDER BY day DESC"
            .to_owned(),
    })
}

pub fn figure_named(head: &str, group: Group, company: &Company) -> Option<Figure> {
    let column = shown(company).position(|(_, own, _)| *own == head)?;
    figure(group, column, company)
}
