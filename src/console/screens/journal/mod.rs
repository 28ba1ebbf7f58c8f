//! What was done and why, how the forecasts turned out, and the notes of the run.

pub mod entries;
mod scores;

use crossterm::event::{KeyCode, KeyEvent};
use ratatui::layout::{Constraint, Layout, Rect};

use super::{Figure, Look, Screen, ScreenState};
use crate::console::action::{Action, Scope};
use crate::console::canvas::{Canvas, Click};
use crate::console::effect::Effect;
use crate::console::theme::Role;
use crate::console::widgets::{Cell, Column, Editor, Table};

/// Panes by number.
const LIST: usize = 0;
const NOTES: usize = 1;
const SCORES: usize = 2;

/// The screen.
pub struct Journal {
    focus: usize,
    table: Table,
    /// Title and text of the whole entry behind every row.
    wholes: Vec<(String, String)>,
    /// What every row is about.
    figures: Vec<Figure>,
    /// The selected horizon of the forecasts.
    horizon: usize,
    notes: Editor,
    /// The notes as they are kept.
    kept: String,
    editing: bool,
}

impl Default for Journal {
    fn default() -> Self {
        let columns = vec![Column::numbers("day"), Column::words("what").at_most(u16::MAX)];
        Journal {
            focus: LIST,
            table: Table::new(columns),
            wholes: Vec::new(),
            figures: Vec::new(),
            horizon: 0,
            notes: Editor::default(),
            kept: String::new(),
            editing: false,
        }
    }
}

impl Journal {
    fn is_draft(&self) -> bool {
        self.notes.text() != self.kept
    }

    fn save(&mut self) -> Vec<Effect> {
        self.editing = false;
        if self.is_draft() {
            vec![Effect::SetMemo(self.notes.text())]
        } else {
            vec![Effect::Say("notes already saved".to_owned())]
        }
    }

    fn open(&self) -> Vec<Effect> {
        let whole = self.table.selected().and_then(|row| self.wholes.get(row));
        whole.map(|(title, text)| Effect::ShowText(title.clone(), text.clone())).into_iter().collect()
    }
}

impl ScreenState for Journal {
    fn renew(&mut self, look: &Look<'_>) {
        let mut rows = Vec::new();
        self.wholes.clear();
        self.figures.clear();
        for line in entries::lines(look.company) {
            rows.push(vec![
                Cell::number(f64::from(line.day), line.day.to_string()).role(Role::Dim),
                Cell::words(line.text).role(line.role),
            ]);
            self.figures.push(Figure { title: line.title.clone(), term: line.term, sql: line.sql });
            self.wholes.push((line.title, line.whole));
        }
        self.table.set_rows(rows);
        // The editor has its own idea of line ends: only like is compared with like.
        let kept = Editor::of(&look.company.memo);
        if !self.is_draft() && kept.text() != self.kept {
            self.notes = kept.clone();
        }
        self.kept = kept.text();
    }

    fn holds_unsent_text(&self) -> bool {
        self.is_draft()
    }
}

impl Screen for Journal {
    fn scopes(&self) -> Vec<Scope> {
        match self.focus {
            _ if self.editing => vec![Scope::Editor, Scope::Memo],
            LIST if self.table.is_typing() => vec![Scope::Field],
            NOTES => vec![Scope::Memo, Scope::List],
            _ => vec![Scope::List, Scope::Memo],
        }
    }

    fn hints(&self) -> Vec<Action> {
        match self.focus {
            _ if self.editing => vec![Action::SaveMemo, Action::LeaveEditor],
            LIST => vec![Action::Open, Action::Filter, Action::EditMemo],
            SCORES => vec![Action::Up, Action::Down, Action::Close],
            _ => vec![Action::EditMemo, Action::SaveMemo],
        }
    }

    fn panes(&self) -> usize {
        3
    }

    fn focus(&self) -> usize {
        self.focus
    }

    fn set_focus(&mut self, pane: usize) {
        self.focus = pane.min(SCORES);
        self.editing = false;
    }

    fn figure(&self, look: &Look<'_>) -> Option<Figure> {
        match self.focus {
            LIST => self.table.selected().and_then(|row| self.figures.get(row)).cloned(),
            SCORES => scores::figure(look.company, self.horizon),
            _ => None,
        }
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Vec<Effect> {
        match action {
            Action::EditMemo => (self.focus, self.editing) = (NOTES, true),
            Action::SaveMemo => return self.save(),
            Action::LeaveEditor => self.editing = false,
            Action::Close if self.focus != LIST => self.focus = LIST,
            Action::Up | Action::First if self.focus == SCORES => {
                self.horizon = self.horizon.saturating_sub(1)
            }
            Action::Down | Action::Last if self.focus == SCORES => {
                self.horizon = (self.horizon + 1).min(look.company.scores.len().saturating_sub(1));
            }
            Action::Open if self.focus == LIST => return self.open(),
            Action::CommitNext | Action::CommitPrevious => {
                self.table.act(Action::Commit, look.page);
            }
            other if self.focus == LIST => {
                self.table.act(other, look.page);
            }
            _ => {}
        }
        Vec::new()
    }

    fn key(&mut self, key: &KeyEvent, _: &Look<'_>) -> Vec<Effect> {
        if self.editing {
            if key.code == KeyCode::BackTab {
                return vec![Effect::Do(Action::FocusPrevious)];
            }
            self.notes.key(key);
        } else {
            self.table.edit_filter(|field| {
                field.key(key);
            });
        }
        Vec::new()
    }

    fn paste(&mut self, text: &str, _: &Look<'_>) -> Vec<Effect> {
        if self.editing {
            self.notes.insert(text);
        } else {
            self.table.edit_filter(|field| field.insert(text));
        }
        Vec::new()
    }

    fn click(&mut self, pane: usize, row: usize, look: &Look<'_>) -> Vec<Effect> {
        if pane == SCORES {
            self.horizon = row.min(look.company.scores.len().saturating_sub(1));
            return Vec::new();
        }
        let before = self.table.selected();
        self.table.select_place(row);
        if before == self.table.selected() { self.open() } else { Vec::new() }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let few = look.company.scores.len() as u16 + 4;
        let small = area.width < 60 || area.height < 14;
        if canvas.zoomed || small {
            return match self.focus {
                NOTES => self.draw_notes(canvas, area, look),
                SCORES => self.draw_scores(canvas, area, look),
                _ => self.draw_list(canvas, area, look),
            };
        }
        if area.width >= 104 {
            let right = (area.width / 3).clamp(48, 64);
            let [list, side] =
                Layout::horizontal([Constraint::Min(0), Constraint::Length(right)]).areas(area);
            // Single forecasts below the scores, where there is room for some of them.
            let tall = (few + 9).min(side.height / 2).max(few);
            let [scores, notes] =
                Layout::vertical([Constraint::Length(tall), Constraint::Min(0)]).areas(side);
            self.draw_list(canvas, list, look);
            self.draw_scores(canvas, scores, look);
            self.draw_notes(canvas, notes, look);
        } else {
            let [list, below] = Layout::vertical([Constraint::Min(0), Constraint::Length(few)]).areas(area);
            let [scores, notes] =
                Layout::horizontal([Constraint::Length(40), Constraint::Min(0)]).areas(below);
            self.draw_list(canvas, list, look);
            self.draw_scores(canvas, scores, look);
            self.draw_notes(canvas, notes, look);
        }
    }
}

impl Journal {
    fn draw_list(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let focused = self.focus == LIST;
        canvas.click(area, Click::Pane(LIST));
        let inside = canvas.pane(area, "Journal", &self.table.note(), focused);
        self.table.draw(canvas, inside, focused, LIST);
        if focused {
            canvas.pane_keys(area, &look.hints(&[Action::Open, Action::Filter]));
        }
    }

    fn draw_scores(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        scores::draw(canvas, area, look.company, self.horizon, self.focus == SCORES, SCORES);
    }

    fn draw_notes(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        canvas.click(area, Click::Pane(NOTES));
        let note = if self.is_draft() { "draft, unsaved" } else { "" };
        let inside = canvas.pane(area, "Notes", note, self.focus == NOTES);
        let hint = "notes to yourself, saved with the run";
        self.notes.draw(canvas, inside, self.editing, hint);
        let keys: &[Action] = match self.focus {
            _ if self.editing => &[Action::SaveMemo, Action::LeaveEditor],
            _ if self.is_draft() => &[Action::EditMemo, Action::SaveMemo],
            _ => &[Action::EditMemo],
        };
        canvas.pane_keys(area, &look.hints(keys));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::console::company::Company;
    use crate::console::keys::Keys;
    use crate::console::test_kit::{company, picture, session, sweep};
    use crate::session::Via;
    use crossterm::event::KeyModifiers;
    use serde_json::json;

    fn with_look<T>(company: &Company, work: impl FnOnce(&Look<'_>) -> T) -> T {
        let keys = Keys::shipped();
        work(&Look { company, keys: &keys, page: 5 })
    }

    fn act(screen: &mut Journal, company: &Company, action: Action) -> Vec<Effect> {
        with_look(company, |look| screen.act(action, look))
    }

    fn write(screen: &mut Journal, company: &Company, text: &str) {
        for letter in text.chars() {
            let key = KeyEvent::new(KeyCode::Char(letter), KeyModifiers::NONE);
            with_look(company, |look| screen.key(&key, look));
        }
    }

    fn played() -> Company {
        let mut session = session();
        let prices = json!({"A": 12, "B": 25, "C": 55});
        session.call("set_prices", &prices, Via::Form).expect("prices");
        let forecasts = session.naive_forecasts();
        session
            .advance("Cheaper than the others.\nSee who comes.", &forecasts, Via::Form, &mut |_| {})
            .expect("a week");
        session.call("set_prices", &json!({"A": 13}), Via::Form).expect("prices");
        session.undo(Via::Form).expect("taken back");
        Company::of(&session)
    }

    fn renewed(company: &Company) -> Journal {
        let mut screen = Journal::default();
        with_look(company, |look| screen.renew(look));
        screen
    }

    fn holds(lines: &[String], part: &str) -> bool {
        lines.iter().any(|line| line.contains(part))
    }

    #[test]
    fn weeks_stand_with_the_newest_first() {
        let company = played();
        let screen = renewed(&company);
        let texts: Vec<String> = screen.table.rows().iter().map(|row| row[1].text.clone()).collect();
        assert_eq!(texts[0], "week 2 · now · 2 actions");
        assert_eq!(texts[1], "  undone: set_prices A 12 → 13");
        assert_eq!(texts[2], "  undo: set_prices A 13 → 12");
        assert!(texts[3].starts_with("week 1 · day 7 · cash $"), "{texts:#?}");
        assert_eq!(texts[4], "  why  Cheaper than the others. See who comes.");
        assert!(texts[5].starts_with("  said naively: 1 wk $"), "{texts:#?}");
        assert_eq!(texts[6], "  set_prices A 12 B 25 C 55");
    }

    #[test]
    fn every_row_names_what_it_is_about_and_its_rows() {
        let mut session = crate::console::test_kit::played(2);
        let company = Company::of(&session);
        let mut screen = renewed(&company);
        let mut terms = Vec::new();
        for _ in 0..screen.table.rows().len() {
            let figure = with_look(&company, |look| screen.figure(look)).expect("a figure");
            if let Some(sql) = &figure.sql {
                let rows = session.query(sql).unwrap_or_else(|refusal| panic!("{sql}: {refusal}")).rows;
                if figure.term == "cash-change" {
                    let sum: f64 = rows.iter().map(|row| crate::session::number_at(row, 1)).sum();
                    let week = company.weeks.iter().find(|week| (week.cash_change - sum).abs() < 0.01);
                    assert!(week.is_some(), "{sql}: {sum}");
                }
            }
            terms.push(figure.term);
            act(&mut screen, &company, Action::Down);
        }
        for term in ["cash-change", "rationale", "forecast", "set_prices", "set_targeted_ad_spend"] {
            assert!(terms.contains(&term), "{term} in {terms:?}");
        }
        screen.set_focus(SCORES);
        act(&mut screen, &company, Action::Down);
        let figure = with_look(&company, |look| screen.figure(look)).expect("a figure");
        assert!(figure.title.contains("4 weeks"), "{figure:?}");
    }

    #[test]
    fn an_entry_opens_as_text() {
        let company = played();
        let mut screen = renewed(&company);
        for _ in 0..4 {
            act(&mut screen, &company, Action::Down);
        }
        let effects = act(&mut screen, &company, Action::Open);
        let [Effect::ShowText(title, text)] = &effects[..] else { panic!("{effects:?}") };
        assert!(title.starts_with("week 1"), "{title}");
        for part in ["See who comes.", "Forecasts of cash, filled", "set_prices A 12", "How it went"] {
            assert!(text.contains(part), "{text}");
        }
    }

    #[test]
    fn the_screen_shows_list_scores_and_notes() {
        let company = played();
        let screen = renewed(&company);
        for (width, height) in [(80, 21), (120, 37), (200, 57)] {
            let lines = picture(&screen, &company, width, height);
            for part in ["Journal", "week 1 · day 7", " of 1 ", "26 weeks", "Notes"] {
                assert!(holds(&lines, part), "{width}×{height} {part}: {lines:#?}");
            }
        }
    }

    #[test]
    fn a_draft_of_the_notes_survives_until_it_is_kept() {
        let mut company = company();
        let mut screen = renewed(&company);
        act(&mut screen, &company, Action::EditMemo);
        assert_eq!(screen.scopes(), [Scope::Editor, Scope::Memo]);
        write(&mut screen, &company, "watch S3");
        act(&mut screen, &company, Action::LeaveEditor);
        with_look(&company, |look| screen.renew(look));
        assert!(screen.holds_unsent_text() && screen.notes.text() == "watch S3");
        assert!(holds(&picture(&screen, &company, 80, 21), "draft, unsaved"));
        let effects = act(&mut screen, &company, Action::SaveMemo);
        assert!(matches!(&effects[..], [Effect::SetMemo(text)] if text == "watch S3"));
        company.memo = "watch S3\n".to_owned();
        with_look(&company, |look| screen.renew(look));
        assert!(!screen.holds_unsent_text());
        company.memo = "from elsewhere".to_owned();
        with_look(&company, |look| screen.renew(look));
        assert_eq!(screen.notes.text(), "from elsewhere", "nothing was typed: the kept notes are shown");
    }

    #[test]
    fn no_size_is_too_small() {
        for company in [company(), played()] {
            let mut screen = renewed(&company);
            sweep(&mut screen, &company);
            act(&mut screen, &company, Action::Filter);
            sweep(&mut screen, &company);
            act(&mut screen, &company, Action::Discard);
            act(&mut screen, &company, Action::EditMemo);
            write(&mut screen, &company, "a long note with words");
            sweep(&mut screen, &company);
        }
    }
}
