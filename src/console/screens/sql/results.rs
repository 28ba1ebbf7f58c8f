//! What came of a statement: rows to walk, copy and export, or why there are none.

use std::time::Duration;

use ratatui::layout::Rect;

use super::{RESULTS, values};
use crate::console::action::Action;
use crate::console::canvas::{Canvas, Click, rows_of};
use crate::console::effect::Effect;
use crate::console::screens::Look;
use crate::console::text::wrapped;
use crate::console::theme::Role;
use crate::console::widgets::Table;
use crate::notation::grouped;
use crate::session::{Cell, Refusal, Rows};

/// What came of the last statement.
#[derive(Debug, Default)]
pub enum Answer {
    /// Nothing was asked yet.
    #[default]
    None,
    /// Rows, and how long they took.
    Rows(Rows, Duration),
    /// Why it was not answered.
    Refused(Refusal),
}

/// The pane of results.
#[derive(Default)]
pub struct Results {
    answer: Answer,
    table: Table,
}

/// What to try first.
const LESSON: &str = "Examples; type one, or choose a table on the left (shift-tab, then enter):

SELECT category, round(sum(amount)) AS dollars FROM ledger GROUP BY category ORDER BY dollars

SELECT plan, count(*) AS subscribers, round(avg(effective_price), 2) AS price
FROM subscriptions WHERE status = 'subscribed' GROUP BY plan

SELECT channel_id, group_id, sum(leads_generated) AS leads, sum(spend) AS spend
FROM ad_channel_leads GROUP BY 1, 2 ORDER BY leads DESC

Only reading is possible. Days count from 0; money is in dollars.";

/// The place of an error in the statement, in bytes, where the message names it.
pub fn place_of(refusal: &Refusal) -> Option<usize> {
    let (_, place) = refusal.message.rsplit_once("(at character ")?;
    place.strip_suffix(')')?.parse::<usize>().ok()?.checked_sub(1)
}

impl Results {
    /// Takes an answer.
    pub fn take(&mut self, answer: Result<Rows, Refusal>, took: Duration) {
        match answer {
            Ok(rows) => {
                let columns = values::columns(&rows);
                let same = matches!(&self.answer, Answer::Rows(before, _) if before.columns == rows.columns);
                if !same {
                    self.table = Table::new(columns.clone()).by_cell();
                }
                self.table.set(columns, values::cells(&rows));
                self.answer = Answer::Rows(rows, took);
            }
            Err(refusal) => self.answer = Answer::Refused(refusal),
        }
    }

    /// The table of rows.
    pub fn table(&mut self) -> &mut Table {
        &mut self.table
    }

    /// Whether a filter is being typed.
    pub fn is_typing(&self) -> bool {
        self.table.is_typing()
    }

    fn rows(&self) -> Option<&Rows> {
        match &self.answer {
            Answer::Rows(rows, _) => Some(rows),
            _ => None,
        }
    }

    /// The selected row in full.
    fn row(&self) -> Option<&[Cell]> {
        self.rows()?.rows.get(self.table.selected()?).map(Vec::as_slice)
    }

    /// Name and value of the selected cell.
    fn cell(&self) -> Option<(&str, &Cell)> {
        let at = self.table.selected_column();
        Some((self.rows()?.columns.get(at)?, self.row()?.get(at)?))
    }

    /// Walks, sorts, filters, copies and exports.
    pub fn act(&mut self, action: Action, page: u16) -> Vec<Effect> {
        let nothing = || vec![Effect::Complain("there is no result to take anything from".to_owned())];
        match action {
            Action::WholeCell => {
                let read = |(name, cell): (&str, &Cell)| Effect::ShowText(name.to_owned(), readable(cell));
                return self.cell().map(read).map_or_else(nothing, |effect| vec![effect]);
            }
            Action::CopyCell => {
                let copy = |(_, cell)| vec![Effect::Copy(values::whole(cell))];
                return self.cell().map_or_else(nothing, copy);
            }
            Action::CopyRow => {
                return self.row().map_or_else(nothing, |row| vec![Effect::Copy(values::tabbed(row))]);
            }
            Action::ExportCsv => {
                let Some(rows) = self.rows() else { return nothing() };
                return vec![match values::csv(rows) {
                    Ok(bytes) => Effect::Write("query-0001.csv".to_owned(), bytes),
                    Err(problem) => Effect::Complain(problem),
                }];
            }
            Action::ExportJson => {
                let Some(rows) = self.rows() else { return nothing() };
                return vec![Effect::Write("query-0001.json".to_owned(), values::json(rows))];
            }
            Action::CommitNext | Action::CommitPrevious => {
                self.table.act(Action::Commit, page);
            }
            other => {
                self.table.act(other, page);
            }
        }
        Vec::new()
    }

    /// A row was clicked; a second time opens its cell.
    pub fn click(&mut self, place: usize, page: u16) -> Vec<Effect> {
        let before = self.table.selected();
        self.table.select_place(place);
        if before == self.table.selected() { self.act(Action::WholeCell, page) } else { Vec::new() }
    }

    /// Draws the pane.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, focused: bool, running: bool, look: &Look<'_>) {
        if area.is_empty() {
            return;
        }
        canvas.click(area, Click::Pane(RESULTS));
        let (title, note) = match &self.answer {
            _ if running => ("Result".to_owned(), String::new()),
            Answer::None => ("Result".to_owned(), String::new()),
            Answer::Refused(refusal) if refusal.code == "sql_timeout" => {
                ("Result · stopped".to_owned(), String::new())
            }
            Answer::Refused(_) => ("Result · refused".to_owned(), String::new()),
            Answer::Rows(rows, took) => (title(rows, *took), self.table.note()),
        };
        let inside = canvas.pane(area, &title, &note, focused);
        if focused {
            let keys = [
                Action::WholeCell,
                Action::Sort,
                Action::Filter,
                Action::CopyCell,
                Action::ExportCsv,
                Action::ExportJson,
            ];
            canvas.pane_keys(area, &look.hints(&keys));
        }
        if running {
            canvas.text(
                Rect { height: 1.min(inside.height), ..inside },
                "running … esc cancels",
                Role::Warning,
            );
            return;
        }
        match &self.answer {
            Answer::None => {
                text(canvas, inside, "", LESSON, Role::Dim);
            }
            Answer::Refused(refusal) => {
                let role = if refusal.code == "sql_timeout" { Role::Warning } else { Role::Bad };
                text(canvas, inside, refusal.code, &refusal.message, role);
            }
            Answer::Rows(rows, _) => self.draw_rows(canvas, inside, focused, rows),
        }
    }

    fn draw_rows(&self, canvas: &mut Canvas<'_>, area: Rect, focused: bool, rows: &Rows) {
        let remark = match (&rows.warning, &rows.hint) {
            (Some(warning), _) => Some(warning.clone()),
            (None, Some(hint)) => Some(format!("no rows: {hint}")),
            (None, None) if rows.rows.is_empty() => Some("no rows".to_owned()),
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
        self.table.draw(canvas, below, focused, RESULTS);
    }
}

/// `Result · 3 rows · 12 ms`.
fn title(rows: &Rows, took: Duration) -> String {
    let count = rows.rows.len();
    let of = if rows.truncated { "first " } else { "" };
    let noun = if count == 1 { "row" } else { "rows" };
    let milliseconds = took.as_secs_f64() * 1e3;
    let time = match milliseconds {
        slow if slow >= 1000.0 => format!("{:.2} s", slow / 1e3),
        quick if quick >= 1.0 => format!("{quick:.0} ms"),
        _ => "under 1 ms".to_owned(),
    };
    format!("Result · {of}{} {noun} · {time}", grouped(count as f64, 0))
}

/// A value to read in a window of its own; JSON is laid out.
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

/// Writes text in wrapped lines below a head, and returns how many rows it took.
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

/// The statements of the lesson.
#[cfg(test)]
pub fn examples() -> Vec<String> {
    let statements = LESSON.split("\n\n").filter(|part| part.starts_with("SELECT"));
    statements.map(str::to_owned).collect()
}
