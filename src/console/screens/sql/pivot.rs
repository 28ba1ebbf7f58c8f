//! Setup of a pivot: the focused column gives the rows, the rest has defaults.

use ratatui::layout::Rect;

use super::meant::RowsMeant;
use super::summary::{Aggregate, Distinct, MOST_ACROSS, PivotShape, pivot};
use super::values::is_numeric;
use crate::action::Action;
use crate::context::Look;
use novamind_database::{Cell, Rows};
use novamind_tui::canvas::{Canvas, Click, centered, rows_of};
use novamind_tui::theme::Role;

/// Number of lines: the options, and the one that runs the pivot.
const LINES: usize = 4;
const RUN: usize = LINES - 1;

/// A pivot being set up.
pub struct PivotChoice {
    sql: String,
    meant: RowsMeant,
    /// Available rows of those that the pivot covers.
    held: Rows,
    shape: PivotShape,
    /// Columns that can be aggregated.
    numeric: Vec<usize>,
    line: usize,
}

/// Result of an action.
#[derive(Debug, PartialEq, Eq)]
pub enum PivotStep {
    /// The setup stays open.
    Choosing,
    /// The setup closes.
    Left,
    /// Runs this statement.
    Run(String),
}

impl PivotChoice {
    /// Returns the setup of a pivot by a column of a result. Returns `None` if the statement cannot be
    /// pivoted.
    pub fn of(sql: &str, held: Rows, rows: usize, meant: RowsMeant) -> Option<PivotChoice> {
        let numeric: Vec<usize> =
            (0..held.columns.len()).filter(|at| *at != rows && is_numeric(&held, *at)).collect();
        let few = |at: &usize| {
            let Distinct { values, .. } = Distinct::of(&held, *at);
            *at != rows && (2..MOST_ACROSS).contains(&values.len()) && values.len() < held.rows.len()
        };
        let is_real = |at: usize| held.rows.iter().any(|row| matches!(row.get(at), Some(Cell::Real(_))));
        let across = (0..held.columns.len()).filter(|at| !is_real(*at)).find(few);
        let values =
            numeric.iter().copied().find(|at| Some(*at) != across && !names_something(&held.columns[*at]));
        let aggregate = if values.is_some() { Aggregate::Sum } else { Aggregate::Count };
        let shape = PivotShape { rows, across, values, aggregate };
        // Do not open the setup if no statement can be derived.
        pivot(sql, &held, shape, &meant)?;
        Some(PivotChoice { sql: sql.to_owned(), meant, held, shape, numeric, line: 0 })
    }

    pub fn act(&mut self, action: Action) -> PivotStep {
        match action {
            Action::Up => self.line = self.line.saturating_sub(1),
            Action::Down => self.line = (self.line + 1).min(RUN),
            Action::Left => self.turn(false),
            Action::Right => self.turn(true),
            Action::Open => {
                return pivot(&self.sql, &self.held, self.shape, &self.meant)
                    .map_or(PivotStep::Left, PivotStep::Run);
            }
            Action::Close => return PivotStep::Left,
            _ => {}
        }
        PivotStep::Choosing
    }

    /// Handles a click on a line; clicking the selected line changes it.
    pub fn click(&mut self, line: usize) -> PivotStep {
        let again = self.line == line;
        self.line = line.min(RUN);
        match (line, again) {
            (RUN, _) => self.act(Action::Open),
            (_, true) => self.act(Action::Right),
            _ => PivotStep::Choosing,
        }
    }

    /// Changes the selected line to its next or previous option.
    fn turn(&mut self, on: bool) {
        let shape = &mut self.shape;
        match self.line {
            0 => {
                let others = (0..self.held.columns.len()).filter(|at| *at != shape.rows).map(Some);
                shape.across = next_of(std::iter::once(None).chain(others), shape.across, on);
            }
            1 => {
                let columns = self.numeric.iter().copied().map(Some);
                shape.values = next_of(std::iter::once(None).chain(columns), shape.values, on);
                shape.aggregate = match shape.values {
                    None => Aggregate::Count,
                    Some(_) if shape.aggregate == Aggregate::Count => Aggregate::Sum,
                    Some(_) => shape.aggregate,
                };
            }
            2 if shape.values.is_some() => {
                shape.aggregate = next_of(Aggregate::OF_COLUMNS.into_iter(), shape.aggregate, on);
            }
            _ => {}
        }
    }

    fn lines(&self) -> [(&'static str, String); LINES] {
        let name = |at: usize| self.held.columns[at].clone();
        let across = match self.shape.across.map(|at| (at, Distinct::of(&self.held, at))) {
            None => "none".to_owned(),
            Some((at, distinct)) => {
                let other = if distinct.complete { "" } else { " and other" };
                format!("{} ({} values{other})", name(at), distinct.values.len())
            }
        };
        [
            ("columns", across),
            ("values", self.shape.values.map_or("rows".to_owned(), name)),
            ("aggregate", self.shape.aggregate.word().to_owned()),
            ("run", format!("one row for each {}", name(self.shape.rows))),
        ]
    }

    /// Draws the setup over the screen.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, pane: usize, look: &Look<'_>) {
        let own = centered(area, 56, LINES as u16 + 2);
        canvas.clear(own, Role::Text);
        canvas.clicks.clear();
        let title = format!("Pivot by {}", self.held.columns[self.shape.rows]);
        let words = self.meant.in_words();
        let inside = canvas.pane(own, &title, words.trim_start_matches(", "), true);
        for (row, (at, (label, value))) in rows_of(inside).zip(self.lines().into_iter().enumerate()) {
            let selected = at == self.line;
            let role = |other| if selected { Role::Selection } else { other };
            if selected {
                canvas.clear(row, Role::Selection);
            }
            let head = Rect { x: row.x + 1, width: 10.min(row.width), ..row };
            canvas.text(head, label, role(if at == RUN { Role::Key } else { Role::Dim }));
            let rest = Rect { x: row.x + 12, width: row.width.saturating_sub(13), ..row };
            let shown = if selected && at != RUN { format!("‹ {value} ›") } else { value };
            canvas.text(rest, &shown, role(Role::Text));
            canvas.click(row, Click::Row(pane, at));
        }
        let key = |action| look.keys.label(action).unwrap_or_default();
        let [open, left, right] = [Action::Open, Action::Left, Action::Right].map(key);
        canvas.pane_keys(
            own,
            &format!("{open} run · {left} {right} change · {}", look.hints(&[Action::Close])),
        );
    }
}

/// Returns whether the numbers of a column are identifiers, such as days, which are not summed.
fn names_something(column: &str) -> bool {
    const NAMES: [&str; 6] = ["id", "day", "week", "month", "number", "mod30"];
    column.to_lowercase().split(|letter: char| !letter.is_alphanumeric()).any(|word| NAMES.contains(&word))
}

/// Returns the next or previous option, cyclically.
fn next_of<T: PartialEq + Copy>(all: impl Iterator<Item = T>, now: T, on: bool) -> T {
    let all: Vec<T> = all.collect();
    let at = all.iter().position(|own| *own == now).unwrap_or(0);
    all[(at + if on { 1 } else { all.len() - 1 }) % all.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn held() -> Rows {
        let row = |group: &str, plan: &str, day: i64, amount: f64| {
            let text = |text: &str| Cell::Text(text.to_owned());
            vec![text(group), text(plan), Cell::Integer(day), Cell::Real(amount)]
        };
        Rows {
            columns: ["group_id", "plan", "start_day", "amount"].map(str::to_owned).to_vec(),
            rows: vec![row("S1", "A", 1, 2.5), row("S1", "B", 2, 1.0), row("S2", "A", 3, 4.0)],
            ..Rows::default()
        }
    }

    #[test]
    fn two_keys_give_the_pivot_that_is_likely() {
        let mut choice = PivotChoice::of("SELECT * FROM t", held(), 0, RowsMeant::All).expect("a choice");
        let shape = PivotShape { rows: 0, across: Some(1), values: Some(3), aggregate: Aggregate::Sum };
        assert_eq!(choice.shape, shape, "days and decimals are not used as columns, and days are not summed");
        assert!(
            matches!(choice.act(Action::Open), PivotStep::Run(sql) if sql.contains("sum(amount) FILTER"))
        );
        assert_eq!(choice.act(Action::Close), PivotStep::Left);
        assert!(PivotChoice::of("EXPLAIN QUERY PLAN SELECT 1", held(), 0, RowsMeant::All).is_none());
    }

    #[test]
    fn lines_change_by_key_and_by_click() {
        let mut choice = PivotChoice::of("SELECT * FROM t", held(), 0, RowsMeant::All).expect("a choice");
        choice.act(Action::Left);
        assert_eq!(choice.shape.across, None);
        choice.act(Action::Left);
        assert_eq!(choice.shape.across, Some(3), "options wrap around");
        choice.act(Action::Down);
        choice.act(Action::Right);
        assert_eq!((choice.shape.values, choice.shape.aggregate), (None, Aggregate::Count));
        choice.act(Action::Down);
        choice.act(Action::Right);
        assert_eq!(choice.shape.aggregate, Aggregate::Count, "rows can only be counted");
        choice.click(1);
        choice.click(1);
        assert_eq!((choice.shape.values, choice.shape.aggregate), (Some(2), Aggregate::Sum));
        choice.click(2);
        choice.click(2);
        assert_eq!(choice.shape.aggregate, Aggregate::Mean);
        assert!(matches!(choice.click(RUN), PivotStep::Run(sql) if sql.contains("avg(start_day)")));
    }
}
