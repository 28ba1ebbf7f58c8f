//! The glossary: all terms, with a filter.

use std::sync::Arc;

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::{Dialog, Outcome, term_picture};
use crate::action::{Action, Scope};
use crate::context::Look;
use crate::effect::Effect;
use novamind_glossary::{Subject, Term, terms};
use novamind_tools::Numbers;
use novamind_tui::canvas::{Canvas, centered, rows_of};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{Cell, Column, Table};

/// The glossary dialog.
pub struct Glossary {
    table: Table,
    numbers: Arc<Numbers>,
}

const TEXT_ROWS: u16 = 6;
/// Rows for a text with a picture: a rule and the picture.
const PICTURE_ROWS: u16 = 1 + term_picture::MOST_ROWS;

impl Glossary {
    /// Lists all terms by topic, with the parameters of the run.
    pub fn new(numbers: Arc<Numbers>) -> Glossary {
        let columns = vec![
            Column::words("term").at_most(22),
            Column::words("about").at_most(9),
            Column::words("what it is").at_most(160),
        ];
        let row = |term: &Term| {
            // Synonyms are appended after the visible text, so that the filter finds them.
            let text = match term.aka.as_slice() {
                [] => term.text.clone(),
                words => format!("{} Also: {}.", term.text, words.join(", ")),
            };
            vec![
                Cell::words(term.title.as_str()),
                Cell::words(term.topic.as_str()).role(Role::Dim),
                Cell::words(text).role(Role::Text),
            ]
        };
        let mut table = Table::new(columns);
        table.set_rows(terms().iter().map(row).collect());
        Glossary { table, numbers }
    }

    fn selected(&self) -> Option<&'static Term> {
        self.table.selected().and_then(|at| terms().get(at))
    }

    fn open(&self) -> Outcome {
        match self.selected() {
            Some(term) => Outcome::with(vec![Effect::Explain(Subject::Term(term))]),
            None => Outcome::stay(),
        }
    }
}

impl Dialog for Glossary {
    fn what(&self) -> String {
        "glossary".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        if self.table.is_typing() { vec![Scope::Field] } else { vec![Scope::List, Scope::Dialog] }
    }

    fn hints(&self) -> Vec<Action> {
        if self.table.is_typing() {
            vec![Action::Commit, Action::Discard]
        } else {
            vec![Action::Open, Action::Filter, Action::Close]
        }
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Outcome {
        // The wheel moves the selection.
        let action = match action {
            Action::ScrollUp => Action::Up,
            Action::ScrollDown => Action::Down,
            other => other,
        };
        if self.table.act(action, look.page) {
            return Outcome::stay();
        }
        match action {
            Action::Open => self.open(),
            Action::Close | Action::Cancel => Outcome::close(),
            // Prevents a second glossary from opening over an explanation.
            Action::Glossary => Outcome::stay(),
            other if other.entry().scope == Scope::Global => Outcome::close_with(vec![Effect::Do(other)]),
            _ => Outcome::stay(),
        }
    }

    fn key(&mut self, key: &KeyEvent, _: &Look<'_>) -> Outcome {
        self.table.edit_filter(|field| {
            field.key(key);
        });
        Outcome::stay()
    }

    fn paste(&mut self, text: &str, _: &Look<'_>) -> Outcome {
        self.table.edit_filter(|field| field.insert(text.trim()));
        Outcome::stay()
    }

    fn click(&mut self, row: usize, _: &Look<'_>) -> Outcome {
        let before = self.table.selected();
        self.table.select_place(row);
        if before == self.table.selected() { self.open() } else { Outcome::stay() }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let own = centered(area, area.width.saturating_sub(4).min(130), area.height.saturating_sub(2));
        canvas.clear(own, Role::Text);
        let note = match self.table.note() {
            note if note.is_empty() => format!("{} terms", terms().len()),
            note => note,
        };
        let inside = canvas.pane(own, "Glossary", &note, true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let has_picture = self.selected().is_some_and(|term| term_picture::has_picture(&term.id));
        let for_text = match inside.height {
            height if has_picture && height >= 2 * PICTURE_ROWS => PICTURE_ROWS,
            height if height >= 2 * TEXT_ROWS => TEXT_ROWS,
            _ => 0,
        };
        let list = Rect { height: inside.height - for_text, ..inside };
        self.table.draw(canvas, list, true, 0);
        if self.table.shown().is_empty() && list.height > 1 {
            let row = Rect { y: list.y + 1, height: 1, ..list };
            let text = format!("no term contains {}", look.hint(Action::Discard));
            canvas.text(row, &text, Role::Dim);
        }
        let below = Rect { y: list.bottom(), height: for_text, ..inside };
        if let Some(term) = self.selected() {
            self.draw_term(canvas, below, term, look);
        }
        canvas.pane_keys(own, &look.hints(&self.hints()));
    }
}

impl Glossary {
    fn draw_term(&self, canvas: &mut Canvas<'_>, area: Rect, term: &Term, look: &Look<'_>) {
        if area.is_empty() {
            return;
        }
        let rule = "─".repeat(area.width as usize);
        canvas.text(area, &rule, Role::Border);
        let text = format!("{} {}", term.text, self.numbers.fill(&term.more));
        let rest = Rect { y: area.y + 1, height: area.height - 1, ..area };
        // The picture is drawn next to the text if half of the width remains.
        let has_picture = term_picture::has_picture(&term.id) && area.width >= 2 * term_picture::COLUMNS;
        let taken = if has_picture { term_picture::COLUMNS } else { 0 };
        let words = Rect { width: area.width - taken, ..rest };
        for (row, line) in
            rows_of(words).zip(wrapped(text.trim(), words.width.saturating_sub(taken.min(1)) as usize))
        {
            canvas.text(row, &line, Role::Text);
        }
        term_picture::draw(canvas, Rect { x: words.right(), width: taken, ..rest }, &term.id, look.company);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::{company, dialog_picture, in_dialog, played};
    use novamind_worker::company::Company;

    #[test]
    fn terms_are_found_by_any_of_their_words_and_opened() {
        let company = company();
        let mut dialog = Glossary::new(company.numbers.clone());
        let shown = dialog_picture(&dialog, &company, 80, 21);
        assert!(
            shown.contains("terms") && shown.contains("Runway") && shown.contains("amounts in the ledger"),
            "{shown}"
        );
        in_dialog(&mut dialog, Action::Filter, &company);
        dialog.table.edit_filter(|field| field.insert("word of mouth"));
        in_dialog(&mut dialog, Action::Commit, &company);
        let outcome = in_dialog(&mut dialog, Action::Open, &company);
        assert!(
            matches!(&outcome.effects[..], [Effect::Explain(Subject::Term(term))] if term.id == "network-source"),
            "{outcome:?}"
        );
        assert!(!outcome.close, "closing the explanation leads back to the list");
        let away = in_dialog(&mut dialog, Action::Cash, &company);
        assert!(away.close && matches!(away.effects[..], [Effect::Do(Action::Cash)]));
        assert!(!in_dialog(&mut dialog, Action::Close, &company).close, "the filter is cleared first");
        assert!(in_dialog(&mut dialog, Action::Close, &company).close);
    }

    #[test]
    fn the_participation_curve_is_there_with_a_picture() {
        let company = company();
        let mut dialog = Glossary::new(company.numbers.clone());
        in_dialog(&mut dialog, Action::Filter, &company);
        dialog.table.edit_filter(|field| field.insert("participation curve"));
        in_dialog(&mut dialog, Action::Commit, &company);
        let shown = dialog_picture(&dialog, &company, 120, 40);
        assert!(
            shown.contains("Participation curve") && shown.contains("$50") && shown.contains('┈'),
            "{shown}"
        );
        let small = dialog_picture(&dialog, &company, 80, 24);
        assert!(small.contains("Participation curve") && !small.contains("$50"), "{small}");
    }

    #[test]
    fn terms_are_drawn_from_the_figures_of_the_company() {
        let company = Company::of(&played(2));
        for (word, caption) in [
            ("fit", "estimates of day 0"),
            ("cohort", "Share of a cohort that remains"),
            ("spill-over", "a reputation change of 0.1"),
            ("quality bank", "base quality"),
            ("network leads", "Leads of all groups by week"),
        ] {
            let mut dialog = Glossary::new(company.numbers.clone());
            in_dialog(&mut dialog, Action::Filter, &company);
            dialog.table.edit_filter(|field| field.insert(word));
            in_dialog(&mut dialog, Action::Commit, &company);
            let shown = dialog_picture(&dialog, &company, 130, 44);
            assert!(shown.contains(caption), "{word}: {shown}");
            for (width, height) in [(0, 0), (20, 60), (60, 60), (80, 24), (90, 60)] {
                dialog_picture(&dialog, &company, width, height);
            }
        }
    }

    #[test]
    fn a_filter_without_terms_says_so() {
        let company = company();
        let mut dialog = Glossary::new(company.numbers.clone());
        in_dialog(&mut dialog, Action::Filter, &company);
        dialog.table.edit_filter(|field| field.insert("zzz"));
        let shown = dialog_picture(&dialog, &company, 80, 21);
        assert!(shown.contains("no term contains"), "{shown}");
        in_dialog(&mut dialog, Action::Commit, &company);
        assert!(in_dialog(&mut dialog, Action::Open, &company).effects.is_empty());
        for (width, height) in [(0, 0), (2, 2), (20, 5), (60, 13), (200, 57)] {
            dialog_picture(&dialog, &company, width, height);
        }
    }
}
