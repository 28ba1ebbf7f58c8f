//! The curve explorer: the required quality of a group at each price, the plans, and how leads would respond to other
//! prices and qualities. Nothing is set.

mod draw;
#[cfg(test)]
mod tests;

use ratatui::layout::Rect;
use serde_json::{Map, Value, json};

use super::{Dialog, Outcome};
use crate::action::{Action, Scope};
use crate::context::Look;
use crate::effect::Effect;
use novamind_insight::{CurveExplorer, CurveOutcome, PlanPoint};
use novamind_session::identifiers::{ByPlan, Group, Plan};
use novamind_tools::{Refusal, ToolId};
use novamind_tui::canvas::Canvas;
use novamind_worker::asking::{Ask, Pending};
use novamind_worker::questions::CurveQuestion;

/// Step by which qualities are changed; page keys change by ten steps.
const QUALITY_STEP: f64 = 0.01;
const MOST_QUALITY: f64 = 2.0;

struct ExploredCurve {
    explorer: CurveExplorer,
    plans: ByPlan<PlanPoint>,
    outcome: CurveOutcome,
}

/// The curve explorer.
pub struct CurvePage {
    group: Group,
    asked: Pending<CurveQuestion>,
    /// The curve, or `None` while it is computed.
    found: Option<Result<ExploredCurve, Refusal>>,
    /// The dragged plan; `None` for all plans.
    chosen: Option<Plan>,
}

impl CurvePage {
    /// Requests the curve of a group.
    pub fn new(group: Group) -> (CurvePage, Ask) {
        let (asked, ask) = Pending::asking(CurveQuestion(group));
        (CurvePage { group, asked, found: None, chosen: Some(Plan::A) }, ask)
    }

    fn take(&mut self, explorer: CurveExplorer) -> ExploredCurve {
        let plans = explorer.plans;
        let outcome = explorer.outcome(&plans);
        // Plans with the same quality and price move together.
        if Plan::ALL.iter().all(|plan| plans[*plan] == plans[Plan::A]) {
            self.chosen = None;
        }
        ExploredCurve { explorer, plans, outcome }
    }

    fn opened(&self) -> Option<&ExploredCurve> {
        self.found.as_ref()?.as_ref().ok()
    }

    /// Changes the selected plan or all plans, and recomputes the responses of leads.
    fn drag(&mut self, change: impl Fn(&mut PlanPoint)) {
        let chosen = self.chosen;
        let Some(Ok(opened)) = &mut self.found else { return };
        for plan in Plan::ALL.into_iter().filter(|plan| chosen.is_none_or(|own| own == *plan)) {
            change(&mut opened.plans[plan]);
        }
        opened.outcome = opened.explorer.outcome(&opened.plans);
    }

    fn drag_price(&mut self, steps: f64) {
        let Some(most) = self.opened().map(ExploredCurve::greatest_price) else { return };
        let step = price_step(most);
        self.drag(|own| own.list = stepped(own.list, steps, step).clamp(0.0, most));
    }

    fn drag_quality(&mut self, steps: f64) {
        self.drag(|own| own.quality = stepped(own.quality, steps, QUALITY_STEP).clamp(0.0, MOST_QUALITY));
    }

    fn reset(&mut self) {
        if let Some(Ok(opened)) = &mut self.found {
            opened.plans = opened.explorer.plans;
            opened.outcome = opened.explorer.outcome(&opened.plans);
        }
    }

    /// Selects the next of A, B, C and all plans.
    fn choose_next(&mut self) {
        self.chosen = match self.chosen {
            None => Some(Plan::A),
            Some(plan) => Plan::ALL.into_iter().skip_while(|own| *own != plan).nth(1),
        };
    }

    /// Requests the curve of the next or previous known group.
    fn turn(&mut self, forward: bool, look: &Look<'_>) -> Outcome {
        let known = &look.company.seen.known_groups;
        let Some(at) = known.iter().position(|own| *own == self.group) else { return Outcome::stay() };
        let step = if forward { 1 } else { known.len() - 1 };
        self.group = known[(at + step) % known.len()];
        self.found = None;
        Outcome::with(vec![Effect::Ask(self.asked.ask(CurveQuestion(self.group)))])
    }

    /// Opens the price form with the dragged prices filled in.
    fn to_form(&self) -> Outcome {
        let Some(opened) = self.opened() else { return Outcome::stay() };
        let moved = |plan: &Plan| opened.plans[*plan].list != opened.explorer.plans[*plan].list;
        let prices: Map<String, Value> = Plan::ALL
            .into_iter()
            .filter(moved)
            .map(|plan| (plan.id().to_owned(), json!(opened.plans[plan].list)))
            .collect();
        let form = match prices.is_empty() {
            true => Effect::ShowTool(ToolId::SetPrices),
            false => Effect::Prefill { tool: ToolId::SetPrices, arguments: Value::Object(prices) },
        };
        Outcome::close_with(vec![Effect::CloseDialogs, form])
    }
}

impl ExploredCurve {
    fn greatest_price(&self) -> f64 {
        self.explorer.points.last().map_or(1.0, |point| point.price)
    }
}

/// Returns the price step in dollars: about a hundred steps over the curve.
fn price_step(most: f64) -> f64 {
    match most {
        most if most <= 150.0 => 1.0,
        most if most <= 400.0 => 2.0,
        _ => 5.0,
    }
}

/// Moves a value by whole steps along the multiples of `step`.
fn stepped(value: f64, steps: f64, step: f64) -> f64 {
    let at = value / step;
    // From between two multiples, the first step goes to the nearest one in its direction.
    let from = if steps > 0.0 { (at + 1e-9).floor() } else { (at - 1e-9).ceil() };
    (from + steps) * step
}

impl Dialog for CurvePage {
    fn what(&self) -> String {
        format!("curve of {}", self.group)
    }

    fn term(&self) -> Option<String> {
        Some("participation-curve".to_owned())
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Curve, Scope::List, Scope::Dialog]
    }

    fn hints(&self) -> Vec<Action> {
        match self.opened() {
            Some(_) => {
                vec![Action::NextPlan, Action::NextCurve, Action::ResetCurve, Action::Open, Action::Close]
            }
            None => vec![Action::Close],
        }
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Outcome {
        match action {
            Action::Close | Action::Cancel => return Outcome::close(),
            Action::NextCurve | Action::PreviousCurve => return self.turn(action == Action::NextCurve, look),
            Action::Open | Action::Confirm => return self.to_form(),
            Action::Left => self.drag_price(-1.0),
            Action::Right => self.drag_price(1.0),
            Action::Up | Action::ScrollUp => self.drag_quality(1.0),
            Action::Down | Action::ScrollDown => self.drag_quality(-1.0),
            Action::PageUp => self.drag_quality(10.0),
            Action::PageDown => self.drag_quality(-10.0),
            Action::NextPlan => self.choose_next(),
            Action::ResetCurve => self.reset(),
            _ => {}
        }
        Outcome::stay()
    }

    fn take_answers(&mut self) {
        if let Some((_, found)) = self.asked.try_take() {
            self.found = Some(found.map(|explorer| self.take(explorer)));
        }
    }

    fn click(&mut self, row: usize, _: &Look<'_>) -> Outcome {
        self.chosen = Plan::ALL.get(row).copied();
        Outcome::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        self.draw_page(canvas, area, look);
    }
}
