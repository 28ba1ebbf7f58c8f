//! Drawing of the curve explorer: the plans, the responses of leads, and the curve.

use ratatui::layout::Rect;

use super::{CurvePage, ExploredCurve};
use crate::action::Action;
use crate::context::Look;
use crate::dialogs::Dialog;
use novamind_base::notation::{dollars, price_to_cents};
use novamind_insight::{CurvePoint, PlanPoint, SAMPLED_LEADS};
use novamind_report::curve::{
    basis_in_words, outcome_in_few_words, outcome_in_words, plan_in_words, quality,
};
use novamind_session::identifiers::Plan;
use novamind_tui::canvas::{Canvas, Click, centered, rows_of};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::{Axis, Band, Line, Plot, Side, Sign};
use novamind_tui::widgets::scale::Unit;

const WIDEST: u16 = 140;
const LEAST_CHART: u16 = 5;
const LEAST_IN_FULL: u16 = 12;
const LEAST_WITH_LEGEND: u16 = 14;

impl CurvePage {
    pub(super) fn draw_page(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let own = centered(area, area.width.saturating_sub(2).min(WIDEST), area.height.saturating_sub(2));
        canvas.clear(own, Role::Text);
        let note = self.opened().map_or(String::new(), |opened| basis_in_words(&opened.explorer.basis));
        let title = match own.width {
            ..78 => format!("Curve of {}", self.group),
            _ => format!("Participation curve of {}", self.group),
        };
        let inside = canvas.pane(own, &title, &note, true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        match &self.found {
            None => canvas.text(inside, &format!("asking {SAMPLED_LEADS} leads …"), Role::Warning),
            Some(Err(refusal)) => {
                for (row, line) in rows_of(inside).zip(wrapped(&refusal.message, inside.width as usize)) {
                    canvas.text(row, &line, Role::Bad);
                }
            }
            Some(Ok(opened)) => self.draw_opened(canvas, inside, opened),
        }
        canvas.pane_keys(own, &self.keys(look));
    }

    /// The drag keys come first.
    fn keys(&self, look: &Look<'_>) -> String {
        let label = |action| look.keys.label(action).unwrap_or_default();
        let drags = match self.opened() {
            Some(_) => format!(
                "{} {} price · {} {} quality · ",
                label(Action::Left),
                label(Action::Right),
                label(Action::Up),
                label(Action::Down)
            ),
            None => String::new(),
        };
        drags + &look.hints(&self.hints())
    }

    fn draw_opened(&self, canvas: &mut Canvas<'_>, area: Rect, opened: &ExploredCurve) {
        let is_low = area.height < LEAST_IN_FULL;
        let outcome = match is_low {
            true => vec![outcome_in_few_words(&opened.outcome)],
            false => wrapped(&outcome_in_words(&opened.outcome), area.width as usize),
        };
        let legend = legend(opened, area);
        let plans = if is_low { 1 } else { Plan::ALL.len() as u16 }.min(area.height);
        match is_low {
            true => canvas.text(area, &self.plans_in_few_words(opened), Role::Strong),
            false => self.draw_plans(canvas, Rect { height: plans, ..area }, opened),
        }
        let rest = Rect { y: area.y + plans, height: area.height - plans, ..area };
        for (row, line) in rows_of(rest).zip(&outcome) {
            canvas.text(row, line, Role::Title);
        }
        let above = (outcome.len() as u16).min(rest.height);
        let chart = Rect {
            y: rest.y + above,
            height: (rest.height - above).saturating_sub(legend.len() as u16),
            ..area
        };
        if chart.height >= LEAST_CHART {
            self.draw_chart(canvas, chart, opened);
        }
        let below = Rect { y: chart.bottom(), height: area.bottom().saturating_sub(chart.bottom()), ..area };
        for (row, line) in rows_of(below).zip(&legend) {
            canvas.text(row, line, Role::Dim);
        }
    }

    /// Returns the prefix of a dragged plan.
    fn mark(&self, plan: Plan) -> &'static str {
        if self.chosen.is_none_or(|own| own == plan) { "›" } else { " " }
    }

    fn draw_plans(&self, canvas: &mut Canvas<'_>, area: Rect, opened: &ExploredCurve) {
        for (row, plan) in rows_of(area).zip(Plan::ALL) {
            let mark = self.mark(plan);
            let role = if mark == "›" { Role::Strong } else { Role::Text };
            canvas.text(row, &format!("{mark} {}", line_of(opened, plan)), role);
            canvas.click(row, Click::Row(0, plan.index()));
        }
    }

    fn plans_in_few_words(&self, opened: &ExploredCurve) -> String {
        let words = |(plan, own): (Plan, &PlanPoint)| {
            format!("{}{plan} {} {}", self.mark(plan), price_to_cents(own.list), quality(own.quality))
        };
        opened.plans.pairs().map(words).collect::<Vec<_>>().join("  ")
    }

    fn draw_chart(&self, canvas: &mut Canvas<'_>, area: Rect, opened: &ExploredCurve) {
        let points = &opened.explorer.points;
        let plans = || opened.plans.iter().chain(opened.explorer.plans.iter());
        let top = plans().map(|own| own.quality).fold(1.0, f64::max);
        let most = opened.greatest_price();
        // Unaffordable prices are not drawn: lines end there, and the band extends to its upper edge.
        let line = |of: fn(&CurvePoint) -> f64, role| {
            let inside = points.iter().filter(|point| of(point) <= top);
            Line::through(inside.map(|point| (point.price, of(point))).collect(), role)
        };
        let mut lines = Vec::new();
        if !opened.explorer.is_truth() {
            lines.push(line(|point| point.median_between.0, Role::Dim));
            lines.push(line(|point| point.median_between.1, Role::Dim));
        }
        lines.push(line(|point| point.median, Role::Series(0)).named("half"));
        let covered = points.iter().filter(|point| point.tenth <= top);
        let ends = covered.map(|point| (point.price, point.tenth, point.ninetieth.min(top))).collect();
        let band = Band { ends, name: "" };
        let x = Axis { write: &|value| dollars(value), holds: &[0.0, most] };
        let y = Side { unit: Unit::Number, holds: &[0.0, top] };
        let promotion = opened.explorer.promotion;
        let sign = |plan: Plan| {
            let own: &PlanPoint = &opened.plans[plan];
            let here = self.chosen.is_none_or(|chosen| chosen == plan);
            let role = if here { Role::Selection } else { Role::Series(1) };
            Sign { x: (own.list - promotion).max(0.0), y: own.quality, text: plan.id(), role }
        };
        // The selected plan is drawn on top.
        let mut order = Plan::ALL;
        order.sort_by_key(|plan| self.chosen == Some(*plan));
        let signs: Vec<Sign> = order.into_iter().map(sign).collect();
        Plot { lines: &lines, band: Some(&band), mark: None, x: &x, y: &y }.draw_with(canvas, area, &signs);
    }
}

/// Describes a plan and its changes: `A $12 → $15, quality 0.20, taken by 12.3%`.
fn line_of(opened: &ExploredCurve, plan: Plan) -> String {
    let (now, was) = (&opened.plans[plan], &opened.explorer.plans[plan]);
    let words = plan_in_words(plan, now, opened.outcome.takers.as_ref());
    let mut changes = Vec::new();
    if now.list != was.list {
        changes.push(format!("set {}", price_to_cents(was.list)));
    }
    if now.quality != was.quality {
        changes.push(format!("delivered {}", quality(was.quality)));
    }
    if changes.is_empty() { words } else { format!("{words} ({})", changes.join(", ")) }
}

/// Explains the chart as far as space permits.
fn legend(opened: &ExploredCurve, area: Rect) -> Vec<String> {
    if area.height < LEAST_WITH_LEGEND {
        return Vec::new();
    }
    let unit = if opened.explorer.group.is_enterprise() { "price per seat" } else { "price" };
    let mut words =
        format!("x: {unit}, y: quality · line: enough for half of the leads · shaded: for 1 to 9 in 10");
    if !opened.explorer.is_truth() {
        words += " · dim lines: half, at both ends of the error · spread and slope are assumed; studies measure means";
    }
    wrapped(&words, area.width as usize)
}
