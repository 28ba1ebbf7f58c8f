//! Capacity tiers and their utilization.

use ratatui::layout::{Constraint, Layout, Rect};

use super::model::{ServiceDay, CapacityTier, last_week};
use super::panel::{ProductPanel, prefill_tier_effect};
use super::{Product, ProductPane};
use crate::context::Figure;
use crate::effect::Effect;
use crate::screens::panes::PanePlacement;
use novamind_base::formatting::{compact_number, dollars, percent};
use novamind_insight::WeekQuantity;
use novamind_record::figures::WeekFigure;
use novamind_report::peak::PeakProjection;
use novamind_tools::ToolId;
use novamind_tui::canvas::{Canvas, Click, row_rects};
use novamind_tui::text::first_fitting;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{XAxis, Curve, YAxis, AxisUnit, draw_chart};
use novamind_worker::company::DisplayedCompany;

/// Returns the capacity tier of the last day and the capacity tier of the current setting.
pub fn used_and_set_tiers(company: &DisplayedCompany, days: &[ServiceDay]) -> (Option<u32>, u32) {
    (days.last().map(|day| day.tier), company.current_setting(ToolId::SetCapacityTier, "tier") as u32)
}

/// Returns one-line summaries of capacity, the longest first.
fn summary(company: &DisplayedCompany, all_tiers: &[CapacityTier], days: &[ServiceDay]) -> Vec<String> {
    let (_, set) = used_and_set_tiers(company, days);
    let Some(tier_facts) = all_tiers.iter().find(|tier_facts| tier_facts.tier == set) else { return Vec::new() };
    let Some((mean, peak)) = last_week(days).filter(|_| tier_facts.units > 0.0) else {
        return vec![format!("tier {set} · {} units a day", compact_number(tier_facts.units))];
    };
    let [mean, peak] = [mean, peak].map(|units| capacity_share(units, tier_facts.units));
    let used = format!("tier {set} · used {mean}, peak {peak}");
    let coming = PeakProjection::from_weeks(&company.weeks).filter(|_| company.is_running());
    let Some(next) = coming else { return vec![used] };
    let (growth, next) = (next.format_growth(), capacity_share(next.next_peak(), tier_facts.units));
    vec![
        format!("{used} · next week {next} at last week's growth ({growth})"),
        format!("tier {set} · peak {peak} → {next} at last week's growth ({growth})"),
        format!("peak {peak} → {next} at last week's growth ({growth})"),
        format!("{next} next week at last week's growth"),
    ]
}

/// Formats the utilization of a tier in percent. If the usage is at least ten times the capacity, a lower bound is
/// shown instead.
fn capacity_share(units: f64, of: f64) -> String {
    match of {
        of if of <= 0.0 => "–".to_owned(),
        of if units >= 10.0 * of => "> 999%".to_owned(),
        of => percent(units / of, 0),
    }
}

/// Pane with the capacity tiers. The usage history is next to or below the tiers if it fits.
pub struct CapacityPane;

impl ProductPanel for CapacityPane {
    fn id(&self) -> ProductPane {
        ProductPane::Capacity
    }

    fn row_count(&self, product: &Product, _: &DisplayedCompany) -> usize {
        product.capacity_tiers.len()
    }

    fn summary(&self, product: &Product, company: &DisplayedCompany, width: usize) -> String {
        first_fitting(summary(company, &product.capacity_tiers, &product.days), width)
    }

    fn destination(&self, _: &Product) -> &'static str {
        ToolId::SetCapacityTier.name()
    }

    fn open_effect(&self, product: &Product, _: &DisplayedCompany) -> Effect {
        let tier_facts = product.capacity_tiers.get(product.selected_row(self.id()));
        prefill_tier_effect(ToolId::SetCapacityTier, tier_facts.map(|tier_facts| tier_facts.tier))
    }

    fn selected_figure(&self, product: &Product, company: &DisplayedCompany) -> Option<Figure> {
        let tier = product.capacity_tiers.get(product.selected_row(self.id()))?.tier;
        let sql = "SELECT day, total_usage_units, capacity_units, capacity_tier FROM service_day\n\
                   WHERE day > (SELECT max(day) FROM service_day) - 7 ORDER BY day DESC";
        let title = format!("usage of tier {tier} in the last week");
        let figure = Figure { title, term: "capacity-tier", sql: Some(sql.to_owned()), week_quantity: None };
        Some(figure.with_week_quantity(WeekQuantity::for_company(WeekFigure::Usage), company.observation.week))
    }

    fn draw_content(&self, product: &Product, canvas: &mut Canvas<'_>, placement: PanePlacement, company: &DisplayedCompany) {
        let (area, rows) = (placement.area, product.capacity_tiers.len() as u16 + 1);
        let [list, history] = if area.height >= rows + 7 {
            Layout::vertical([Constraint::Length(rows), Constraint::Min(0)]).areas(area)
        } else if area.width >= 90 {
            Layout::horizontal([Constraint::Length(54), Constraint::Min(0)]).areas(area)
        } else {
            [area, Rect::default()]
        };
        draw_tiers(product, canvas, PanePlacement { area: list, ..placement }, company);
        draw_history(canvas, history, &product.capacity_tiers, &product.days);
    }
}

fn draw_tiers(product: &Product, canvas: &mut Canvas<'_>, placement: PanePlacement, company: &DisplayedCompany) {
    let (area, all_tiers, days) = (placement.area, &product.capacity_tiers, &product.days);
    let selected = product.selected_row(ProductPane::Capacity);
    let head = format!("{:<6}{:>10}{:>10}{:>9}{:>9}{:>8}", "tier", "units/day", "$/day", "mean", "peak", "");
    canvas.draw_text(area, &head, Role::Header);
    let (in_force, set) = used_and_set_tiers(company, days);
    let used = last_week(days);
    let below = Rect { y: area.y + 1, height: area.height.saturating_sub(1), ..area };
    if placement.focused {
        canvas.page_rows = below.height.max(1);
    }
    let from = canvas.scroll_to_row(below, selected, all_tiers.len());
    for (row, (at, tier_facts)) in row_rects(below).zip(all_tiers.iter().enumerate().skip(from)) {
        let (mean, peak) = used.map_or(("–".to_owned(), "–".to_owned()), |(mean, peak)| {
            (capacity_share(mean, tier_facts.units), capacity_share(peak, tier_facts.units))
        });
        let mark = match tier_facts.tier {
            tier if Some(tier) == in_force && tier == set => "◆ now",
            tier if Some(tier) == in_force => "◆ until next day",
            tier if tier == set => "▸ set",
            _ if used.is_some_and(|(_, peak)| peak > tier_facts.units) => "! too small",
            _ => "",
        };
        let role = match (placement.focused && at == selected, tier_facts.tier == set, mark.starts_with('!')) {
            (true, ..) => Role::Selection,
            (_, true, _) => Role::Strong,
            (_, _, true) => Role::Dim,
            _ => Role::Text,
        };
        canvas.clear(row, role);
        let text = format!(
            "{:<6}{:>10}{:>10}{mean:>9}{peak:>9}  {mark}",
            tier_facts.tier,
            compact_number(tier_facts.units),
            dollars(tier_facts.cost)
        );
        canvas.draw_text(row, &text, role);
        canvas.register_click(row, Click::Row(placement.index, at));
    }
}

fn draw_history(canvas: &mut Canvas<'_>, area: Rect, all_tiers: &[CapacityTier], days: &[ServiceDay]) {
    let most = days.iter().map(|day| day.usage.max(day.capacity)).fold(0.0, f64::max);
    let (Some(first), Some(last)) = (days.first(), days.last()) else {
        return canvas.draw_text(area, canvas.empty_chart_text, Role::Dim);
    };
    let step = (f64::from(last.day - first.day) / 24.0).max(1.0);
    let near = all_tiers.iter().filter(|tier_facts| tier_facts.units > most / 20.0 && tier_facts.units <= most);
    let dotted = |tier_facts: &CapacityTier| {
        let days = (0..=24).map(|at| f64::from(first.day) + step * f64::from(at));
        let days = days.filter(|day| *day <= f64::from(last.day));
        Curve { is_scatter: true, ..Curve::from_points(days.map(|day| (day, tier_facts.units)).collect(), Role::Dim) }
    };
    let tiers: Vec<String> =
        near.clone().map(|tier_facts| format!("{} {}", tier_facts.tier, compact_number(tier_facts.units))).collect();
    let words = format!("usage below capacity; dotted: tier {}", tiers.join(", "));
    let key = Rect { height: u16::from(area.height >= 8), ..area };
    canvas.draw_text(key, &words, Role::Dim);
    let area = Rect { y: area.y + key.height, height: area.height - key.height, ..area };
    let dotted: Vec<Curve> = near.map(dotted).collect();
    let points = |value: fn(&ServiceDay) -> f64| days.iter().map(|day| (f64::from(day.day), value(day))).collect();
    let curves = [
        Curve::from_points(points(|day| day.capacity), Role::Warning),
        Curve::from_points(points(|day| day.usage), Role::Series(0)),
    ];
    let lines: Vec<Curve> = dotted.into_iter().chain(curves).collect();
    let x = XAxis { format: &|day| format!("day {day:.0}"), required_values: &[] };
    draw_chart(canvas, area, &lines, &x, &YAxis { unit: AxisUnit::Number, required_values: &[0.0] });
}
