//! The what-if page: edits decisions from a week on and compares the results.

mod changes;
mod comparison;
mod decisions;
mod drawing;
mod editing;
mod picker;

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::{Dialog, DialogContent, DialogResponse, DialogView};
use crate::action::{Action, Scope};
use crate::context::ScreenContext;
use crate::effect::Effect;
use comparison::ComparisonView;
use decisions::{DecisionList, Input};
use novamind_report::decision_words::decision_name;
use novamind_report::whatif::branch_name;
use novamind_tools::Rejection;
use novamind_tui::canvas::{Canvas, centered_rect, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_worker::branches::{BranchesAnswer, BranchesQuestion};
use novamind_worker::question::{OutgoingQuestion, Pending};
use novamind_worker::request::Request;

const FUTURE_COUNT: u32 = 20;
const INVALID_CHANGE: &str = "A change cannot be simulated. Correct the selected change, or remove it.";

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
    /// The check of the edits of the current alternative.
    checking: Pending<BranchesQuestion>,
    problem: Option<String>,
    /// Whether the user was warned that closing the page discards the changes.
    is_closing: bool,
}

impl BranchesPage {
    /// Opens the page at `week`. The user can choose weeks up to `last_week`. Requests the recorded decisions.
    pub fn new(week: u32, last_week: u32) -> (BranchesPage, OutgoingQuestion) {
        let (pending, ask) = Pending::with_question(BranchesQuestion::Decisions);
        let decisions = DecisionList::new(week, last_week);
        let (page, checking) = (BranchesView::Decisions, Pending::default());
        (BranchesPage { decisions, page, asked: pending, checking, problem: None, is_closing: false }, ask)
    }

    fn request_comparison(&mut self, futures: Option<u32>) -> DialogResponse {
        if self.decisions.history().is_none() {
            return DialogResponse::stay();
        }
        if self.decisions.select_invalid_change() {
            self.problem = Some(INVALID_CHANGE.to_owned());
            self.page = BranchesView::Decisions;
            return DialogResponse::stay();
        }
        let alternatives = self.decisions.alternatives();
        if alternatives.is_empty() {
            self.problem = Some("No decision is changed yet. Change one, or add a decision.".to_owned());
            return DialogResponse::stay();
        }
        self.page = BranchesView::Simulating;
        let question = BranchesQuestion::Compare { week: self.decisions.start_week(), alternatives, futures };
        DialogResponse::stay_with(vec![Effect::Ask(self.asked.ask(question))])
    }

    fn go_back(&mut self, context: &ScreenContext<'_>) -> DialogResponse {
        match self.page {
            BranchesView::Decisions if self.decisions.has_changes() && !self.is_closing => {
                self.is_closing = true;
                let key = context.keys.label(Action::Close).unwrap_or_default();
                self.problem =
                    Some(format!("Closing the page discards your changes. Press {key} again to close it."));
                DialogResponse::stay()
            }
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
        let (week, edits) = (self.decisions.start_week(), figures.selected_edits());
        DialogResponse::confirm_with(vec![Effect::Request(Request::AdoptBranch { week, edits })])
    }

    fn set_result(&mut self, found: Result<BranchesAnswer, Rejection>) {
        match found {
            Ok(BranchesAnswer::Decisions(history)) => self.decisions.set_history(history),
            Ok(BranchesAnswer::Checked(_)) => {}
            Ok(BranchesAnswer::Compared(comparison, futures)) => {
                self.decisions.set_compared(&comparison);
                let figure = match &self.page {
                    BranchesView::Comparison(figures) => figures.figure(),
                    _ => 0,
                };
                let days = self.decisions.days_per_week();
                let figures = ComparisonView::new(*comparison, futures.map(|boxed| *boxed), days, figure);
                self.page = BranchesView::Comparison(Box::new(figures));
            }
            Err(rejection) => {
                self.page = BranchesView::Decisions;
                // The check has already stated the reason in the row of the change.
                let is_invalid = self.decisions.select_invalid_change();
                self.problem = Some(if is_invalid { INVALID_CHANGE.to_owned() } else { rejection.message });
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

    fn tour_view(&self) -> Option<DialogView> {
        let is_shown = matches!(self.page, BranchesView::Comparison(_));
        let actions = match self.page {
            BranchesView::Decisions if self.decisions.input.is_some() => vec![Action::Discard],
            BranchesView::Decisions if self.decisions.has_changes() => vec![Action::SimulateBranches],
            BranchesView::Decisions if self.decisions.is_decision_selected() => {
                vec![Action::OmitDecision, Action::SimulateBranches]
            }
            BranchesView::Decisions => vec![Action::Left],
            BranchesView::Simulating | BranchesView::Comparison(_) => Vec::new(),
        };
        Some(DialogView { content: DialogContent::WhatIf, is_shown, actions })
    }

    fn scopes(&self) -> Vec<Scope> {
        match self.page {
            BranchesView::Decisions => {
                self.decisions.input_scopes().unwrap_or_else(|| vec![Scope::Decisions, Scope::List])
            }
            BranchesView::Simulating => vec![Scope::Dialog],
            BranchesView::Comparison(_) => vec![Scope::Branches, Scope::List, Scope::Dialog],
        }
    }

    fn hints(&self) -> Vec<Action> {
        match (&self.page, &self.decisions.input) {
            (BranchesView::Decisions, _) if self.decisions.history().is_none() => vec![Action::Close],
            (BranchesView::Decisions, None) => vec![
                Action::CycleDecision,
                Action::AddDecision,
                Action::SimulateBranches,
                Action::OmitDecision,
                Action::ScaleDecision,
                Action::ReplaceDecision,
                Action::NextAlternative,
                Action::Close,
            ],
            (BranchesView::Decisions, Some(Input::Picker(_))) => {
                vec![Action::Open, Action::ScaleDecision, Action::OmitDecision, Action::Close]
            }
            (BranchesView::Decisions, Some(Input::Form { form, .. })) if !form.is_typing() => {
                vec![Action::EditCell, Action::Apply, Action::ResetForm, Action::Close]
            }
            (BranchesView::Decisions, Some(Input::Form { .. })) => {
                vec![Action::Commit, Action::CommitNext, Action::Apply, Action::Discard]
            }
            (BranchesView::Decisions, Some(_)) => vec![Action::Commit, Action::Discard],
            (BranchesView::Simulating, _) => vec![Action::Cancel],
            (BranchesView::Comparison(_), _) => {
                vec![Action::NextFigure, Action::SimulateFutures, Action::AdoptBranch, Action::Close]
            }
        }
    }

    fn handle_action(&mut self, action: Action, context: &ScreenContext<'_>) -> DialogResponse {
        // Until the decisions are loaded, the page shows only the problem, so the problem is kept.
        self.problem.take_if(|_| self.decisions.history().is_some());
        self.is_closing &= matches!(action, Action::Close | Action::Cancel);
        match (&mut self.page, action) {
            (BranchesView::Decisions, action) if self.decisions.input.is_some() => {
                self.decisions.handle_action(action, context.company);
            }
            (_, Action::Close | Action::Cancel) => return self.go_back(context),
            (BranchesView::Decisions, Action::SimulateBranches) => return self.request_comparison(None),
            (BranchesView::Comparison(_), Action::SimulateFutures) => {
                return self.request_comparison(Some(FUTURE_COUNT));
            }
            (BranchesView::Comparison(_), Action::AdoptBranch) => return self.adopt_selected(),
            (BranchesView::Decisions, action) => self.decisions.handle_action(action, context.company),
            (BranchesView::Comparison(figures), action) => figures.handle_action(action),
            (BranchesView::Simulating, _) => {}
        }
        self.request_check()
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
        match self.checking.try_take() {
            Some((BranchesQuestion::Check { edits, .. }, Ok(BranchesAnswer::Checked(refused)))) => {
                self.decisions.set_checked(&edits, refused);
            }
            Some((_, Err(refusal))) => self.problem = Some(refusal.message),
            _ => {}
        }
        if let Some((_, found)) = self.asked.try_take() {
            self.set_result(found);
        }
    }

    fn handle_click(&mut self, row: usize, context: &ScreenContext<'_>) -> DialogResponse {
        match &mut self.page {
            BranchesView::Decisions => self.decisions.handle_click(row, context.company),
            BranchesView::Comparison(figures) => figures.select(row),
            BranchesView::Simulating => {}
        }
        DialogResponse::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let dialog_area =
            centered_rect(area, area.width.saturating_sub(2).min(140), area.height.saturating_sub(2));
        canvas.clear(dialog_area, Role::Text);
        let inside = canvas.draw_pane_frame(dialog_area, &self.title(), &self.border_note(), true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let problem =
            self.problem.as_deref().map_or(Vec::new(), |problem| wrap(problem, inside.width as usize));
        let below = (problem.len() as u16).min(inside.height);
        let page = Rect { height: inside.height - below, ..inside };
        match &self.page {
            BranchesView::Decisions if self.decisions.history().is_none() && self.asked.is_waiting() => {
                canvas.draw_text(page, "reading the record …", Role::Warning);
            }
            BranchesView::Decisions => self.decisions.draw(canvas, page, context),
            BranchesView::Simulating => {
                let (done, all) = self.asked.progress().unwrap_or_default();
                let share = 100 * done / all.max(1);
                canvas.draw_text(page, &format!("simulating days again: {share} % …"), Role::Warning);
            }
            BranchesView::Comparison(figures) => {
                let names = &context.company.enterprise_names;
                let mut labels = vec![branch_name(&[])];
                labels.extend(self.decisions.alternative_names(names));
                figures.draw(canvas, page, &labels, names);
            }
        }
        let rows = Rect { y: page.y + page.height, height: below, ..inside };
        for (row, line) in row_rects(rows).zip(&problem) {
            canvas.draw_text(row, line, Role::Bad);
        }
        canvas.draw_pane_keys(dialog_area, &context.hints(&self.hints()));
    }
}

impl BranchesPage {
    /// Sends the edits of the current alternative for a check, if they changed.
    fn request_check(&mut self) -> DialogResponse {
        match self.decisions.take_unchecked_edits() {
            Some((week, edits)) => {
                let question = BranchesQuestion::Check { week, edits };
                DialogResponse::stay_with(vec![Effect::Ask(self.checking.ask(question))])
            }
            None => DialogResponse::stay(),
        }
    }

    fn title(&self) -> String {
        match (&self.page, &self.decisions.input) {
            (BranchesView::Decisions, Some(Input::Form { form, .. })) => {
                format!("What if, {}", decision_name(form.tool()))
            }
            (BranchesView::Decisions, _) => format!("What if, decisions of week {}", self.decisions.week()),
            _ => format!("What if, from week {}", self.decisions.start_week()),
        }
    }

    fn border_note(&self) -> String {
        match &self.page {
            BranchesView::Comparison(figures) => figures.figure_label(),
            BranchesView::Decisions if self.decisions.input.is_some() => {
                format!("week {}", self.decisions.week())
            }
            _ => self.decisions.position_label(),
        }
    }
}

#[cfg(test)]
mod tests;
