//! Costs and revenue of each plan.

use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};

use super::model::PlanFacts;
use super::part::{ProductPart, cell};
use super::{Product, ProductPane};
use crate::action::Action;
use crate::context::Figure;
use crate::effect::Effect;
use crate::screens::panes::Seat;
use novamind_base::notation::{cents, compact, grouped, percent};
use novamind_session::identifiers::Plan;
use novamind_tools::ToolId;
use novamind_tui::canvas::{Canvas, Click, rows_of};
use novamind_tui::text::fitting;
use novamind_tui::theme::Role;
use novamind_tui::widgets::table::first_row;
use novamind_worker::company::Company;

/// Table with plans as columns. A row opens the tool that sets it.
pub struct Plans;

impl ProductPart for Plans {
    fn name(&self) -> ProductPane {
        ProductPane::Plans
    }

    fn rows(&self, _: &Product, _: &Company) -> usize {
        FIGURES.len()
    }

    fn summary(&self, product: &Product, _: &Company, width: usize) -> String {
        let each = |write: fn(&PlanFacts) -> String| {
            let plans = Plan::ALL.iter().zip(&product.plans);
            plans.map(|(name, plan)| format!("{name} {}", write(plan))).collect::<Vec<_>>().join(", ")
        };
        let customers = each(|plan| grouped(plan.sold.customers, 0));
        if product.plans.iter().all(|plan| plan.margin().is_none()) {
            return fitting(
                [format!("no margin yet · customers {customers}"), "no margin yet".to_owned()],
                width,
            );
        }
        let margins = each(|plan| or_none(plan.margin(), |margin| percent(margin, 0)));
        let wordings = [
            format!("margin at last-day usage {margins} · customers {customers}"),
            format!("margin at last-day usage {margins}"),
            format!("margin {margins}"),
        ];
        fitting(wordings, width)
    }

    fn note(&self, _: &Product, _: &Company, _: usize) -> String {
        "for seats with usage on the last day, 30 days a month".to_owned()
    }

    fn destination(&self, product: &Product) -> &'static str {
        tool_of(product.place(self.name())).name()
    }

    fn open(&self, product: &Product, _: &Company) -> Effect {
        cell(tool_of(product.place(self.name())), Some(product.plan().to_string()))
    }

    fn selected(&self, product: &Product, _: &Company) -> Option<Figure> {
        Some(figure_of(product.place(self.name()), product.plan()))
    }

    fn turn(&self, product: &mut Product, action: Action) -> bool {
        match action {
            Action::Left if product.column > 0 => product.column -= 1,
            Action::Right if product.column + 1 < Plan::ALL.len() => product.column += 1,
            _ => return false,
        }
        true
    }

    fn paint(&self, product: &Product, canvas: &mut Canvas<'_>, seat: Seat, _: &Company) {
        let (area, plans, selected) = (seat.area, &product.plans, product.place(self.name()));
        let line = |name: &str, cells: [String; 3]| {
            let [a, b, c] = cells;
            format!("{name:<18} {a:>10} {b:>10} {c:>10}")
        };
        canvas.text(area, &line("per plan", Plan::ALL.map(|plan| plan.id().to_owned())), Role::Header);
        let below = Rect { y: area.y + 1, height: area.height.saturating_sub(1), ..area };
        if seat.focused {
            canvas.page = below.height.max(1);
        }
        let from = first_row(selected, below.height as usize, FIGURES.len());
        for (row, (at, (name, write))) in rows_of(below).zip(FIGURES.iter().enumerate().skip(from)) {
            let loses = *name == "gross margin"
                && plans.iter().any(|plan| plan.margin().is_some_and(|margin| margin < 0.0));
            let role = match (seat.focused && at == selected, loses) {
                (true, _) => Role::Selection,
                (false, true) => Role::Bad,
                (false, false) => Role::Text,
            };
            canvas.clear(row, role);
            canvas.text(row, &line(name, [0, 1, 2].map(|plan| write(&plans[plan]))), role);
            if seat.focused && at == selected {
                let place = Rect { x: row.x + 19 + 11 * product.column as u16, width: 10, ..row };
                let mark = Style::new().add_modifier(Modifier::BOLD | Modifier::UNDERLINED);
                canvas.buffer.set_style(place.intersection(row).intersection(canvas.area()), mark);
            }
            canvas.click(row, Click::Row(seat.number, at));
        }
    }
}

/// Name and format of a figure.
type PlanFigure = (&'static str, fn(&PlanFacts) -> String);

fn or_none(value: Option<f64>, write: impl Fn(f64) -> String) -> String {
    value.map_or("–".to_owned(), write)
}

/// Figures in display order, most used first.
static FIGURES: [PlanFigure; 11] = [
    ("model tier", |plan| format!("T{}", plan.tier)),
    ("price/month", |plan| cents(plan.price)),
    ("quota/day", |plan| compact(plan.quota)),
    ("unit cost, $/1k", |plan| format!("${}", grouped(plan.unit_cost * 1000.0, 3))),
    ("customers", |plan| grouped(plan.sold.customers, 0)),
    ("billed seats", |plan| grouped(plan.sold.seats, 0)),
    ("usage/seat, day", |plan| or_none(plan.sold.usage(), |usage| grouped(usage, 1))),
    ("paid/seat, mo.", |plan| or_none(plan.sold.revenue(), cents)),
    ("compute/seat, mo.", |plan| or_none(plan.compute(), cents)),
    ("gross margin", |plan| {
        // The warning sign is on the losing plan, where narrow windows do not cut it.
        or_none(plan.margin(), |margin| {
            format!("{}{}", if margin < 0.0 { "! " } else { "" }, percent(margin, 1))
        })
    }),
    ("billed/month", |plan| format!("${}", compact(plan.sold.monthly))),
];

/// Returns the tool that sets the value of a row.
fn tool_of(row: usize) -> ToolId {
    match row {
        0 | 3 | 9 => ToolId::SetModelTiers,
        2 | 6 | 8 => ToolId::SetUsageQuotas,
        _ => ToolId::SetPrices,
    }
}

/// Returns the figure of a row and plan, with a query for its rows.
fn figure_of(row: usize, plan: Plan) -> Figure {
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
    Figure { title: format!("{name} of plan {plan}"), term, sql, why: None }
}
