//! The what-if page: edits decisions from a week on and compares the results.

mod decisions;
mod outcome;

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::{Dialog, Outcome};
use crate::action::{Action, Scope};
use crate::context::Look;
use crate::effect::Effect;
use decisions::Decisions;
use novamind_insight::FORMS;
use novamind_tools::Refusal;
use novamind_tui::canvas::{Canvas, centered};
use novamind_tui::theme::Role;
use novamind_worker::asking::{Ask, Pending};
use novamind_worker::branches::{BranchesFound, BranchesQuestion};
use novamind_worker::request::Request;
use outcome::Figures;

const FUTURES: u32 = 20;

enum Page {
    Decisions,
    Working,
    Figures(Box<Figures>),
}

/// The what-if page.
pub struct BranchesPage {
    decisions: Decisions,
    page: Page,
    asked: Pending<BranchesQuestion>,
    problem: Option<String>,
}

impl BranchesPage {
    /// Opens the page at `week`, which the user can move up to `last_week`. Requests the recorded decisions.
    pub fn new(week: u32, last_week: u32) -> (BranchesPage, Ask) {
        let (asked, ask) = Pending::asking(BranchesQuestion::Decisions);
        let decisions = Decisions::new(week, last_week);
        (BranchesPage { decisions, page: Page::Decisions, asked, problem: None }, ask)
    }

    fn ask(&mut self, futures: Option<u32>) -> Outcome {
        let alternatives = self.decisions.alternatives();
        if alternatives.is_empty() {
            self.problem = Some(format!("change a decision first; for example {}", FORMS[0]));
            return Outcome::stay();
        }
        self.page = Page::Working;
        let question = BranchesQuestion::Compare { week: self.decisions.week(), alternatives, futures };
        Outcome::with(vec![Effect::Ask(self.asked.ask(question))])
    }

    fn leave(&mut self) -> Outcome {
        match self.page {
            Page::Decisions => Outcome::close(),
            Page::Working => {
                self.asked.cancel();
                self.page = Page::Decisions;
                Outcome::stay()
            }
            Page::Figures(_) => {
                self.page = Page::Decisions;
                Outcome::stay()
            }
        }
    }

    fn adopt(&mut self) -> Outcome {
        let Page::Figures(figures) = &self.page else { return Outcome::stay() };
        let (week, edits) = (self.decisions.week(), figures.selected_edits());
        Outcome::close_with(vec![Effect::Request(Request::AdoptBranch { week, edits })])
    }

    fn take(&mut self, found: Result<BranchesFound, Refusal>) {
        match found {
            Ok(BranchesFound::Decisions(calls, days)) => self.decisions.take(calls, days),
            Ok(BranchesFound::Compared(comparison, futures)) => {
                let figure = match &self.page {
                    Page::Figures(figures) => figures.figure(),
                    _ => 0,
                };
                let days = self.decisions.days_per_week();
                let figures = Figures::new(*comparison, futures.map(|own| *own), days, figure);
                self.page = Page::Figures(Box::new(figures));
            }
            Err(refusal) => {
                self.problem = Some(refusal.message);
                self.decisions.refuse();
                self.page = Page::Decisions;
            }
        }
    }
}

impl Dialog for BranchesPage {
    fn what(&self) -> String {
        format!("what if, week {}", self.decisions.week())
    }

    fn step(&self) -> Option<&'static str> {
        Some(match self.page {
            Page::Decisions => "decisions",
            Page::Working => "simulating",
            Page::Figures(_) => "figures",
        })
    }

    fn scopes(&self) -> Vec<Scope> {
        match self.page {
            Page::Decisions if self.decisions.is_typing() => vec![Scope::Field],
            Page::Decisions => vec![Scope::Decisions, Scope::List, Scope::Dialog],
            Page::Working => vec![Scope::Dialog],
            Page::Figures(_) => vec![Scope::Branches, Scope::List, Scope::Dialog],
        }
    }

    fn hints(&self) -> Vec<Action> {
        match self.page {
            Page::Decisions if self.decisions.is_typing() => vec![Action::Commit, Action::Discard],
            Page::Decisions => vec![
                Action::AddDecision,
                Action::DropDecision,
                Action::SimulateBranches,
                Action::NextAlternative,
                Action::Open,
                Action::Close,
            ],
            Page::Working => vec![Action::Cancel],
            Page::Figures(_) => {
                vec![Action::NextFigure, Action::DrawFutures, Action::AdoptBranch, Action::Close]
            }
        }
    }

    fn act(&mut self, action: Action, _: &Look<'_>) -> Outcome {
        self.problem = None;
        match (&mut self.page, action) {
            (_, Action::Close | Action::Cancel) => return self.leave(),
            (Page::Decisions, Action::SimulateBranches) => return self.ask(None),
            (Page::Figures(_), Action::DrawFutures) => return self.ask(Some(FUTURES)),
            (Page::Figures(_), Action::AdoptBranch) => return self.adopt(),
            (Page::Decisions, action) => self.problem = self.decisions.act(action).err(),
            (Page::Figures(figures), action) => figures.act(action),
            (Page::Working, _) => {}
        }
        Outcome::stay()
    }

    fn key(&mut self, key: &KeyEvent, _: &Look<'_>) -> Outcome {
        self.problem = None;
        self.decisions.key(key);
        Outcome::stay()
    }

    fn paste(&mut self, text: &str, _: &Look<'_>) -> Outcome {
        self.decisions.paste(text);
        Outcome::stay()
    }

    fn take_answers(&mut self) {
        if let Some((_, found)) = self.asked.try_take() {
            self.take(found);
        }
    }

    fn click(&mut self, row: usize, _: &Look<'_>) -> Outcome {
        match &mut self.page {
            Page::Decisions => self.decisions.select(row),
            Page::Figures(figures) => figures.select(row),
            Page::Working => {}
        }
        Outcome::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let own = centered(area, area.width.saturating_sub(2).min(140), area.height.saturating_sub(2));
        canvas.clear(own, Role::Text);
        let week = self.decisions.week();
        let inside = canvas.pane(own, &format!("What if, from week {week}"), &self.note(), true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let below = self.problem.as_ref().map_or(0, |_| 1).min(inside.height);
        let page = Rect { height: inside.height - below, ..inside };
        match &self.page {
            Page::Decisions => self.decisions.draw(canvas, page),
            Page::Working => {
                let (done, all) = self.asked.progress().unwrap_or_default();
                let share = 100 * done / all.max(1);
                canvas.text(page, &format!("simulating days again: {share} % …"), Role::Warning);
            }
            Page::Figures(figures) => figures.draw(canvas, page),
        }
        if let Some(problem) = &self.problem {
            let row = Rect { y: page.y + page.height, height: below, ..inside };
            canvas.text(row, problem, Role::Bad);
        }
        canvas.pane_keys(own, &look.hints(&self.hints()));
    }
}

impl BranchesPage {
    fn note(&self) -> String {
        match &self.page {
            Page::Figures(figures) => figures.note(),
            _ => self.decisions.note(),
        }
    }
}

#[cfg(test)]
mod tests;
