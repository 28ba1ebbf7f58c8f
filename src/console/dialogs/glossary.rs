//! The glossary: all terms, with a filter.

use std::sync::Arc;

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::{Dialog, DialogResponse, glossary_picture};
use crate::action::{Action, Scope};
use crate::context::ScreenContext;
use crate::effect::Effect;
use novamind_glossary::{Subject, Term, terms};
use novamind_tools::ParameterNumbers;
use novamind_tui::canvas::{Canvas, centered_rect, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{Table, TableCell, TableColumn};

/// The glossary dialog.
pub struct GlossaryDialog {
    table: Table,
    numbers: Arc<ParameterNumbers>,
}

const TEXT_ROWS: u16 = 6;
/// Additional rows if the term has a picture: a separator line and the picture.
const PICTURE_ROWS: u16 = 1 + glossary_picture::MAX_ROWS;

impl GlossaryDialog {
    /// Lists all terms by topic, with the parameters of the run.
    pub fn new(numbers: Arc<ParameterNumbers>) -> GlossaryDialog {
        let columns = vec![
            TableColumn::text("term").with_max_width(22),
            TableColumn::text("about").with_max_width(9),
            TableColumn::text("meaning").with_max_width(160),
        ];
        let row = |term: &Term| {
            // Synonyms are appended after the visible text, so that the filter finds them.
            let text = match term.aka.as_slice() {
                [] => term.text.clone(),
                words => format!("{} Also: {}.", term.text, words.join(", ")),
            };
            vec![
                TableCell::from_text(term.title.as_str()),
                TableCell::from_text(term.topic.as_str()).with_role(Role::Dim),
                TableCell::from_text(text).with_role(Role::Text),
            ]
        };
        let mut table = Table::new(columns);
        table.set_rows(terms().iter().map(row).collect());
        GlossaryDialog { table, numbers }
    }

    fn selected(&self) -> Option<&'static Term> {
        self.table.selected().and_then(|at| terms().get(at))
    }

    fn open_term(&self) -> DialogResponse {
        match self.selected() {
            Some(term) => DialogResponse::stay_with(vec![Effect::Explain(Subject::Term(term))]),
            None => DialogResponse::stay(),
        }
    }
}

impl Dialog for GlossaryDialog {
    fn record_name(&self) -> String {
        "glossary".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        if self.table.is_filter_open() { vec![Scope::Field] } else { vec![Scope::List, Scope::Dialog] }
    }

    fn hints(&self) -> Vec<Action> {
        if self.table.is_filter_open() {
            vec![Action::Commit, Action::Discard]
        } else {
            vec![Action::Open, Action::Filter, Action::Close]
        }
    }

    fn handle_action(&mut self, action: Action, context: &ScreenContext<'_>) -> DialogResponse {
        // The mouse wheel moves the selection.
        let action = match action {
            Action::ScrollUp => Action::Up,
            Action::ScrollDown => Action::Down,
            other => other,
        };
        if self.table.handle_action(action, context.page_rows) {
            return DialogResponse::stay();
        }
        match action {
            Action::Open => self.open_term(),
            Action::Close | Action::Cancel => DialogResponse::close(),
            // Prevents a second glossary from opening over an explanation.
            Action::Glossary => DialogResponse::stay(),
            other if other.entry().scope == Scope::Global => {
                DialogResponse::confirm_with(vec![Effect::Execute(other)])
            }
            _ => DialogResponse::stay(),
        }
    }

    fn handle_key(&mut self, key: &KeyEvent, _: &ScreenContext<'_>) -> DialogResponse {
        self.table.edit_filter(|field| {
            field.handle_key(key);
        });
        DialogResponse::stay()
    }

    fn paste(&mut self, text: &str, _: &ScreenContext<'_>) -> DialogResponse {
        self.table.edit_filter(|field| field.insert(text.trim()));
        DialogResponse::stay()
    }

    fn handle_click(&mut self, row: usize, _: &ScreenContext<'_>) -> DialogResponse {
        let before = self.table.selected();
        self.table.select_visible_row(row);
        if before == self.table.selected() { self.open_term() } else { DialogResponse::stay() }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let dialog_area =
            centered_rect(area, area.width.saturating_sub(4).min(130), area.height.saturating_sub(2));
        canvas.clear(dialog_area, Role::Text);
        let note = match self.table.summary() {
            note if note.is_empty() => format!("{} terms", terms().len()),
            note => note,
        };
        let inside = canvas.draw_pane_frame(dialog_area, "Glossary", &note, true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let has_picture = self.selected().is_some_and(|term| glossary_picture::has_picture(&term.id));
        let for_text = match inside.height {
            height if has_picture && height >= 2 * PICTURE_ROWS => PICTURE_ROWS,
            height if height >= 2 * TEXT_ROWS => TEXT_ROWS,
            _ => 0,
        };
        let list = Rect { height: inside.height - for_text, ..inside };
        self.table.draw(canvas, list, true, 0);
        if self.table.visible_rows().is_empty() && list.height > 1 {
            let row = Rect { y: list.y + 1, height: 1, ..list };
            let text = format!("no term contains {}", context.hint(Action::Discard));
            canvas.draw_text(row, &text, Role::Dim);
        }
        let below = Rect { y: list.bottom(), height: for_text, ..inside };
        if let Some(term) = self.selected() {
            self.draw_term(canvas, below, term, context);
        }
        canvas.draw_pane_keys(dialog_area, &context.hints(&self.hints()));
    }
}

impl GlossaryDialog {
    fn draw_term(&self, canvas: &mut Canvas<'_>, area: Rect, term: &Term, context: &ScreenContext<'_>) {
        if area.is_empty() {
            return;
        }
        let rule = "─".repeat(area.width as usize);
        canvas.draw_text(area, &rule, Role::Border);
        let text = format!("{} {}", term.text, self.numbers.substitute(&term.more));
        let rest = Rect { y: area.y + 1, height: area.height - 1, ..area };
        // The picture is drawn next to the text if half of the width remains.
        let has_picture =
            glossary_picture::has_picture(&term.id) && area.width >= 2 * glossary_picture::SIDE_COLUMNS;
        let taken = if has_picture { glossary_picture::SIDE_COLUMNS } else { 0 };
        let words = Rect { width: area.width - taken, ..rest };
        for (row, line) in
            row_rects(words).zip(wrap(text.trim(), words.width.saturating_sub(taken.min(1)) as usize))
        {
            canvas.draw_text(row, &line, Role::Text);
        }
        glossary_picture::draw(
            canvas,
            Rect { x: words.right(), width: taken, ..rest },
            &term.id,
            context.company,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::{dialog_action, dialog_text, new_company, played_session};
    use novamind_worker::company::DisplayedCompany;

    #[test]
    fn filter_finds_terms_by_synonyms() {
        let company = new_company();
        let mut dialog = GlossaryDialog::new(company.numbers.clone());
        let shown = dialog_text(&dialog, &company, 80, 21);
        assert!(
            shown.contains("terms") && shown.contains("Runway") && shown.contains("amounts in the ledger"),
            "{shown}"
        );
        dialog_action(&mut dialog, Action::Filter, &company);
        dialog.table.edit_filter(|field| field.insert("word of mouth"));
        dialog_action(&mut dialog, Action::Commit, &company);
        let outcome = dialog_action(&mut dialog, Action::Open, &company);
        assert!(
            matches!(&outcome.effects[..], [Effect::Explain(Subject::Term(term))] if term.id == "network-source"),
            "{outcome:?}"
        );
        assert!(!outcome.closes, "closing the explanation leads back to the list");
        let away = dialog_action(&mut dialog, Action::Cash, &company);
        assert!(away.closes && matches!(away.effects[..], [Effect::Execute(Action::Cash)]));
        assert!(!dialog_action(&mut dialog, Action::Close, &company).closes, "the filter is cleared first");
        assert!(dialog_action(&mut dialog, Action::Close, &company).closes);
    }

    #[test]
    fn participation_curve_has_a_picture() {
        let company = new_company();
        let mut dialog = GlossaryDialog::new(company.numbers.clone());
        dialog_action(&mut dialog, Action::Filter, &company);
        dialog.table.edit_filter(|field| field.insert("participation curve"));
        dialog_action(&mut dialog, Action::Commit, &company);
        let shown = dialog_text(&dialog, &company, 120, 40);
        assert!(
            shown.contains("Participation curve") && shown.contains("$50") && shown.contains('┈'),
            "{shown}"
        );
        let small = dialog_text(&dialog, &company, 80, 24);
        assert!(small.contains("Participation curve") && !small.contains("$50"), "{small}");
    }

    #[test]
    fn pictures_use_the_figures_of_the_company() {
        let company = DisplayedCompany::from_session(&played_session(2));
        for (word, caption) in [
            ("fit", "estimates of day 0"),
            ("cohort", "Share of a cohort that remains"),
            ("spill-over", "a reputation change of 0.1"),
            ("quality bank", "base quality"),
            ("network leads", "Leads of all groups by week"),
        ] {
            let mut dialog = GlossaryDialog::new(company.numbers.clone());
            dialog_action(&mut dialog, Action::Filter, &company);
            dialog.table.edit_filter(|field| field.insert(word));
            dialog_action(&mut dialog, Action::Commit, &company);
            let shown = dialog_text(&dialog, &company, 130, 44);
            assert!(shown.contains(caption), "{word}: {shown}");
            for (width, height) in [(0, 0), (20, 60), (60, 60), (80, 24), (90, 60)] {
                dialog_text(&dialog, &company, width, height);
            }
        }
    }

    #[test]
    fn filter_without_matches_shows_a_message() {
        let company = new_company();
        let mut dialog = GlossaryDialog::new(company.numbers.clone());
        dialog_action(&mut dialog, Action::Filter, &company);
        dialog.table.edit_filter(|field| field.insert("zzz"));
        let shown = dialog_text(&dialog, &company, 80, 21);
        assert!(shown.contains("no term contains"), "{shown}");
        dialog_action(&mut dialog, Action::Commit, &company);
        assert!(dialog_action(&mut dialog, Action::Open, &company).effects.is_empty());
        for (width, height) in [(0, 0), (2, 2), (20, 5), (60, 13), (200, 57)] {
            dialog_text(&dialog, &company, width, height);
        }
    }
}
