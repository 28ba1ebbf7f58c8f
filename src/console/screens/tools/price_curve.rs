//! The participation curve in the price form: how leads of one group would respond to the drafted prices, as
//! estimated by market studies.

use ratatui::layout::Rect;

use super::form::ToolForm;
use crate::curve_chart::{MIN_CHART_ROWS, draw_curve_chart};
use crate::effect::Effect;
use novamind_insight::{CurveExplorer, PlanPoint};
use novamind_report::curve::{describe_conversion_briefly, describe_omissions};
use novamind_session::identifiers::{ByPlan, Group, Plan};
use novamind_tools::{Rejection, ToolId};
use novamind_tui::canvas::{Canvas, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_worker::company::DisplayedCompany;
use novamind_worker::page_questions::EstimatedCurveQuestion;
use novamind_worker::question::Pending;

/// Maximum height of the chart, in rows.
const MAX_CHART_ROWS: u16 = 16;

/// The curve of the group with the most leads.
#[derive(Default)]
pub(super) struct PriceCurve {
    pending: Pending<EstimatedCurveQuestion>,
    curve: Option<Result<CurveExplorer, Rejection>>,
    is_current: bool,
}

impl PriceCurve {
    /// Marks the curve as outdated, because the company has changed.
    pub fn set_outdated(&mut self) {
        self.is_current = false;
    }

    /// Requests the curve of the group with the most leads, unless it is current or already requested.
    pub fn request(&mut self, company: &DisplayedCompany) -> Vec<Effect> {
        if self.is_current {
            return Vec::new();
        }
        self.is_current = true;
        let group = main_group(company);
        group.map_or_else(Vec::new, |group| vec![Effect::Ask(self.pending.ask(EstimatedCurveQuestion(group)))])
    }

    /// Stores the answer if it has arrived.
    pub fn take_answer(&mut self) {
        if let Some((_, found)) = self.pending.try_take() {
            self.curve = Some(found);
        }
    }

    #[cfg(test)]
    pub fn set_answer(&mut self, answer: Result<CurveExplorer, Rejection>) {
        self.pending.set_answer(answer);
        self.take_answer();
    }

    /// Returns the conversion at the drafted prices with the measured conversion, and what the estimate leaves out.
    /// Returns no lines for other forms.
    pub fn lines(&self, form: &ToolForm, company: &DisplayedCompany) -> Vec<String> {
        match self.curve.as_ref().filter(|_| form.spec.id == ToolId::SetPrices) {
            Some(Ok(explorer)) => {
                let outcome = explorer.outcome_for_plans(&drafted_plans(explorer, form));
                let measured = company.fit(explorer.group).map(|fit| &fit.measured);
                let conversion = describe_conversion_briefly(&outcome, measured);
                let draft = if form.sheet.is_changed() { " at the drafted prices" } else { "" };
                let plans = drafted_plans(explorer, form);
                let is_sold = |plan: &PlanPoint| plan.list_price > 0.0 && plan.quota > 0.0;
                let unsold = match plans.iter().any(is_sold) {
                    true => "",
                    false => " No plan has both a price and a quota.",
                };
                let omissions = describe_omissions(explorer);
                vec![format!("{}{draft}: {conversion}.{unsold} {omissions}", explorer.group)]
            }
            Some(Err(refusal)) => vec![refusal.message.clone()],
            None => Vec::new(),
        }
    }

    /// Draws the curve with the drafted prices if it fits. Returns the number of rows, including a blank row.
    pub fn draw(&self, form: &ToolForm, canvas: &mut Canvas<'_>, area: Rect) -> u16 {
        let Some(Ok(explorer)) = &self.curve else { return 0 };
        if form.spec.id != ToolId::SetPrices || area.height < MIN_CHART_ROWS + 3 {
            return 0;
        }
        let head =
            format!("participation curve of {} · line: half accept · shaded: 10 to 90 %", explorer.group);
        let head = wrap(&head, area.width as usize);
        for (row, line) in row_rects(area).zip(&head) {
            canvas.draw_text(row, line, Role::Header);
        }
        let above = (head.len() as u16).min(area.height);
        let rows = (area.height - above).min(MAX_CHART_ROWS);
        let chart = Rect { y: area.y + above, height: rows, ..area };
        let plans = drafted_plans(explorer, form);
        let is_drafted = |plan: Plan| plans[plan].list_price != explorer.plans[plan].list_price;
        draw_curve_chart(canvas, chart, explorer, &plans, is_drafted);
        (above + rows + 1).min(area.height)
    }
}

/// Returns the known group of individuals with the most leads in the measured weeks, or the first such group if there
/// were no leads.
fn main_group(company: &DisplayedCompany) -> Option<Group> {
    let people = company.fits.iter().filter(|fit| !fit.group.is_enterprise());
    // The first of equal groups is preferred.
    people.rev().max_by_key(|fit| fit.measured.leads).map(|fit| fit.group)
}

/// Returns the current plans with the drafted prices.
fn drafted_plans(explorer: &CurveExplorer, form: &ToolForm) -> ByPlan<PlanPoint> {
    let drafted = form.sheet.arguments().ok();
    let price = |plan: Plan| drafted.as_ref()?.get(plan.id())?.as_f64();
    ByPlan::from_fn(|plan| PlanPoint {
        list_price: price(plan).unwrap_or(explorer.plans[plan].list_price),
        ..explorer.plans[plan]
    })
}
