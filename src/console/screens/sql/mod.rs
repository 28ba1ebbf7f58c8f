//! The SQL screen, with tables at the left and the statement above its result.

mod browser;
mod completion;
mod editor;
mod hidden_tables;
mod history;
mod row_filter;
mod overlays;
mod panes;
mod picker;
mod pivot_form;
mod result_chart;
mod results;
mod save_query;
mod aggregation;
mod tabs;
mod export;
#[cfg(test)]
mod tests;
pub mod values;

use std::time::{Duration, Instant};

use ratatui::layout::{Constraint, Layout, Rect};
use strum::VariantArray;

use super::ScreenState;
use super::panes::{Pane, PaneScreen, draw_pane, draw_stack};
use crate::action::Action;
use crate::context::ScreenContext;
use crate::effect::Effect;
use browser::TableBrowser;
use editor::{QueryEditor, Statement};
use hidden_tables::reads_hidden_tables;
use history::StatementHistory;
use novamind_record::folder::query_library::QueryLibrary;
use novamind_record::trajectory::record::QuerySource;
use novamind_tui::canvas::Canvas;
use novamind_worker::question::Pending;
use novamind_worker::queries::{QueriedTables, Query};
use overlays::SqlOverlay;
use tabs::ResultTabs;

/// Panes of the SQL screen in tab order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, VariantArray)]
pub enum SqlPane {
    /// Editor of the statement.
    #[default]
    Editor,
    /// Results of statements.
    Results,
    /// Tree of tables and columns.
    Tables,
}

/// Minimum width for showing the tables even without the focus.
const MIN_WIDTH_FOR_TABLES: u16 = 90;

/// A running statement, and the editor text from which the statement was started.
struct RunningStatement {
    text: String,
    statement: Statement,
    started_at: Instant,
    /// Day of the company when the statement was started.
    day: u32,
    answer: Pending<Query>,
}

/// The SQL screen.
pub struct Sql {
    editor: QueryEditor,
    results: ResultTabs,
    browser: TableBrowser,
    history: StatementHistory,
    library: QueryLibrary,
    overlay: Option<SqlOverlay>,
    focus: SqlPane,
    /// Whether keys type into the editor. Only the editor pane can be in this mode.
    editing: bool,
    running: Option<RunningStatement>,
    /// Whether the last action inserted a column from the tables. The next inserted column is then separated by a
    /// comma.
    has_inserted_column: bool,
    /// The last statement that was derived from a result.
    derived_sql: String,
    /// Whether the run permits queries of x-ray tables.
    can_inspect: bool,
    /// Current day of the company.
    day: u32,
}

impl Default for Sql {
    fn default() -> Self {
        Sql {
            editor: QueryEditor::default(),
            results: ResultTabs::default(),
            browser: TableBrowser::default(),
            history: StatementHistory::default(),
            library: QueryLibrary::bundled(),
            overlay: None,
            focus: SqlPane::Editor,
            editing: false,
            running: None,
            has_inserted_column: false,
            derived_sql: String::new(),
            can_inspect: false,
            day: 0,
        }
    }
}

impl Sql {
    /// Stores the named queries.
    pub fn set_library(&mut self, library: QueryLibrary) {
        self.library = library;
    }

    /// Replaces the editor text and adds the old text to the history. Does not start editing.
    pub fn set_statement(&mut self, sql: &str) {
        if self.editor.text().trim() != sql.trim() {
            self.history.add_draft(&self.editor.text());
        }
        self.editor.replace(sql);
        self.overlay = None;
        if self.focus != SqlPane::Editor {
            self.set_focused_pane(SqlPane::Editor);
        }
    }

    /// Replaces the editor text with a statement and runs the statement.
    pub fn edit_and_run(&mut self, sql: &str) -> Vec<Effect> {
        self.set_statement(sql);
        self.editor.go_to_top();
        // The user did not type the statement, so the results get the focus.
        self.set_focused_pane(SqlPane::Results);
        self.run_statement()
    }

    /// Replaces the editor text with a derived statement and runs the statement.
    fn edit_and_run_derived(&mut self, sql: &str) -> Vec<Effect> {
        self.derived_sql = sql.trim().to_owned();
        self.edit_and_run(sql)
    }

    /// Returns the editor text.
    pub fn draft(&self) -> String {
        self.editor.text()
    }

    /// Returns whether the screen shows rows of a named query.
    pub fn shows_rows_of(&self, query: &str) -> bool {
        let named = self.library.queries().iter().find(|named| named.name == query);
        let is_shown = named.is_some_and(|named| self.results.statement().map(str::trim) == Some(named.sql.trim()));
        is_shown && self.overlay.is_none() && self.running.is_none() && self.results.current().has_rows()
    }

    /// Returns whether a statement is running.
    pub fn is_running(&self) -> bool {
        self.running.is_some()
    }

    fn run_statement(&mut self) -> Vec<Effect> {
        if self.running.is_some() {
            return vec![Effect::ShowError("A query is running. Cancel it with esc.".to_owned())];
        }
        self.editor.hide_completion();
        let Some(statement) = self.editor.statement() else {
            return vec![Effect::ShowError("No statement to run. Type one first.".to_owned())];
        };
        self.history.add(&statement.sql);
        let of = self.query_source(&statement.sql);
        let (answer, ask) = Pending::with_question(Query { sql: statement.sql.clone(), tables: of });
        self.running = Some(RunningStatement { text: self.editor.text(), statement, started_at: Instant::now(), day: self.day, answer });
        vec![Effect::SentText("sql"), Effect::Ask(ask)]
    }

    /// Returns whether a statement reads x-ray tables and the run permits such queries.
    fn reads_hidden_state(&self, sql: &str) -> bool {
        self.can_inspect && reads_hidden_tables(sql)
    }

    fn query_source(&self, sql: &str) -> QueriedTables {
        let is = |other: &str| sql.trim() == other.trim();
        QueriedTables::Visible(match self.library.queries().iter().any(|query| is(&query.sql)) {
            _ if self.reads_hidden_state(sql) => return QueriedTables::Hidden,
            true => QuerySource::Library,
            false if is(&self.derived_sql) => QuerySource::Derived,
            false => QuerySource::Typed,
        })
    }

    fn start_editing(&mut self) {
        (self.focus, self.editing) = (SqlPane::Editor, true);
    }

    /// Ends editing. If there is a result, the results get the focus.
    fn leave_editor(&mut self) -> Vec<Effect> {
        if self.editor.hide_completion() {
            return Vec::new();
        }
        if self.running.is_some() {
            return vec![Effect::CancelQuery];
        }
        let has_result = self.results.statement().is_some();
        self.set_focused_pane(if has_result { SqlPane::Results } else { SqlPane::Editor });
        Vec::new()
    }
}

impl ScreenState for Sql {
    fn on_company_change(&mut self, context: &ScreenContext<'_>) {
        self.can_inspect = context.company.can_inspect;
        self.day = context.company.observation.day;
        self.browser.shows_hidden = self.can_inspect;
        self.browser.interface = context.company.numbers.interface();
        self.editor.interface = self.browser.interface;
    }

    fn screen_escape_depth(&self) -> usize {
        let filtered = self.focus == SqlPane::Tables && self.browser.is_filtered();
        usize::from(self.results.current().is_chart()) + usize::from(filtered)
    }

    fn open_object(&self, _: &ScreenContext<'_>) -> Option<(&'static str, String)> {
        let table = self.browser.open_table().filter(|_| self.focus == SqlPane::Tables)?;
        Some(("table", table.to_owned()))
    }

    fn edited_text(&self) -> Option<(String, String)> {
        let typing = self.editing && self.overlay.is_none();
        typing.then(|| ("sql".to_owned(), self.editor.text()))
    }

    fn take_answers(&mut self, _: &ScreenContext<'_>) -> Vec<Effect> {
        let answer = self.running.as_mut().and_then(|running| running.answer.try_take());
        let Some((_, answer)) = answer else { return Vec::new() };
        let Some(running) = self.running.take() else { return Vec::new() };
        // The error position is valid only if the editor text has not changed since the statement was run.
        if let Err(refusal) = &answer
            && let Some(place) = results::error_offset(refusal)
            && self.editor.text() == running.text
        {
            self.editor.mark_error(running.statement.offset + place);
            if self.focus != SqlPane::Editor {
                self.set_focused_pane(SqlPane::Editor);
            }
        }
        let took = answer.as_ref().map_or(Duration::ZERO, |(_, took)| *took);
        self.results.add_answer(&running.statement.sql, answer.map(|(rows, _)| rows), took, running.day);
        Vec::new()
    }
}

impl PaneScreen for Sql {
    type PaneId = SqlPane;

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

    fn overlay(&self) -> Option<&'static dyn Pane<Sql>> {
        self.overlay.as_ref().map(SqlOverlay::pane)
    }

    fn focused_pane(&self) -> SqlPane {
        self.focus
    }

    fn set_focused_pane(&mut self, name: SqlPane) {
        (self.focus, self.editing) = (name, false);
        self.editor.hide_completion();
    }

    fn handle_screen_action(&mut self, action: Action, context: &ScreenContext<'_>) -> Option<Vec<Effect>> {
        if action != Action::Open {
            self.has_inserted_column = false;
        }
        match action {
            Action::RunQuery => {
                let effects = self.run_statement();
                if self.is_running() && !self.editing {
                    self.set_focused_pane(SqlPane::Results);
                }
                return Some(effects);
            }
            Action::Complete if !self.editing => {
                return Some(vec![Effect::Execute(Action::FocusNext)]);
            }
            Action::EditQuery => self.start_editing(),
            Action::ClearQuery => self.set_statement(""),
            Action::LeaveEditor => return Some(self.leave_editor()),
            Action::History => return Some(self.open_history(context)),
            Action::Library => self.open_library(),
            Action::SaveQuery => return Some(self.open_save_query()),
            Action::Export => return Some(self.open_export(context)),
            _ => return None,
        }
        Some(Vec::new())
    }

    fn draw_panes(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let width = match area.width {
            wide if wide >= 150 => 38,
            wide if wide >= MIN_WIDTH_FOR_TABLES => 29,
            _ => 0,
        };
        let [tables, rest] = Layout::horizontal([Constraint::Length(width), Constraint::Min(0)]).areas(area);
        let upper = match (area.height, self.focus) {
            (0..10, SqlPane::Results | SqlPane::Tables) => 0,
            (0..10, _) => area.height,
            (height, _) => (height / 3).clamp(5, 14),
        };
        let [above, below] = Layout::vertical([Constraint::Length(upper), Constraint::Min(0)]).areas(rest);
        draw_pane(self, SqlPane::Editor, canvas, above, context);
        if width > 0 {
            draw_pane(self, SqlPane::Tables, canvas, tables, context);
            draw_pane(self, SqlPane::Results, canvas, below, context);
        } else {
            draw_stack(self, &[SqlPane::Results, SqlPane::Tables], canvas, below, context);
        }
        if self.editing && self.overlay.is_none() {
            self.editor.draw_completion(canvas, rest);
        }
    }
}
