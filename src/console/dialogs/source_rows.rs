//! The source rows of a figure, and their query.

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::explanation::MAX_FIGURE_TITLE;
use super::{Dialog, DialogResponse};
use crate::action::{Action, Scope};
use crate::context::ScreenContext;
use crate::effect::Effect;
use crate::screens::sql::values;
use novamind_base::formatting::grouped_number;
use novamind_database::QueryResult;
use novamind_record::trajectory::record::QuerySource;
use novamind_tools::Rejection;
use novamind_tui::canvas::{Canvas, centered_rect, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::Table;
use novamind_worker::queries::{QueriedTables, Query};
use novamind_worker::question::{OutgoingQuestion, Pending};

const MAX_QUERY_LINES: usize = 6;

/// The dialog that shows the source rows of a figure.
pub struct SourceRowsDialog {
    title: String,
    sql: String,
    asked: Pending<Query>,
    answer: Option<Result<QueryResult, Rejection>>,
    table: Table,
}

impl SourceRowsDialog {
    /// Requests the source rows of a figure.
    pub fn new(title: String, sql: String) -> (SourceRowsDialog, OutgoingQuestion) {
        let of = QueriedTables::Visible(QuerySource::DrillDown);
        let (pending, ask) = Pending::with_question(Query { sql: sql.clone(), tables: of });
        (SourceRowsDialog { title, sql, asked: pending, answer: None, table: Table::default() }, ask)
    }

    fn border_note(&self) -> String {
        match &self.answer {
            None => String::new(),
            Some(Err(_)) => "rejected".to_owned(),
            Some(Ok(rows)) => {
                let count = grouped_number(rows.rows.len() as f64, 0);
                let noun = if rows.rows.len() == 1 { "row" } else { "rows" };
                let first = if rows.truncated { "first " } else { "" };
                format!("{first}{count} {noun} {}", self.table.summary()).trim_end().to_owned()
            }
        }
    }

    fn show_cell(&self) -> Option<Effect> {
        let Some(Ok(rows)) = &self.answer else { return None };
        let column = self.table.selected_column();
        let cell = rows.rows.get(self.table.selected()?)?.get(column)?;
        Some(Effect::ShowText(rows.columns.get(column)?.clone(), values::full_text(cell)))
    }
}

impl Dialog for SourceRowsDialog {
    fn record_name(&self) -> String {
        format!("rows behind {}", self.title)
    }

    fn scopes(&self) -> Vec<Scope> {
        if self.table.is_filter_open() { vec![Scope::Field] } else { vec![Scope::List, Scope::Dialog] }
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::OpenInSql, Action::CopyQuery, Action::Sort, Action::Filter, Action::Close]
    }

    fn handle_action(&mut self, action: Action, context: &ScreenContext<'_>) -> DialogResponse {
        match action {
            Action::OpenInSql => {
                let effects = vec![Effect::EditSql(self.sql.clone()), Effect::Execute(Action::RunQuery)];
                return DialogResponse::confirm_with(effects);
            }
            Action::CopyQuery => return DialogResponse::stay_with(vec![Effect::Copy(self.sql.clone())]),
            Action::Open => return DialogResponse::stay_with(self.show_cell().into_iter().collect()),
            _ => {}
        }
        if self.table.handle_action(action, context.page_rows) {
            return DialogResponse::stay();
        }
        match action {
            Action::Close | Action::Cancel if self.answer.is_none() => {
                DialogResponse::cancel_with(vec![Effect::CancelQuery])
            }
            Action::Close | Action::Cancel => DialogResponse::close(),
            _ => DialogResponse::stay(),
        }
    }

    fn handle_key(&mut self, key: &KeyEvent, _: &ScreenContext<'_>) -> DialogResponse {
        self.table.edit_filter(|field| {
            field.handle_key(key);
        });
        DialogResponse::stay()
    }

    fn take_answers(&mut self) {
        let Some((_, answer)) = self.asked.try_take() else { return };
        let answer = answer.map(|(rows, _)| rows);
        if let Ok(rows) = &answer {
            self.table = Table::new(values::columns(rows)).with_cell_selection();
            self.table.set_rows(values::cells(rows));
        }
        self.answer = Some(answer);
    }

    fn handle_click(&mut self, row: usize, _: &ScreenContext<'_>) -> DialogResponse {
        self.table.select_visible_row(row);
        DialogResponse::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let dialog_area =
            centered_rect(area, area.width.saturating_sub(4).min(140), area.height.saturating_sub(2));
        canvas.clear(dialog_area, Role::Text);
        // The text of an action item is too long for the border.
        let is_long = self.title.width() > MAX_FIGURE_TITLE;
        let title = if is_long { "Source rows" } else { &self.title };
        let inside = canvas.draw_pane_frame(dialog_area, title, &self.border_note(), true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let heading = wrap(if is_long { &self.title } else { "" }, inside.width.into());
        let heading_rows = (heading.len() as u16).min(inside.height / 3);
        for (row, line) in row_rects(Rect { height: heading_rows, ..inside }).zip(&heading) {
            canvas.draw_text(row, line, Role::Text);
        }
        let inside = Rect { y: inside.y + heading_rows, height: inside.height - heading_rows, ..inside };
        let query = wrap(&self.sql, inside.width as usize);
        let used = query.len().min(MAX_QUERY_LINES).min(inside.height as usize / 3);
        for (row, line) in row_rects(inside).zip(query.iter().take(used)) {
            canvas.draw_text(row, line, Role::Dim);
        }
        let taken = (used as u16 + 1).min(inside.height);
        let below = Rect { y: inside.y + taken, height: inside.height - taken, ..inside };
        match &self.answer {
            None => canvas.draw_text(below, "running … esc cancels", Role::Warning),
            Some(Err(rejection)) => canvas.draw_text(below, &rejection.message, Role::Bad),
            Some(Ok(rows)) if rows.rows.is_empty() => {
                canvas.draw_text(below, "no rows yet", Role::Dim);
            }
            Some(Ok(_)) => self.table.draw(canvas, below, true, 0),
        }
        let keys = [Action::OpenInSql, Action::CopyQuery, Action::Sort, Action::Filter, Action::Close];
        canvas.draw_pane_keys(dialog_area, &context.hints(&keys));
    }
}
