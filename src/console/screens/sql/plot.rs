//! Charts of a result: choice of columns, lines or bars, and a summary above them.

use ratatui::layout::Rect;

use super::values::{decimals_shown, is_numeric};
use crate::screens::panes::Seat;
use novamind_base::notation::{compact, grouped};
use novamind_database::{Cell, Rows};
use novamind_record::folder::library::{ChartKind, ChartLine};
use novamind_tui::canvas::{Align, Canvas, Click, rows_of};
use novamind_tui::text::{arrow, number};
use novamind_tui::theme::Role;
use novamind_tui::widgets::bars::{Bar, SIGNS, Scale};
use novamind_tui::widgets::chart::zero_if_near;
use novamind_tui::widgets::table::first_row;
use novamind_tui::widgets::{Axis, Line, Side, Table, Unit, chart};

/// Maximum number of series; more are hard to distinguish.
const MOST: usize = 6;

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlottedColumns {
    kind: ChartKind,
    /// Column of the x axis; `None` for the row index.
    x: Option<usize>,
    /// Plotted columns, at least one.
    ys: Vec<usize>,
}

fn numeric(rows: &Rows) -> Vec<usize> {
    (0..rows.columns.len()).filter(|at| is_numeric(rows, *at)).collect()
}

fn value(rows: &Rows, row: usize, column: usize) -> Option<f64> {
    match rows.rows.get(row)?.get(column)? {
        Cell::Integer(number) => Some(*number as f64),
        Cell::Real(number) => Some(*number).filter(|number| number.is_finite()),
        _ => None,
    }
}

impl PlottedColumns {
    /// Returns the chart that a statement specifies, otherwise a default. Returns `None` without a numeric
    /// column.
    pub fn of(rows: &Rows, proposed: Option<&ChartLine>) -> Option<PlottedColumns> {
        proposed
            .and_then(|line| PlottedColumns::proposed(rows, line))
            .or_else(|| PlottedColumns::likeliest(rows))
    }

    fn proposed(rows: &Rows, line: &ChartLine) -> Option<PlottedColumns> {
        let place = |name: &String| rows.columns.iter().position(|column| column == name);
        let x = place(&line.x)?;
        let ys: Vec<usize> = line.ys.iter().filter_map(place).filter(|at| is_numeric(rows, *at)).collect();
        (!ys.is_empty()).then_some(PlottedColumns { kind: line.kind, x: Some(x), ys })
    }

    fn likeliest(rows: &Rows) -> Option<PlottedColumns> {
        let numbers = numeric(rows);
        let words = (0..rows.columns.len()).find(|at| !numbers.contains(at));
        let x = words.or_else(|| numbers.first().copied().filter(|_| numbers.len() > 1));
        let y = numbers.into_iter().find(|at| Some(*at) != x)?;
        let kind = if words.is_none() && rows.rows.len() > 2 { ChartKind::Line } else { ChartKind::Bar };
        Some(PlottedColumns { kind, x, ys: vec![y] })
    }

    /// Selects the next column for the x axis.
    pub fn next_x(&mut self, rows: &Rows) {
        let free: Vec<usize> = (0..rows.columns.len()).filter(|at| !self.ys.contains(at)).collect();
        let next = free.iter().copied().find(|at| self.x.is_none_or(|x| *at > x));
        self.x = match next {
            Some(at) => Some(at),
            // The row index follows the last column.
            None if self.x.is_some() => None,
            None => free.first().copied(),
        };
    }

    fn after(&self, rows: &Rows, column: usize) -> Option<usize> {
        let free: Vec<usize> = numeric(rows)
            .into_iter()
            .filter(|at| Some(*at) != self.x && (*at == column || !self.ys.contains(at)))
            .collect();
        free.iter().copied().find(|at| *at > column).or_else(|| free.first().copied())
    }

    /// Replaces the last series with the next column.
    pub fn next_y(&mut self, rows: &Rows) {
        if let Some(last) = self.ys.last().copied()
            && let Some(next) = self.after(rows, last)
        {
            self.ys.pop();
            self.ys.push(next);
        }
    }

    /// Adds a series; returns false if there is no other column or no room.
    pub fn more(&mut self, rows: &Rows) -> bool {
        let last = self.ys.last().copied().unwrap_or(0);
        let next = self.after(rows, last).filter(|next| !self.ys.contains(next) && self.ys.len() < MOST);
        self.ys.extend(next);
        next.is_some()
    }

    /// Removes a series, but not the last one.
    pub fn fewer(&mut self) {
        if self.ys.len() > 1 {
            self.ys.pop();
        }
    }

    /// Switches between lines and bars.
    pub fn other_kind(&mut self) {
        self.kind = match self.kind {
            ChartKind::Line => ChartKind::Bar,
            ChartKind::Bar => ChartKind::Line,
        };
    }

    /// Returns the first plotted column.
    pub fn first_y(&self) -> usize {
        self.ys[0]
    }

    fn sign(&self, series: usize) -> &'static str {
        match self.kind {
            ChartKind::Bar => SIGNS[series % SIGNS.len()],
            ChartKind::Line if is_dotted(series) => "•",
            ChartKind::Line => "⎯",
        }
    }

    /// Returns a title such as `█ leads · ▒ signed by channel`.
    pub fn title(&self, rows: &Rows) -> String {
        let names = self.ys.iter().enumerate();
        let names: Vec<String> =
            names.map(|(series, at)| format!("{} {}", self.sign(series), rows.columns[*at])).collect();
        let along = self.x.map_or("row", |at| rows.columns[at].as_str());
        format!("{} by {along}", names.join(" · "))
    }

    /// Returns the label of a row: its x value as in the table.
    fn name(&self, table: &Table, row: usize) -> String {
        match self.x {
            Some(at) => table.rows()[row].get(at).map_or(String::new(), |cell| cell.text.clone()),
            None => (row + 1).to_string(),
        }
    }

    /// Returns the rows in drawing order: by x if it is numeric, otherwise as in the table.
    fn order(&self, rows: &Rows, table: &Table) -> Vec<usize> {
        let mut order = table.shown().to_vec();
        if self.kind == ChartKind::Line
            && let Some(x) = self.x.filter(|at| is_numeric(rows, *at))
        {
            let along = |row: &usize| value(rows, *row, x).unwrap_or(f64::INFINITY);
            order.sort_by(|left, right| along(left).total_cmp(&along(right)));
        }
        order
    }

    fn summary(&self, rows: &Rows, table: &Table, column: usize) -> String {
        let order = self.order(rows, table);
        let known: Vec<(usize, f64)> =
            order.iter().filter_map(|row| Some((*row, value(rows, *row, column)?))).collect();
        let name = &rows.columns[column];
        let by = |left: &&(usize, f64), right: &&(usize, f64)| left.1.total_cmp(&right.1);
        let (Some(least), Some(most)) = (known.iter().min_by(by), known.iter().rev().max_by(by)) else {
            return format!("{name}: no numbers");
        };
        let decimals = decimals_shown(rows, column);
        // Large numbers have three digits to fit above the chart; the table has all digits.
        let written = |value: f64| match value.abs() {
            large if large >= 100_000.0 => compact(value),
            _ => grouped(value, decimals),
        };
        let at = |row: usize| match self.kind {
            ChartKind::Line => format!("at {}", self.name(table, row)),
            ChartKind::Bar => format!("({})", self.name(table, row)),
        };
        let (first, last) = (known[0].1, known[known.len() - 1].1);
        let end = match self.kind {
            ChartKind::Line => {
                let change = last - first;
                format!("last {} · change {}", written(last), arrow(change, &written(change.abs())))
            }
            ChartKind::Bar => {
                let total: f64 = known.iter().map(|(_, value)| value).sum();
                let average = total / known.len() as f64;
                let average = if average.abs() >= 100_000.0 { compact(average) } else { number(average) };
                let average = format!("average {average}");
                if can_be_added(name) { format!("total {} · {average}", written(total)) } else { average }
            }
        };
        format!(
            "{name}: min {} {} · max {} {} · {end}",
            written(least.1),
            at(least.0),
            written(most.1),
            at(most.0)
        )
    }

    /// Draws the summary and the chart.
    pub fn draw(&self, canvas: &mut Canvas<'_>, seat: Seat, rows: &Rows, table: &Table) {
        let area = seat.area;
        // The chart needs a minimum of rows below the summary.
        let said = self.ys.len().min(usize::from(area.height.saturating_sub(5)));
        for (row, (series, column)) in rows_of(area).zip(self.ys.iter().enumerate().take(said)) {
            canvas.text(row, self.sign(series), Role::Series(series));
            let text = Rect { x: row.x + 2, width: row.width.saturating_sub(2), ..row };
            canvas.text(text, &self.summary(rows, table, *column), Role::Text);
        }
        let below = Rect { y: area.y + said as u16, height: area.height - said as u16, ..area };
        match self.kind {
            ChartKind::Line => self.draw_lines(canvas, below, rows, table),
            ChartKind::Bar => self.draw_bars(canvas, Seat { area: below, ..seat }, rows, table),
        }
    }

    fn draw_lines(&self, canvas: &mut Canvas<'_>, area: Rect, rows: &Rows, table: &Table) {
        let order = self.order(rows, table);
        let numeric_x = self.x.filter(|at| is_numeric(rows, *at));
        let along = |place: usize, row: usize| match numeric_x {
            Some(x) => value(rows, row, x),
            None => Some(place as f64),
        };
        let points = |column: usize| -> Vec<(f64, f64)> {
            let places = order.iter().enumerate();
            places
                .filter_map(|(place, row)| Some((along(place, *row)?, value(rows, *row, column)?)))
                .collect()
        };
        let line = |(series, column): (usize, &usize)| Line {
            scattered: is_dotted(series),
            ..Line::through(points(*column), Role::Series(series))
        };
        let lines: Vec<Line> = self.ys.iter().enumerate().map(line).collect();
        if lines.iter().map(|line| line.points.len()).sum::<usize>() < 2 {
            canvas.text(area, "A line needs at least two points. Use bars (b).", Role::Dim);
            return;
        }
        let name = |place: f64| {
            let row = order.get(place.round().max(0.0) as usize);
            row.map_or(String::new(), |row| self.name(table, *row).chars().take(12).collect())
        };
        let write_x = |at: f64| if numeric_x.is_some() { axis_number(at) } else { name(at) };
        let heights = lines.iter().flat_map(|line| &line.points).map(|point| point.1);
        let x = Axis { write: &write_x, holds: &[] };
        let y = Side { unit: Unit::Number, holds: zero_if_near(heights) };
        chart(canvas, area, &lines, &x, &y);
    }

    fn draw_bars(&self, canvas: &mut Canvas<'_>, seat: Seat, rows: &Rows, table: &Table) {
        let (area, focused) = (seat.area, seat.focused);
        let shown = table.shown();
        let names: Vec<String> = shown.iter().map(|row| self.name(table, *row)).collect();
        let selected = table.selected();
        let numbers = self.x.is_none_or(|x| is_numeric(rows, x));
        let side = if numbers { Align::Right } else { Align::Left };
        let bar = |place: usize, series: usize| {
            let (row, column) = (shown[place], self.ys[series]);
            Bar {
                name: if series == 0 { &names[place] } else { "" },
                side,
                value: value(rows, row, column),
                shown: table.rows()[row].get(column).map_or("", |cell| &cell.text),
                series,
                selected: focused && series == 0 && selected == Some(row),
            }
        };
        let each = self.ys.len();
        let all = (0..shown.len()).flat_map(|place| (0..each).map(move |series| (place, series)));
        let scale = Scale::of(all.clone().map(|(place, series)| bar(place, series)), area.width);
        let fit = (usize::from(area.height) / each).max(1);
        if focused {
            canvas.page = fit as u16;
        }
        let place = selected.and_then(|row| shown.iter().position(|own| *own == row)).unwrap_or(0);
        let from = first_row(place, fit, shown.len());
        for (row, (place, series)) in rows_of(area).zip(all.skip(from * each)) {
            scale.draw(canvas, row, &bar(place, series));
            canvas.click(row, Click::Row(seat.number, place));
        }
    }
}

/// Returns whether the sum of a column with this name is meaningful; shares and prices are not summed.
fn can_be_added(name: &str) -> bool {
    const NEVER: [&str; 6] = ["percent", "share", "rate", "average", "price", "per"];
    !name.to_lowercase().split(|letter: char| !letter.is_alphanumeric()).any(|word| NEVER.contains(&word))
}

/// Returns whether a series is dotted. Solid and dotted lines alternate to distinguish series without color.
fn is_dotted(series: usize) -> bool {
    series % 2 == 1
}

/// Formats a number on the x axis: days and weeks in full, large ones short.
fn axis_number(value: f64) -> String {
    if value.abs() < 10_000.0 { number((value * 10.0).round() / 10.0) } else { compact(value) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_record::folder::library::Head;

    fn result(columns: &[&str], rows: Vec<Vec<Cell>>) -> Rows {
        Rows { columns: columns.iter().map(|name| (*name).to_owned()).collect(), rows, ..Rows::default() }
    }

    fn leads() -> Rows {
        let row = |name: &str, leads: i64, spend: f64| {
            vec![Cell::Text(name.to_owned()), Cell::Integer(leads), Cell::Real(spend)]
        };
        result(&["channel", "leads", "spend"], vec![row("a", 5, 1.5), row("b", -3, 2.0), row("c", 8, 0.25)])
    }

    fn shown(rows: &Rows) -> Table {
        let mut table = Table::new(Vec::new());
        table.set(super::super::values::columns(rows), super::super::values::cells(rows));
        table
    }

    fn proposed(text: &str) -> Option<ChartLine> {
        Head::of(&format!("-- chart: {text}")).chart
    }

    #[test]
    fn words_are_x_and_the_first_number_is_y_unless_the_statement_says_more() {
        let rows = leads();
        let plot = PlottedColumns::of(&rows, None).expect("a chart");
        assert_eq!(plot, PlottedColumns { kind: ChartKind::Bar, x: Some(0), ys: vec![1] });
        let plot = PlottedColumns::of(&rows, proposed("line leads spend").as_ref()).expect("a chart");
        assert_eq!(plot, PlottedColumns { kind: ChartKind::Line, x: Some(1), ys: vec![2] });
        let plot = PlottedColumns::of(&rows, proposed("line nothing spend").as_ref()).expect("a chart");
        assert_eq!(plot.x, Some(0), "an unknown column leads to the default chart");
        let days =
            result(&["day", "cash"], (0..3).map(|at| vec![Cell::Integer(at), Cell::Real(1.0)]).collect());
        let plot = PlottedColumns::of(&days, None).expect("a chart");
        assert_eq!(plot, PlottedColumns { kind: ChartKind::Line, x: Some(0), ys: vec![1] });
        let single = result(&["n"], vec![vec![Cell::Integer(1)]]);
        assert_eq!(PlottedColumns::of(&single, None).map(|plot| plot.x), Some(None));
        assert_eq!(PlottedColumns::of(&result(&["t"], vec![vec![Cell::Text("x".to_owned())]]), None), None);
        assert_eq!(PlottedColumns::of(&result(&["t"], Vec::new()), None), None);
    }

    #[test]
    fn columns_are_walked_in_a_circle_and_series_are_added() {
        let rows = leads();
        let mut plot = PlottedColumns::of(&rows, None).expect("a chart");
        plot.next_y(&rows);
        assert_eq!(plot.ys, [2]);
        plot.next_y(&rows);
        assert_eq!(plot.ys, [1]);
        assert!(plot.more(&rows) && !plot.more(&rows));
        assert_eq!(plot.ys, [1, 2]);
        assert_eq!(plot.title(&rows), "█ leads · ▒ spend by channel");
        plot.fewer();
        plot.fewer();
        assert_eq!(plot.ys, [1]);
        let mut along = Vec::new();
        for _ in 0..3 {
            plot.next_x(&rows);
            along.push(plot.x);
        }
        assert_eq!(along, [Some(2), None, Some(0)]);
        plot.other_kind();
        assert_eq!(plot.title(&rows), "⎯ leads by channel");
    }

    #[test]
    fn the_words_say_least_most_and_what_became_of_it() {
        let rows = leads();
        let table = shown(&rows);
        let mut plot = PlottedColumns::of(&rows, None).expect("a chart");
        assert_eq!(plot.summary(&rows, &table, 1), "leads: min -3 (b) · max 8 (c) · total 10 · average 3.33");
        plot.other_kind();
        assert_eq!(
            plot.summary(&rows, &table, 2),
            "spend: min 0.25 at c · max 2.00 at b · last 0.25 · change ▼ 1.25"
        );
        let empty = result(&["t", "n"], vec![vec![Cell::Text("x".to_owned()), Cell::Null]]);
        assert_eq!(plot.summary(&empty, &shown(&empty), 1), "n: no numbers");
    }

    #[test]
    fn shares_and_prices_are_not_added() {
        assert!(can_be_added("leads") && can_be_added("persons") && can_be_added("dollars_a_month"));
        assert!(!can_be_added("left_percent") && !can_be_added("Average price"));
    }

    #[test]
    fn a_line_follows_x_whatever_the_order_of_the_rows() {
        let pairs = [(3, 30.0), (1, 10.0), (2, 20.0)];
        let rows = result(
            &["day", "cash"],
            pairs.into_iter().map(|(day, cash)| vec![Cell::Integer(day), Cell::Real(cash)]).collect(),
        );
        let plot = PlottedColumns::of(&rows, None).expect("a chart");
        assert_eq!(plot.order(&rows, &shown(&rows)), [1, 2, 0]);
        assert!(plot.summary(&rows, &shown(&rows), 1).ends_with("last 30 · change ▲ 20"));
    }
}
