//! Panes of the SQL screen: editor, result and tables.

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use ratatui::layout::Rect;

use super::over::Over;
use super::pivot::PivotChoice;
use super::summary::{NOT_A_TABLE, count};
use super::{Sql, SqlPane};
use crate::action::{Action, Scope};
use crate::context::Look;
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_record::folder::library::Head;
use novamind_tui::canvas::Canvas;
use novamind_tui::widgets::{Field, Table};

const NO_RESULT: &str = "No result yet. Run a statement first.";
const REFUSED: &str = "The last statement failed and has no rows.";

pub struct EditorPane;

impl Pane<Sql> for EditorPane {
    fn scopes(&self, _: &Sql) -> Vec<Scope> {
        vec![Scope::Editor, Scope::Query]
    }

    fn hints(&self, _: &Sql) -> Vec<Action> {
        vec![Action::RunQuery, Action::Complete, Action::SaveQuery, Action::LeaveEditor]
    }

    fn act(&self, sql: &mut Sql, action: Action, _: &Look<'_>) -> Vec<Effect> {
        // The wheel scrolls the editor.
        let turn = |code| KeyEvent::new(code, KeyModifiers::NONE);
        match action {
            Action::Complete => sql.editor.complete(),
            Action::Up | Action::Down => {
                sql.editor.hide_completion();
                let code = if action == Action::Up { KeyCode::Up } else { KeyCode::Down };
                sql.editor.key(&turn(code));
            }
            _ => {}
        }
        Vec::new()
    }

    fn key(&self, sql: &mut Sql, key: &KeyEvent, _: &Look<'_>) -> Vec<Effect> {
        if key.code == KeyCode::BackTab {
            return vec![Effect::Do(Action::FocusPrevious)];
        }
        sql.column_put_in = false;
        sql.editor.key(key);
        Vec::new()
    }

    fn paste(&self, sql: &mut Sql, text: &str, _: &Look<'_>) -> Vec<Effect> {
        sql.editor.paste(text);
        Vec::new()
    }

    fn border(&self, sql: &Sql, _: Rect, look: &Look<'_>) -> Border {
        let (number, count) = sql.editor.count();
        let named = sql.editor.statement().and_then(|statement| Head::of(&statement.sql).title);
        let title = match named {
            _ if count > 1 => format!("Query · statement {number} of {count}"),
            Some(title) => format!("Query · {title}"),
            None => "Query".to_owned(),
        };
        let is_of_xray = sql.editor.statement().is_some_and(|statement| sql.looks_inside(&statement.sql));
        let title = if is_of_xray { format!("{title} · x-ray") } else { title };
        let note = look.hints(&[Action::RunQuery, Action::History, Action::Library]);
        Border { title, note, ..Border::default() }
    }

    fn draw(&self, sql: &Sql, canvas: &mut Canvas<'_>, seat: Seat, _: &Look<'_>) {
        let hint = if seat.focused { "type a statement" } else { "i or a click to edit" };
        sql.editor.draw(canvas, seat.area, seat.focused && sql.over.is_none(), hint);
    }
}

pub struct ResultsPane;

impl Pane<Sql> for ResultsPane {
    fn table<'a>(&self, sql: &'a Sql) -> Option<&'a Table> {
        Some(sql.results.shown().table())
    }

    fn table_mut<'a>(&self, sql: &'a mut Sql) -> Option<&'a mut Table> {
        Some(sql.results.shown_mut().table_mut())
    }

    fn scopes(&self, sql: &Sql) -> Vec<Scope> {
        match (sql.results.shown().table().is_typing(), sql.results.shown().is_chart()) {
            (true, _) => vec![Scope::Field],
            (false, true) => vec![Scope::Chart, Scope::Result, Scope::List, Scope::Query],
            (false, false) => vec![Scope::Result, Scope::List, Scope::Query],
        }
    }

    fn hints(&self, sql: &Sql) -> Vec<Action> {
        sql.results.shown().hints()
    }

    fn act(&self, sql: &mut Sql, action: Action, look: &Look<'_>) -> Vec<Effect> {
        if matches!(action, Action::Close | Action::CloseChart) && sql.is_running() {
            return vec![Effect::CancelQuery];
        }
        if let Some(effects) = sql.act_on_results(action) {
            return effects;
        }
        sql.results.shown_mut().act(action, look.page)
    }

    fn click(&self, sql: &mut Sql, row: usize, look: &Look<'_>) -> Vec<Effect> {
        if sql.results.click(row) {
            return Vec::new();
        }
        sql.results.shown_mut().click(row, look.page)
    }

    fn border(&self, sql: &Sql, _: Rect, look: &Look<'_>) -> Border {
        let (title, note) = match sql.is_running() {
            true => ("Result".to_owned(), String::new()),
            false => sql.results.shown().head(),
        };
        let asked = match &sql.running {
            Some(running) => Some(running.statement.sql.as_str()),
            None => sql.results.statement(),
        };
        let mark = if asked.is_some_and(|asked| sql.looks_inside(asked)) { " · x-ray" } else { "" };
        let title = title.replacen("Result", &format!("Result{}{mark}", sql.results.number()), 1);
        Border { title, note, keys: look.hints(sql.results.shown().keys()), ..Border::default() }
    }

    fn draw(&self, sql: &Sql, canvas: &mut Canvas<'_>, seat: Seat, _: &Look<'_>) {
        match &sql.running {
            Some(running) => sql.results.shown().draw_running(canvas, seat.area, running.since.elapsed()),
            None => {
                let area = sql.results.draw(canvas, seat.area, seat.number);
                sql.results.shown().draw(canvas, Seat { area, ..seat }, &sql.library);
            }
        }
    }
}

pub struct TablesPane;

impl Pane<Sql> for TablesPane {
    fn scopes(&self, sql: &Sql) -> Vec<Scope> {
        if sql.browser.is_typing() { vec![Scope::Field] } else { vec![Scope::List, Scope::Query] }
    }

    fn hints(&self, _: &Sql) -> Vec<Action> {
        vec![Action::Open, Action::Filter, Action::RunQuery, Action::EditQuery]
    }

    fn act(&self, sql: &mut Sql, action: Action, look: &Look<'_>) -> Vec<Effect> {
        if action == Action::Open {
            sql.put_in();
        } else if !sql.browser.act(action, look.page) && action == Action::Close {
            sql.focus = SqlPane::Editor;
        }
        Vec::new()
    }

    fn filter(&self, sql: &mut Sql, edit: &mut dyn FnMut(&mut Field)) {
        sql.browser.edit_filter(edit);
    }

    fn click(&self, sql: &mut Sql, row: usize, look: &Look<'_>) -> Vec<Effect> {
        if sql.browser.select(row) { self.act(sql, Action::Right, look) } else { Vec::new() }
    }

    fn border(&self, sql: &Sql, _: Rect, look: &Look<'_>) -> Border {
        let label = |action| look.keys.label(action).unwrap_or_default();
        let keys = (label(Action::Open), label(Action::Right), label(Action::Left));
        Border {
            title: "Tables".to_owned(),
            note: sql.browser.note(),
            keys: format!("{} insert · {} columns · {} fold", keys.0, keys.1, keys.2),
            ..Border::default()
        }
    }

    fn draw(&self, sql: &Sql, canvas: &mut Canvas<'_>, seat: Seat, _: &Look<'_>) {
        sql.browser.draw(canvas, seat);
    }
}

impl Sql {
    /// Runs actions on whole results: switch, pin, close, derive a query.
    fn act_on_results(&mut self, action: Action) -> Option<Vec<Effect>> {
        match action {
            Action::PreviousResult => self.results.walk(false),
            Action::NextResult => self.results.walk(true),
            Action::CloseResult if !self.results.close() => {
                return Some(vec![Effect::Complain("No result to close".to_owned())]);
            }
            Action::CloseResult => {}
            Action::PinResult => {
                return Some(vec![match self.results.pin() {
                    Ok(true) => Effect::Say("Pinned: this result stays until you close it".to_owned()),
                    Ok(false) => Effect::Say("Unpinned".to_owned()),
                    Err(why) => Effect::Complain(why),
                }]);
            }
            Action::RecallQuery => match self.results.statement().map(str::to_owned) {
                Some(sql) => self.edit(&sql),
                None => return Some(vec![Effect::Complain(NO_RESULT.to_owned())]),
            },
            Action::CountColumn | Action::Pivot => return Some(self.sum_up(action)),
            _ => return None,
        }
        Some(Vec::new())
    }

    /// Counts the values of the focused column, or opens the setup of a pivot.
    fn sum_up(&mut self, action: Action) -> Vec<Effect> {
        let complain = |text: &str| vec![Effect::Complain(text.to_owned())];
        let shown = self.results.shown();
        let (Some(sql), Some((rows, at))) = (self.results.statement(), shown.focused_column()) else {
            return complain(if shown.is_refused() { REFUSED } else { NO_RESULT });
        };
        let meant = shown.rows_meant();
        let warning = meant.warning().map(Effect::Say);
        if self.is_running() {
            return complain("A query is running. Cancel it with esc.");
        }
        if action == Action::Pivot {
            match PivotChoice::of(sql, shown.held(&meant), at, meant) {
                Some(choice) => self.over = Some(Over::Pivot(choice)),
                None => return complain(NOT_A_TABLE),
            }
            return warning.into_iter().collect();
        }
        let Some(counting) = count(sql, &rows.columns, at, &meant) else { return complain(NOT_A_TABLE) };
        let mut effects = self.edit_and_run_derived(&counting);
        effects.extend(warning);
        effects
    }

    fn put_in(&mut self) {
        let Some(entry) = self.browser.selected() else { return };
        if self.editor.is_blank() && entry.column().is_none() {
            self.editor.replace(&format!("SELECT * FROM {} LIMIT 100", entry.name()));
        } else {
            self.editor.insert_name(entry.name(), self.column_put_in && entry.column().is_some());
            self.column_put_in = entry.column().is_some();
        }
    }
}
