//! Quality by group, and what each plan costs and earns.

use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};

use super::model::PlanFacts;
use crate::console::canvas::{Canvas, Click, rows_of};
use crate::console::company::Company;
use crate::console::text::number;
use crate::console::theme::Role;
use crate::console::widgets::table::first_row;
use crate::notation::{cents, compact, grouped, percent};
use crate::tools::ToolId;
use crate::world::identifiers::Plan;

/// Draws the components of quality, one group in a row.
pub fn draw_quality(
    canvas: &mut Canvas<'_>,
    area: Rect,
    company: &Company,
    selected: usize,
    focused: bool,
    pane: usize,
) {
    let (base, shared) = company.quality_base;
    let tier = |plan: &str| format!("{plan} T{}", number(company.setting(ToolId::SetModelTiers, plan)));
    let wide = area.width >= 62;
    let parts = if wide { format!(" {:>7} {:>8}", "base", "general") } else { String::new() };
    let head = format!("group {parts} {:>8} {:>9} {:>8} {:>8}", "own +", tier("A"), tier("B"), tier("C"));
    canvas.text(area, &head, Role::Header);
    let below = Rect { y: area.y + 1, height: area.height.saturating_sub(1), ..area };
    if focused {
        canvas.page = below.height.max(1);
    }
    let from = first_row(selected, below.height as usize, company.quality.len());
    for (row, (at, quality)) in rows_of(below).zip(company.quality.iter().enumerate().skip(from)) {
        let parts = if wide { format!(" {base:>7.4} {shared:>+8.4}") } else { String::new() };
        let own = match quality.group_bonus {
            bonus if bonus > 0.0 => format!("{bonus:+.4}"),
            _ => "–".to_owned(),
        };
        let [a, b, c] = quality.by_plan.0;
        let text = format!("{:<6}{parts} {own:>8} {a:>9.4} {b:>8.4} {c:>8.4}", quality.group.id());
        let role = match (focused && at == selected, quality.group_bonus > 0.0) {
            (true, _) => Role::Selection,
            (false, true) => Role::Text,
            (false, false) => Role::Dim,
        };
        canvas.clear(row, role);
        canvas.text(row, &text, role);
        canvas.click(row, Click::Row(pane, at));
    }
}

/// A figure of a plan: name, how it is written.
type Figure = (&'static str, fn(&PlanFacts) -> String);

fn or_none(value: Option<f64>, write: impl Fn(f64) -> String) -> String {
    value.map_or("–".to_owned(), write)
}

/// Figures of the plans, in the order of what is looked at first.
pub static FIGURES: [Figure; 11] = [
    ("model tier", |plan| format!("T{}", plan.tier)),
    ("price a month", |plan| cents(plan.price)),
    ("quota a day", |plan| compact(plan.quota)),
    ("unit cost, $/1k", |plan| format!("${}", grouped(plan.unit_cost * 1000.0, 3))),
    ("customers", |plan| grouped(plan.customers, 0)),
    ("billed seats", |plan| grouped(plan.seats, 0)),
    ("usage/seat, day", |plan| or_none(plan.usage(), |usage| grouped(usage, 1))),
    ("paid/seat, mo.", |plan| or_none(plan.revenue(), cents)),
    ("compute/seat, mo.", |plan| or_none(plan.compute(), cents)),
    ("gross margin", |plan| {
        // The sign stands beside the plan that loses, where no window cuts it.
        or_none(plan.margin(), |margin| {
            format!("{}{}", if margin < 0.0 { "! " } else { "" }, percent(margin, 1))
        })
    }),
    ("billed a month", |plan| format!("${}", compact(plan.monthly))),
];

/// Draws the plans as columns; a row leads to the tool that sets it.
pub fn draw_plans(
    canvas: &mut Canvas<'_>,
    area: Rect,
    plans: &[PlanFacts; 3],
    (selected, column): (usize, usize),
    focused: bool,
    pane: usize,
) {
    let line = |name: &str, cells: [String; 3]| {
        let [a, b, c] = cells;
        format!("{name:<18} {a:>10} {b:>10} {c:>10}")
    };
    canvas.text(area, &line("per plan", Plan::ALL.map(|plan| plan.id().to_owned())), Role::Header);
    let below = Rect { y: area.y + 1, height: area.height.saturating_sub(1), ..area };
    if focused {
        canvas.page = below.height.max(1);
    }
    let from = first_row(selected, below.height as usize, FIGURES.len());
    for (row, (at, (name, write))) in rows_of(below).zip(FIGURES.iter().enumerate().skip(from)) {
        let loses = *name == "gross margin"
            && plans.iter().any(|plan| plan.margin().is_some_and(|margin| margin < 0.0));
        let role = match (focused && at == selected, loses) {
            (true, _) => Role::Selection,
            (false, true) => Role::Bad,
            (false, false) => Role::Text,
        };
        canvas.clear(row, role);
        canvas.text(row, &line(name, [0, 1, 2].map(|plan| write(&plans[plan]))), role);
        if focused && at == selected {
            let place = Rect { x: row.x + 19 + 11 * column as u16, width: 10, ..row };
            let mark = Style::new().add_modifier(Modifier::BOLD | Modifier::UNDERLINED);
            canvas.buffer.set_style(place.intersection(row).intersection(canvas.area()), mark);
        }
        canvas.click(row, Click::Row(pane, at));
    }
}

/// The tool that sets what a row shows.
pub fn tool_of(row: usize) -> ToolId {
    match row {
        0 | 3 | 9 => ToolId::SetModelTiers,
        2 | 6 | 8 => ToolId::SetUsageQuotas,
        _ => ToolId::SetPrices,
    }
}
