//! SQL queries: tables at the left, the statement above its result.

mod browser;
mod completion;
mod editor;
mod hidden;
mod history;
mod meant;
mod over;
mod panes;
mod picker;
mod pivot;
mod plot;
mod results;
mod saving;
mod summary;
mod tabs;
mod takeout;
#[cfg(test)]
mod tests;
pub mod values;

use std::time::{Duration, Instant};

use ratatui::layout::{Constraint, Layout, Rect};
use strum::VariantArray;

use super::ScreenState;
use super::panes::{Pane, Paned, draw_pane};
use crate::action::Action;
use crate::context::Look;
use crate::effect::Effect;
use browser::Browser;
use editor::{QueryEditor, Statement};
use hidden::names_hidden;
use history::History;
use novamind_record::folder::library::Library;
use novamind_record::trajectory::record::QuerySource;
use novamind_tui::canvas::Canvas;
use novamind_worker::asking::Pending;
use novamind_worker::queries::{QueriedTables, Query};
use over::Over;
use tabs::Tabs;

/// Panes in tab order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, VariantArray)]
pub enum SqlPane {
    /// The statement.
    #[default]
    Editor,
    /// Results.
    Results,
    /// Tables and columns.
    Tables,
}

/// Below this width the tables are visible only while they have the focus.
const WIDE: u16 = 90;

/// A running statement, and the editor text when it was started.
struct Running {
    text: String,
    statement: Statement,
    since: Instant,
    answer: Pending<Query>,
}

/// The SQL screen.
pub struct Sql {
    editor: QueryEditor,
    results: Tabs,
    browser: Browser,
    history: History,
    library: Library,
    over: Option<Over>,
    focus: SqlPane,
    running: Option<Running>,
    /// Whether the last action inserted a column from the tables; another one then follows after a comma.
    column_put_in: bool,
    /// The last statement that was derived from a result.
    derived: String,
    /// Whether the run permits queries of x-ray tables.
    may_look_inside: bool,
}

impl Default for Sql {
    fn default() -> Self {
        Sql {
            editor: QueryEditor::default(),
            results: Tabs::default(),
            browser: Browser::default(),
            history: History::default(),
            library: Library::shipped(),
            over: None,
            focus: SqlPane::Editor,
            running: None,
            column_put_in: false,
            derived: String::new(),
            may_look_inside: false,
        }
    }
}

impl Sql {
    /// Stores the named queries.
    pub fn learn(&mut self, library: Library) {
        self.library = library;
    }

    /// Replaces the editor text; the old text is added to the history.
    pub fn edit(&mut self, sql: &str) {
        if self.editor.text().trim() != sql.trim() {
            self.history.remember_draft(&self.editor.text());
        }
        self.editor.replace(sql);
        self.over = None;
        self.focus = SqlPane::Editor;
    }

    /// Replaces the editor text and runs it.
    pub fn edit_and_run(&mut self, sql: &str) -> Vec<Effect> {
        self.edit(sql);
        self.editor.go_to_top();
        // The user did not type, so the result takes the focus.
        self.focus = SqlPane::Results;
        self.run()
    }

    /// Replaces the editor text with a derived statement and runs it.
    fn edit_and_run_derived(&mut self, sql: &str) -> Vec<Effect> {
        self.derived = sql.trim().to_owned();
        self.edit_and_run(sql)
    }

    /// Returns the editor text.
    pub fn unsent(&self) -> String {
        self.editor.text()
    }

    /// Returns whether a statement is running.
    pub fn is_running(&self) -> bool {
        self.running.is_some()
    }

    fn run(&mut self) -> Vec<Effect> {
        if self.running.is_some() {
            return vec![Effect::Complain("A query is running. Cancel it with esc.".to_owned())];
        }
        self.editor.hide_completion();
        let Some(statement) = self.editor.statement() else {
            return vec![Effect::Complain("No statement to run. Type one first.".to_owned())];
        };
        self.history.remember(&statement.sql);
        let of = self.tables_of(&statement.sql);
        let (answer, ask) = Pending::asking(Query { sql: statement.sql.clone(), of });
        self.running = Some(Running { text: self.editor.text(), statement, since: Instant::now(), answer });
        vec![Effect::SentText("sql"), Effect::Ask(ask)]
    }

    /// Returns whether a statement reads x-ray tables and the run permits it.
    fn looks_inside(&self, sql: &str) -> bool {
        self.may_look_inside && names_hidden(sql)
    }

    fn tables_of(&self, sql: &str) -> QueriedTables {
        let is = |other: &str| sql.trim() == other.trim();
        QueriedTables::Visible(match self.library.queries().iter().any(|query| is(&query.sql)) {
            _ if self.looks_inside(sql) => return QueriedTables::Hidden,
            true => QuerySource::Library,
            false if is(&self.derived) => QuerySource::Derived,
            false => QuerySource::Typed,
        })
    }

    fn leave_editor(&mut self) -> Vec<Effect> {
        if self.editor.hide_completion() {
            return Vec::new();
        }
        if self.running.is_some() {
            return vec![Effect::CancelQuery];
        }
        self.focus = SqlPane::Results;
        Vec::new()
    }
}

impl ScreenState for Sql {
    fn renew(&mut self, look: &Look<'_>) {
        self.may_look_inside = look.company.may_look_inside;
        self.browser.shows_hidden = self.may_look_inside;
    }

    fn opened(&self) -> usize {
        let filtered = self.focus == SqlPane::Tables && self.browser.is_filtered();
        usize::from(self.results.shown().is_chart()) + usize::from(filtered)
    }

    fn open_object(&self, _: &Look<'_>) -> Option<(&'static str, String)> {
        let table = self.browser.opened().filter(|_| self.focus == SqlPane::Tables)?;
        Some(("table", table.to_owned()))
    }

    fn edited(&self) -> Option<(String, String)> {
        let typing = self.focus == SqlPane::Editor && self.over.is_none();
        typing.then(|| ("sql".to_owned(), self.editor.text()))
    }

    fn take_answers(&mut self, _: &Look<'_>) -> Vec<Effect> {
        let answer = self.running.as_mut().and_then(|running| running.answer.try_take());
        let Some((_, answer)) = answer else { return Vec::new() };
        let Some(running) = self.running.take() else { return Vec::new() };
        // An error position is valid only for the text that was run.
        if let Err(refusal) = &answer
            && let Some(place) = results::place_of(refusal)
            && self.editor.text() == running.text
        {
            self.editor.mark(running.statement.from + place);
            self.focus = SqlPane::Editor;
        }
        let took = answer.as_ref().map_or(Duration::ZERO, |(_, took)| *took);
        self.results.take(&running.statement.sql, answer.map(|(rows, _)| rows), took);
        Vec::new()
    }
}

impl Paned for Sql {
    type Name = SqlPane;

    fn panes(&self) -> &'static [SqlPane] {
        SqlPane::VARIANTS
    }

    fn pane(name: SqlPane) -> &'static dyn Pane<Sql> {
        match name {
            SqlPane::Editor => &panes::EditorPane,
            SqlPane::Results => &panes::ResultsPane,
            SqlPane::Tables => &panes::TablesPane,
        }
    }

    fn over(&self) -> Option<&'static dyn Pane<Sql>> {
        self.over.as_ref().map(Over::pane)
    }

    fn focused(&self) -> SqlPane {
        self.focus
    }

    fn focus_on(&mut self, name: SqlPane) {
        self.focus = name;
        self.editor.hide_completion();
    }

    fn act_anywhere(&mut self, action: Action, look: &Look<'_>) -> Option<Vec<Effect>> {
        if action != Action::Open {
            self.column_put_in = false;
        }
        match action {
            Action::RunQuery => return Some(self.run()),
            Action::Complete if self.focus != SqlPane::Editor => {
                return Some(vec![Effect::Do(Action::FocusNext)]);
            }
            Action::EditQuery => self.focus = SqlPane::Editor,
            Action::ClearQuery => self.edit(""),
            Action::LeaveEditor => return Some(self.leave_editor()),
            Action::History => return Some(self.find_earlier(look)),
            Action::Library => self.find_named(),
            Action::SaveQuery => return Some(self.save()),
            Action::Export => return Some(self.take_out()),
            _ => return None,
        }
        Some(Vec::new())
    }

    fn arrange(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let width = match area.width {
            wide if wide >= 150 => 38,
            wide if wide >= WIDE => 29,
            narrow if self.focus == SqlPane::Tables => narrow.min(34),
            _ => 0,
        };
        let [tables, rest] = Layout::horizontal([Constraint::Length(width), Constraint::Min(0)]).areas(area);
        let upper = match (area.height, self.focus) {
            (0..10, SqlPane::Results) => 0,
            (0..10, _) => area.height,
            (height, _) => (height / 3).clamp(5, 14),
        };
        let [above, below] = Layout::vertical([Constraint::Length(upper), Constraint::Min(0)]).areas(rest);
        draw_pane(self, SqlPane::Tables, canvas, tables, look);
        draw_pane(self, SqlPane::Editor, canvas, above, look);
        draw_pane(self, SqlPane::Results, canvas, below, look);
        if self.focus == SqlPane::Editor && self.over.is_none() {
            self.editor.draw_completion(canvas, rest);
        }
    }
}
