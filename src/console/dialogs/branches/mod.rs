//! The what-if page: edits decisions from a week on and compares the results.

mod comparison;
mod decisions;

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::{Dialog, DialogResponse};
use crate::action::{Action, Scope};
use crate::context::ScreenContext;
use crate::effect::Effect;
use comparison::ComparisonView;
use decisions::DecisionList;
use novamind_insight::EDIT_SYNTAX;
use novamind_tools::Rejection;
use novamind_tui::canvas::{Canvas, centered_rect};
use novamind_tui::theme::Role;
use novamind_worker::branches::{BranchesAnswer, BranchesQuestion};
use novamind_worker::question::{OutgoingQuestion, Pending};
use novamind_worker::request::Request;

const FUTURE_COUNT: u32 = 20;

enum BranchesView {
    Decisions,
    Simulating,
    Comparison(Box<ComparisonView>),
}

/// The what-if page.
pub struct BranchesPage {
    decisions: DecisionList,
    page: BranchesView,
    asked: Pending<BranchesQuestion>,
    problem: Option<String>,
}

impl BranchesPage {
    /// Opens the page at `week`, which the user can move up to `last_week`. Requests the recorded decisions.
    pub fn new(week: u32, last_week: u32) -> (BranchesPage, OutgoingQuestion) {
        let (pending, ask) = Pending::with_question(BranchesQuestion::Decisions);
        let decisions = DecisionList::new(week, last_week);
        (BranchesPage { decisions, page: BranchesView::Decisions, asked: pending, problem: None }, ask)
    }

    fn request_comparison(&mut self, futures: Option<u32>) -> DialogResponse {
        let alternatives = self.decisions.alternatives();
        if alternatives.is_empty() {
            self.problem = Some(format!("change a decision first; for example {}", EDIT_SYNTAX[0]));
            return DialogResponse::stay();
        }
        self.page = BranchesView::Simulating;
        let question = BranchesQuestion::Compare { week: self.decisions.week(), alternatives, futures };
        DialogResponse::stay_with(vec![Effect::Ask(self.asked.ask(question))])
    }

    fn go_back(&mut self) -> DialogResponse {
        match self.page {
            BranchesView::Decisions => DialogResponse::close(),
            BranchesView::Simulating => {
                self.asked.cancel();
                self.page = BranchesView::Decisions;
                DialogResponse::stay()
            }
            BranchesView::Comparison(_) => {
                self.page = BranchesView::Decisions;
                DialogResponse::stay()
            }
        }
    }

    fn adopt_selected(&mut self) -> DialogResponse {
        let BranchesView::Comparison(figures) = &self.page else { return DialogResponse::stay() };
        let (week, edits) = (self.decisions.week(), figures.selected_edits());
        DialogResponse::confirm_with(vec![Effect::Request(Request::AdoptBranch { week, edits })])
    }

    fn set_result(&mut self, found: Result<BranchesAnswer, Rejection>) {
        match found {
            Ok(BranchesAnswer::Decisions(calls, days)) => self.decisions.set_recorded(calls, days),
            Ok(BranchesAnswer::Compared(comparison, futures)) => {
                let figure = match &self.page {
                    BranchesView::Comparison(figures) => figures.figure(),
                    _ => 0,
                };
                let days = self.decisions.days_per_week();
                let figures = ComparisonView::new(*comparison, futures.map(|boxed| *boxed), days, figure);
                self.page = BranchesView::Comparison(Box::new(figures));
            }
            Err(rejection) => {
                self.problem = Some(rejection.message);
                self.decisions.mark_rejected();
                self.page = BranchesView::Decisions;
            }
        }
    }
}

impl Dialog for BranchesPage {
    fn record_name(&self) -> String {
        format!("what if, week {}", self.decisions.week())
    }

    fn step(&self) -> Option<&'static str> {
        Some(match self.page {
            BranchesView::Decisions => "decisions",
            BranchesView::Simulating => "simulating",
            BranchesView::Comparison(_) => "figures",
        })
    }

    fn scopes(&self) -> Vec<Scope> {
        match self.page {
            BranchesView::Decisions if self.decisions.is_typing() => vec![Scope::Field],
            BranchesView::Decisions => vec![Scope::Decisions, Scope::List, Scope::Dialog],
            BranchesView::Simulating => vec![Scope::Dialog],
            BranchesView::Comparison(_) => vec![Scope::Branches, Scope::List, Scope::Dialog],
        }
    }

    fn hints(&self) -> Vec<Action> {
        match self.page {
            BranchesView::Decisions if self.decisions.is_typing() => vec![Action::Commit, Action::Discard],
            BranchesView::Decisions => vec![
                Action::AddDecision,
                Action::OmitDecision,
                Action::SimulateBranches,
                Action::NextAlternative,
                Action::Open,
                Action::Close,
            ],
            BranchesView::Simulating => vec![Action::Cancel],
            BranchesView::Comparison(_) => {
                vec![Action::NextFigure, Action::SimulateFutures, Action::AdoptBranch, Action::Close]
            }
        }
    }

    fn handle_action(&mut self, action: Action, _: &ScreenContext<'_>) -> DialogResponse {
        self.problem = None;
        match (&mut self.page, action) {
            (_, Action::Close | Action::Cancel) => return self.go_back(),
            (BranchesView::Decisions, Action::SimulateBranches) => return self.request_comparison(None),
            (BranchesView::Comparison(_), Action::SimulateFutures) => {
                return self.request_comparison(Some(FUTURE_COUNT));
            }
            (BranchesView::Comparison(_), Action::AdoptBranch) => return self.adopt_selected(),
            (BranchesView::Decisions, action) => self.problem = self.decisions.handle_action(action).err(),
            (BranchesView::Comparison(figures), action) => figures.handle_action(action),
            (BranchesView::Simulating, _) => {}
        }
        DialogResponse::stay()
    }

    fn handle_key(&mut self, key: &KeyEvent, _: &ScreenContext<'_>) -> DialogResponse {
        self.problem = None;
        self.decisions.handle_key(key);
        DialogResponse::stay()
    }

    fn paste(&mut self, text: &str, _: &ScreenContext<'_>) -> DialogResponse {
        self.decisions.paste(text);
        DialogResponse::stay()
    }

    fn take_answers(&mut self) {
        if let Some((_, found)) = self.asked.try_take() {
            self.set_result(found);
        }
    }

    fn handle_click(&mut self, row: usize, _: &ScreenContext<'_>) -> DialogResponse {
        match &mut self.page {
            BranchesView::Decisions => self.decisions.select(row),
            BranchesView::Comparison(figures) => figures.select(row),
            BranchesView::Simulating => {}
        }
        DialogResponse::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let dialog_area =
            centered_rect(area, area.width.saturating_sub(2).min(140), area.height.saturating_sub(2));
        canvas.clear(dialog_area, Role::Text);
        let week = self.decisions.week();
        let inside = canvas.draw_pane_frame(
            dialog_area,
            &format!("What if, from week {week}"),
            &self.border_note(),
            true,
        );
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let below = self.problem.as_ref().map_or(0, |_| 1).min(inside.height);
        let page = Rect { height: inside.height - below, ..inside };
        match &self.page {
            BranchesView::Decisions => self.decisions.draw(canvas, page),
            BranchesView::Simulating => {
                let (done, all) = self.asked.progress().unwrap_or_default();
                let share = 100 * done / all.max(1);
                canvas.draw_text(page, &format!("simulating days again: {share} % …"), Role::Warning);
            }
            BranchesView::Comparison(figures) => figures.draw(canvas, page),
        }
        if let Some(problem) = &self.problem {
            let row = Rect { y: page.y + page.height, height: below, ..inside };
            canvas.draw_text(row, problem, Role::Bad);
        }
        canvas.draw_pane_keys(dialog_area, &context.hints(&self.hints()));
    }
}

impl BranchesPage {
    fn border_note(&self) -> String {
        match &self.page {
            BranchesView::Comparison(figures) => figures.figure_label(),
            _ => self.decisions.position_label(),
        }
    }
}

#[cfg(test)]
mod tests;
