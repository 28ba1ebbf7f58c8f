//! The panes: the statement, its result, the tables.

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use ratatui::layout::Rect;

use super::{Sql, SqlPane};
use crate::console::action::{Action, Scope};
use crate::console::canvas::Canvas;
use crate::console::effect::Effect;
use crate::console::screens::Look;
use crate::console::screens::panes::{Border, Pane, Seat};
use crate::console::widgets::{Field, Table};
use crate::session::library::Head;

/// The statement.
pub struct EditorPane;

impl Pane<Sql> for EditorPane {
    fn scopes(&self, _: &Sql) -> Vec<Scope> {
        vec![Scope::Editor, Scope::Query]
    }

    fn hints(&self, _: &Sql) -> Vec<Action> {
        vec![Action::RunQuery, Action::Complete, Action::SaveQuery, Action::LeaveEditor]
    }

    fn act(&self, sql: &mut Sql, action: Action, _: &Look<'_>) -> Vec<Effect> {
        // The wheel turns over the editor.
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
        let note = look.hints(&[Action::RunQuery, Action::History, Action::Library]);
        Border { title, note, ..Border::default() }
    }

    fn draw(&self, sql: &Sql, canvas: &mut Canvas<'_>, seat: Seat, _: &Look<'_>) {
        let hint = if seat.focused { "type a statement" } else { "i or a click to edit" };
        sql.editor.draw(canvas, seat.area, seat.focused && sql.over.is_none(), hint);
    }
}

/// What came of it.
pub struct ResultsPane;

impl Pane<Sql> for ResultsPane {
    fn table<'a>(&self, sql: &'a Sql) -> Option<&'a Table> {
        Some(sql.results.table())
    }

    fn table_mut<'a>(&self, sql: &'a mut Sql) -> Option<&'a mut Table> {
        Some(sql.results.table_mut())
    }

    fn scopes(&self, sql: &Sql) -> Vec<Scope> {
        match (sql.results.table().is_typing(), sql.results.is_chart()) {
            (true, _) => vec![Scope::Field],
            (false, true) => vec![Scope::Chart, Scope::Result, Scope::List, Scope::Query],
            (false, false) => vec![Scope::Result, Scope::List, Scope::Query],
        }
    }

    fn hints(&self, sql: &Sql) -> Vec<Action> {
        sql.results.hints()
    }

    fn act(&self, sql: &mut Sql, action: Action, look: &Look<'_>) -> Vec<Effect> {
        if matches!(action, Action::Close | Action::CloseChart) && sql.is_running() {
            return vec![Effect::CancelQuery];
        }
        sql.results.act(action, look.page)
    }

    fn click(&self, sql: &mut Sql, row: usize, look: &Look<'_>) -> Vec<Effect> {
        sql.results.click(row, look.page)
    }

    fn border(&self, sql: &Sql, _: Rect, look: &Look<'_>) -> Border {
        let (title, note) = match sql.is_running() {
            true => ("Result".to_owned(), String::new()),
            false => sql.results.head(),
        };
        Border { title, note, keys: look.hints(sql.results.keys()), ..Border::default() }
    }

    fn draw(&self, sql: &Sql, canvas: &mut Canvas<'_>, seat: Seat, _: &Look<'_>) {
        match &sql.running {
            Some(running) => sql.results.draw_running(canvas, seat.area, running.since.elapsed()),
            None => sql.results.draw(canvas, seat, &sql.library),
        }
    }
}

/// The tables and their columns.
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
}
