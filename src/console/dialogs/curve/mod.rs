//! The curve explorer: the required quality of a group at each price, the plans, and how leads would respond to other
//! prices and qualities. The explorer does not change settings.

mod draw;
#[cfg(test)]
mod tests;

use ratatui::layout::Rect;
use serde_json::{Map, Value, json};

use super::{Dialog, DialogContent, DialogResponse, DialogView};
use crate::action::{Action, Scope};
use crate::context::ScreenContext;
use crate::effect::Effect;
use novamind_insight::{CurveExplorer, CurveOutcome, PlanPoint};
use novamind_session::identifiers::{ByPlan, Group, Plan};
use novamind_tools::{Rejection, ToolId};
use novamind_tui::canvas::Canvas;
use novamind_worker::page_questions::CurveQuestion;
use novamind_worker::question::{OutgoingQuestion, Pending};

/// Step by which a key changes a quality. Page keys change the quality by ten steps.
const QUALITY_STEP: f64 = 0.01;
const MAX_QUALITY: f64 = 2.0;

struct CurveExploration {
    explorer: CurveExplorer,
    plans: ByPlan<PlanPoint>,
    outcome: CurveOutcome,
}

/// The curve explorer.
pub struct CurveDialog {
    group: Group,
    asked: Pending<CurveQuestion>,
    /// The curve, or `None` while it is computed.
    exploration: Option<Result<CurveExploration, Rejection>>,
    /// The dragged plan, or `None` if all plans are dragged.
    selected_plan: Option<Plan>,
}

impl CurveDialog {
    /// Requests the curve of a group.
    pub fn new(group: Group) -> (CurveDialog, OutgoingQuestion) {
        let (pending, ask) = Pending::with_question(CurveQuestion(group));
        (CurveDialog { group, asked: pending, exploration: None, selected_plan: Some(Plan::A) }, ask)
    }

    fn set_result(&mut self, explorer: CurveExplorer) -> CurveExploration {
        let plans = explorer.plans;
        let outcome = explorer.outcome_for_plans(&plans);
        // Plans that all have the same quality and price are dragged together.
        if Plan::ALL.iter().all(|plan| plans[*plan] == plans[Plan::A]) {
            self.selected_plan = None;
        }
        CurveExploration { explorer, plans, outcome }
    }

    fn successful_exploration(&self) -> Option<&CurveExploration> {
        self.exploration.as_ref()?.as_ref().ok()
    }

    /// Changes the selected plan or all plans, and recomputes the responses of leads.
    fn adjust_plans(&mut self, change: impl Fn(&mut PlanPoint)) {
        let chosen = self.selected_plan;
        let Some(Ok(opened)) = &mut self.exploration else { return };
        for plan in Plan::ALL.into_iter().filter(|plan| chosen.is_none_or(|selected| selected == *plan)) {
            change(&mut opened.plans[plan]);
        }
        opened.outcome = opened.explorer.outcome_for_plans(&opened.plans);
    }

    fn adjust_price(&mut self, steps: f64) {
        let Some(most) = self.successful_exploration().map(CurveExploration::max_price) else { return };
        let step = price_step(most);
        self.adjust_plans(|plan_point| {
            plan_point.list_price = step_to_multiple(plan_point.list_price, steps, step).clamp(0.0, most)
        });
    }

    fn adjust_quality(&mut self, steps: f64) {
        self.adjust_plans(|plan_point| {
            plan_point.quality =
                step_to_multiple(plan_point.quality, steps, QUALITY_STEP).clamp(0.0, MAX_QUALITY)
        });
    }

    fn reset(&mut self) {
        if let Some(Ok(opened)) = &mut self.exploration {
            opened.plans = opened.explorer.plans;
            opened.outcome = opened.explorer.outcome_for_plans(&opened.plans);
        }
    }

    /// Selects the next item in the cycle A, B, C and all plans.
    fn select_next_plan(&mut self) {
        self.selected_plan = match self.selected_plan {
            None => Some(Plan::A),
            Some(plan) => Plan::ALL.into_iter().skip_while(|skipped| *skipped != plan).nth(1),
        };
    }

    /// Requests the curve of the next or previous known group.
    fn change_group(&mut self, forward: bool, context: &ScreenContext<'_>) -> DialogResponse {
        let known = &context.company.observation.known_groups;
        let Some(at) = known.iter().position(|group| *group == self.group) else {
            return DialogResponse::stay();
        };
        let step = if forward { 1 } else { known.len() - 1 };
        self.group = known[(at + step) % known.len()];
        self.exploration = None;
        DialogResponse::stay_with(vec![Effect::Ask(self.asked.ask(CurveQuestion(self.group)))])
    }

    /// Opens the price form with the dragged prices filled in.
    fn open_price_form(&self) -> DialogResponse {
        let Some(opened) = self.successful_exploration() else { return DialogResponse::stay() };
        let moved = |plan: &Plan| opened.plans[*plan].list_price != opened.explorer.plans[*plan].list_price;
        let prices: Map<String, Value> = Plan::ALL
            .into_iter()
            .filter(moved)
            .map(|plan| (plan.id().to_owned(), json!(opened.plans[plan].list_price)))
            .collect();
        let form = match prices.is_empty() {
            true => Effect::ShowTool(ToolId::SetPrices),
            false => Effect::Prefill { tool: ToolId::SetPrices, arguments: Value::Object(prices) },
        };
        DialogResponse::confirm_with(vec![Effect::CloseDialogs, form])
    }
}

impl CurveExploration {
    fn max_price(&self) -> f64 {
        self.explorer.points.last().map_or(1.0, |point| point.price)
    }
}

/// Returns the price step in dollars, which divides the curve into about a hundred steps.
fn price_step(most: f64) -> f64 {
    match most {
        most if most <= 150.0 => 1.0,
        most if most <= 400.0 => 2.0,
        _ => 5.0,
    }
}

/// Moves a value by whole steps along the multiples of `step`.
fn step_to_multiple(value: f64, steps: f64, step: f64) -> f64 {
    let at = value / step;
    // If the value is between two multiples, the first step ends at the next multiple in its direction.
    let from = if steps > 0.0 { (at + 1e-9).floor() } else { (at - 1e-9).ceil() };
    (from + steps) * step
}

impl Dialog for CurveDialog {
    fn record_name(&self) -> String {
        format!("curve of {}", self.group)
    }

    fn tour_view(&self) -> Option<DialogView> {
        Some(DialogView::new(DialogContent::Curve, self.successful_exploration().is_some()))
    }

    fn term(&self) -> Option<String> {
        Some("participation-curve".to_owned())
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Curve, Scope::List, Scope::Dialog]
    }

    fn hints(&self) -> Vec<Action> {
        match self.successful_exploration() {
            Some(_) => {
                vec![Action::NextPlan, Action::NextCurve, Action::ResetCurve, Action::Open, Action::Close]
            }
            None => vec![Action::Close],
        }
    }

    fn handle_action(&mut self, action: Action, context: &ScreenContext<'_>) -> DialogResponse {
        match action {
            Action::Close | Action::Cancel => return DialogResponse::close(),
            Action::NextCurve | Action::PreviousCurve => {
                return self.change_group(action == Action::NextCurve, context);
            }
            Action::Open | Action::Confirm => return self.open_price_form(),
            Action::Left => self.adjust_price(-1.0),
            Action::Right => self.adjust_price(1.0),
            Action::Up | Action::ScrollUp => self.adjust_quality(1.0),
            Action::Down | Action::ScrollDown => self.adjust_quality(-1.0),
            Action::PageUp => self.adjust_quality(10.0),
            Action::PageDown => self.adjust_quality(-10.0),
            Action::NextPlan => self.select_next_plan(),
            Action::ResetCurve => self.reset(),
            _ => {}
        }
        DialogResponse::stay()
    }

    fn take_answers(&mut self) {
        if let Some((_, found)) = self.asked.try_take() {
            self.exploration = Some(found.map(|explorer| self.set_result(explorer)));
        }
    }

    fn handle_click(&mut self, row: usize, _: &ScreenContext<'_>) -> DialogResponse {
        self.selected_plan = Plan::ALL.get(row).copied();
        DialogResponse::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        self.draw_page(canvas, area, context);
    }
}
