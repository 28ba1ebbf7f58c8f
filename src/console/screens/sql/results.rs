//! The result of a statement: rows that the user can browse, copy and export, or an error.

use std::time::Duration;

use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::row_filter::RowFilter;
use super::result_chart::ResultChart;
use super::{export, values};
use crate::action::Action;
use crate::effect::Effect;
use crate::screens::panes::PanePlacement;
use novamind_database::{Cell, QueryResult};
use novamind_record::folder::query_library::{ChartSpec, QueryHeader, QueryLibrary};
use novamind_tools::Rejection;
use novamind_tui::canvas::{Canvas, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::Table;

/// Answer to the last statement.
#[derive(Debug, Default)]
pub enum QueryAnswer {
    /// No statement has been run yet.
    #[default]
    None,
    Rows(QueryResult, Duration),
    Rejected(Rejection),
}

#[derive(Default)]
pub struct ResultView {
    answer: QueryAnswer,
    table: Table,
    /// Chart that the header of the statement specifies.
    chart_line: Option<ChartSpec>,
    /// The chart, while it replaces the rows.
    chart: Option<ResultChart>,
    bytes: usize,
}

/// Introduction that is shown before the first query.
const INTRODUCTION: &str =
    "Open the library of queries with ctrl-o, type one of these queries, or choose a table (shift-tab, then enter):

SELECT category, round(sum(amount)) AS dollars FROM ledger GROUP BY category ORDER BY dollars

SELECT plan, count(*) AS subscribers, round(avg(effective_price), 2) AS price
FROM subscriptions WHERE status = 'subscribed' GROUP BY plan

SELECT channel_id, group_id, sum(leads_generated) AS leads, sum(spend) AS spend
FROM ad_channel_leads GROUP BY 1, 2 ORDER BY leads DESC

Statements can only read. Days count from 0; amounts are in dollars.";

/// Returns the byte offset of a SQL error, if the message contains an offset.
pub fn error_offset(refusal: &Rejection) -> Option<usize> {
    let (_, place) = refusal.message.rsplit_once("(at character ")?;
    place.strip_suffix(')')?.parse::<usize>().ok()?.checked_sub(1)
}

impl ResultView {
    /// Stores the answer to a statement.
    pub fn set_answer(&mut self, sql: &str, answer: Result<QueryResult, Rejection>, took: Duration) {
        let proposed = QueryHeader::parse(sql).chart;
        match answer {
            Ok(rows) => {
                let columns = values::columns(&rows);
                let same = matches!(&self.answer, QueryAnswer::Rows(before, _) if before.columns == rows.columns);
                if !same {
                    self.table = Table::new(columns.clone()).with_cell_selection();
                }
                if !same || proposed != self.chart_line {
                    self.chart = None;
                }
                self.table.set_columns_and_rows(columns, values::cells(&rows));
                self.chart_line = proposed;
                self.bytes = estimate_bytes(&rows);
                self.answer = QueryAnswer::Rows(rows, took);
            }
            Err(refusal) => (self.answer, self.bytes) = (QueryAnswer::Rejected(refusal), 0),
        }
    }

    pub fn table(&self) -> &Table {
        &self.table
    }

    pub fn table_mut(&mut self) -> &mut Table {
        &mut self.table
    }

    pub fn is_chart(&self) -> bool {
        self.chart.is_some() && self.rows().is_some()
    }

    /// Returns whether the statement failed.
    pub fn is_rejected(&self) -> bool {
        matches!(self.answer, QueryAnswer::Rejected(_))
    }

    /// Returns the approximate size in bytes of the rows and their display form.
    pub fn size_in_bytes(&self) -> usize {
        self.bytes
    }

    /// Returns the rows and the index of the selected column.
    pub fn focused_column(&self) -> Option<(&QueryResult, usize)> {
        let at = self.table.selected_column();
        self.rows().filter(|rows| at < rows.columns.len()).map(|rows| (rows, at))
    }

    /// Returns the filter for the rows that counts and pivots cover.
    pub fn row_filter(&self) -> RowFilter {
        let all = |rows| RowFilter::from_filter(self.table.filter_text(), rows, self.table.visible_rows());
        self.rows().map_or(RowFilter::All, all)
    }

    /// Returns the loaded rows that pass a row filter.
    pub fn filtered_rows(&self, covered_rows: &RowFilter) -> QueryResult {
        let Some(all) = self.rows() else { return QueryResult::default() };
        match (covered_rows, self.visible_rows()) {
            (RowFilter::Containing { .. }, Some(query_result)) => QueryResult { truncated: all.truncated, ..query_result },
            _ => all.clone(),
        }
    }

    /// Returns whether there are rows to export.
    pub fn has_rows(&self) -> bool {
        self.rows().is_some()
    }

    /// Returns the displayed rows, filtered and sorted.
    fn visible_rows(&self) -> Option<QueryResult> {
        let all = self.rows()?;
        let rows = self.table.visible_rows().iter().map(|row| all.rows[*row].clone()).collect();
        Some(QueryResult { columns: all.columns.clone(), rows, ..QueryResult::default() })
    }

    /// Describes the rows to export, for example `12 of 300 rows, as filtered`.
    pub fn export_label(&self) -> String {
        let Some(rows) = self.rows() else { return String::new() };
        match (self.table.visible_rows().len(), rows.rows.len()) {
            (shown, all) if shown < all => format!("{shown} of {}, as filtered", export::format_row_count(all)),
            (_, all) if rows.truncated => format!("the first {}; more exist", export::format_row_count(all)),
            (_, all) => export::format_row_count(all),
        }
    }

    /// Returns the effects that export the displayed rows.
    pub fn export(&self, way: Action) -> Vec<Effect> {
        self.visible_rows().map_or_else(Vec::new, |rows| export::export_effects(way, &rows))
    }

    fn open_chart(&mut self) -> Vec<Effect> {
        self.chart = self.rows().and_then(|rows| ResultChart::for_rows(rows, self.chart_line.as_ref()));
        match (&self.chart, self.rows()) {
            (Some(_), _) => Vec::new(),
            (None, Some(_)) => {
                vec![Effect::ShowError("No numeric column to chart".to_owned())]
            }
            (None, None) if self.is_rejected() => {
                vec![Effect::ShowError("No result to chart. The last statement failed.".to_owned())]
            }
            (None, None) => {
                vec![Effect::ShowError("No result to chart. Run a statement first.".to_owned())]
            }
        }
    }

    /// Handles an action of the chart. Other actions are handled by the rows.
    fn handle_chart_action(&mut self, action: Action, page: u16) -> Vec<Effect> {
        let (Some(plot), QueryAnswer::Rows(rows, _)) = (&mut self.chart, &self.answer) else { return Vec::new() };
        match action {
            Action::ChartX => plot.next_x(rows),
            Action::ChartY => plot.next_y(rows),
            Action::MoreSeries if !plot.add_series(rows) => {
                return vec![Effect::ShowError("No other numeric column, or too many series".to_owned())];
            }
            Action::MoreSeries | Action::Left | Action::Right => {}
            Action::FewerSeries => plot.remove_series(),
            Action::ChartKind => plot.toggle_kind(),
            Action::Sort => {
                let column = plot.first_y();
                self.table.select_column(column);
                self.table.handle_action(Action::Sort, page);
            }
            Action::CloseChart | Action::Close => self.chart = None,
            Action::Filter => {
                self.chart = None;
                self.table.handle_action(Action::Filter, page);
            }
            other => return self.handle_rows_action(other, page),
        }
        Vec::new()
    }

    fn rows(&self) -> Option<&QueryResult> {
        match &self.answer {
            QueryAnswer::Rows(rows, _) => Some(rows),
            _ => None,
        }
    }

    /// Returns all cells of the selected row.
    fn row(&self) -> Option<&[Cell]> {
        self.rows()?.rows.get(self.table.selected()?).map(Vec::as_slice)
    }

    /// Returns the column name and the value of the selected cell.
    fn selected_cell(&self) -> Option<(&str, &Cell)> {
        let at = self.table.selected_column();
        Some((self.rows()?.columns.get(at)?, self.row()?.get(at)?))
    }

    /// Handles actions on the rows or the chart, such as moving, sorting, filtering and copying.
    pub fn handle_action(&mut self, action: Action, page: u16) -> Vec<Effect> {
        match action {
            _ if self.is_chart() => self.handle_chart_action(action, page),
            Action::Chart => self.open_chart(),
            other => self.handle_rows_action(other, page),
        }
    }

    fn handle_rows_action(&mut self, action: Action, page: u16) -> Vec<Effect> {
        let nothing = || vec![Effect::ShowError("No result to copy from".to_owned())];
        match action {
            Action::ShowCell => {
                let read = |(name, cell): (&str, &Cell)| Effect::ShowText(name.to_owned(), format_cell(cell));
                self.selected_cell().map(read).map_or_else(nothing, |effect| vec![effect])
            }
            Action::CopyCell => {
                let copy = |(_, cell)| vec![Effect::Copy(values::full_text(cell))];
                self.selected_cell().map_or_else(nothing, copy)
            }
            Action::CopyRow => self.row().map_or_else(nothing, |row| vec![Effect::Copy(values::tab_separated_row(row))]),
            Action::CommitNext | Action::CommitPrevious => {
                self.table.handle_action(Action::Commit, page);
                Vec::new()
            }
            other => {
                self.table.handle_action(other, page);
                Vec::new()
            }
        }
    }

    /// Handles a click on a row. A second click opens the selected cell.
    pub fn handle_click(&mut self, place: usize, page: u16) -> Vec<Effect> {
        let before = self.table.selected();
        self.table.select_visible_row(place);
        let again = before == self.table.selected() && !self.is_chart();
        if again { self.handle_action(Action::ShowCell, page) } else { Vec::new() }
    }

    /// Returns the title and the note of the pane: a description of the result, its filter and its order.
    pub fn heading(&self) -> (String, String) {
        match &self.answer {
            QueryAnswer::None => ("Result".to_owned(), "no query yet".to_owned()),
            QueryAnswer::Rejected(refusal) => (format!("Result · {}", rejection_title(refusal.code)), String::new()),
            QueryAnswer::Rows(rows, took) => {
                let drawn = self.chart.as_ref().map(|plot| format!(" · {}", plot.title(rows)));
                (result_title(rows, *took) + &drawn.unwrap_or_default(), self.table.summary())
            }
        }
    }

    /// Draws the elapsed time of a running statement.
    pub fn draw_running(&self, canvas: &mut Canvas<'_>, area: Rect, since: Duration) {
        let seconds = match since.as_secs() {
            0 => String::new(),
            seconds => format!("{seconds} s "),
        };
        let row = Rect { height: 1.min(area.height), ..area };
        canvas.draw_text(row, &format!("running {seconds}… esc cancels"), Role::Warning);
    }

    pub fn draw(&self, canvas: &mut Canvas<'_>, placement: PanePlacement, library: &QueryLibrary) {
        match &self.answer {
            QueryAnswer::None => draw_empty_state(canvas, placement.area, library),
            QueryAnswer::Rejected(refusal) => {
                let role = if rejection_title(refusal.code) == "failed" { Role::Bad } else { Role::Warning };
                draw_wrapped_text(canvas, placement.area, refusal.code, &refusal.message, role);
            }
            QueryAnswer::Rows(rows, _) => self.draw_rows(canvas, placement, rows),
        }
    }

    fn draw_rows(&self, canvas: &mut Canvas<'_>, placement: PanePlacement, rows: &QueryResult) {
        let area = placement.area;
        let remark = match (&rows.warning, &rows.hint) {
            (Some(warning), _) => Some(warning.clone()),
            (None, Some(hint)) => Some(format!("No rows: {hint}")),
            (None, None) if rows.rows.is_empty() => Some("No rows".to_owned()),
            (None, None) => None,
        };
        let role = if rows.warning.is_some() || rows.hint.is_some() { Role::Warning } else { Role::Dim };
        let used = match remark {
            Some(remark) if rows.rows.is_empty() => {
                let below =
                    Rect { y: area.y + 2.min(area.height), height: area.height.saturating_sub(2), ..area };
                draw_wrapped_text(canvas, below, "", &remark, role);
                0
            }
            Some(remark) => {
                canvas.draw_text(area, &remark, role);
                1.min(area.height)
            }
            None => 0,
        };
        let below = Rect { y: area.y + used, height: area.height.saturating_sub(used), ..area };
        match &self.chart {
            Some(plot) => plot.draw(canvas, PanePlacement { area: below, ..placement }, rows, &self.table),
            None => self.table.draw(canvas, below, placement.focused, placement.index),
        }
    }

    /// Returns the actions to show in the footer.
    pub fn hints(&self) -> Vec<Action> {
        match (self.is_chart(), self.rows()) {
            (true, _) => vec![Action::ChartY, Action::ChartKind, Action::CloseChart, Action::EditQuery],
            (false, Some(_)) => vec![Action::ShowCell, Action::Chart, Action::Export, Action::EditQuery],
            (false, None) => vec![Action::EditQuery],
        }
    }

    /// Returns the actions that the current answer supports.
    pub fn actions(&self) -> &'static [Action] {
        match (self.is_chart(), &self.answer) {
            (true, _) => &[
                Action::ChartX,
                Action::ChartY,
                Action::MoreSeries,
                Action::FewerSeries,
                Action::ChartKind,
                Action::Sort,
                Action::CloseChart,
            ],
            (false, QueryAnswer::None | QueryAnswer::Rejected(_)) => &[],
            (false, QueryAnswer::Rows(..)) => &[
                Action::ShowCell,
                Action::Sort,
                Action::Filter,
                Action::Chart,
                Action::CountColumn,
                Action::Pivot,
                Action::Export,
                Action::CopyCell,
                Action::CopyRow,
            ],
        }
    }
}

/// Draws the introduction, and the query library if it fits.
fn draw_empty_state(canvas: &mut Canvas<'_>, area: Rect, library: &QueryLibrary) {
    let used = (draw_wrapped_text(canvas, area, "", INTRODUCTION, Role::Text) + 1).min(area.height);
    let below = Rect { y: area.y + used, height: area.height - used, ..area };
    let titles = library.queries().iter().map(|query| query.title.width()).max().unwrap_or(0) as u16;
    for (row, query) in row_rects(below).zip(library.queries()) {
        canvas.draw_text(Rect { width: titles.min(row.width), ..row }, &query.title, Role::Text);
        let what = Rect { x: row.x + titles + 2, width: row.width.saturating_sub(titles + 2), ..row };
        canvas.draw_text(what, &query.description, Role::Dim);
    }
}

/// Returns a title for a statement that was rejected or stopped.
fn rejection_title(code: &str) -> &'static str {
    match code {
        "sql_timeout" => "stopped at a limit",
        "sql_cancelled" => "cancelled",
        _ => "failed",
    }
}

fn result_title(rows: &QueryResult, took: Duration) -> String {
    let of = if rows.truncated { "first " } else { "" };
    let milliseconds = took.as_secs_f64() * 1e3;
    let time = match milliseconds {
        slow if slow >= 1000.0 => format!("{:.2} s", slow / 1e3),
        quick if quick >= 1.0 => format!("{quick:.0} ms"),
        _ => "under 1 ms".to_owned(),
    };
    format!("Result · {of}{} · {time}", export::format_row_count(rows.rows.len()))
}

/// Estimates the memory that rows and their table cells use. The table cells contain only the start of long texts.
fn estimate_bytes(rows: &QueryResult) -> usize {
    const BYTES_PER_CELL: usize = 128;
    let text = |cell: &Cell| if let Cell::Text(text) = cell { text.len() + text.len().min(400) } else { 0 };
    rows.rows.iter().flatten().map(|cell| BYTES_PER_CELL + text(cell)).sum()
}

/// Formats a value for a separate window, with line breaks and indentation in JSON.
fn format_cell(cell: &Cell) -> String {
    match cell {
        Cell::Null => "NULL".to_owned(),
        Cell::Text(text) if text.is_empty() => "(empty text)".to_owned(),
        Cell::Text(text) if text.starts_with(['{', '[']) => {
            let value = serde_json::from_str::<serde_json::Value>(text).ok();
            value.and_then(|value| serde_json::to_string_pretty(&value).ok()).unwrap_or_else(|| text.clone())
        }
        other => values::full_text(other),
    }
}

/// Draws wrapped text below a heading and returns the number of rows.
fn draw_wrapped_text(canvas: &mut Canvas<'_>, area: Rect, head: &str, words: &str, role: Role) -> u16 {
    let mut rows = row_rects(area);
    let mut used = 0;
    if !head.is_empty()
        && let Some(row) = rows.next()
    {
        canvas.draw_text(row, head, role);
        used += 1;
    }
    for (row, line) in rows.zip(wrap(words, area.width as usize)) {
        canvas.draw_text(row, &line, role);
        used += 1;
    }
    used
}

/// Returns the example statements of the introduction.
#[cfg(test)]
pub fn example_statements() -> Vec<String> {
    let statements = INTRODUCTION.split("\n\n").filter(|part| part.starts_with("SELECT"));
    statements.map(str::to_owned).collect()
}
