//! The source rows of a figure, and their query.

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::{Dialog, Outcome};
use crate::action::{Action, Scope};
use crate::context::Look;
use crate::effect::Effect;
use crate::screens::sql::values;
use novamind_base::notation::grouped;
use novamind_database::Rows;
use novamind_record::trajectory::record::QuerySource;
use novamind_tools::Refusal;
use novamind_tui::canvas::{Canvas, centered, rows_of};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_tui::widgets::Table;
use novamind_worker::asking::{Ask, Pending};
use novamind_worker::queries::{QueriedTables, Query};

const QUERY_LINES: usize = 6;

/// The dialog.
pub struct RowsBehind {
    title: String,
    sql: String,
    asked: Pending<Query>,
    answer: Option<Result<Rows, Refusal>>,
    table: Table,
}

impl RowsBehind {
    /// Requests the source rows of a figure.
    pub fn new(title: String, sql: String) -> (RowsBehind, Ask) {
        let of = QueriedTables::Visible(QuerySource::DrillDown);
        let (asked, ask) = Pending::asking(Query { sql: sql.clone(), of });
        (RowsBehind { title, sql, asked, answer: None, table: Table::default() }, ask)
    }

    fn note(&self) -> String {
        match &self.answer {
            None => String::new(),
            Some(Err(_)) => "refused".to_owned(),
            Some(Ok(rows)) => {
                let count = grouped(rows.rows.len() as f64, 0);
                let noun = if rows.rows.len() == 1 { "row" } else { "rows" };
                let first = if rows.truncated { "first " } else { "" };
                format!("{first}{count} {noun} {}", self.table.note()).trim_end().to_owned()
            }
        }
    }

    fn whole_cell(&self) -> Option<Effect> {
        let Some(Ok(rows)) = &self.answer else { return None };
        let column = self.table.selected_column();
        let cell = rows.rows.get(self.table.selected()?)?.get(column)?;
        Some(Effect::ShowText(rows.columns.get(column)?.clone(), values::whole(cell)))
    }
}

impl Dialog for RowsBehind {
    fn what(&self) -> String {
        format!("rows behind {}", self.title)
    }

    fn scopes(&self) -> Vec<Scope> {
        if self.table.is_typing() { vec![Scope::Field] } else { vec![Scope::List, Scope::Dialog] }
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::OpenInSql, Action::CopyQuery, Action::Sort, Action::Filter, Action::Close]
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Outcome {
        match action {
            Action::OpenInSql => {
                let effects = vec![Effect::EditSql(self.sql.clone()), Effect::Do(Action::RunQuery)];
                return Outcome::close_with(effects);
            }
            Action::CopyQuery => return Outcome::with(vec![Effect::Copy(self.sql.clone())]),
            Action::Open => return Outcome::with(self.whole_cell().into_iter().collect()),
            _ => {}
        }
        if self.table.act(action, look.page) {
            return Outcome::stay();
        }
        match action {
            Action::Close | Action::Cancel if self.answer.is_none() => {
                Outcome::leave_with(vec![Effect::CancelQuery])
            }
            Action::Close | Action::Cancel => Outcome::close(),
            _ => Outcome::stay(),
        }
    }

    fn key(&mut self, key: &KeyEvent, _: &Look<'_>) -> Outcome {
        self.table.edit_filter(|field| {
            field.key(key);
        });
        Outcome::stay()
    }

    fn take_answers(&mut self) {
        let Some((_, answer)) = self.asked.try_take() else { return };
        let answer = answer.map(|(rows, _)| rows);
        if let Ok(rows) = &answer {
            self.table = Table::new(values::columns(rows)).by_cell();
            self.table.set_rows(values::cells(rows));
        }
        self.answer = Some(answer);
    }

    fn click(&mut self, row: usize, _: &Look<'_>) -> Outcome {
        self.table.select_place(row);
        Outcome::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let own = centered(area, area.width.saturating_sub(4).min(140), area.height.saturating_sub(2));
        canvas.clear(own, Role::Text);
        let inside = canvas.pane(own, &self.title, &self.note(), true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let query = wrapped(&self.sql, inside.width as usize);
        let used = query.len().min(QUERY_LINES).min(inside.height as usize / 3);
        for (row, line) in rows_of(inside).zip(query.iter().take(used)) {
            canvas.text(row, line, Role::Dim);
        }
        let taken = (used as u16 + 1).min(inside.height);
        let below = Rect { y: inside.y + taken, height: inside.height - taken, ..inside };
        match &self.answer {
            None => canvas.text(below, "running … esc cancels", Role::Warning),
            Some(Err(refusal)) => canvas.text(below, &refusal.message, Role::Bad),
            Some(Ok(rows)) if rows.rows.is_empty() => {
                canvas.text(below, "no rows yet", Role::Dim);
            }
            Some(Ok(_)) => self.table.draw(canvas, below, true, 0),
        }
        let keys = [Action::OpenInSql, Action::CopyQuery, Action::Sort, Action::Filter, Action::Close];
        canvas.pane_keys(own, &look.hints(&keys));
    }
}
