//! Fit of the open group: each plan compared with the estimated requirements, the leads, and the gaps of each plan.

use ratatui::layout::Rect;

use super::Customers;
use super::selection::{move_index, show_rows_effect};
use crate::action::Action;
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_base::formatting::{compact_number, percent, price_to_cents};
use novamind_insight::WeekQuantity;
use novamind_record::figures::WeekFigure;
use novamind_report::fit::{RangePosition, FitCriterion, Fit, TrueValueRange};
use novamind_session::identifiers::Plan;
use novamind_tools::ToolId;
use novamind_tui::canvas::{Canvas, row_rects};
use novamind_tui::text::{format_number, wrap};
use novamind_tui::theme::Role;

const NAME_WIDTH: usize = 8;

pub struct FitPane;

impl Pane<Customers> for FitPane {
    fn hints(&self, _: &Customers) -> Vec<Action> {
        vec![Action::Open, Action::FocusNext, Action::Close]
    }

    fn figure(&self, customers: &Customers, context: &ScreenContext<'_>) -> Option<Figure> {
        let group = customers.group(context.company)?;
        let sql = format!(
            "SELECT (c.created_day + 6) / 7 AS week, c.acquisition_source = 'network' AS by_word_of_mouth, count(*) AS \
             leads,\n    total(s.status IN ('subscribed', 'cancelled')) AS signed\nFROM customers c\nLEFT JOIN subscriptions s \
             ON s.customer_id = c.customer_id\nWHERE c.group_id = '{group}'\nGROUP BY 1, 2\nORDER BY 1 DESC, 2"
        );
        let title = format!("fit of {group} and its leads by week");
        // Enterprises sign weeks after they arrive, so the conversion of enterprises in one week is meaningless.
        let quantity =
            WeekQuantity::for_group(WeekFigure::Conversion, group).filter(|_| !group.is_enterprise());
        let figure = Figure { title, term: "fit", sql: Some(sql), week_quantity: None };
        Some(figure.with_week_quantity(quantity, context.company.observation.week))
    }

    fn handle_action(&self, customers: &mut Customers, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        if action == Action::Open {
            return show_rows_effect(self.figure(customers, context));
        }
        customers.group_state.fit_line = move_index(customers.group_state.fit_line, usize::MAX - 1, action);
        Vec::new()
    }

    fn border(&self, customers: &Customers, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let fit = customers.group(context.company).and_then(|group| context.company.fit(group));
        fit.map_or_else(PaneBorder::default, |fit| PaneBorder {
            title: format!("Fit of {}", fit.group),
            note: format!("study level {} · {}", fit.level, fit.describe_study_day()),
            ..PaneBorder::default()
        })
    }

    fn draw(&self, customers: &Customers, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let company = context.company;
        let Some(fit) = customers.group(company).and_then(|group| company.fit(group)) else { return };
        let tier = |plan: Plan| format_number(company.current_setting(ToolId::SetModelTiers, plan.id()));
        let lines = fit_lines(fit, placement.area.width as usize, &tier);
        let last = lines.len().saturating_sub(placement.area.height as usize);
        let from = if placement.focused { customers.group_state.fit_line.min(last) } else { 0 };
        for (row, line) in row_rects(placement.area).zip(&lines[from..]) {
            canvas.draw_text(row, &line.text, line.role);
        }
    }
}

struct FitLine {
    text: String,
    role: Role,
}

fn styled_line(text: String, role: Role) -> FitLine {
    FitLine { text, role }
}

/// Returns all lines of the pane, at most `width` columns wide.
fn fit_lines(fit: &Fit, width: usize, tier: &dyn Fn(Plan) -> String) -> Vec<FitLine> {
    let company = fit.group.is_enterprise();
    let mut lines = vec![styled_line(format!("quality  required {}", fit.floor.format_quality()), Role::Header)];
    let qualities = Plan::ALL.map(|plan| fit.plans[plan].quality);
    lines.extend(Plan::ALL.map(|plan| {
        let name = format!("T{}", tier(plan));
        let shown = format!("{:.4}", fit.plans[plan].quality);
        bar_line(fit, (plan, FitCriterion::Quality), (&name, &shown), (fit.floor, &qualities), width)
    }));
    let per = if company { " a seat" } else { "" };
    lines.push(styled_line(format!("price    budget {}{per}", fit.budget.format_money()), Role::Header));
    let prices = Plan::ALL.map(|plan| fit.plans[plan].lead_price);
    lines.extend(Plan::ALL.map(|plan| {
        let plan_fit = &fit.plans[plan];
        let name = if plan_fit.lead_price < plan_fit.list_price { "lead" } else { "list" };
        bar_line(
            fit,
            (plan, FitCriterion::Price),
            (name, &price_to_cents(plan_fit.lead_price)),
            (fit.budget, &prices),
            width,
        )
    }));
    let smallest = if company { " (smallest)" } else { "" };
    lines.push(styled_line(format!("quota    typically {} units a day{smallest}", fit.usage.format_units()), Role::Header));
    let quotas = Plan::ALL.map(|plan| format!("{plan} {}", compact_number(fit.plans[plan].quota)));
    lines.push(styled_line(format!(" {} a day", quotas.join(" · ")), shared_role(fit, FitCriterion::Quota)));
    let mut add_rows = |name: &str, text: &str, role: Role| {
        for (at, text) in wrap(text, width.saturating_sub(NAME_WIDTH + 1)).into_iter().enumerate() {
            let name = if at == 0 { name } else { "" };
            lines.push(styled_line(format!("{name:<NAME_WIDTH$} {text}"), role));
        }
    };
    match fit.last_week {
        Some(week) => {
            add_rows("leads", &format!("last week: {}", week.describe()), Role::Text);
            add_rows("", &format!("last 4 weeks: {}", fit.recent.describe()), Role::Text);
        }
        None => add_rows("leads", "no week has been simulated", Role::Dim),
    }
    for plan in Plan::ALL {
        let name = if plan == Plan::A { "missing" } else { "" };
        let role = match FitCriterion::ALL.iter().any(|concern| fit.certain_gap(plan, *concern).is_some()) {
            true => Role::Bad,
            false => Role::Text,
        };
        add_rows(name, &format!("{plan} {}", fit.describe_gaps(plan)), role);
    }
    add_rows("", "█ reached · ▓ reached, in the range · ▒ rest of the range", Role::Dim);
    add_rows(
        "",
        &format!(
            "Ranges are for the group's means (±{}). Customers require more quality at a higher price.",
            percent(fit.max_relative_error, 0)
        ),
        Role::Dim,
    );
    lines
}

/// Returns the display role of a line that describes all plans.
fn shared_role(fit: &Fit, concern: FitCriterion) -> Role {
    match Plan::ALL.iter().any(|plan| fit.certain_gap(*plan, concern).is_some()) {
        true => Role::Bad,
        false => Role::Text,
    }
}

/// Returns a line that compares a plan with a range: `A T1 ███▒▒▒▒  0.1200 short 0.0610`.
fn bar_line(
    fit: &Fit,
    (plan, concern): (Plan, FitCriterion),
    (name, shown): (&str, &str),
    (range, figures): (TrueValueRange, &[f64; 3]),
    width: usize,
) -> FitLine {
    let figure = figures[plan.index()];
    let most = figures.iter().copied().fold(range.most, f64::max);
    let (verdict, role) = fit_verdict(fit, plan, concern);
    let cells = width.saturating_sub(33).clamp(4, 60);
    let bar = if fit.plans[plan].list_price > 0.0 || concern == FitCriterion::Quality {
        range_bar(figure, range, most, cells)
    } else {
        " ".repeat(cells)
    };
    styled_line(format!(" {plan} {name:<4} {bar} {shown:>9} {verdict}"), role)
}

/// Returns a bar up to a figure, followed by the part of the range above the figure.
fn range_bar(figure: f64, range: TrueValueRange, most: f64, cells: usize) -> String {
    let per_cell = if most > 0.0 { most / cells as f64 } else { 1.0 };
    let cell = |at: usize| {
        let value = (at as f64 + 0.5) * per_cell;
        match (value <= figure, range.position_of(value)) {
            (true, RangePosition::InRange) => '▓',
            (true, _) => '█',
            (false, RangePosition::InRange) => '▒',
            (false, _) => ' ',
        }
    };
    (0..cells).map(cell).collect()
}

/// Compares a plan with a requirement. Returns a text and its display role.
fn fit_verdict(fit: &Fit, plan: Plan, concern: FitCriterion) -> (String, Role) {
    if fit.plans[plan].list_price <= 0.0 {
        return ("no price".to_owned(), Role::Dim);
    }
    if let Some(missing) = fit.certain_gap(plan, concern) {
        return match concern {
            FitCriterion::Price => (format!("over {}", price_to_cents(missing)), Role::Bad),
            _ => (format!("short {missing:.4}"), Role::Bad),
        };
    }
    match fit.position(plan, concern) {
        None => ("negotiated".to_owned(), Role::Dim),
        Some(RangePosition::InRange) => ("in range".to_owned(), Role::Text),
        Some(_) if concern == FitCriterion::Price => ("below budget".to_owned(), Role::Good),
        Some(_) => ("enough".to_owned(), Role::Good),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn range_bar_marks_the_reached_part() {
        let range = TrueValueRange { least: 0.2, most: 0.8 };
        assert_eq!(range_bar(0.1, range, 1.0, 10), "█ ▒▒▒▒▒▒  ");
        assert_eq!(range_bar(0.5, range, 1.0, 10), "██▓▓▓▒▒▒  ");
        assert_eq!(range_bar(1.0, range, 1.0, 10), "██▓▓▓▓▓▓██");
        assert_eq!(range_bar(0.0, TrueValueRange { least: 0.0, most: 0.0 }, 0.0, 3), "   ");
    }
}
