//! What needs the person, the most urgent first.

use serde_json::Value;

use crate::console::company::Company;
use crate::console::effect::Effect;
use crate::console::screens::{Figure, ScreenId};
use crate::console::text::short_dollars;
use crate::notation::{compact, dollars, grouped, percent};
use crate::session::{JournalEntry, WeekFigures};

/// Why something needs the person; the order is that of urgency.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// The run is over.
    Over,
    /// Companies wait for an answer.
    Threads,
    /// Nobody can subscribe.
    NoPrice,
    /// Usage went above capacity.
    Overload,
    /// The service was down.
    Outage,
    /// Cash will not last.
    Runway,
    /// More leave than come.
    Losses,
    /// Many people write about the company.
    Stir,
    /// Capacity is nearly used up.
    Capacity,
    /// Subscribers wait for support.
    Support,
    /// R&D has ended.
    Research,
    /// A study or a search for groups has ended.
    Study,
    /// Nothing is in development.
    NoResearch,
    /// The index of the economy was published.
    Economy,
    /// A forecast has come due.
    Forecast,
    /// People write about the company.
    Posts,
    /// The press writes.
    Press,
    /// Nothing was posted.
    NoPost,
}

/// Something that needs the person.
#[derive(Debug, Clone, PartialEq)]
pub struct Alert {
    /// Why.
    pub kind: Kind,
    /// Words.
    pub text: String,
    /// It costs something not to act now.
    pub urgent: bool,
}

impl Alert {
    /// An alert that can wait.
    pub fn note(kind: Kind, text: String) -> Alert {
        Alert { kind, text, urgent: false }
    }

    fn urgent(kind: Kind, text: String) -> Alert {
        Alert { kind, text, urgent: true }
    }

    /// Where it is looked after.
    pub fn at(&self) -> ScreenId {
        match self.kind {
            Kind::Over | Kind::Forecast => ScreenId::Journal,
            Kind::Threads => ScreenId::Inbox,
            Kind::NoPrice => ScreenId::Tools,
            Kind::Overload
            | Kind::Outage
            | Kind::Capacity
            | Kind::Support
            | Kind::Research
            | Kind::NoResearch => ScreenId::Product,
            Kind::Runway => ScreenId::Cash,
            Kind::Losses => ScreenId::Customers,
            Kind::Study | Kind::Economy | Kind::Press => ScreenId::Market,
            Kind::Stir | Kind::Posts | Kind::NoPost => ScreenId::Social,
        }
    }

    /// What leads there.
    pub fn way(&self) -> Effect {
        match self.kind {
            Kind::NoPrice => Effect::ShowTool("set_prices"),
            _ => Effect::Show(self.at()),
        }
    }

    /// The figure it speaks of.
    pub fn figure(&self, day: u32) -> Figure {
        let from = day.saturating_sub(6);
        let days = |columns: &str| {
            format!("SELECT {columns}\nFROM service_day\nWHERE day BETWEEN {from} AND {day}\nORDER BY day")
        };
        let posts = format!(
            "SELECT post_id, day, content\nFROM social_media_posts\nWHERE day BETWEEN {from} AND {day}\n\
             ORDER BY post_id DESC"
        );
        let (term, sql) = match self.kind {
            Kind::Over => ("score", None),
            Kind::Threads => (
                "thread",
                Some(format!(
                    "SELECT customer_id, thread_type, max(turn_number) AS turn, day, sender, seat_count\n\
                     FROM enterprise_turns\nGROUP BY customer_id, thread_type\n\
                     HAVING sender <> 'agent' AND closed = 0 AND day >= {from}\nORDER BY seat_count DESC"
                )),
            ),
            Kind::NoPrice => ("set_prices", None),
            Kind::Overload | Kind::Capacity => {
                ("overload", Some(days("day, total_usage_units, capacity_units, capacity_tier")))
            }
            Kind::Outage => ("outage", Some(days("day, downtime_minutes, p95_ms, error_rate"))),
            Kind::Runway => (
                "runway",
                Some(format!(
                    "SELECT day, sum(amount) AS change\nFROM ledger\nWHERE day > {}\nGROUP BY day\nORDER BY day",
                    day.saturating_sub(28)
                )),
            ),
            Kind::Losses => ("churn", None),
            Kind::Support => ("issues", None),
            Kind::Research | Kind::NoResearch => {
                ("research", Some("SELECT *\nFROM research_projects\nORDER BY started_day DESC".to_owned()))
            }
            Kind::Study => {
                ("info-level", Some("SELECT *\nFROM group_info_levels\nWHERE info_level > 0".to_owned()))
            }
            Kind::Economy => {
                ("pmi", Some("SELECT *\nFROM macroeconomic_conditions\nORDER BY day DESC".to_owned()))
            }
            Kind::Forecast => (
                "forecast",
                Some(format!("SELECT *\nFROM predictions\nWHERE submit_day + horizon_days = {day}")),
            ),
            Kind::Stir | Kind::Posts | Kind::Press => ("social_media_posts.content", Some(posts)),
            Kind::NoPost => ("post_social_media", None),
        };
        Figure { title: self.text.clone(), term, sql }
    }
}

/// What needs the person as far as the company itself tells it, the most urgent first.
pub fn alerts(company: &Company) -> Vec<Alert> {
    let seen = &company.seen;
    if !company.is_running() {
        let text = "the run is over; readings and queries stay open".to_owned();
        return vec![Alert::note(Kind::Over, text)];
    }
    let mut alerts = Vec::new();
    alerts.extend(threads(company));
    if seen.subscribers == 0 && company.setting("set_prices", "A") == 0.0 {
        let text = "no plan has a price yet: set prices, quotas and capacity, or nobody can subscribe";
        alerts.push(Alert::urgent(Kind::NoPrice, text.to_owned()));
    }
    if let Some(weeks) = seen.runway_weeks.filter(|weeks| *weeks < 8.0) {
        let text = format!("cash lasts {weeks:.1} weeks at the loss of the last four");
        alerts.push(Alert::urgent(Kind::Runway, text));
    }
    if let Some(week) = &seen.last_week {
        alerts.extend(of_week(week, company));
        alerts.extend(forecast(week, company));
    }
    alerts.extend(unspent(company));
    sort(&mut alerts);
    alerts
}

/// Puts the most urgent first.
pub fn sort(alerts: &mut [Alert]) {
    alerts.sort_by_key(|alert| (!alert.urgent, alert.kind));
}

fn threads(company: &Company) -> Option<Alert> {
    let waiting = &company.seen.waiting;
    let last = company.seen.day + waiting.iter().map(|thread| thread.days_left).max()?;
    let seats: f64 = waiting.iter().map(|thread| f64::from(thread.seats)).sum();
    let (who, fate) = match waiting.len() {
        1 => ("1 company waits".to_owned(), "it is lost"),
        count => (format!("{} companies wait", grouped(count as f64, 0)), "all are lost"),
    };
    let seats = grouped(seats, 0);
    Some(Alert::urgent(
        Kind::Threads,
        format!("{who} for an answer ({seats} seats); unanswered, {fate} by day {last}"),
    ))
}

fn of_week(week: &WeekFigures, company: &Company) -> Vec<Alert> {
    let mut alerts = Vec::new();
    let count = |count: u32| grouped(f64::from(count), 0);
    if week.overload_peak > 0.0 {
        let over = percent(week.overload_peak, 1);
        let text = format!("usage was up to {over} above capacity; service suffers{}", next_tier(company));
        alerts.push(Alert::urgent(Kind::Overload, text));
    } else if let Some((used, tier)) = utilisation(company).filter(|(used, _)| *used > 0.85) {
        let used = percent(used, 0);
        let text = format!("{used} of capacity tier {tier} was used on an average day{}", next_tier(company));
        alerts.push(Alert::note(Kind::Capacity, text));
    }
    if week.outage {
        let text = format!("outages took {} minutes", week.downtime_minutes);
        alerts.push(Alert::urgent(Kind::Outage, text));
    }
    if week.open_issues > 0 && f64::from(week.open_issues) > 0.02 * f64::from(week.individual_subscribers) {
        let text = format!("{} subscribers wait for support", count(week.open_issues));
        alerts.push(Alert::note(Kind::Support, text));
    }
    if week.cancellations > week.new_individual_subscribers && week.cancellations > 20 {
        let (left, came) = (count(week.cancellations), count(week.new_individual_subscribers));
        alerts.push(Alert::urgent(Kind::Losses, format!("{left} cancelled, {came} came")));
    }
    alerts
}

/// Mean share of the capacity in force that the last week used, and the tier.
fn utilisation(company: &Company) -> Option<(f64, u32)> {
    let week = company.seen.last_week?;
    let tier = company.setting("set_capacity_tier", "tier") as u32;
    let units = capacity(company, tier, "capacity_units")?;
    (units > 0.0 && week.days_run > 0).then(|| (week.usage as f64 / f64::from(week.days_run) / units, tier))
}

fn capacity(company: &Company, tier: u32, of: &str) -> Option<f64> {
    company.costs.get("capacity_tiers")?.get(tier.to_string())?.get(of)?.as_f64()
}

/// What the next tier of capacity brings and costs; empty at the highest.
fn next_tier(company: &Company) -> String {
    let tier = company.setting("set_capacity_tier", "tier") as u32;
    let step = |of: &str| Some(capacity(company, tier + 1, of)? - capacity(company, tier, of)?);
    match (step("capacity_units"), step("cost_per_day")) {
        (Some(units), Some(cost)) => {
            format!("; tier {} adds {} units for {} a day", tier + 1, compact(units), dollars(cost))
        }
        _ => String::new(),
    }
}

/// A forecast of more than a week that has come due.
fn forecast(week: &WeekFigures, company: &Company) -> Option<Alert> {
    let filed = company.journal.iter().rev().find_map(|entry| match entry {
        JournalEntry::Advance { day, forecasts, .. } => forecasts
            .iter()
            .find(|forecast| day + forecast.horizon_days == week.day && forecast.horizon_days > 7),
        _ => None,
    })?;
    let side = match week.cash {
        cash if cash < filed.lower => "below",
        cash if cash > filed.upper => "above",
        _ => "inside",
    };
    Some(Alert::note(
        Kind::Forecast,
        format!(
            "{} weeks ago you expected {}; it is {}, {side} your interval",
            filed.horizon_days / 7,
            short_dollars(filed.point),
            short_dollars(week.cash)
        ),
    ))
}

/// What could be going on and is not: R&D that is affordable, a post of the week.
fn unspent(company: &Company) -> Vec<Alert> {
    let mut alerts = Vec::new();
    let tiers = company.projects.get("tiers").and_then(Value::as_array);
    let number = |tier: &Value, of: &str| tier.get(of).and_then(Value::as_f64).unwrap_or(0.0);
    // A project that takes most of the cash is no missed chance.
    let affordable = |tier: &&Value| number(tier, "cost") * 4.0 < company.seen.cash;
    if company.seen.running_research == 0
        && company.seen.week > 0
        && let Some(best) = tiers.into_iter().flatten().rfind(affordable)
    {
        let text = format!(
            "no R&D runs; tier {} costs {} and adds about {:.2} quality in {:.0} days",
            number(best, "tier"),
            dollars(number(best, "cost")),
            number(best, "mean_quality_boost"),
            number(best, "mean_days")
        );
        alerts.push(Alert::note(Kind::NoResearch, text));
    }
    let posted = company.journal.iter().rev().any(|entry| match entry {
        JournalEntry::Call { day, tool, .. } => *day == company.seen.day && tool == "post_social_media",
        _ => false,
    });
    if !posted && company.seen.week > 0 {
        alerts.push(Alert::note(Kind::NoPost, "nothing was posted since the last week".to_owned()));
    }
    alerts
}
