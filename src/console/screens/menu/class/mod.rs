//! Results of a class: ranking, cash curves, a decision plotted against a figure, guesses, pitfalls.

mod draw;
#[cfg(test)]
mod tests;

use crate::action::Action;
use novamind_course::CollectedClass;
use novamind_report::class::{ClassView, RankedStudent, Shown, asked, decisions, figures, ranked};

const PAGE: usize = 10;

/// Pane below the curves in a small window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Below {
    Scatter,
    Guesses,
    Pitfalls,
}

pub(super) struct ClassPage {
    class: CollectedClass,
    shown: Shown,
    /// The part, from 1.
    part: u32,
    /// Index of the shown question among the answered ones of the part.
    question: usize,
    below: Below,
}

impl ClassPage {
    pub(super) fn new(class: CollectedClass, shown: Shown) -> ClassPage {
        let mut page = ClassPage { class, shown, part: 1, question: 0, below: Below::Scatter };
        if page.shown.lit.is_none() {
            page.light(0);
        }
        page
    }

    fn view(&self) -> ClassView<'_> {
        ClassView::of(&self.class, self.shown.clone())
    }

    /// Selects a student by rank, from 0; the last student if the rank is too high.
    pub(super) fn light(&mut self, place: usize) {
        let view = self.view();
        let ranking = ranked(&view);
        let lit = ranking.get(place).or(ranking.last()).map(|student| student.label.to_owned());
        self.shown.lit = lit.or(self.shown.lit.take());
    }

    /// Returns the rank of the selected student.
    fn lit(&self, ranking: &[RankedStudent<'_>]) -> Option<usize> {
        ranking.iter().position(|student| Some(student.label) == self.shown.lit.as_deref())
    }

    pub(super) fn hints(&self) -> Vec<Action> {
        // The key to close the page is visible in the narrowest window, too.
        let mut hints = vec![Action::Down, Action::ClassDecision, Action::ClassFigure, Action::HideNames];
        hints.extend([Action::Close, Action::ClassView]);
        hints.extend((self.questions() > 1).then_some(Action::ClassQuestion));
        hints.extend((self.view().parts() > 1).then_some(Action::ClassPart));
        hints
    }

    /// Returns the number of answered questions of the part.
    fn questions(&self) -> usize {
        let view = self.view();
        asked(&view).iter().filter(|own| own.part == self.part && !own.answers.is_empty()).count()
    }

    pub(super) fn act(&mut self, action: Action) {
        match action {
            Action::HideNames => self.shown.hides_names = !self.shown.hides_names,
            Action::ClassDecision => self.turn_decision(),
            Action::ClassFigure => self.turn_figure(),
            Action::ClassQuestion => self.question = (self.question + 1) % self.questions().max(1),
            Action::ClassPart => {
                self.part = self.part % self.view().parts() + 1;
                (self.question, self.shown.decision) = (0, None);
            }
            Action::ClassView => {
                self.below = match self.below {
                    Below::Scatter => Below::Guesses,
                    Below::Guesses => Below::Pitfalls,
                    Below::Pitfalls => Below::Scatter,
                };
            }
            _ => self.walk(action),
        }
    }

    fn walk(&mut self, action: Action) {
        let view = self.view();
        let ranking = ranked(&view);
        let place = match (action, self.lit(&ranking)) {
            (Action::Up, Some(place)) => place.saturating_sub(1),
            (Action::Down, Some(place)) => place + 1,
            (Action::PageUp, Some(place)) => place.saturating_sub(PAGE),
            (Action::PageDown, Some(place)) => place + PAGE,
            (Action::Last, _) => ranking.len(),
            (Action::First, _) | (Action::Up | Action::Down | Action::PageUp | Action::PageDown, None) => 0,
            _ => return,
        };
        self.light(place);
    }

    /// Plots the next decision, starting with the one in which students differ most.
    fn turn_decision(&mut self) {
        let all = decisions(&ranked(&self.view()), self.part);
        let now = self.shown.decision.as_ref().or(all.first());
        self.shown.decision = next_of(&all, now).or(self.shown.decision.take());
    }

    fn turn_figure(&mut self) {
        let all = figures(&ranked(&self.view()), self.part);
        let now = self.shown.figure.as_ref().or(all.first());
        self.shown.figure = next_of(&all, now).or(self.shown.figure.take());
    }
}

/// Returns the next name, cyclically; `None` if there are no names.
fn next_of(all: &[String], now: Option<&String>) -> Option<String> {
    let at = all.iter().position(|own| Some(own) == now);
    all.get(at.map_or(0, |at| (at + 1) % all.len())).cloned()
}
