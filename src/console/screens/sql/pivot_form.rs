//! The form of a pivot. The focused column defines the rows, and all other options have defaults.

use ratatui::layout::Rect;

use super::row_filter::RowFilter;
use super::aggregation::{Aggregate, DistinctValues, MAX_PIVOT_COLUMNS, PivotShape, pivot_statement};
use super::values::is_numeric;
use crate::action::Action;
use crate::context::ScreenContext;
use novamind_database::{Cell, QueryResult};
use novamind_tui::canvas::{Canvas, Click, centered_rect, row_rects};
use novamind_tui::theme::Role;

/// Number of lines: three options, and the line that runs the pivot.
const LINE_COUNT: usize = 4;
const RUN_LINE: usize = LINE_COUNT - 1;

/// The form in which the user defines a pivot.
pub struct PivotForm {
    sql: String,
    filter: RowFilter,
    /// Loaded rows that pass the filter.
    rows: QueryResult,
    shape: PivotShape,
    /// Indexes of the columns that can be aggregated.
    numeric: Vec<usize>,
    line: usize,
}

/// Result of an action in the pivot form.
#[derive(Debug, PartialEq, Eq)]
pub enum PivotResult {
    /// The form stays open.
    Pending,
    /// The form closes without running the pivot.
    Cancelled,
    /// The form closes, and this statement runs.
    Run(String),
}

impl PivotForm {
    /// Returns the form for a pivot whose rows are the values of a column. Returns `None` if the statement cannot be
    /// pivoted.
    pub fn new(sql: &str, query_result: QueryResult, rows: usize, covered_rows: RowFilter) -> Option<PivotForm> {
        let numeric: Vec<usize> =
            (0..query_result.columns.len()).filter(|at| *at != rows && is_numeric(&query_result, *at)).collect();
        let few = |at: &usize| {
            let DistinctValues { values, .. } = DistinctValues::from_rows(&query_result, *at);
            *at != rows && (2..MAX_PIVOT_COLUMNS).contains(&values.len()) && values.len() < query_result.rows.len()
        };
        let is_real = |at: usize| query_result.rows.iter().any(|row| matches!(row.get(at), Some(Cell::Real(_))));
        let across = (0..query_result.columns.len()).filter(|at| !is_real(*at)).find(few);
        let values =
            numeric.iter().copied().find(|at| Some(*at) != across && !is_identifier_column(&query_result.columns[*at]));
        let aggregate = if values.is_some() { Aggregate::Sum } else { Aggregate::Count };
        let shape = PivotShape { row_column: rows, header_column: across, value_column: values, aggregate };
        // The form is not opened if no statement can be derived.
        pivot_statement(sql, &query_result, shape, &covered_rows)?;
        Some(PivotForm { sql: sql.to_owned(), filter: covered_rows, rows: query_result, shape, numeric, line: 0 })
    }

    pub fn handle_action(&mut self, action: Action) -> PivotResult {
        match action {
            Action::Up => self.line = self.line.saturating_sub(1),
            Action::Down => self.line = (self.line + 1).min(RUN_LINE),
            Action::Left => self.change_line(false),
            Action::Right => self.change_line(true),
            Action::Open => {
                return pivot_statement(&self.sql, &self.rows, self.shape, &self.filter)
                    .map_or(PivotResult::Cancelled, PivotResult::Run);
            }
            Action::Close => return PivotResult::Cancelled,
            _ => {}
        }
        PivotResult::Pending
    }

    /// Handles a click on a line. A click on the selected line changes its option.
    pub fn handle_click(&mut self, line: usize) -> PivotResult {
        let again = self.line == line;
        self.line = line.min(RUN_LINE);
        match (line, again) {
            (RUN_LINE, _) => self.handle_action(Action::Open),
            (_, true) => self.handle_action(Action::Right),
            _ => PivotResult::Pending,
        }
    }

    /// Changes the selected line to its next or previous option.
    fn change_line(&mut self, on: bool) {
        let shape = &mut self.shape;
        match self.line {
            0 => {
                let others = (0..self.rows.columns.len()).filter(|at| *at != shape.row_column).map(Some);
                shape.header_column = next_choice(std::iter::once(None).chain(others), shape.header_column, on);
            }
            1 => {
                let columns = self.numeric.iter().copied().map(Some);
                shape.value_column = next_choice(std::iter::once(None).chain(columns), shape.value_column, on);
                shape.aggregate = match shape.value_column {
                    None => Aggregate::Count,
                    Some(_) if shape.aggregate == Aggregate::Count => Aggregate::Sum,
                    Some(_) => shape.aggregate,
                };
            }
            2 if shape.value_column.is_some() => {
                shape.aggregate = next_choice(Aggregate::COLUMN_AGGREGATES.into_iter(), shape.aggregate, on);
            }
            _ => {}
        }
    }

    fn lines(&self) -> [(&'static str, String); LINE_COUNT] {
        let name = |at: usize| self.rows.columns[at].clone();
        let across = match self.shape.header_column.map(|at| (at, DistinctValues::from_rows(&self.rows, at))) {
            None => "none".to_owned(),
            Some((at, distinct)) => {
                let other = if distinct.complete { "" } else { " and other" };
                format!("{} ({} values{other})", name(at), distinct.values.len())
            }
        };
        [
            ("columns", across),
            ("values", self.shape.value_column.map_or("rows".to_owned(), name)),
            ("aggregate", self.shape.aggregate.label().to_owned()),
            ("run", format!("one row for each {}", name(self.shape.row_column))),
        ]
    }

    /// Draws the pivot form over the screen.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, pane: usize, context: &ScreenContext<'_>) {
        let dialog_area = centered_rect(area, 56, LINE_COUNT as u16 + 2);
        canvas.clear(dialog_area, Role::Text);
        canvas.clicks.clear();
        let title = format!("Pivot by {}", self.rows.columns[self.shape.row_column]);
        let words = self.filter.label();
        let inside = canvas.draw_pane_frame(dialog_area, &title, words.trim_start_matches(", "), true);
        for (row, (at, (label, value))) in row_rects(inside).zip(self.lines().into_iter().enumerate()) {
            let selected = at == self.line;
            let role = |other| if selected { Role::Selection } else { other };
            if selected {
                canvas.clear(row, Role::Selection);
            }
            let head = Rect { x: row.x + 1, width: 10.min(row.width), ..row };
            canvas.draw_text(head, label, role(if at == RUN_LINE { Role::Key } else { Role::Dim }));
            let rest = Rect { x: row.x + 12, width: row.width.saturating_sub(13), ..row };
            let shown = if selected && at != RUN_LINE { format!("‹ {value} ›") } else { value };
            canvas.draw_text(rest, &shown, role(Role::Text));
            canvas.register_click(row, Click::Row(pane, at));
        }
        let key = |action| context.keys.label(action).unwrap_or_default();
        let [open, left, right] = [Action::Open, Action::Left, Action::Right].map(key);
        canvas.draw_pane_keys(
            dialog_area,
            &format!("{open} run · {left} {right} change · {}", context.hints(&[Action::Close])),
        );
    }
}

/// Returns whether the numbers of a column are identifiers or days, which are not summed.
fn is_identifier_column(column: &str) -> bool {
    const NAMES: [&str; 6] = ["id", "day", "week", "month", "number", "mod30"];
    column.to_lowercase().split(|letter: char| !letter.is_alphanumeric()).any(|word| NAMES.contains(&word))
}

/// Returns the next or previous option, cyclically.
fn next_choice<T: PartialEq + Copy>(all: impl Iterator<Item = T>, now: T, on: bool) -> T {
    let all: Vec<T> = all.collect();
    let at = all.iter().position(|choice| *choice == now).unwrap_or(0);
    all[(at + if on { 1 } else { all.len() - 1 }) % all.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example_rows() -> QueryResult {
        let row = |group: &str, plan: &str, day: i64, amount: f64| {
            let text = |text: &str| Cell::Text(text.to_owned());
            vec![text(group), text(plan), Cell::Integer(day), Cell::Real(amount)]
        };
        QueryResult {
            columns: ["group_id", "plan", "start_day", "amount"].map(str::to_owned).to_vec(),
            rows: vec![row("S1", "A", 1, 2.5), row("S1", "B", 2, 1.0), row("S2", "A", 3, 4.0)],
            ..QueryResult::default()
        }
    }

    #[test]
    fn default_pivot_takes_two_keys() {
        let mut choice = PivotForm::new("SELECT * FROM t", example_rows(), 0, RowFilter::All).expect("a choice");
        let shape = PivotShape { row_column: 0, header_column: Some(1), value_column: Some(3), aggregate: Aggregate::Sum };
        assert_eq!(choice.shape, shape, "days and decimals are not used as columns, and days are not summed");
        assert!(
            matches!(choice.handle_action(Action::Open), PivotResult::Run(sql) if sql.contains("sum(amount) FILTER"))
        );
        assert_eq!(choice.handle_action(Action::Close), PivotResult::Cancelled);
        assert!(PivotForm::new("EXPLAIN QUERY PLAN SELECT 1", example_rows(), 0, RowFilter::All).is_none());
    }

    #[test]
    fn lines_change_by_key_and_by_click() {
        let mut choice = PivotForm::new("SELECT * FROM t", example_rows(), 0, RowFilter::All).expect("a choice");
        choice.handle_action(Action::Left);
        assert_eq!(choice.shape.header_column, None);
        choice.handle_action(Action::Left);
        assert_eq!(choice.shape.header_column, Some(3), "options wrap around");
        choice.handle_action(Action::Down);
        choice.handle_action(Action::Right);
        assert_eq!((choice.shape.value_column, choice.shape.aggregate), (None, Aggregate::Count));
        choice.handle_action(Action::Down);
        choice.handle_action(Action::Right);
        assert_eq!(choice.shape.aggregate, Aggregate::Count, "rows can only be counted");
        choice.handle_click(1);
        choice.handle_click(1);
        assert_eq!((choice.shape.value_column, choice.shape.aggregate), (Some(2), Aggregate::Sum));
        choice.handle_click(2);
        choice.handle_click(2);
        assert_eq!(choice.shape.aggregate, Aggregate::Mean);
        assert!(matches!(choice.handle_click(RUN_LINE), PivotResult::Run(sql) if sql.contains("avg(start_day)")));
    }
}
