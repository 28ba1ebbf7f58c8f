//! Result of a statement: rows to browse, copy and export, or the error.

use std::time::Duration;

use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::meant::RowsMeant;
use super::plot::PlottedColumns;
use super::{takeout, values};
use crate::action::Action;
use crate::effect::Effect;
use crate::screens::panes::Seat;
use novamind_database::{Cell, Rows};
use novamind_record::folder::library::{ChartLine, Head, Library};
use novamind_tools::Refusal;
use novamind_tui::canvas::{Canvas, rows_of};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_tui::widgets::Table;

/// Answer to the last statement.
#[derive(Debug, Default)]
pub enum Answer {
    /// No statement has been run.
    #[default]
    None,
    Rows(Rows, Duration),
    Refused(Refusal),
}

#[derive(Default)]
pub struct Results {
    answer: Answer,
    table: Table,
    /// Chart that the statement specifies.
    proposed: Option<ChartLine>,
    /// The chart, while it replaces the rows.
    plot: Option<PlottedColumns>,
    bytes: usize,
}

/// Introduction, shown before the first query.
const LESSON: &str =
    "Open the library of queries with ctrl-o, type one of these, or choose a table (shift-tab, then enter):

SELECT category, round(sum(amount)) AS dollars FROM ledger GROUP BY category ORDER BY dollars

SELECT plan, count(*) AS subscribers, round(avg(effective_price), 2) AS price
FROM subscriptions WHERE status = 'subscribed' GROUP BY plan

SELECT channel_id, group_id, sum(leads_generated) AS leads, sum(spend) AS spend
FROM ad_channel_leads GROUP BY 1, 2 ORDER BY leads DESC

Statements can only read. Days count from 0; amounts are in dollars.";

/// Returns the byte offset of an error, if the message contains it.
pub fn place_of(refusal: &Refusal) -> Option<usize> {
    let (_, place) = refusal.message.rsplit_once("(at character ")?;
    place.strip_suffix(')')?.parse::<usize>().ok()?.checked_sub(1)
}

impl Results {
    /// Stores the answer to a statement.
    pub fn take(&mut self, sql: &str, answer: Result<Rows, Refusal>, took: Duration) {
        let proposed = Head::of(sql).chart;
        match answer {
            Ok(rows) => {
                let columns = values::columns(&rows);
                let same = matches!(&self.answer, Answer::Rows(before, _) if before.columns == rows.columns);
                if !same {
                    self.table = Table::new(columns.clone()).by_cell();
                }
                if !same || proposed != self.proposed {
                    self.plot = None;
                }
                self.table.set(columns, values::cells(&rows));
                self.proposed = proposed;
                self.bytes = bytes_of(&rows);
                self.answer = Answer::Rows(rows, took);
            }
            Err(refusal) => (self.answer, self.bytes) = (Answer::Refused(refusal), 0),
        }
    }

    pub fn table(&self) -> &Table {
        &self.table
    }

    pub fn table_mut(&mut self) -> &mut Table {
        &mut self.table
    }

    pub fn is_chart(&self) -> bool {
        self.plot.is_some() && self.rows().is_some()
    }

    /// Returns whether the statement failed.
    pub fn is_refused(&self) -> bool {
        matches!(self.answer, Answer::Refused(_))
    }

    /// Returns the approximate size in bytes of the rows and their display form.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    /// Returns the rows and the selected column.
    pub fn focused_column(&self) -> Option<(&Rows, usize)> {
        let at = self.table.selected_column();
        self.rows().filter(|rows| at < rows.columns.len()).map(|rows| (rows, at))
    }

    /// Returns the rows that counts and pivots cover.
    pub fn rows_meant(&self) -> RowsMeant {
        let all = |rows| RowsMeant::by(self.table.filter_text(), rows, self.table.shown());
        self.rows().map_or(RowsMeant::All, all)
    }

    /// Returns the available rows among them.
    pub fn held(&self, meant: &RowsMeant) -> Rows {
        let Some(all) = self.rows() else { return Rows::default() };
        match (meant, self.rows_as_shown()) {
            (RowsMeant::Holding { .. }, Some(shown)) => Rows { truncated: all.truncated, ..shown },
            _ => all.clone(),
        }
    }

    /// Returns whether there are rows to export.
    pub fn has_rows(&self) -> bool {
        self.rows().is_some()
    }

    /// Returns the rows as shown, filtered and sorted.
    fn rows_as_shown(&self) -> Option<Rows> {
        let all = self.rows()?;
        let rows = self.table.shown().iter().map(|row| all.rows[*row].clone()).collect();
        Some(Rows { columns: all.columns.clone(), rows, ..Rows::default() })
    }

    /// Describes the exported rows: `12 of 300 rows, as filtered`.
    pub fn what_is_taken(&self) -> String {
        let Some(rows) = self.rows() else { return String::new() };
        match (self.table.shown().len(), rows.rows.len()) {
            (shown, all) if shown < all => format!("{shown} of {}, as filtered", takeout::count(all)),
            (_, all) if rows.truncated => format!("the first {}; more exist", takeout::count(all)),
            (_, all) => takeout::count(all),
        }
    }

    /// Exports the rows as shown.
    pub fn take_out(&self, way: Action) -> Vec<Effect> {
        self.rows_as_shown().map_or_else(Vec::new, |rows| takeout::take(way, &rows))
    }

    fn open_chart(&mut self) -> Vec<Effect> {
        self.plot = self.rows().and_then(|rows| PlottedColumns::of(rows, self.proposed.as_ref()));
        match (&self.plot, self.rows()) {
            (Some(_), _) => Vec::new(),
            (None, Some(_)) => {
                vec![Effect::Complain("No numeric column to chart".to_owned())]
            }
            (None, None) if self.is_refused() => {
                vec![Effect::Complain("No result to chart. The last statement failed.".to_owned())]
            }
            (None, None) => {
                vec![Effect::Complain("No result to chart. Run a statement first.".to_owned())]
            }
        }
    }

    /// Runs an action in the chart; other actions go to the rows.
    fn act_in_chart(&mut self, action: Action, page: u16) -> Vec<Effect> {
        let (Some(plot), Answer::Rows(rows, _)) = (&mut self.plot, &self.answer) else { return Vec::new() };
        match action {
            Action::ChartX => plot.next_x(rows),
            Action::ChartY => plot.next_y(rows),
            Action::MoreSeries if !plot.more(rows) => {
                return vec![Effect::Complain("No other numeric column, or no room for it".to_owned())];
            }
            Action::MoreSeries | Action::Left | Action::Right => {}
            Action::FewerSeries => plot.fewer(),
            Action::ChartKind => plot.other_kind(),
            Action::Sort => {
                let column = plot.first_y();
                self.table.select_column(column);
                self.table.act(Action::Sort, page);
            }
            Action::CloseChart | Action::Close => self.plot = None,
            Action::Filter => {
                self.plot = None;
                self.table.act(Action::Filter, page);
            }
            other => return self.act_in_rows(other, page),
        }
        Vec::new()
    }

    fn rows(&self) -> Option<&Rows> {
        match &self.answer {
            Answer::Rows(rows, _) => Some(rows),
            _ => None,
        }
    }

    /// Returns all values of the selected row.
    fn row(&self) -> Option<&[Cell]> {
        self.rows()?.rows.get(self.table.selected()?).map(Vec::as_slice)
    }

    /// Returns the column and value of the selected cell.
    fn cell(&self) -> Option<(&str, &Cell)> {
        let at = self.table.selected_column();
        Some((self.rows()?.columns.get(at)?, self.row()?.get(at)?))
    }

    /// Moves, sorts, filters, copies or switches to a chart.
    pub fn act(&mut self, action: Action, page: u16) -> Vec<Effect> {
        match action {
            _ if self.is_chart() => self.act_in_chart(action, page),
            Action::Chart => self.open_chart(),
            other => self.act_in_rows(other, page),
        }
    }

    fn act_in_rows(&mut self, action: Action, page: u16) -> Vec<Effect> {
        let nothing = || vec![Effect::Complain("No result to copy from".to_owned())];
        match action {
            Action::WholeCell => {
                let read = |(name, cell): (&str, &Cell)| Effect::ShowText(name.to_owned(), readable(cell));
                self.cell().map(read).map_or_else(nothing, |effect| vec![effect])
            }
            Action::CopyCell => {
                let copy = |(_, cell)| vec![Effect::Copy(values::whole(cell))];
                self.cell().map_or_else(nothing, copy)
            }
            Action::CopyRow => self.row().map_or_else(nothing, |row| vec![Effect::Copy(values::tabbed(row))]),
            Action::CommitNext | Action::CommitPrevious => {
                self.table.act(Action::Commit, page);
                Vec::new()
            }
            other => {
                self.table.act(other, page);
                Vec::new()
            }
        }
    }

    /// Handles a click on a row; a second click opens its cell.
    pub fn click(&mut self, place: usize, page: u16) -> Vec<Effect> {
        let before = self.table.selected();
        self.table.select_place(place);
        let again = before == self.table.selected() && !self.is_chart();
        if again { self.act(Action::WholeCell, page) } else { Vec::new() }
    }

    /// Returns the title and note: description of the result, its filter and order.
    pub fn head(&self) -> (String, String) {
        match &self.answer {
            Answer::None => ("Result".to_owned(), "no query yet".to_owned()),
            Answer::Refused(refusal) => (format!("Result · {}", outcome(refusal.code)), String::new()),
            Answer::Rows(rows, took) => {
                let drawn = self.plot.as_ref().map(|plot| format!(" · {}", plot.title(rows)));
                (title(rows, *took) + &drawn.unwrap_or_default(), self.table.note())
            }
        }
    }

    /// Draws the time of a running statement.
    pub fn draw_running(&self, canvas: &mut Canvas<'_>, area: Rect, since: Duration) {
        let seconds = match since.as_secs() {
            0 => String::new(),
            seconds => format!("{seconds} s "),
        };
        let row = Rect { height: 1.min(area.height), ..area };
        canvas.text(row, &format!("running {seconds}… esc cancels"), Role::Warning);
    }

    pub fn draw(&self, canvas: &mut Canvas<'_>, seat: Seat, library: &Library) {
        match &self.answer {
            Answer::None => draw_nothing(canvas, seat.area, library),
            Answer::Refused(refusal) => {
                let role = if outcome(refusal.code) == "failed" { Role::Bad } else { Role::Warning };
                text(canvas, seat.area, refusal.code, &refusal.message, role);
            }
            Answer::Rows(rows, _) => self.draw_rows(canvas, seat, rows),
        }
    }

    fn draw_rows(&self, canvas: &mut Canvas<'_>, seat: Seat, rows: &Rows) {
        let area = seat.area;
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
                text(canvas, below, "", &remark, role);
                0
            }
            Some(remark) => {
                canvas.text(area, &remark, role);
                1.min(area.height)
            }
            None => 0,
        };
        let below = Rect { y: area.y + used, height: area.height.saturating_sub(used), ..area };
        match &self.plot {
            Some(plot) => plot.draw(canvas, Seat { area: below, ..seat }, rows, &self.table),
            None => self.table.draw(canvas, below, seat.focused, seat.number),
        }
    }

    /// Returns the actions for the footer.
    pub fn hints(&self) -> Vec<Action> {
        match (self.is_chart(), self.rows()) {
            (true, _) => vec![Action::ChartY, Action::ChartKind, Action::CloseChart, Action::EditQuery],
            (false, Some(_)) => vec![Action::WholeCell, Action::Chart, Action::Export, Action::EditQuery],
            (false, None) => vec![Action::EditQuery],
        }
    }

    /// Returns the actions for the current answer.
    pub fn keys(&self) -> &'static [Action] {
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
            (false, Answer::None | Answer::Refused(_)) => &[],
            (false, Answer::Rows(..)) => &[
                Action::WholeCell,
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

/// Draws the introduction, and the library if it fits.
fn draw_nothing(canvas: &mut Canvas<'_>, area: Rect, library: &Library) {
    let used = (text(canvas, area, "", LESSON, Role::Text) + 1).min(area.height);
    let below = Rect { y: area.y + used, height: area.height - used, ..area };
    let titles = library.queries().iter().map(|query| query.title.width()).max().unwrap_or(0) as u16;
    for (row, query) in rows_of(below).zip(library.queries()) {
        canvas.text(Rect { width: titles.min(row.width), ..row }, &query.title, Role::Text);
        let what = Rect { x: row.x + titles + 2, width: row.width.saturating_sub(titles + 2), ..row };
        canvas.text(what, &query.what, Role::Dim);
    }
}

/// Returns the outcome of a statement without rows.
fn outcome(code: &str) -> &'static str {
    match code {
        "sql_timeout" => "stopped at a limit",
        "sql_cancelled" => "cancelled",
        _ => "failed",
    }
}

fn title(rows: &Rows, took: Duration) -> String {
    let of = if rows.truncated { "first " } else { "" };
    let milliseconds = took.as_secs_f64() * 1e3;
    let time = match milliseconds {
        slow if slow >= 1000.0 => format!("{:.2} s", slow / 1e3),
        quick if quick >= 1.0 => format!("{quick:.0} ms"),
        _ => "under 1 ms".to_owned(),
    };
    format!("Result · {of}{} · {time}", takeout::count(rows.rows.len()))
}

/// Returns the bytes of rows and of their cells, which contain only the start of long texts.
fn bytes_of(rows: &Rows) -> usize {
    const OF_A_CELL: usize = 128;
    let text = |cell: &Cell| if let Cell::Text(text) = cell { text.len() + text.len().min(400) } else { 0 };
    rows.rows.iter().flatten().map(|cell| OF_A_CELL + text(cell)).sum()
}

/// Returns a value for a separate window, with formatted JSON.
fn readable(cell: &Cell) -> String {
    match cell {
        Cell::Null => "NULL".to_owned(),
        Cell::Text(text) if text.is_empty() => "(empty text)".to_owned(),
        Cell::Text(text) if text.starts_with(['{', '[']) => {
            let value = serde_json::from_str::<serde_json::Value>(text).ok();
            value.and_then(|value| serde_json::to_string_pretty(&value).ok()).unwrap_or_else(|| text.clone())
        }
        other => values::whole(other),
    }
}

/// Draws wrapped text below a heading; returns the number of rows.
fn text(canvas: &mut Canvas<'_>, area: Rect, head: &str, words: &str, role: Role) -> u16 {
    let mut rows = rows_of(area);
    let mut used = 0;
    if !head.is_empty()
        && let Some(row) = rows.next()
    {
        canvas.text(row, head, role);
        used += 1;
    }
    for (row, line) in rows.zip(wrapped(words, area.width as usize)) {
        canvas.text(row, &line, role);
        used += 1;
    }
    used
}

/// Returns the example statements of the introduction.
#[cfg(test)]
pub fn examples() -> Vec<String> {
    let statements = LESSON.split("\n\n").filter(|part| part.starts_with("SELECT"));
    statements.map(str::to_owned).collect()
}
