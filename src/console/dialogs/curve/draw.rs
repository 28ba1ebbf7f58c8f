//! Draws the curve explorer: the plans, the responses of leads, and the curve.

use ratatui::layout::Rect;

use super::{CurveDialog, CurveExploration};
use crate::action::Action;
use crate::context::ScreenContext;
use crate::curve_chart::{MIN_CHART_ROWS, draw_curve_chart};
use crate::dialogs::Dialog;
use novamind_base::formatting::price_to_cents;
use novamind_insight::{LEAD_SAMPLE_SIZE, PlanPoint};
use novamind_report::curve::{
    describe_basis, describe_conversion_briefly, describe_omissions, describe_omissions_briefly,
    describe_outcome, describe_plan, format_quality,
};
use novamind_session::identifiers::Plan;
use novamind_tui::canvas::{Canvas, Click, centered_rect, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;

const MAX_DIALOG_WIDTH: u16 = 140;
const MIN_ROWS_FOR_PLAN_LINES: u16 = 12;
const MIN_ROWS_FOR_LEGEND: u16 = 14;
const MIN_ROWS_FOR_OMISSIONS: u16 = 9;

impl CurveDialog {
    pub(super) fn draw_page(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let dialog_area = centered_rect(
            area,
            area.width.saturating_sub(2).min(MAX_DIALOG_WIDTH),
            area.height.saturating_sub(2),
        );
        canvas.clear(dialog_area, Role::Text);
        let note = self
            .successful_exploration()
            .map_or(String::new(), |opened| describe_basis(&opened.explorer.basis));
        let title = match dialog_area.width {
            ..78 => format!("Curve of {}", self.group),
            _ => format!("Participation curve of {}", self.group),
        };
        let inside = canvas.draw_pane_frame(dialog_area, &title, &note, true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        match &self.exploration {
            None => canvas.draw_text(inside, &format!("asking {LEAD_SAMPLE_SIZE} leads …"), Role::Warning),
            Some(Err(rejection)) => {
                for (row, line) in row_rects(inside).zip(wrap(&rejection.message, inside.width as usize)) {
                    canvas.draw_text(row, &line, Role::Bad);
                }
            }
            Some(Ok(opened)) => self.draw_explorer(canvas, inside, opened, context),
        }
        canvas.draw_pane_keys(dialog_area, &self.key_hints(context));
    }

    /// Returns the key hints. The keys that drag plans are first.
    fn key_hints(&self, context: &ScreenContext<'_>) -> String {
        let label = |action| context.keys.label(action).unwrap_or_default();
        let drags = match self.successful_exploration() {
            Some(_) => format!(
                "{} {} price · {} {} quality · ",
                label(Action::Left),
                label(Action::Right),
                label(Action::Up),
                label(Action::Down)
            ),
            None => String::new(),
        };
        drags + &context.hints(&self.hints())
    }

    fn draw_explorer(
        &self,
        canvas: &mut Canvas<'_>,
        area: Rect,
        opened: &CurveExploration,
        context: &ScreenContext<'_>,
    ) {
        let is_low = area.height < MIN_ROWS_FOR_PLAN_LINES;
        let (width, measured) =
            (area.width as usize, context.company.fit(self.group).map(|fit| &fit.measured));
        let outcome: Vec<String> = match (is_low, measured) {
            (true, measured) => wrap(&describe_conversion_briefly(&opened.outcome, measured), width),
            (false, None) => wrap(&describe_outcome(&opened.outcome), width),
            (false, Some(measured)) => [describe_outcome(&opened.outcome), measured.describe()]
                .iter()
                .flat_map(|text| wrap(text, width))
                .collect(),
        };
        let legend = legend_lines(opened, area);
        let plans = if is_low { 1 } else { Plan::ALL.len() as u16 }.min(area.height);
        match is_low {
            true => canvas.draw_text(area, &self.plans_summary(opened), Role::Strong),
            false => self.draw_plans(canvas, Rect { height: plans, ..area }, opened),
        }
        let rest = Rect { y: area.y + plans, height: area.height - plans, ..area };
        for (row, line) in row_rects(rest).zip(&outcome) {
            canvas.draw_text(row, line, Role::Title);
        }
        let above = (outcome.len() as u16).min(rest.height);
        let chart = Rect {
            y: rest.y + above,
            height: (rest.height - above).saturating_sub(legend.len() as u16),
            ..area
        };
        if chart.height >= MIN_CHART_ROWS {
            // If all plans are dragged together, all are highlighted.
            let is_selected = |plan| self.selected_plan.is_none_or(|selected| selected == plan);
            draw_curve_chart(canvas, chart, &opened.explorer, &opened.plans, is_selected);
        }
        let below = Rect { y: chart.bottom(), height: area.bottom().saturating_sub(chart.bottom()), ..area };
        for (row, line) in row_rects(below).zip(&legend) {
            canvas.draw_text(row, line, Role::Dim);
        }
    }

    /// Returns the prefix of a dragged plan.
    fn selection_mark(&self, plan: Plan) -> &'static str {
        if self.selected_plan.is_none_or(|selected| selected == plan) { "›" } else { " " }
    }

    fn draw_plans(&self, canvas: &mut Canvas<'_>, area: Rect, opened: &CurveExploration) {
        for (row, plan) in row_rects(area).zip(Plan::ALL) {
            let mark = self.selection_mark(plan);
            let role = if mark == "›" { Role::Strong } else { Role::Text };
            canvas.draw_text(row, &format!("{mark} {}", plan_line(opened, plan)), role);
            canvas.register_click(row, Click::Row(0, plan.index()));
        }
    }

    fn plans_summary(&self, opened: &CurveExploration) -> String {
        let words = |(plan, plan_point): (Plan, &PlanPoint)| {
            format!(
                "{}{plan} {} {}",
                self.selection_mark(plan),
                price_to_cents(plan_point.list_price),
                format_quality(plan_point.quality)
            )
        };
        opened.plans.pairs().map(words).collect::<Vec<_>>().join("  ")
    }
}

/// Describes a plan and its changes: `A $12 → $15, quality 0.20, taken by 12.3%`.
fn plan_line(opened: &CurveExploration, plan: Plan) -> String {
    let (now, was) = (&opened.plans[plan], &opened.explorer.plans[plan]);
    let words = describe_plan(plan, now, opened.outcome.plan_shares.as_ref());
    let mut changes = Vec::new();
    if now.list_price != was.list_price {
        changes.push(format!("set {}", price_to_cents(was.list_price)));
    }
    if now.quality != was.quality {
        changes.push(format!("delivered {}", format_quality(was.quality)));
    }
    if changes.is_empty() { words } else { format!("{words} ({})", changes.join(", ")) }
}

/// Returns the lines of the legend that fit into the area, and what the estimates leave out.
fn legend_lines(opened: &CurveExploration, area: Rect) -> Vec<String> {
    let width = area.width as usize;
    if area.height < MIN_ROWS_FOR_LEGEND {
        let fits = area.height >= MIN_ROWS_FOR_OMISSIONS;
        return if fits { vec![describe_omissions_briefly(&opened.explorer)] } else { Vec::new() };
    }
    let omissions = wrap(&describe_omissions(&opened.explorer), width);
    let unit = if opened.explorer.group.is_enterprise() { "price per seat" } else { "price" };
    let mut words =
        format!("x: {unit}, y: quality · line: half of the leads accept · shaded: 10 to 90 % accept");
    if !opened.explorer.shows_true_values() {
        words += " · dim lines: bounds of the line's error range";
    }
    [omissions, wrap(&words, width)].concat()
}
