//! Fit of the open or selected group: its participation curve with the plans, estimated and measured conversion, and each plan
//! compared with the estimated needs.

use ratatui::layout::Rect;

use super::Customers;
use super::selection::show_rows_effect;
use crate::action::Action;
use crate::context::{Figure, ScreenContext};
use crate::curve_chart::{MIN_CHART_ROWS, draw_curve_chart};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_base::formatting::{compact_number, percent, price_to_cents, quality as format_quality};
use novamind_insight::{CurveExplorer, LEAD_SAMPLE_SIZE, WeekQuantity};
use novamind_record::figures::WeekFigure;
use novamind_report::curve::{describe_omissions, describe_outcome};
use novamind_report::fit::{RangePosition, FitCriterion, Fit};
use novamind_session::identifiers::Plan;
use novamind_tools::{Rejection, ToolId};
use novamind_tui::canvas::{Canvas, row_rects};
use novamind_tui::text::{format_number, wrap};
use novamind_tui::theme::Role;

const NAME_WIDTH: usize = 8;
/// Minimum height and width of the pane for a chart above the text.
const MIN_ROWS_WITH_CHART: u16 = 10;
const MIN_CHART_WIDTH: u16 = 30;

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
        customers.group_state.fit_scroll.handle_action(action, context.page_rows.into());
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
        let (area, curve) = (placement.area, customers.curve.of_group(fit.group));
        let has_chart = has_room_for_chart(area) && matches!(curve, Some(Ok(_)));
        let state = CurveState { curve, is_requested: customers.curve.is_requested(fit.group), has_chart };
        let lines = fit_lines(fit, &state, area.width as usize, &tier);
        let chart = match curve {
            Some(Ok(explorer)) => {
                let rows = chart_rows(area, lines.len());
                let chart = Rect { height: rows, ..area };
                draw_curve_chart(canvas, chart, explorer, &explorer.plans, |_| true);
                rows
            }
            _ => 0,
        };
        let text = Rect { y: area.y + chart, height: area.height - chart, ..area };
        let from = match placement.focused {
            true => {
                canvas.page_rows = text.height.max(1);
                customers.group_state.fit_scroll.scroll_rows(canvas, text, lines.len())
            }
            false => 0,
        };
        for (row, line) in row_rects(text).zip(&lines[from..]) {
            canvas.draw_text(row, &line.text, line.role);
        }
    }
}

fn has_room_for_chart(area: Rect) -> bool {
    area.height >= MIN_ROWS_WITH_CHART && area.width >= MIN_CHART_WIDTH
}

/// Returns the height of the chart above `lines` lines of text, or 0 if the area is too small for a chart.
fn chart_rows(area: Rect, lines: usize) -> u16 {
    if !has_room_for_chart(area) {
        return 0;
    }
    let rest = area.height.saturating_sub(lines as u16);
    rest.max(area.height / 2).max(MIN_CHART_ROWS)
}

struct FitLine {
    text: String,
    role: Role,
}

/// The state of the participation curve of the group.
struct CurveState<'a> {
    curve: Option<&'a Result<CurveExplorer, Rejection>>,
    /// Whether a missing curve will arrive.
    is_requested: bool,
    /// Whether the chart of the curve is drawn above the text.
    has_chart: bool,
}

/// Returns all lines of the pane, at most `width` columns wide: the estimated and the measured conversion, the needs of
/// the group, the plans, and the leads.
fn fit_lines(fit: &Fit, state: &CurveState<'_>, width: usize, tier: &dyn Fn(Plan) -> String) -> Vec<FitLine> {
    let CurveState { curve, is_requested, has_chart } = *state;
    let company = fit.group.is_enterprise();
    let mut lines = Vec::new();
    let mut add_rows = |name: &str, text: &str, role: Role| {
        for (at, text) in wrap(text, width.saturating_sub(NAME_WIDTH + 1)).into_iter().enumerate() {
            let name = if at == 0 { name } else { "" };
            lines.push(FitLine { text: format!("{name:<NAME_WIDTH$} {text}"), role });
        }
    };
    match curve {
        Some(Ok(explorer)) => {
            let outcome = explorer.outcome_for_plans(&explorer.plans);
            add_rows("signups", &describe_outcome(&outcome), Role::Strong);
        }
        Some(Err(refusal)) => add_rows("signups", &refusal.message, Role::Dim),
        None if is_requested => add_rows("signups", &format!("asking {LEAD_SAMPLE_SIZE} sampled leads …"), Role::Dim),
        None => {}
    }
    let name = if curve.is_none() && !is_requested { "signups" } else { "" };
    add_rows(name, &fit.measured.describe(), Role::Strong);
    if let Some(Ok(explorer)) = curve {
        add_rows("", &describe_omissions(explorer), Role::Dim);
    }
    let (seat, smallest) = if company { (" a seat", " (smallest)") } else { ("", "") };
    let needs = format!(
        "quality required {} · budget {}{seat} · quota {} units a day{smallest}",
        fit.floor.format_quality(),
        fit.budget.format_money(),
        fit.usage.format_units()
    );
    add_rows("needs", &needs, Role::Header);
    for plan in Plan::ALL {
        let role = match FitCriterion::ALL.iter().any(|concern| fit.certain_gap(plan, *concern).is_some()) {
            true => Role::Bad,
            false => Role::Text,
        };
        add_rows(&format!("{plan} T{}", tier(plan)), &describe_plan_fit(fit, plan), role);
    }
    match fit.last_week {
        Some(week) => {
            add_rows("leads", &format!("last week: {}", week.describe()), Role::Text);
            add_rows("", &format!("last 4 weeks: {}", fit.recent.describe()), Role::Text);
        }
        None => add_rows("leads", "no week has been simulated", Role::Dim),
    }
    let legend = match has_chart {
        true => ": the curve is the quality that half of the leads accept at a price, the shaded area is 10 to 90 %.",
        false => ".",
    };
    add_rows(
        "",
        &format!(
            "Needs are the ranges of the group's true means: each estimate is within {} of its true value. Customers \
             differ, and require more quality at a higher price{legend}",
            percent(fit.max_relative_error, 0)
        ),
        Role::Dim,
    );
    lines
}

/// Compares a plan with the needs of the group: `quality 0.120: 0.061 short · price $12: below budget · quota 2.00k: enough`.
fn describe_plan_fit(fit: &Fit, plan: Plan) -> String {
    let plan_fit = &fit.plans[plan];
    if plan_fit.list_price <= 0.0 {
        return format!("quality {} · no price", format_quality(plan_fit.quality));
    }
    let discounted = if plan_fit.lead_price < plan_fit.list_price { " for leads" } else { "" };
    format!(
        "quality {}: {} · price {}{discounted}: {} · quota {}: {}",
        format_quality(plan_fit.quality),
        fit_verdict(fit, plan, FitCriterion::Quality),
        price_to_cents(plan_fit.lead_price),
        fit_verdict(fit, plan, FitCriterion::Price),
        compact_number(plan_fit.quota),
        fit_verdict(fit, plan, FitCriterion::Quota)
    )
}

/// Describes whether a plan meets a requirement.
fn fit_verdict(fit: &Fit, plan: Plan, concern: FitCriterion) -> String {
    if let Some(missing) = fit.certain_gap(plan, concern) {
        return match concern {
            FitCriterion::Price => format!("{} over", price_to_cents(missing)),
            FitCriterion::Quality => format!("{} short", format_quality(missing)),
            FitCriterion::Quota => format!("{} short", compact_number(missing.ceil())),
        };
    }
    let verdict = match fit.position(plan, concern) {
        None => "negotiated",
        Some(RangePosition::InRange) => "in range",
        Some(_) if concern == FitCriterion::Price => "below budget",
        Some(_) => "enough",
    };
    verdict.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chart_takes_the_rows_that_the_text_leaves_and_at_least_half() {
        let area = |height| Rect::new(0, 0, 60, height);
        assert_eq!((chart_rows(area(9), 5), chart_rows(area(12), 20)), (0, 6));
        assert_eq!((chart_rows(area(40), 10), chart_rows(Rect::new(0, 0, 20, 40), 10)), (30, 0));
    }
}
