//! Costs and revenue of each plan.

use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};

use super::model::PlanFacts;
use super::panel::{ProductPanel, show_cell_effect};
use super::{Product, ProductPane};
use crate::action::Action;
use crate::context::Figure;
use crate::effect::Effect;
use crate::screens::panes::PanePlacement;
use novamind_base::formatting::{dollars_and_cents, compact_number, grouped_number, percent};
use novamind_session::identifiers::Plan;
use novamind_tools::ToolId;
use novamind_tui::canvas::{Canvas, Click, row_rects};
use novamind_tui::text::first_fitting;
use novamind_tui::theme::Role;
use novamind_worker::company::DisplayedCompany;

/// Pane with a table that has plans as columns. Opening a row shows the tool that sets the values in this row.
pub struct PlansPane;

impl ProductPanel for PlansPane {
    fn id(&self) -> ProductPane {
        ProductPane::Plans
    }

    fn row_count(&self, _: &Product, _: &DisplayedCompany) -> usize {
        PLAN_FIGURES.len()
    }

    fn summary(&self, product: &Product, _: &DisplayedCompany, width: usize) -> String {
        let each = |write: fn(&PlanFacts) -> String| {
            let plans = Plan::ALL.iter().zip(&product.plans);
            plans.map(|(name, plan)| format!("{name} {}", write(plan))).collect::<Vec<_>>().join(", ")
        };
        let customers = each(|plan| grouped_number(plan.usage.customers, 0));
        if product.plans.iter().all(|plan| plan.margin().is_none()) {
            return first_fitting(
                [format!("no margin yet · customers {customers}"), "no margin yet".to_owned()],
                width,
            );
        }
        let margins = each(|plan| format_optional(plan.margin(), |margin| percent(margin, 0)));
        let wordings = [
            format!("margin at last day's usage {margins} · customers {customers}"),
            format!("margin at last day's usage {margins}"),
            format!("margin {margins}"),
        ];
        first_fitting(wordings, width)
    }

    fn note(&self, _: &Product, _: &DisplayedCompany, _: usize) -> String {
        "for seats with usage on the last day · 30 days a month".to_owned()
    }

    fn destination(&self, product: &Product) -> &'static str {
        row_tool(product.selected_row(self.id())).name()
    }

    fn open_effect(&self, product: &Product, _: &DisplayedCompany) -> Effect {
        show_cell_effect(row_tool(product.selected_row(self.id())), Some(product.plan().to_string()))
    }

    fn selected_figure(&self, product: &Product, _: &DisplayedCompany) -> Option<Figure> {
        Some(plan_figure(product.selected_row(self.id()), product.plan()))
    }

    fn move_sideways(&self, product: &mut Product, action: Action) -> bool {
        match action {
            Action::Left if product.selected_plan > 0 => product.selected_plan -= 1,
            Action::Right if product.selected_plan + 1 < Plan::ALL.len() => product.selected_plan += 1,
            _ => return false,
        }
        true
    }

    fn draw_content(&self, product: &Product, canvas: &mut Canvas<'_>, placement: PanePlacement, _: &DisplayedCompany) {
        let (area, plans, selected) = (placement.area, &product.plans, product.selected_row(self.id()));
        let line = |name: &str, cells: [String; 3]| {
            let [a, b, c] = cells;
            format!("{name:<18} {a:>10} {b:>10} {c:>10}")
        };
        canvas.draw_text(area, &line("per plan", Plan::ALL.map(|plan| plan.id().to_owned())), Role::Header);
        let below = Rect { y: area.y + 1, height: area.height.saturating_sub(1), ..area };
        if placement.focused {
            canvas.page_rows = below.height.max(1);
        }
        let from = canvas.scroll_to_row(below, selected, PLAN_FIGURES.len());
        for (row, (at, (name, write))) in row_rects(below).zip(PLAN_FIGURES.iter().enumerate().skip(from)) {
            let loses = *name == "gross margin"
                && plans.iter().any(|plan| plan.margin().is_some_and(|margin| margin < 0.0));
            let role = match (placement.focused && at == selected, loses) {
                (true, _) => Role::Selection,
                (false, true) => Role::Bad,
                (false, false) => Role::Text,
            };
            canvas.clear(row, role);
            canvas.draw_text(row, &line(name, [0, 1, 2].map(|plan| write(&plans[plan]))), role);
            if placement.focused && at == selected {
                let place = Rect { x: row.x + 19 + 11 * product.selected_plan as u16, width: 10, ..row };
                let mark = Style::new().add_modifier(Modifier::BOLD | Modifier::UNDERLINED);
                canvas.buffer.set_style(place.intersection(row).intersection(canvas.area()), mark);
            }
            canvas.register_click(row, Click::Row(placement.index, at));
        }
    }
}

/// Name and format of a figure of a plan.
type PlanFigure = (&'static str, fn(&PlanFacts) -> String);

fn format_optional(value: Option<f64>, write: impl Fn(f64) -> String) -> String {
    value.map_or("–".to_owned(), write)
}

/// Figures of plans in display order, the most important first.
static PLAN_FIGURES: [PlanFigure; 11] = [
    ("model tier", |plan| format!("T{}", plan.tier)),
    ("price/month", |plan| dollars_and_cents(plan.price)),
    ("quota/day", |plan| compact_number(plan.quota)),
    ("unit cost, $/1k", |plan| format!("${}", grouped_number(plan.unit_cost * 1000.0, 3))),
    ("customers", |plan| grouped_number(plan.usage.customers, 0)),
    ("billed seats", |plan| grouped_number(plan.usage.seats, 0)),
    ("usage/seat·day", |plan| format_optional(plan.usage.units_per_seat(), |usage| grouped_number(usage, 1))),
    ("paid/seat·mo.", |plan| format_optional(plan.usage.revenue_per_seat(), dollars_and_cents)),
    ("compute/seat·mo.", |plan| format_optional(plan.compute_cost_per_seat(), dollars_and_cents)),
    ("gross margin", |plan| {
        // A warning sign marks a plan with a negative margin. The sign is in the cell, because narrow windows cut off
        // notes.
        format_optional(plan.margin(), |margin| {
            format!("{}{}", if margin < 0.0 { "! " } else { "" }, percent(margin, 0))
        })
    }),
    ("billed/month", |plan| format!("${}", compact_number(plan.usage.monthly_revenue))),
];

/// Returns the tool that sets the values in a row.
fn row_tool(row: usize) -> ToolId {
    match row {
        0 | 3 | 9 => ToolId::SetModelTiers,
        2 | 6 | 8 => ToolId::SetUsageQuotas,
        _ => ToolId::SetPrices,
    }
}

/// Returns the figure in a row for a plan, with a query for its source rows.
fn plan_figure(row: usize, plan: Plan) -> Figure {
    let subscribers = || {
        Some(format!(
            "SELECT s.customer_id, c.group_id, s.effective_price, s.seat_count, s.start_day\n\
             FROM subscriptions s JOIN customers c USING (customer_id)\n\
             WHERE s.plan = '{plan}' AND s.status = 'subscribed' ORDER BY s.customer_id"
        ))
    };
    let usage = || {
        Some(format!(
            "SELECT u.customer_id, s.seat_count, u.usage_units\n\
             FROM daily_usage u JOIN subscriptions s USING (customer_id)\n\
             WHERE u.day = (SELECT max(day) FROM service_day) AND s.plan = '{plan}' AND s.status = 'subscribed'"
        ))
    };
    let setting =
        |column: &str| Some(format!("SELECT day, \"{column}_{plan}\" FROM config_history ORDER BY day"));
    let (name, term, sql) = match row {
        0 => ("model tier", "model-tier", setting("tier")),
        1 => ("price", "list-price", setting("price")),
        2 => ("quota", "quota", setting("quota")),
        3 => ("unit cost", "compute", setting("tier")),
        4 => ("customers", "subscriber", subscribers()),
        5 => ("billed seats", "billed-seats", subscribers()),
        6 => ("usage per seat", "usage", usage()),
        7 => ("payment per seat", "effective-price", subscribers()),
        8 => ("compute per seat", "compute", usage()),
        9 => ("gross margin", "gross-margin", subscribers()),
        _ => ("billed per month", "billed-seats", subscribers()),
    };
    Figure { title: format!("{name} of plan {plan}"), term, sql, week_quantity: None }
}
