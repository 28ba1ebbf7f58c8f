//! The database: tables on the left, a statement above, its result below.

mod browser;
mod completion;
mod editor;
mod history;
mod lexer;
mod results;
#[cfg(test)]
mod tests;
pub mod values;

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use ratatui::layout::{Constraint, Layout, Rect};

use super::{Look, Screen};
use crate::console::action::{Action, Scope};
use crate::console::canvas::{Canvas, Click};
use crate::console::effect::Effect;
use crate::console::message::News;
use crate::console::widgets::Field;
use browser::Browser;
use editor::{QueryEditor, Statement};
use history::{Choice, History};
use results::Results;

/// Panes by number.
const EDITOR: usize = 0;
const RESULTS: usize = 1;
const BROWSER: usize = 2;
/// Clicks on the list of earlier statements.
const HISTORY: usize = 3;

/// Below this width the tables are shown only while they are used.
const WIDE: u16 = 90;

/// A statement that is being answered: the text of the editor when it was asked, and the statement in it.
struct Running {
    text: String,
    statement: Statement,
}

/// The screen.
#[derive(Default)]
pub struct Sql {
    editor: QueryEditor,
    results: Results,
    browser: Browser,
    history: History,
    focus: usize,
    running: Option<Running>,
    /// The last thing that happened was a column put in from the tables: another one follows after a comma.
    column_put_in: bool,
}

impl Sql {
    /// Puts a statement into the editor.
    pub fn edit(&mut self, sql: &str) {
        self.editor.replace(sql);
        self.history.close();
        self.focus = EDITOR;
    }

    fn run(&mut self) -> Vec<Effect> {
        if self.running.is_some() {
            return vec![Effect::Complain("a query is running; esc cancels it".to_owned())];
        }
        self.editor.hide_completion();
        let Some(statement) = self.editor.statement() else {
            return vec![Effect::Complain("there is no statement to run: type one first".to_owned())];
        };
        self.history.remember(&statement.sql);
        let sql = statement.sql.clone();
        self.running = Some(Running { text: self.editor.text(), statement });
        vec![Effect::Ask(sql)]
    }

    /// The field that is being typed into, if one is.
    fn field(&mut self) -> Option<&mut Field> {
        if self.history.is_open() {
            return self.history.typing();
        }
        match self.focus {
            RESULTS => self.results.table().typing(),
            BROWSER => self.browser.typing(),
            _ => None,
        }
    }

    /// Applies a filter as far as it is typed.
    fn filter_typed(&mut self) {
        if let Some(table) = self.history.table() {
            return table.typed();
        }
        match self.focus {
            RESULTS => self.results.table().typed(),
            _ => self.browser.typed(),
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
        if action == Action::Close && self.running.is_some() {
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
        if self.history.is_open() {
            return vec![if self.history.is_typing() { Scope::Field } else { Scope::List }];
        }
        match self.focus {
            EDITOR => vec![Scope::Editor, Scope::Query],
            RESULTS if self.results.is_typing() => vec![Scope::Field],
            RESULTS => vec![Scope::Result, Scope::List, Scope::Query],
            _ if self.browser.is_typing() => vec![Scope::Field],
            _ => vec![Scope::List, Scope::Query],
        }
    }

    fn hints(&self) -> Vec<Action> {
        if self.history.is_open() {
            return vec![Action::Open, Action::Filter, Action::Close];
        }
        match self.focus {
            EDITOR => vec![Action::RunQuery, Action::Complete, Action::History, Action::LeaveEditor],
            RESULTS => vec![Action::WholeCell, Action::CopyCell, Action::ExportCsv, Action::EditQuery],
            _ => vec![Action::Open, Action::Filter, Action::RunQuery, Action::EditQuery],
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
        }
        self.results.take(answer.clone(), *took);
        Vec::new()
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Vec<Effect> {
        if self.history.is_open() {
            if let Choice::Statement(sql) = self.history.act(action, look.page) {
                self.edit(&sql);
            }
            return Vec::new();
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
            Action::History => {
                self.editor.hide_completion();
                if !self.history.open(&look.company.asked) {
                    return vec![Effect::Say("nothing was asked in this run yet".to_owned())];
                }
            }
            Action::Up | Action::Down if self.focus == EDITOR => self.scroll_editor(action),
            other if self.focus == RESULTS => return self.act_in_results(other, look),
            other if self.focus == BROWSER => return self.act_in_browser(other, look),
            _ => {}
        }
        Vec::new()
    }

    fn key(&mut self, key: &KeyEvent, _: &Look<'_>) -> Vec<Effect> {
        if let Some(field) = self.field() {
            if field.key(key) {
                self.filter_typed();
            }
        } else if self.focus == EDITOR && !self.history.is_open() {
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
        } else if self.focus == EDITOR && !self.history.is_open() {
            self.editor.paste(text);
        }
        Vec::new()
    }

    fn click(&mut self, pane: usize, row: usize, look: &Look<'_>) -> Vec<Effect> {
        match pane {
            HISTORY => {
                if let Some(table) = self.history.table() {
                    table.select_place(row);
                    return self.act(Action::Open, look);
                }
            }
            RESULTS => return self.results.click(row, look.page),
            BROWSER if self.browser.select(row) => return self.act(Action::Right, look),
            _ => {}
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
        self.results.draw(canvas, below, self.focus == RESULTS, self.running.is_some(), look);
        if self.focus == EDITOR && !self.history.is_open() {
            self.editor.draw_completion(canvas, rest);
        }
        self.history.draw(canvas, area, HISTORY, look);
    }
}

impl Sql {
    fn draw_editor(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let focused = self.focus == EDITOR;
        canvas.click(area, Click::Pane(EDITOR));
        let (number, count) = self.editor.count();
        let title =
            if count > 1 { format!("Query · statement {number} of {count}") } else { "Query".to_owned() };
        let note = look.hints(&[Action::RunQuery, Action::History]);
        let inside = canvas.pane(area, &title, &note, focused);
        let editing = focused && !self.history.is_open();
        let hint = if focused { "type a statement" } else { "i or a click types here" };
        self.editor.draw(canvas, inside, editing, hint);
    }
}
