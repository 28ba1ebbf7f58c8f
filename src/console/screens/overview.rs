//! The company at a glance: cash with the fan of the last forecasts, what needs the person, the week, quality.

use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::text::Line as TextLine;

use super::{Look, Screen, ScreenId};
use crate::console::action::{Action, Scope};
use crate::console::canvas::{Align, Canvas, Click, rows_of};
use crate::console::company::Company;
use crate::console::dialogs::filing::draw_fan;
use crate::console::effect::Effect;
use crate::console::text::{arrow, number, short_dollars};
use crate::console::theme::Role;
use crate::console::widgets::table::first_row;
use crate::console::widgets::{Axis, Line, chart, spark};
use crate::notation::{dollars, grouped, percent};
use crate::session::WeekFigures;

/// The screen.
#[derive(Default)]
pub struct Overview {
    /// 0 what needs the person, 1 the week.
    focus: usize,
    alert: usize,
    figure: usize,
}

/// Something that needs the person.
#[derive(Debug, Clone, PartialEq)]
pub struct Alert {
    /// Words.
    pub text: String,
    /// It costs something not to act now.
    pub urgent: bool,
    /// Where it is looked after.
    pub at: ScreenId,
}

/// What needs the person, the most urgent first.
pub fn alerts(company: &Company) -> Vec<Alert> {
    let mut alerts = Vec::new();
    let mut add = |urgent: bool, at: ScreenId, text: String| alerts.push(Alert { text, urgent, at });
    let seen = &company.seen;
    if !company.is_running() {
        add(false, ScreenId::Journal, "the run is over; readings and queries stay open".to_owned());
        return alerts;
    }
    if let Some(weeks) = seen.runway_weeks.filter(|weeks| *weeks < 8.0) {
        add(true, ScreenId::Cash, format!("cash lasts {weeks:.1} weeks at the loss of the last four"));
    }
    let waiting = seen.waiting.len();
    if waiting > 0 {
        let day = seen.day + seen.waiting.iter().map(|thread| thread.days_left).min().unwrap_or(0);
        let seats: u32 = seen.waiting.iter().map(|thread| thread.seats).sum();
        add(
            false,
            ScreenId::Inbox,
            format!(
                "{waiting} companies ask for an offer ({} seats); the first leaves on day {day}",
                grouped(f64::from(seats), 0)
            ),
        );
    }
    if company.seen.subscribers == 0 && company.setting("set_prices", "A") == 0.0 {
        add(
            true,
            ScreenId::Tools,
            "no plan has a price yet: set prices, quotas and capacity, or nobody can subscribe".to_owned(),
        );
    }
    if let Some(week) = &seen.last_week {
        week_alerts(week, company, &mut add);
    }
    forecast_alert(company, &mut add);
    alerts.sort_by_key(|alert| !alert.urgent);
    alerts
}

fn week_alerts(week: &WeekFigures, company: &Company, add: &mut impl FnMut(bool, ScreenId, String)) {
    if week.overload_peak > 0.0 {
        let text =
            format!("usage was up to {} above capacity; service suffers", percent(week.overload_peak, 1));
        add(true, ScreenId::Product, text);
    } else if let Some((used, tier)) = utilisation(company).filter(|(used, _)| *used > 0.85) {
        add(
            false,
            ScreenId::Product,
            format!("{} of capacity tier {tier} was used on an average day", percent(used, 0)),
        );
    }
    if week.outage {
        add(true, ScreenId::Product, format!("an outage took {} minutes", week.downtime_minutes));
    }
    if week.open_issues > 0 && f64::from(week.open_issues) > 0.02 * f64::from(week.individual_subscribers) {
        let text = format!("{} subscribers wait for support", grouped(f64::from(week.open_issues), 0));
        add(false, ScreenId::Product, text);
    }
    if week.cancellations > week.new_individual_subscribers && week.cancellations > 20 {
        let text = format!(
            "{} cancelled, {} came",
            grouped(f64::from(week.cancellations), 0),
            grouped(f64::from(week.new_individual_subscribers), 0)
        );
        add(true, ScreenId::Customers, text);
    }
}

/// Mean share of the capacity in force that the last week used, and the tier.
pub fn utilisation(company: &Company) -> Option<(f64, u32)> {
    let week = company.seen.last_week?;
    let tier = company.setting("set_capacity_tier", "tier") as u32;
    let units =
        company.costs.get("capacity_tiers")?.get(tier.to_string())?.get("capacity_units")?.as_f64()?;
    (units > 0.0 && week.days_run > 0).then(|| (week.usage as f64 / f64::from(week.days_run) / units, tier))
}

fn forecast_alert(company: &Company, add: &mut impl FnMut(bool, ScreenId, String)) {
    let Some(week) = &company.seen.last_week else { return };
    let filed = company.journal.iter().rev().find_map(|entry| match entry {
        crate::session::JournalEntry::Advance { day, forecasts, .. } => forecasts
            .iter()
            .find(|forecast| day + forecast.horizon_days == week.day && forecast.horizon_days > 7),
        _ => None,
    });
    if let Some(forecast) = filed {
        let outside = week.cash < forecast.lower || week.cash > forecast.upper;
        let text = format!(
            "{} weeks ago you expected {}; it is {} ({} your interval)",
            forecast.horizon_days / 7,
            short_dollars(forecast.point),
            short_dollars(week.cash),
            if outside { "outside" } else { "inside" }
        );
        add(false, ScreenId::Journal, text);
    }
}

/// A figure of the week: name, how it is read and written, whether more is better.
struct Figure {
    name: &'static str,
    read: fn(&WeekFigures) -> f64,
    write: fn(f64) -> String,
    more_is_better: bool,
}

fn whole(value: f64) -> String {
    grouped(value, 0)
}

fn share(value: f64) -> String {
    percent(value, 1)
}

fn none_or_percent(value: f64) -> String {
    if value > 0.0 { percent(value, 1) } else { "none".to_owned() }
}

/// Conversion of the week's individual leads, 0 without leads.
fn conversion(week: &WeekFigures) -> f64 {
    f64::from(week.new_individual_subscribers) / f64::from(week.new_individual_leads.max(1))
}

const FIGURES: [Figure; 17] = [
    Figure {
        name: "recurring revenue",
        read: |week| week.recurring_revenue,
        write: dollars,
        more_is_better: true,
    },
    Figure { name: "payments", read: |week| week.payments, write: dollars, more_is_better: true },
    Figure { name: "running costs", read: |week| week.costs, write: dollars, more_is_better: false },
    Figure {
        name: "individual leads",
        read: |week| f64::from(week.new_individual_leads),
        write: whole,
        more_is_better: true,
    },
    Figure {
        name: "new subscribers",
        read: |week| f64::from(week.new_individual_subscribers),
        write: whole,
        more_is_better: true,
    },
    Figure { name: "conversion", read: conversion, write: share, more_is_better: true },
    Figure {
        name: "cancellations",
        read: |week| f64::from(week.cancellations),
        write: whole,
        more_is_better: false,
    },
    Figure { name: "upgrades", read: |week| f64::from(week.upgrades), write: whole, more_is_better: true },
    Figure {
        name: "downgrades",
        read: |week| f64::from(week.downgrades),
        write: whole,
        more_is_better: false,
    },
    Figure {
        name: "enterprise leads",
        read: |week| f64::from(week.new_enterprise_leads),
        write: whole,
        more_is_better: true,
    },
    Figure {
        name: "new seats",
        read: |week| f64::from(week.new_enterprise_seats),
        write: whole,
        more_is_better: true,
    },
    Figure { name: "usage, units", read: |week| week.usage as f64, write: whole, more_is_better: true },
    Figure {
        name: "overload, peak",
        read: |week| week.overload_peak,
        write: none_or_percent,
        more_is_better: false,
    },
    Figure {
        name: "outage, minutes",
        read: |week| f64::from(week.downtime_minutes),
        write: whole,
        more_is_better: false,
    },
    Figure { name: "latency, peak ms", read: |week| week.p95_ms_peak, write: whole, more_is_better: false },
    Figure {
        name: "error rate, peak",
        read: |week| week.error_rate_peak,
        write: |value| percent(value, 2),
        more_is_better: false,
    },
    Figure {
        name: "open issues",
        read: |week| f64::from(week.open_issues),
        write: whole,
        more_is_better: false,
    },
];

impl Screen for Overview {
    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::List]
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::Open]
    }

    fn panes(&self) -> usize {
        2
    }

    fn focus(&self) -> usize {
        self.focus
    }

    fn set_focus(&mut self, pane: usize) {
        self.focus = pane.min(1);
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Vec<Effect> {
        let alerts = alerts(look.company);
        let (place, count) = match self.focus {
            0 => (&mut self.alert, alerts.len()),
            _ => (&mut self.figure, FIGURES.len()),
        };
        let last = count.saturating_sub(1);
        match action {
            Action::Up => *place = place.saturating_sub(1),
            Action::Down => *place = (*place + 1).min(last),
            Action::First => *place = 0,
            Action::Last => *place = last,
            Action::Open if self.focus == 0 => {
                return alerts.get(self.alert).map(|alert| Effect::Show(alert.at)).into_iter().collect();
            }
            _ => {}
        }
        Vec::new()
    }

    fn click(&mut self, pane: usize, row: usize, look: &Look<'_>) -> Vec<Effect> {
        let place = if pane == 0 { &mut self.alert } else { &mut self.figure };
        let again = *place == row;
        *place = row;
        if again { self.act(Action::Open, look) } else { Vec::new() }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let company = look.company;
        if area.width >= 104 {
            let [left, right] =
                Layout::horizontal([Constraint::Percentage(50), Constraint::Min(0)]).areas(area);
            let quality = (company.quality.len() as u16 + 3).min(left.height / 2);
            let [cash, below] =
                Layout::vertical([Constraint::Min(8), Constraint::Length(quality)]).areas(left);
            draw_cash(canvas, cash, company);
            draw_quality(canvas, below, company);
            let [needs, week] =
                Layout::vertical([Constraint::Length(needs_height(company, right)), Constraint::Min(6)])
                    .areas(right);
            self.draw_alerts(canvas, needs, company);
            self.draw_week(canvas, week, company);
        } else {
            let [top, week] =
                Layout::vertical([Constraint::Min(7), Constraint::Length((area.height / 2).min(10))])
                    .areas(area);
            let [cash, needs] =
                Layout::horizontal([Constraint::Percentage(50), Constraint::Min(0)]).areas(top);
            draw_cash(canvas, cash, company);
            self.draw_alerts(canvas, needs, company);
            self.draw_week(canvas, week, company);
        }
    }
}

fn needs_height(company: &Company, area: Rect) -> u16 {
    (alerts(company).len() as u16 + 2).clamp(4, area.height / 2)
}

fn draw_cash(canvas: &mut Canvas<'_>, area: Rect, company: &Company) {
    let note = match company.last_forecasts() {
        Some((day, _)) => format!("{}, and the forecast of day {day}", dollars(company.seen.cash)),
        None => dollars(company.seen.cash),
    };
    let inside = canvas.pane(area, "Cash", &note, false);
    canvas.click(area, Click::Do(Action::Cash));
    match company.last_forecasts() {
        Some((filed, forecasts)) => {
            // Far horizons would flatten the curve: only what lies within the run and the near future is drawn.
            let near: Vec<_> =
                forecasts.iter().copied().filter(|forecast| forecast.horizon_days <= 84).collect();
            draw_fan(canvas, inside, company, filed, &near);
        }
        None => {
            let lines = [Line::of(&company.cash_by_day, Role::Series(0))];
            let x = Axis { write: &|day| format!("day {day:.0}"), holds: &[0.0] };
            chart(canvas, inside, &lines, &x, &Axis { write: &short_dollars, holds: &[] });
        }
    }
}

fn draw_quality(canvas: &mut Canvas<'_>, area: Rect, company: &Company) {
    let (base, shared) = company.quality_base;
    let note = format!("base {base:.2} · for everybody {shared:+.4}");
    let inside = canvas.pane(area, "Delivered quality", &note, false);
    canvas.click(area, Click::Do(Action::Product));
    let tier = |plan: &str| number(company.setting("set_model_tiers", plan));
    let head = format!(
        "group  {:>9} {:>9} {:>9}   {:>9}",
        format!("A T{}", tier("A")),
        format!("B T{}", tier("B")),
        format!("C T{}", tier("C")),
        "group's"
    );
    canvas.text(inside, &head, Role::Header);
    let below = Rect { y: inside.y + 1, height: inside.height.saturating_sub(1), ..inside };
    for (row, quality) in rows_of(below).zip(&company.quality) {
        let [a, b, c] = quality.by_plan.0;
        let bonus =
            if quality.group_bonus > 0.0 { format!("+{:.4}", quality.group_bonus) } else { "–".to_owned() };
        canvas.text(
            row,
            &format!("{:<6} {a:>9.4} {b:>9.4} {c:>9.4}   {bonus:>9}", quality.group.id()),
            Role::Text,
        );
    }
}

impl Overview {
    fn draw_alerts(&self, canvas: &mut Canvas<'_>, area: Rect, company: &Company) {
        let alerts = alerts(company);
        let focused = self.focus == 0;
        canvas.click(area, Click::Pane(0));
        let inside = canvas.pane(area, "Needs you", "", focused);
        if alerts.is_empty() {
            canvas.text(inside, "nothing: n lets the week pass", Role::Dim);
        }
        let from = first_row(self.alert, inside.height as usize, alerts.len());
        for (row, (at, alert)) in rows_of(inside).zip(alerts.iter().enumerate().skip(from)) {
            let role = match (focused && at == self.alert, alert.urgent) {
                (true, _) => Role::Selection,
                (false, true) => Role::Warning,
                (false, false) => Role::Text,
            };
            let mark = if alert.urgent { "!" } else { "·" };
            canvas.clear(row, if role == Role::Selection { Role::Selection } else { Role::Text });
            let place = Rect { width: row.width.saturating_sub(12), ..row };
            canvas.text(place, &format!("{mark} {}", alert.text), role);
            let to = format!("→ {}", alert.at.action().entry().title);
            canvas.aligned(row, &to, if role == Role::Selection { role } else { Role::Dim }, Align::Right);
            canvas.click(row, Click::Row(0, at));
        }
    }

    fn draw_week(&self, canvas: &mut Canvas<'_>, area: Rect, company: &Company) {
        let focused = self.focus == 1;
        canvas.click(area, Click::Pane(1));
        let note = company
            .seen
            .last_week
            .map_or("no week has passed".to_owned(), |week| format!("to day {}", week.day));
        let inside = canvas.pane(area, "This week", &note, focused);
        let wide = inside.width >= 66;
        let head = |canvas: &Canvas<'_>| {
            let mut text = format!("{:<18}{:>12}{:>14}", "", "this week", "change");
            if wide {
                text += &format!("{:>12}", "4-wk mean");
            }
            TextLine::from(canvas.span(text, Role::Header))
        };
        let line = head(canvas);
        canvas.line(inside, &line);
        let below = Rect { y: inside.y + 1, height: inside.height.saturating_sub(1), ..inside };
        if focused {
            canvas.page = below.height.max(1);
        }
        let from = first_row(self.figure, below.height as usize, FIGURES.len());
        for (row, (at, figure)) in rows_of(below).zip(FIGURES.iter().enumerate().skip(from)) {
            draw_figure(canvas, row, figure, company, wide, focused && at == self.figure);
            canvas.click(row, Click::Row(1, at));
        }
    }
}

fn draw_figure(
    canvas: &mut Canvas<'_>,
    row: Rect,
    figure: &Figure,
    company: &Company,
    wide: bool,
    selected: bool,
) {
    let trend = company.trend(12, figure.read);
    let now = trend.last().copied();
    let before = trend.len().checked_sub(2).map(|at| trend[at]);
    let role = |other: Role| if selected { Role::Selection } else { other };
    if selected {
        canvas.clear(row, Role::Selection);
    }
    let value = now.map_or("–".to_owned(), figure.write);
    canvas.text(Rect { width: 18.min(row.width), ..row }, figure.name, role(Role::Text));
    canvas.aligned(
        Rect { x: row.x + 18, width: 12.min(row.width.saturating_sub(18)), ..row },
        &value,
        role(Role::Strong),
        Align::Right,
    );
    let change = match (now, before) {
        (Some(now), Some(before)) => now - before,
        _ => 0.0,
    };
    let moved = if before.is_some() { arrow(change, &(figure.write)(change.abs())) } else { String::new() };
    let tone = match change {
        0.0 => Role::Dim,
        change if (change > 0.0) == figure.more_is_better => Role::Good,
        _ => Role::Bad,
    };
    canvas.aligned(
        Rect { x: row.x + 30, width: 14.min(row.width.saturating_sub(30)), ..row },
        &moved,
        role(tone),
        Align::Right,
    );
    let mut x = row.x + 44;
    if wide {
        let mean = company.mean_of_four(figure.read).map_or("–".to_owned(), figure.write);
        canvas.aligned(Rect { x, width: 12, ..row }, &mean, role(Role::Dim), Align::Right);
        x += 12;
    }
    let room = row.right().saturating_sub(x + 2);
    if room > 3 {
        let place = Rect { x: x + 2, width: room, ..row };
        canvas.text(place, &spark(&trend, room as usize), role(Role::Series(0)));
    }
}
