//! The database: tables on the left, a statement above, its result below.

mod browser;
mod completion;
mod editor;
mod history;
mod lexer;
mod picker;
mod plot;
mod results;
mod saving;
mod takeout;
#[cfg(test)]
mod tests;
pub mod values;

use std::time::Instant;

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use ratatui::layout::{Constraint, Layout, Rect};

use super::{Look, Screen};
use crate::console::action::{Action, Scope};
use crate::console::canvas::{Canvas, Click};
use crate::console::effect::Effect;
use crate::console::message::News;
use crate::console::widgets::Field;
use crate::session::Library;
use crate::session::library::Head;
use browser::Browser;
use editor::{QueryEditor, Statement};
use history::History;
use picker::{Choice, Item, Picker};
use results::Results;
use saving::Saving;
use takeout::TakeOut;

/// Panes by number.
const EDITOR: usize = 0;
const RESULTS: usize = 1;
const BROWSER: usize = 2;
/// Clicks on a list that lies over the panes.
const OVER: usize = 3;

/// Below this width the tables are shown only while they are used.
const WIDE: u16 = 90;

/// A statement that is being answered: the text of the editor when it was asked, and the statement in it.
struct Running {
    text: String,
    statement: Statement,
    since: Instant,
}

/// What lies over the panes.
enum Over {
    /// Statements asked before.
    Earlier(Picker),
    /// Named queries.
    Library(Picker),
    /// The name of a statement that is saved.
    Saving(Saving),
    /// Ways to take a result out.
    TakeOut(TakeOut),
}

/// The screen.
pub struct Sql {
    editor: QueryEditor,
    results: Results,
    browser: Browser,
    history: History,
    library: Library,
    over: Option<Over>,
    focus: usize,
    running: Option<Running>,
    /// The last thing that happened was a column put in from the tables: another one follows after a comma.
    column_put_in: bool,
}

impl Default for Sql {
    fn default() -> Self {
        Sql {
            editor: QueryEditor::default(),
            results: Results::default(),
            browser: Browser::default(),
            history: History::default(),
            library: Library::shipped(),
            over: None,
            focus: EDITOR,
            running: None,
            column_put_in: false,
        }
    }
}

impl Sql {
    /// Takes the named queries.
    pub fn learn(&mut self, library: Library) {
        self.library = library;
    }

    /// Puts a statement into the editor; what was in it is kept among the earlier ones.
    pub fn edit(&mut self, sql: &str) {
        if self.editor.text().trim() != sql.trim() {
            self.history.remember_draft(&self.editor.text());
        }
        self.editor.replace(sql);
        self.over = None;
        self.focus = EDITOR;
    }

    /// Puts a statement into the editor and runs it.
    pub fn edit_and_run(&mut self, sql: &str) -> Vec<Effect> {
        self.edit(sql);
        self.editor.go_to_top();
        // Nothing was typed: the keys are those of the result.
        self.focus = RESULTS;
        self.run()
    }

    /// Whether a statement is being answered.
    pub fn is_running(&self) -> bool {
        self.running.is_some()
    }

    fn run(&mut self) -> Vec<Effect> {
        if self.running.is_some() {
            return vec![Effect::Complain("a query is running; esc cancels it".to_owned())];
        }
        self.editor.hide_completion();
        let Some(statement) = self.editor.statement() else {
            return vec![Effect::Complain("no statement to run: type one first".to_owned())];
        };
        self.history.remember(&statement.sql);
        let sql = statement.sql.clone();
        self.running = Some(Running { text: self.editor.text(), statement, since: Instant::now() });
        vec![Effect::Ask(sql)]
    }

    fn find_earlier(&mut self, look: &Look<'_>) -> Vec<Effect> {
        self.editor.hide_completion();
        match self.history.picker(&look.company.asked) {
            Some(picker) => {
                self.over = Some(Over::Earlier(picker));
                Vec::new()
            }
            None => vec![Effect::Say("no queries in this run yet: f5 runs a statement".to_owned())],
        }
    }

    fn find_named(&mut self) {
        self.editor.hide_completion();
        let item = |query: &crate::session::library::NamedQuery| Item {
            tag: if query.own { "own" } else { "" },
            title: query.title.clone(),
            what: query.what.clone(),
            preview: query.body().to_owned(),
            sql: query.sql.clone(),
        };
        let items = self.library.queries().iter().map(item).collect();
        self.over = Some(Over::Library(Picker::new("Library", "runs it", items)));
    }

    fn save(&mut self) -> Vec<Effect> {
        self.editor.hide_completion();
        let Some(statement) = self.editor.statement() else {
            return vec![Effect::Complain("no statement to save: type one first".to_owned())];
        };
        self.over = Some(Over::Saving(Saving::of(statement.sql)));
        Vec::new()
    }

    fn take_out(&mut self) -> Vec<Effect> {
        if !self.results.has_rows() {
            return vec![Effect::Complain("no result to export: run a statement first".to_owned())];
        }
        self.over = Some(Over::TakeOut(TakeOut::default()));
        Vec::new()
    }

    /// Does an action in what lies over the panes.
    fn act_over(&mut self, action: Action, look: &Look<'_>) -> Vec<Effect> {
        match &mut self.over {
            // The same key again goes on to the next one; the other one changes the list.
            Some(Over::Earlier(picker)) if action == Action::History => picker.next(),
            Some(Over::Library(picker)) if action == Action::Library => picker.next(),
            Some(Over::Earlier(_)) if action == Action::Library => self.find_named(),
            Some(Over::Library(_)) if action == Action::History => return self.find_earlier(look),
            Some(Over::Earlier(picker) | Over::Library(picker)) => {
                let choice = picker.act(action);
                return self.choose(choice);
            }
            Some(Over::Saving(saving)) => match action {
                Action::Commit => {
                    if let Some(effect) = saving.commit(&self.library) {
                        self.over = None;
                        return vec![effect];
                    }
                }
                Action::Discard => self.over = None,
                _ => {}
            },
            Some(Over::TakeOut(list)) => {
                let way = list.act(action);
                if way.is_some() || action == Action::Close {
                    self.over = None;
                }
                return way.map_or_else(Vec::new, |way| self.results.take_out(way));
            }
            None => {}
        }
        Vec::new()
    }

    /// An earlier statement is put into the editor; a named query is run too.
    fn choose(&mut self, choice: Choice) -> Vec<Effect> {
        let named = matches!(self.over, Some(Over::Library(_)));
        match choice {
            Choice::None => {}
            Choice::Closed => self.over = None,
            Choice::Statement(sql) if named => return self.edit_and_run(&sql),
            Choice::Statement(sql) => self.edit(&sql),
        }
        Vec::new()
    }

    /// The field that is being typed into, if one is.
    fn field(&mut self) -> Option<&mut Field> {
        match (&mut self.over, self.focus) {
            (Some(Over::Earlier(picker) | Over::Library(picker)), _) => Some(picker.field()),
            (Some(Over::Saving(saving)), _) => Some(&mut saving.field),
            (Some(Over::TakeOut(_)), _) => None,
            (None, RESULTS) => self.results.table().typing(),
            (None, BROWSER) => self.browser.typing(),
            (None, _) => None,
        }
    }

    /// Looks for what is typed, as far as it is typed.
    fn filter_typed(&mut self) {
        match (&mut self.over, self.focus) {
            (Some(Over::Earlier(picker) | Over::Library(picker)), _) => picker.find(),
            (Some(_), _) => {}
            (None, RESULTS) => self.results.table().typed(),
            (None, _) => self.browser.typed(),
        }
    }

    /// Puts the selected name of the tables into the editor.
    fn put_in(&mut self) {
        let Some(entry) = self.browser.selected() else { return };
        if self.editor.is_blank() && entry.column().is_none() {
            self.editor.replace(&format!("SELECT * FROM {} LIMIT 100", entry.name()));
        } else {
            self.editor.insert_name(entry.name(), self.column_put_in && entry.column().is_some());
            self.column_put_in = entry.column().is_some();
        }
    }

    fn leave_editor(&mut self) -> Vec<Effect> {
        if self.editor.hide_completion() {
            return Vec::new();
        }
        if self.running.is_some() {
            return vec![Effect::CancelQuery];
        }
        self.focus = RESULTS;
        Vec::new()
    }

    fn act_in_browser(&mut self, action: Action, look: &Look<'_>) -> Vec<Effect> {
        if action == Action::Open {
            self.put_in();
        } else if !self.browser.act(action, look.page) && action == Action::Close {
            self.focus = EDITOR;
        }
        Vec::new()
    }

    fn act_in_results(&mut self, action: Action, look: &Look<'_>) -> Vec<Effect> {
        if matches!(action, Action::Close | Action::CloseChart) && self.running.is_some() {
            return vec![Effect::CancelQuery];
        }
        self.results.act(action, look.page)
    }

    /// The wheel turns over the editor.
    fn scroll_editor(&mut self, action: Action) {
        let code = if action == Action::Up { KeyCode::Up } else { KeyCode::Down };
        self.editor.hide_completion();
        self.editor.key(&KeyEvent::new(code, KeyModifiers::NONE));
    }
}

impl Screen for Sql {
    fn scopes(&self) -> Vec<Scope> {
        match (&self.over, self.focus) {
            (Some(Over::Earlier(_) | Over::Library(_)), _) => vec![Scope::Field, Scope::Query],
            (Some(Over::Saving(_)), _) => vec![Scope::Field],
            (Some(Over::TakeOut(_)), _) => vec![Scope::Export, Scope::List],
            (None, EDITOR) => vec![Scope::Editor, Scope::Query],
            (None, RESULTS) if self.results.is_typing() => vec![Scope::Field],
            (None, RESULTS) if self.results.is_chart() => {
                vec![Scope::Chart, Scope::Result, Scope::List, Scope::Query]
            }
            (None, RESULTS) => vec![Scope::Result, Scope::List, Scope::Query],
            (None, _) if self.browser.is_typing() => vec![Scope::Field],
            (None, _) => vec![Scope::List, Scope::Query],
        }
    }

    fn hints(&self) -> Vec<Action> {
        match (&self.over, self.focus) {
            (Some(Over::TakeOut(_)), _) => vec![Action::Open, Action::Close],
            (Some(_), _) => vec![Action::Commit, Action::Discard],
            (None, EDITOR) => {
                vec![Action::RunQuery, Action::Complete, Action::SaveQuery, Action::LeaveEditor]
            }
            (None, RESULTS) => self.results.hints(),
            (None, _) => vec![Action::Open, Action::Filter, Action::RunQuery, Action::EditQuery],
        }
    }

    fn panes(&self) -> usize {
        3
    }

    fn focus(&self) -> usize {
        self.focus
    }

    fn set_focus(&mut self, pane: usize) {
        if pane <= BROWSER {
            self.focus = pane;
            self.editor.hide_completion();
        }
    }

    fn hear(&mut self, news: &News, _: &Look<'_>) -> Vec<Effect> {
        let (News::Answered(_, answer, took), Some(running)) = (news, self.running.take()) else {
            return Vec::new();
        };
        // The place of an error is shown only in the text it belongs to.
        if let Err(refusal) = answer
            && let Some(place) = results::place_of(refusal)
            && self.editor.text() == running.text
        {
            self.editor.mark(running.statement.from + place);
            self.focus = EDITOR;
        }
        self.results.take(&running.statement.sql, answer.clone(), *took);
        Vec::new()
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Vec<Effect> {
        if self.over.is_some() {
            return self.act_over(action, look);
        }
        if action != Action::Open {
            self.column_put_in = false;
        }
        match action {
            Action::RunQuery => return self.run(),
            Action::Complete if self.focus == EDITOR => self.editor.complete(),
            Action::Complete => return vec![Effect::Do(Action::FocusNext)],
            Action::EditQuery => self.focus = EDITOR,
            Action::ClearQuery => self.edit(""),
            Action::LeaveEditor => return self.leave_editor(),
            Action::History => return self.find_earlier(look),
            Action::Library => self.find_named(),
            Action::SaveQuery => return self.save(),
            Action::Export => return self.take_out(),
            Action::Up | Action::Down if self.focus == EDITOR => self.scroll_editor(action),
            other if self.focus == RESULTS => return self.act_in_results(other, look),
            other if self.focus == BROWSER => return self.act_in_browser(other, look),
            _ => {}
        }
        Vec::new()
    }

    fn key(&mut self, key: &KeyEvent, look: &Look<'_>) -> Vec<Effect> {
        if let Some(Over::Earlier(picker) | Over::Library(picker)) = &mut self.over {
            picker.key(key, look.page);
        } else if let Some(field) = self.field() {
            if field.key(key) {
                self.filter_typed();
            }
        } else if self.focus == EDITOR && self.over.is_none() {
            if key.code == KeyCode::BackTab {
                return vec![Effect::Do(Action::FocusPrevious)];
            }
            self.column_put_in = false;
            self.editor.key(key);
        }
        Vec::new()
    }

    fn paste(&mut self, text: &str, _: &Look<'_>) -> Vec<Effect> {
        if let Some(field) = self.field() {
            field.insert(text);
            self.filter_typed();
        } else if self.focus == EDITOR && self.over.is_none() {
            self.editor.paste(text);
        }
        Vec::new()
    }

    fn click(&mut self, pane: usize, row: usize, look: &Look<'_>) -> Vec<Effect> {
        match (&mut self.over, pane) {
            (Some(Over::Earlier(picker) | Over::Library(picker)), OVER) => {
                let choice = picker.click(row);
                return self.choose(choice);
            }
            (Some(Over::TakeOut(list)), OVER) => {
                let way = list.click(row);
                return self.act_over(way, look);
            }
            (Some(_), _) => {}
            (None, pane) => return self.click_pane(pane, row, look),
        }
        Vec::new()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let width = match area.width {
            wide if wide >= 150 => 38,
            wide if wide >= WIDE => 29,
            narrow if self.focus == BROWSER => narrow.min(34),
            _ => 0,
        };
        let [tables, rest] = Layout::horizontal([Constraint::Length(width), Constraint::Min(0)]).areas(area);
        if width > 0 {
            self.browser.draw(canvas, tables, self.focus == BROWSER, BROWSER, look);
        }
        let upper = match (area.height, self.focus) {
            (0..10, RESULTS) => 0,
            (0..10, _) => area.height,
            (height, _) => (height / 3).clamp(5, 14),
        };
        let [above, below] = Layout::vertical([Constraint::Length(upper), Constraint::Min(0)]).areas(rest);
        self.draw_editor(canvas, above, look);
        if self.results.is_empty() && self.running.is_none() {
            self.results.draw_nothing(canvas, below, self.focus == RESULTS, &self.library);
        } else {
            self.results.draw(
                canvas,
                below,
                self.focus == RESULTS,
                self.running.as_ref().map(|own| own.since.elapsed()),
                look,
            );
        }
        if self.focus == EDITOR && self.over.is_none() {
            self.editor.draw_completion(canvas, rest);
        }
        self.draw_over(canvas, area, look);
    }
}

impl Sql {
    fn click_pane(&mut self, pane: usize, row: usize, look: &Look<'_>) -> Vec<Effect> {
        match pane {
            RESULTS => self.results.click(row, look.page),
            BROWSER if self.browser.select(row) => self.act(Action::Right, look),
            _ => Vec::new(),
        }
    }

    fn draw_over(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        match &self.over {
            Some(Over::Earlier(picker) | Over::Library(picker)) => picker.draw(canvas, area, OVER),
            Some(Over::Saving(saving)) => saving.draw(canvas, area, &self.library, look),
            Some(Over::TakeOut(list)) => {
                list.draw(canvas, area, OVER, &self.results.what_is_taken(), look);
            }
            None => {}
        }
    }

    fn draw_editor(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let focused = self.focus == EDITOR;
        canvas.click(area, Click::Pane(EDITOR));
        let (number, count) = self.editor.count();
        let named = self.editor.statement().and_then(|statement| Head::of(&statement.sql).title);
        let title = match named {
            _ if count > 1 => format!("Query · statement {number} of {count}"),
            Some(title) => format!("Query · {title}"),
            None => "Query".to_owned(),
        };
        let note = look.hints(&[Action::RunQuery, Action::History, Action::Library]);
        let inside = canvas.pane(area, &title, &note, focused);
        let editing = focused && self.over.is_none();
        let hint = if focused { "type a statement" } else { "i or a click to edit" };
        self.editor.draw(canvas, inside, editing, hint);
    }
}
