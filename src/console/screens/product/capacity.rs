//! Capacity tiers and their utilization.

use ratatui::layout::{Constraint, Layout, Rect};

use super::model::{Day, Rung, last_week};
use super::part::{ProductPart, tier};
use super::{Product, ProductPane};
use crate::context::Figure;
use crate::effect::Effect;
use crate::screens::panes::Seat;
use novamind_base::notation::{compact, dollars, percent};
use novamind_insight::WeekQuantity;
use novamind_record::figures::WeekFigure;
use novamind_report::peak::PeakProjection;
use novamind_tools::ToolId;
use novamind_tui::canvas::{Canvas, Click, rows_of};
use novamind_tui::text::fitting;
use novamind_tui::theme::Role;
use novamind_tui::widgets::table::first_row;
use novamind_tui::widgets::{Axis, Line, Side, Unit, chart};
use novamind_worker::company::Company;

/// Returns the tier of the last day, and the tier that is set.
pub fn tiers(company: &Company, days: &[Day]) -> (Option<u32>, u32) {
    (days.last().map(|day| day.tier), company.setting(ToolId::SetCapacityTier, "tier") as u32)
}

/// Returns one line on capacity, longest wording first.
fn summary(company: &Company, rungs: &[Rung], days: &[Day]) -> Vec<String> {
    let (_, set) = tiers(company, days);
    let Some(rung) = rungs.iter().find(|rung| rung.tier == set) else { return Vec::new() };
    let Some((mean, peak)) = last_week(days).filter(|_| rung.units > 0.0) else {
        return vec![format!("tier {set} · {} units a day", compact(rung.units))];
    };
    let [mean, peak] = [mean, peak].map(|units| share(units, rung.units));
    let used = format!("tier {set} · used {mean}, peak {peak}");
    let coming = PeakProjection::of(&company.weeks).filter(|_| company.is_running());
    let Some(next) = coming else { return vec![used] };
    let (growth, next) = (next.growth_in_words(), share(next.next(), rung.units));
    vec![
        format!("{used} · next week {next} at last week's growth ({growth})"),
        format!("tier {set} · peak {peak} → {next} at last week's growth ({growth})"),
        format!("peak {peak} → {next} at last week's growth ({growth})"),
        format!("{next} next week at last week's growth"),
    ]
}

/// Returns the utilization of a tier in percent, capped at ten times its capacity.
fn share(units: f64, of: f64) -> String {
    match of {
        of if of <= 0.0 => "–".to_owned(),
        of if units >= 10.0 * of => "> 999%".to_owned(),
        of => percent(units / of, 0),
    }
}

/// The capacity tiers, with the usage history next to or below them if it fits.
pub struct Capacity;

impl ProductPart for Capacity {
    fn name(&self) -> ProductPane {
        ProductPane::Capacity
    }

    fn rows(&self, product: &Product, _: &Company) -> usize {
        product.rungs.len()
    }

    fn summary(&self, product: &Product, company: &Company, width: usize) -> String {
        fitting(summary(company, &product.rungs, &product.days), width)
    }

    fn destination(&self, _: &Product) -> &'static str {
        ToolId::SetCapacityTier.name()
    }

    fn open(&self, product: &Product, _: &Company) -> Effect {
        let rung = product.rungs.get(product.place(self.name()));
        tier(ToolId::SetCapacityTier, rung.map(|rung| rung.tier))
    }

    fn selected(&self, product: &Product, company: &Company) -> Option<Figure> {
        let tier = product.rungs.get(product.place(self.name()))?.tier;
        let sql = "SELECT day, total_usage_units, capacity_units, capacity_tier FROM service_day\n\
                   WHERE day > (SELECT max(day) FROM service_day) - 7 ORDER BY day DESC";
        let title = format!("usage of tier {tier} in the last week");
        let figure = Figure { title, term: "capacity-tier", sql: Some(sql.to_owned()), why: None };
        Some(figure.of_week(WeekQuantity::of_company(WeekFigure::Usage), company.seen.week))
    }

    fn paint(&self, product: &Product, canvas: &mut Canvas<'_>, seat: Seat, company: &Company) {
        let (area, rows) = (seat.area, product.rungs.len() as u16 + 1);
        let [list, history] = if area.height >= rows + 7 {
            Layout::vertical([Constraint::Length(rows), Constraint::Min(0)]).areas(area)
        } else if area.width >= 90 {
            Layout::horizontal([Constraint::Length(54), Constraint::Min(0)]).areas(area)
        } else {
            [area, Rect::default()]
        };
        draw_ladder(product, canvas, Seat { area: list, ..seat }, company);
        draw_history(canvas, history, &product.rungs, &product.days);
    }
}

fn draw_ladder(product: &Product, canvas: &mut Canvas<'_>, seat: Seat, company: &Company) {
    let (area, rungs, days) = (seat.area, &product.rungs, &product.days);
    let selected = product.place(ProductPane::Capacity);
    let head = format!("{:<6}{:>10}{:>10}{:>9}{:>9}{:>8}", "tier", "units/day", "$/day", "mean", "peak", "");
    canvas.text(area, &head, Role::Header);
    let (in_force, set) = tiers(company, days);
    let used = last_week(days);
    let below = Rect { y: area.y + 1, height: area.height.saturating_sub(1), ..area };
    if seat.focused {
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
        let role = match (seat.focused && at == selected, rung.tier == set, mark.starts_with('!')) {
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
        canvas.click(row, Click::Row(seat.number, at));
    }
}

fn draw_history(canvas: &mut Canvas<'_>, area: Rect, rungs: &[Rung], days: &[Day]) {
    let most = days.iter().map(|day| day.usage.max(day.capacity)).fold(0.0, f64::max);
    let (Some(first), Some(last)) = (days.first(), days.last()) else {
        return canvas.text(area, canvas.no_data, Role::Dim);
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
