//! Panes of the SQL screen: editor, result and tables.

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use ratatui::layout::Rect;

use super::overlays::SqlOverlay;
use super::pivot_form::PivotForm;
use super::aggregation::{NOT_A_TABLE_ERROR, count_statement};
use super::{Sql, SqlPane};
use crate::action::{Action, Scope};
use crate::context::{EditorDocument, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_record::folder::query_library::QueryHeader;
use novamind_tui::canvas::{Canvas, Click};
use novamind_tui::widgets::{TextField, Table};

const NO_RESULT_ERROR: &str = "No result yet. Run a statement first.";
const REJECTED_ERROR: &str = "The last statement failed and has no rows.";

pub struct EditorPane;

impl Pane<Sql> for EditorPane {
    fn scopes(&self, sql: &Sql) -> Vec<Scope> {
        if sql.editing { vec![Scope::Editor, Scope::Query] } else { vec![Scope::Query, Scope::List] }
    }

    fn hints(&self, sql: &Sql) -> Vec<Action> {
        match sql.editing {
            true => vec![Action::RunQuery, Action::Complete, Action::SaveQuery, Action::LeaveEditor],
            false => vec![
                Action::EditQuery,
                Action::RunQuery,
                Action::Library,
                Action::History,
                Action::SaveQuery,
                Action::ClearQuery,
            ],
        }
    }

    fn handle_action(&self, sql: &mut Sql, action: Action, _: &ScreenContext<'_>) -> Vec<Effect> {
        // The arrow keys and the mouse wheel scroll the editor.
        let turn = |code| KeyEvent::new(code, KeyModifiers::NONE);
        match action {
            Action::Complete => sql.editor.accept_or_offer_completion(),
            Action::Close if sql.is_running() => return vec![Effect::CancelQuery],
            Action::Up | Action::Down => {
                sql.editor.hide_completion();
                let code = if action == Action::Up { KeyCode::Up } else { KeyCode::Down };
                sql.editor.handle_key(&turn(code));
            }
            _ => {}
        }
        Vec::new()
    }

    fn handle_key(&self, sql: &mut Sql, key: &KeyEvent, _: &ScreenContext<'_>) -> Vec<Effect> {
        if key.code == KeyCode::BackTab {
            return vec![Effect::Execute(Action::FocusPrevious)];
        }
        if !sql.editing {
            return Vec::new();
        }
        sql.has_inserted_column = false;
        sql.editor.handle_key(key);
        Vec::new()
    }

    fn paste(&self, sql: &mut Sql, text: &str, _: &ScreenContext<'_>) -> Vec<Effect> {
        sql.start_editing();
        sql.editor.paste(text);
        Vec::new()
    }

    fn editor_document(&self, sql: &Sql) -> Option<EditorDocument> {
        Some(EditorDocument { text: sql.editor.text(), extension: "sql" })
    }

    fn replace_document(&self, sql: &mut Sql, text: &str) -> Vec<Effect> {
        sql.editor.replace(text);
        Vec::new()
    }

    fn handle_click(&self, sql: &mut Sql, _: usize, _: &ScreenContext<'_>) -> Vec<Effect> {
        sql.start_editing();
        Vec::new()
    }

    fn border(&self, sql: &Sql, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let (number, count) = sql.editor.statement_position();
        let named = sql.editor.statement().and_then(|statement| QueryHeader::parse(&statement.sql).title);
        let title = match named {
            _ if count > 1 => format!("Query · statement {number} of {count}"),
            Some(title) => format!("Query · {title}"),
            None => "Query".to_owned(),
        };
        let is_of_xray = sql.editor.statement().is_some_and(|statement| sql.reads_hidden_state(&statement.sql));
        let title = if is_of_xray { format!("{title} · x-ray") } else { title };
        let note = context.hints(&[Action::RunQuery, Action::History, Action::Library]);
        PaneBorder { title, note, ..PaneBorder::default() }
    }

    fn draw(&self, sql: &Sql, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let hint = match sql.editing {
            true => "type a statement".to_owned(),
            false => format!("{} or click to type a statement", context.keys.label(Action::EditQuery).unwrap_or_default()),
        };
        sql.editor.draw(canvas, placement.area, sql.editing && sql.overlay.is_none(), &hint);
        canvas.register_click(placement.area, Click::Row(placement.index, 0));
    }
}

pub struct ResultsPane;

impl Pane<Sql> for ResultsPane {
    fn table<'a>(&self, sql: &'a Sql) -> Option<&'a Table> {
        Some(sql.results.current().table())
    }

    fn table_mut<'a>(&self, sql: &'a mut Sql) -> Option<&'a mut Table> {
        Some(sql.results.current_mut().table_mut())
    }

    fn scopes(&self, sql: &Sql) -> Vec<Scope> {
        match (sql.results.current().table().is_filter_open(), sql.results.current().is_chart()) {
            (true, _) => vec![Scope::Field],
            (false, true) => vec![Scope::Chart, Scope::Result, Scope::List, Scope::Query],
            (false, false) => vec![Scope::Result, Scope::List, Scope::Query],
        }
    }

    fn hints(&self, sql: &Sql) -> Vec<Action> {
        sql.results.current().hints()
    }

    fn handle_action(&self, sql: &mut Sql, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        if matches!(action, Action::Close | Action::CloseChart) && sql.is_running() {
            return vec![Effect::CancelQuery];
        }
        if let Some(effects) = sql.handle_result_action(action) {
            return effects;
        }
        sql.results.current_mut().handle_action(action, context.page_rows)
    }

    fn handle_click(&self, sql: &mut Sql, row: usize, context: &ScreenContext<'_>) -> Vec<Effect> {
        if sql.results.handle_click(row) {
            return Vec::new();
        }
        sql.results.current_mut().handle_click(row, context.page_rows)
    }

    fn border(&self, sql: &Sql, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let (title, note) = match sql.is_running() {
            true => ("Result".to_owned(), String::new()),
            false => sql.results.current().heading(),
        };
        let asked = match &sql.running {
            Some(running) => Some(running.statement.sql.as_str()),
            None => sql.results.statement(),
        };
        let mark = if asked.is_some_and(|asked| sql.reads_hidden_state(asked)) { " · x-ray" } else { "" };
        let outdated = sql.results.outdated_day(context.company.observation.day).filter(|_| !sql.is_running());
        let outdated = outdated.map_or(String::new(), |day| format!(" · as of day {day}"));
        let in_editor = sql.editor.statement();
        let in_editor = in_editor.as_ref().map(|statement| statement.sql.as_str());
        // If there are several results, the tabs show the titles of the results.
        let other = match &sql.running {
            Some(_) => None,
            None => sql.results.title_of_other_statement(in_editor),
        };
        let other = other.map_or(String::new(), |title| format!(" of {title}"));
        let title = title.replacen("Result", &format!("Result{}{other}{mark}{outdated}", sql.results.position_label()), 1);
        PaneBorder { title, note, keys: context.hints(sql.results.current().actions()), ..PaneBorder::default() }
    }

    fn draw(&self, sql: &Sql, canvas: &mut Canvas<'_>, placement: PanePlacement, _: &ScreenContext<'_>) {
        match &sql.running {
            Some(running) => sql.results.current().draw_running(canvas, placement.area, running.started_at.elapsed()),
            None => {
                let area = sql.results.draw(canvas, placement.area, placement.index);
                sql.results.current().draw(canvas, PanePlacement { area, ..placement }, &sql.library);
            }
        }
    }
}

pub struct TablesPane;

impl Pane<Sql> for TablesPane {
    fn scopes(&self, sql: &Sql) -> Vec<Scope> {
        if sql.browser.is_filter_open() { vec![Scope::Field] } else { vec![Scope::List, Scope::Query] }
    }

    fn hints(&self, _: &Sql) -> Vec<Action> {
        vec![Action::Open, Action::Filter, Action::RunQuery, Action::EditQuery]
    }

    fn handle_action(&self, sql: &mut Sql, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        if action == Action::Open {
            sql.insert_selected_name();
        } else if !sql.browser.handle_action(action, context.page_rows) && action == Action::Close {
            sql.focus = SqlPane::Editor;
        }
        Vec::new()
    }

    fn edit_filter(&self, sql: &mut Sql, edit: &mut dyn FnMut(&mut TextField)) {
        sql.browser.edit_filter_text(edit);
    }

    fn handle_click(&self, sql: &mut Sql, row: usize, context: &ScreenContext<'_>) -> Vec<Effect> {
        if sql.browser.select(row) { self.handle_action(sql, Action::Right, context) } else { Vec::new() }
    }

    fn border(&self, sql: &Sql, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let label = |action| context.keys.label(action).unwrap_or_default();
        let keys = (label(Action::Open), label(Action::Right), label(Action::Left));
        PaneBorder {
            title: "Tables".to_owned(),
            note: sql.browser.filter_text(),
            keys: format!("{} insert · {} columns · {} fold", keys.0, keys.1, keys.2),
            ..PaneBorder::default()
        }
    }

    fn draw(&self, sql: &Sql, canvas: &mut Canvas<'_>, placement: PanePlacement, _: &ScreenContext<'_>) {
        sql.browser.draw(canvas, placement);
    }
}

impl Sql {
    /// Handles actions on complete results: switch, pin, close, and derive a query.
    fn handle_result_action(&mut self, action: Action) -> Option<Vec<Effect>> {
        match action {
            Action::PreviousResult => self.results.select_adjacent(false),
            Action::NextResult => self.results.select_adjacent(true),
            Action::CloseResult if !self.results.close() => {
                return Some(vec![Effect::ShowError("No result to close".to_owned())]);
            }
            Action::CloseResult => {}
            Action::PinResult => {
                return Some(vec![match self.results.toggle_pin() {
                    Ok(true) => Effect::ShowStatus("Pinned: this result stays until you close it".to_owned()),
                    Ok(false) => Effect::ShowStatus("Unpinned".to_owned()),
                    Err(why) => Effect::ShowError(why),
                }]);
            }
            Action::RecallQuery => match self.results.statement().map(str::to_owned) {
                Some(sql) => {
                    self.set_statement(&sql);
                    self.start_editing();
                }
                None => return Some(vec![Effect::ShowError(NO_RESULT_ERROR.to_owned())]),
            },
            Action::CountColumn | Action::Pivot => return Some(self.handle_aggregate_action(action)),
            _ => return None,
        }
        Some(Vec::new())
    }

    /// Runs a statement that counts the values of the focused column, or opens the pivot form.
    fn handle_aggregate_action(&mut self, action: Action) -> Vec<Effect> {
        let complain = |text: &str| vec![Effect::ShowError(text.to_owned())];
        let result_view = self.results.current();
        let (Some(sql), Some((rows, at))) = (self.results.statement(), result_view.focused_column()) else {
            return complain(if result_view.is_rejected() { REJECTED_ERROR } else { NO_RESULT_ERROR });
        };
        let covered_rows = result_view.row_filter();
        let warning = covered_rows.warning().map(Effect::ShowStatus);
        if self.is_running() {
            return complain("A query is running. Cancel it with esc.");
        }
        if action == Action::Pivot {
            match PivotForm::new(sql, result_view.filtered_rows(&covered_rows), at, covered_rows) {
                Some(choice) => self.overlay = Some(SqlOverlay::Pivot(choice)),
                None => return complain(NOT_A_TABLE_ERROR),
            }
            return warning.into_iter().collect();
        }
        let Some(counting) = count_statement(sql, &rows.columns, at, &covered_rows) else { return complain(NOT_A_TABLE_ERROR) };
        let mut effects = self.edit_and_run_derived(&counting);
        effects.extend(warning);
        effects
    }

    fn insert_selected_name(&mut self) {
        let Some(entry) = self.browser.selected() else { return };
        if self.editor.is_blank() && entry.column().is_none() {
            self.editor.replace(&format!("SELECT * FROM {} LIMIT 100", entry.name()));
        } else {
            self.editor.insert_name(entry.name(), self.has_inserted_column && entry.column().is_some());
            self.has_inserted_column = entry.column().is_some();
        }
    }
}
