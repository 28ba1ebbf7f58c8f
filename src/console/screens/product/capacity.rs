//! The capacity ladder, how much of it is used, and how the service runs.

use ratatui::layout::{Constraint, Layout, Rect};

use super::model::{Day, Rung, last_week};
use crate::console::canvas::{Align, Canvas, Click, rows_of};
use crate::console::company::Company;
use crate::console::text::number;
use crate::console::theme::Role;
use crate::console::widgets::chart::NO_DATA;
use crate::console::widgets::table::first_row;
use crate::console::widgets::{Axis, Line, Side, Unit, chart, spark};
use crate::notation::{compact, dollars, grouped, percent};
use crate::tools::ToolId;

/// The tier that served last, and the tier that is set.
pub fn tiers(company: &Company, days: &[Day]) -> (Option<u32>, u32) {
    (days.last().map(|day| day.tier), company.setting(ToolId::SetCapacityTier, "tier") as u32)
}

/// One line on capacity.
pub fn summary(company: &Company, rungs: &[Rung], days: &[Day]) -> String {
    let (_, set) = tiers(company, days);
    let Some(rung) = rungs.iter().find(|rung| rung.tier == set) else { return String::new() };
    match last_week(days) {
        Some((mean, peak)) if rung.units > 0.0 => format!(
            "tier {set} · used {}, peak {} · {} {}",
            share(mean, rung.units),
            share(peak, rung.units),
            compact((rung.units - peak).abs()),
            if peak > rung.units { "too few" } else { "free" }
        ),
        _ => format!("tier {set} · {} units a day", compact(rung.units)),
    }
}

/// Units as a share of what a tier serves; how far beyond it matters no more at ten times of it.
fn share(units: f64, of: f64) -> String {
    match of {
        of if of <= 0.0 => "–".to_owned(),
        of if units >= 10.0 * of => "> 999%".to_owned(),
        of => percent(units / of, 0),
    }
}

/// Draws the ladder, and the history of usage beside or below it where there is room.
#[allow(clippy::too_many_arguments)]
pub fn draw(
    canvas: &mut Canvas<'_>,
    area: Rect,
    company: &Company,
    rungs: &[Rung],
    days: &[Day],
    selected: usize,
    focused: bool,
    pane: usize,
) {
    let rows = rungs.len() as u16 + 1;
    let (list, history) = if area.height >= rows + 7 {
        let [list, history] = Layout::vertical([Constraint::Length(rows), Constraint::Min(0)]).areas(area);
        (list, history)
    } else if area.width >= 90 {
        let [list, history] = Layout::horizontal([Constraint::Length(54), Constraint::Min(0)]).areas(area);
        (list, history)
    } else {
        (area, Rect::default())
    };
    draw_ladder(canvas, list, company, rungs, days, selected, focused, pane);
    draw_history(canvas, history, rungs, days);
}

#[allow(clippy::too_many_arguments)]
fn draw_ladder(
    canvas: &mut Canvas<'_>,
    area: Rect,
    company: &Company,
    rungs: &[Rung],
    days: &[Day],
    selected: usize,
    focused: bool,
    pane: usize,
) {
    let head = format!("{:<6}{:>10}{:>10}{:>9}{:>9}{:>8}", "tier", "units/day", "$/day", "mean", "peak", "");
    canvas.text(area, &head, Role::Header);
    let (in_force, set) = tiers(company, days);
    let used = last_week(days);
    let below = Rect { y: area.y + 1, height: area.height.saturating_sub(1), ..area };
    if focused {
        canvas.page = below.height.max(1);
    }
    let from = first_row(selected, below.height as usize, rungs.len());
    for (row, (at, rung)) in rows_of(below).zip(rungs.iter().enumerate().skip(from)) {
        let (mean, peak) = used.map_or(("–".to_owned(), "–".to_owned()), |(mean, peak)| {
            (share(mean, rung.units), share(peak, rung.units))
        });
        let mark = match rung.tier {
            tier if Some(tier) == in_force && tier == set => "◆ now",
            tier if Some(tier) == in_force => "◆ until tomorrow",
            tier if tier == set => "▸ set",
            _ if used.is_some_and(|(_, peak)| peak > rung.units) => "! too small",
            _ => "",
        };
        let role = match (focused && at == selected, rung.tier == set, mark.starts_with('!')) {
            (true, ..) => Role::Selection,
            (_, true, _) => Role::Strong,
            (_, _, true) => Role::Dim,
            _ => Role::Text,
        };
        canvas.clear(row, role);
        let text = format!(
            "{:<6}{:>10}{:>10}{mean:>9}{peak:>9}  {mark}",
            rung.tier,
            compact(rung.units),
            dollars(rung.cost)
        );
        canvas.text(row, &text, role);
        canvas.click(row, Click::Row(pane, at));
    }
}

/// Usage against what was to be had, with the tiers near it as dotted lines.
fn draw_history(canvas: &mut Canvas<'_>, area: Rect, rungs: &[Rung], days: &[Day]) {
    let most = days.iter().map(|day| day.usage.max(day.capacity)).fold(0.0, f64::max);
    let (Some(first), Some(last)) = (days.first(), days.last()) else {
        return canvas.text(area, NO_DATA, Role::Dim);
    };
    let step = (f64::from(last.day - first.day) / 24.0).max(1.0);
    let near = rungs.iter().filter(|rung| rung.units > most / 20.0 && rung.units <= most);
    let dotted = |rung: &Rung| {
        let days = (0..=24).map(|at| f64::from(first.day) + step * f64::from(at));
        let days = days.filter(|day| *day <= f64::from(last.day));
        Line { scattered: true, ..Line::through(days.map(|day| (day, rung.units)).collect(), Role::Dim) }
    };
    let tiers: Vec<String> =
        near.clone().map(|rung| format!("{} {}", rung.tier, compact(rung.units))).collect();
    let words = format!("usage below capacity; dotted: tier {}", tiers.join(", "));
    let key = Rect { height: u16::from(area.height >= 8), ..area };
    canvas.text(key, &words, Role::Dim);
    let area = Rect { y: area.y + key.height, height: area.height - key.height, ..area };
    let dotted: Vec<Line> = near.map(dotted).collect();
    let points = |value: fn(&Day) -> f64| days.iter().map(|day| (f64::from(day.day), value(day))).collect();
    let curves = [
        Line::through(points(|day| day.capacity), Role::Warning),
        Line::through(points(|day| day.usage), Role::Series(0)),
    ];
    let lines: Vec<Line> = dotted.into_iter().chain(curves).collect();
    let x = Axis { write: &|day| format!("day {day:.0}"), holds: &[] };
    chart(canvas, area, &lines, &x, &Side { unit: Unit::Number, holds: &[0.0] });
}

/// A measure of the service: name, how it is read and written, and how several days are taken together.
type Measure = (&'static str, fn(&Day) -> f64, fn(f64) -> String, fn(&[f64]) -> f64);

static MEASURES: [Measure; 4] = [
    ("utilisation", Day::utilisation, |share| percent(share, 0), peak),
    ("latency p95, ms", |day| day.latency, |value| grouped(value, 0), peak),
    ("error rate", |day| day.errors, |share| percent(share, 2), peak),
    ("outage, minutes", |day| day.downtime, number, |days| days.iter().sum()),
];

fn peak(days: &[f64]) -> f64 {
    days.iter().copied().fold(0.0, f64::max)
}

/// One line on the service.
pub fn service_summary(days: &[Day]) -> String {
    let Some(last) = days.last() else { return NO_DATA.to_owned() };
    let minutes: f64 = days.iter().rev().take(28).map(|day| day.downtime).sum();
    format!(
        "p95 {} ms · errors {} · outage {} min in 28 days",
        grouped(last.latency, 0),
        percent(last.errors, 2),
        number(minutes)
    )
}

/// Draws the measures of the service by day, then the last outages.
pub fn draw_service(canvas: &mut Canvas<'_>, area: Rect, days: &[Day]) {
    let head = format!("{:<16}{:>8}{:>9}{:>9}  ", "", "last", "7-day", "28-day");
    canvas.text(area, &head, Role::Header);
    let trend = area.width.saturating_sub(44);
    canvas.text(
        Rect { x: area.x + 44.min(area.width), width: trend, ..area },
        &format!("last {} days", (trend as usize).min(days.len())),
        Role::Header,
    );
    let rows = rows_of(Rect { y: area.y + 1, height: area.height.saturating_sub(1), ..area });
    let figures = MEASURES.iter().map(Some).chain(std::iter::once(None));
    for (row, measure) in rows.zip(figures) {
        match measure {
            Some(measure) => draw_measure(canvas, row, measure, days),
            None => draw_outages(canvas, row, days),
        }
    }
}

fn draw_measure(canvas: &mut Canvas<'_>, row: Rect, (name, read, write, together): &Measure, days: &[Day]) {
    let values: Vec<f64> = days.iter().map(read).collect();
    let of_days = |count: usize| match &values[values.len().saturating_sub(count)..] {
        [] => "–".to_owned(),
        last => write(together(last)),
    };
    let last = values.last().map_or("–".to_owned(), |value| write(*value));
    let text = format!("{name:<16}{last:>8}{:>9}{:>9}", of_days(7), of_days(28));
    canvas.text(row, &text, Role::Text);
    if row.width > 44 {
        let room = row.width - 44;
        let place = Rect { x: row.x + 44, width: room, ..row };
        canvas.text(place, &spark(&values, room as usize), Role::Series(0));
    }
    let overloaded = *name == "utilisation" && values.last().is_some_and(|value| *value > 1.0);
    if overloaded {
        canvas.aligned(Rect { width: 43.min(row.width), ..row }, "!", Role::Bad, Align::Right);
    }
}

fn draw_outages(canvas: &mut Canvas<'_>, row: Rect, days: &[Day]) {
    let outages: Vec<String> = days
        .iter()
        .rev()
        .filter(|day| day.downtime > 0.0)
        .take(6)
        .map(|day| format!("day {} {} min", day.day, number(day.downtime)))
        .collect();
    let text = match outages.is_empty() {
        true => "no outages so far; 7-day and 28-day figures are peaks".to_owned(),
        false => format!("outages: {}", outages.join(" · ")),
    };
    canvas.text(row, &text, Role::Dim);
}
