//! Results of a class: ranking, cash curves, a decision plotted against a figure, guesses, pitfalls.

mod draw;
#[cfg(test)]
mod tests;

use crate::action::Action;
use novamind_course::CollectedClass;
use novamind_report::class::{
    ClassDisplayOptions, ClassView, RankedStudent, class_questions, differing_decisions, differing_figures,
    rank_students,
};

const PAGE_ROWS: usize = 10;

/// Pane below the curves in a small window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum LowerPane {
    Scatter,
    Guesses,
    Pitfalls,
}

pub(super) struct ClassPage {
    class: CollectedClass,
    shown: ClassDisplayOptions,
    /// Number of the displayed part, counted from 1.
    part: u32,
    /// Index of the displayed question among the answered questions of the part.
    question: usize,
    lower_pane: LowerPane,
}

impl ClassPage {
    pub(super) fn new(class: CollectedClass, display_options: ClassDisplayOptions) -> ClassPage {
        let mut page =
            ClassPage { class, shown: display_options, part: 1, question: 0, lower_pane: LowerPane::Scatter };
        if page.shown.highlighted_student.is_none() {
            page.highlight(0);
        }
        page
    }

    fn view(&self) -> ClassView<'_> {
        ClassView::new(&self.class, self.shown.clone())
    }

    /// Selects a student by rank, counted from 0. If the rank is too high, selects the last student.
    pub(super) fn highlight(&mut self, place: usize) {
        let view = self.view();
        let ranking = rank_students(&view);
        let lit = ranking.get(place).or(ranking.last()).map(|student| student.label.to_owned());
        self.shown.highlighted_student = lit.or(self.shown.highlighted_student.take());
    }

    /// Returns the index of the selected student in the ranking.
    fn highlighted_index(&self, ranking: &[RankedStudent<'_>]) -> Option<usize> {
        ranking.iter().position(|student| Some(student.label) == self.shown.highlighted_student.as_deref())
    }

    pub(super) fn hints(&self) -> Vec<Action> {
        // The key that closes the page is early in the list, so that it is visible in the narrowest window.
        let mut hints = vec![Action::Down, Action::ClassDecision, Action::ClassFigure, Action::HideNames];
        hints.extend([Action::Close, Action::ClassView]);
        hints.extend((self.question_count() > 1).then_some(Action::ClassQuestion));
        hints.extend((self.view().part_count() > 1).then_some(Action::ClassPart));
        hints
    }

    /// Returns the number of answered questions of the part.
    fn question_count(&self) -> usize {
        let view = self.view();
        class_questions(&view)
            .iter()
            .filter(|class_question| class_question.part == self.part && !class_question.answers.is_empty())
            .count()
    }

    pub(super) fn handle_action(&mut self, action: Action) {
        match action {
            Action::HideNames => self.shown.hides_names = !self.shown.hides_names,
            Action::ClassDecision => self.next_decision(),
            Action::ClassFigure => self.next_figure(),
            Action::ClassQuestion => self.question = (self.question + 1) % self.question_count().max(1),
            Action::ClassPart => {
                self.part = self.part % self.view().part_count() + 1;
                (self.question, self.shown.decision) = (0, None);
            }
            Action::ClassView => {
                self.lower_pane = match self.lower_pane {
                    LowerPane::Scatter => LowerPane::Guesses,
                    LowerPane::Guesses => LowerPane::Pitfalls,
                    LowerPane::Pitfalls => LowerPane::Scatter,
                };
            }
            _ => self.move_highlight(action),
        }
    }

    fn move_highlight(&mut self, action: Action) {
        let view = self.view();
        let ranking = rank_students(&view);
        let place = match (action, self.highlighted_index(&ranking)) {
            (Action::Up, Some(place)) => place.saturating_sub(1),
            (Action::Down, Some(place)) => place + 1,
            (Action::PageUp, Some(place)) => place.saturating_sub(PAGE_ROWS),
            (Action::PageDown, Some(place)) => place + PAGE_ROWS,
            (Action::Last, _) => ranking.len(),
            (Action::First, _) | (Action::Up | Action::Down | Action::PageUp | Action::PageDown, None) => 0,
            _ => return,
        };
        self.highlight(place);
    }

    /// Plots the next decision. The first decision is the one in which students differ most.
    fn next_decision(&mut self) {
        let all = differing_decisions(&rank_students(&self.view()), self.part);
        let now = self.shown.decision.as_ref().or(all.first());
        self.shown.decision = next_name(&all, now).or(self.shown.decision.take());
    }

    fn next_figure(&mut self) {
        let all = differing_figures(&rank_students(&self.view()), self.part);
        let now = self.shown.figure.as_ref().or(all.first());
        self.shown.figure = next_name(&all, now).or(self.shown.figure.take());
    }
}

/// Returns the name after the current name, cyclically. Returns `None` if there are no names.
fn next_name(all: &[String], now: Option<&String>) -> Option<String> {
    let at = all.iter().position(|text| Some(text) == now);
    all.get(at.map_or(0, |at| (at + 1) % all.len())).cloned()
}
