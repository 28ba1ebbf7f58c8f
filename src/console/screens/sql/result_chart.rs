//! Charts of a query result: the choice of columns, lines or bars, and a summary above the chart.

use ratatui::layout::Rect;

use super::values::{decimals_shown, is_numeric};
use crate::screens::panes::PanePlacement;
use novamind_base::formatting::{compact_number, grouped_number};
use novamind_database::{Cell, QueryResult};
use novamind_record::folder::query_library::{ChartKind, ChartSpec};
use novamind_tui::canvas::{Align, Canvas, Click, first_visible_row, row_rects};
use novamind_tui::text::{format_change, format_number};
use novamind_tui::theme::Role;
use novamind_tui::widgets::bars::{Bar, SERIES_SYMBOLS, BarLayout};
use novamind_tui::widgets::chart::zero_if_near;
use novamind_tui::widgets::{XAxis, Curve, YAxis, Table, AxisUnit, draw_chart};

/// Maximum number of series. More series would be hard to distinguish.
const MAX_SERIES: usize = 6;

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ResultChart {
    kind: ChartKind,
    /// Column of the x axis, or `None` for the row index.
    x_column: Option<usize>,
    /// Indexes of the plotted columns, at least one.
    y_columns: Vec<usize>,
}

fn numeric_columns(rows: &QueryResult) -> Vec<usize> {
    (0..rows.columns.len()).filter(|at| is_numeric(rows, *at)).collect()
}

fn value(rows: &QueryResult, row: usize, column: usize) -> Option<f64> {
    match rows.rows.get(row)?.get(column)? {
        Cell::Integer(number) => Some(*number as f64),
        Cell::Real(number) => Some(*number).filter(|number| number.is_finite()),
        _ => None,
    }
}

impl ResultChart {
    /// Returns the chart that a statement specifies, otherwise a default chart. Returns `None` if the result has no
    /// numeric column.
    pub fn for_rows(rows: &QueryResult, proposed: Option<&ChartSpec>) -> Option<ResultChart> {
        proposed
            .and_then(|line| ResultChart::from_chart_line(rows, line))
            .or_else(|| ResultChart::default_for_rows(rows))
    }

    fn from_chart_line(rows: &QueryResult, line: &ChartSpec) -> Option<ResultChart> {
        let place = |name: &String| rows.columns.iter().position(|column| column == name);
        let x = place(&line.x_column)?;
        let ys: Vec<usize> = line.y_columns.iter().filter_map(place).filter(|at| is_numeric(rows, *at)).collect();
        (!ys.is_empty()).then_some(ResultChart { kind: line.kind, x_column: Some(x), y_columns: ys })
    }

    fn default_for_rows(rows: &QueryResult) -> Option<ResultChart> {
        let numbers = numeric_columns(rows);
        let words = (0..rows.columns.len()).find(|at| !numbers.contains(at));
        let x = words.or_else(|| numbers.first().copied().filter(|_| numbers.len() > 1));
        let y = numbers.into_iter().find(|at| Some(*at) != x)?;
        let kind = if words.is_none() && rows.rows.len() > 2 { ChartKind::Line } else { ChartKind::Bar };
        Some(ResultChart { kind, x_column: x, y_columns: vec![y] })
    }

    /// Selects the next column for the x axis.
    pub fn next_x(&mut self, rows: &QueryResult) {
        let free: Vec<usize> = (0..rows.columns.len()).filter(|at| !self.y_columns.contains(at)).collect();
        let next = free.iter().copied().find(|at| self.x_column.is_none_or(|x| *at > x));
        self.x_column = match next {
            Some(at) => Some(at),
            // After the last column, the row index is selected.
            None if self.x_column.is_some() => None,
            None => free.first().copied(),
        };
    }

    fn column_after(&self, rows: &QueryResult, column: usize) -> Option<usize> {
        let free: Vec<usize> = numeric_columns(rows)
            .into_iter()
            .filter(|at| Some(*at) != self.x_column && (*at == column || !self.y_columns.contains(at)))
            .collect();
        free.iter().copied().find(|at| *at > column).or_else(|| free.first().copied())
    }

    /// Replaces the last series with the next column.
    pub fn next_y(&mut self, rows: &QueryResult) {
        if let Some(last) = self.y_columns.last().copied()
            && let Some(next) = self.column_after(rows, last)
        {
            self.y_columns.pop();
            self.y_columns.push(next);
        }
    }

    /// Adds a series to the chart. Returns false if no numeric column is left or the maximum number of series is
    /// reached.
    pub fn add_series(&mut self, rows: &QueryResult) -> bool {
        let last = self.y_columns.last().copied().unwrap_or(0);
        let next = self.column_after(rows, last).filter(|next| !self.y_columns.contains(next) && self.y_columns.len() < MAX_SERIES);
        self.y_columns.extend(next);
        next.is_some()
    }

    /// Removes the last series, unless it is the only series.
    pub fn remove_series(&mut self) {
        if self.y_columns.len() > 1 {
            self.y_columns.pop();
        }
    }

    /// Switches between lines and bars.
    pub fn toggle_kind(&mut self) {
        self.kind = match self.kind {
            ChartKind::Line => ChartKind::Bar,
            ChartKind::Bar => ChartKind::Line,
        };
    }

    /// Returns the first plotted column.
    pub fn first_y(&self) -> usize {
        self.y_columns[0]
    }

    fn series_symbol(&self, series: usize) -> &'static str {
        match self.kind {
            ChartKind::Bar => SERIES_SYMBOLS[series % SERIES_SYMBOLS.len()],
            ChartKind::Line if is_dotted(series) => "•",
            ChartKind::Line => "⎯",
        }
    }

    /// Returns the title of the chart, for example `█ leads · ▒ signed by channel`.
    pub fn title(&self, rows: &QueryResult) -> String {
        let names = self.y_columns.iter().enumerate();
        let names: Vec<String> =
            names.map(|(series, at)| format!("{} {}", self.series_symbol(series), rows.columns[*at])).collect();
        let along = self.x_column.map_or("row", |at| rows.columns[at].as_str());
        format!("{} by {along}", names.join(" · "))
    }

    /// Returns the label of a row: its x value as formatted in the table.
    fn row_name(&self, table: &Table, row: usize) -> String {
        match self.x_column {
            Some(at) => table.rows()[row].get(at).map_or(String::new(), |cell| cell.text.clone()),
            None => (row + 1).to_string(),
        }
    }

    /// Returns the rows in drawing order: sorted by x if x is numeric, otherwise in table order.
    fn row_order(&self, rows: &QueryResult, table: &Table) -> Vec<usize> {
        let mut order = table.visible_rows().to_vec();
        if self.kind == ChartKind::Line
            && let Some(x) = self.x_column.filter(|at| is_numeric(rows, *at))
        {
            let along = |row: &usize| value(rows, *row, x).unwrap_or(f64::INFINITY);
            order.sort_by(|left, right| along(left).total_cmp(&along(right)));
        }
        order
    }

    fn summary(&self, rows: &QueryResult, table: &Table, column: usize) -> String {
        let order = self.row_order(rows, table);
        let known: Vec<(usize, f64)> =
            order.iter().filter_map(|row| Some((*row, value(rows, *row, column)?))).collect();
        let name = &rows.columns[column];
        let by = |left: &&(usize, f64), right: &&(usize, f64)| left.1.total_cmp(&right.1);
        let (Some(least), Some(most)) = (known.iter().min_by(by), known.iter().rev().max_by(by)) else {
            return format!("{name}: no numbers");
        };
        let decimals = decimals_shown(rows, column);
        // Large numbers are shortened to three digits so that they fit above the chart. The table shows all digits.
        let written = |value: f64| match value.abs() {
            large if large >= 100_000.0 => compact_number(value),
            _ => grouped_number(value, decimals),
        };
        let at = |row: usize| match self.kind {
            ChartKind::Line => format!("at {}", self.row_name(table, row)),
            ChartKind::Bar => format!("({})", self.row_name(table, row)),
        };
        let (first, last) = (known[0].1, known[known.len() - 1].1);
        let end = match self.kind {
            ChartKind::Line => {
                let change = last - first;
                format!("last {} · change {}", written(last), format_change(change, &written(change.abs())))
            }
            ChartKind::Bar => {
                let total: f64 = known.iter().map(|(_, value)| value).sum();
                let average = total / known.len() as f64;
                let average = if average.abs() >= 100_000.0 { compact_number(average) } else { format_number(average) };
                let average = format!("average {average}");
                if is_additive(name) { format!("total {} · {average}", written(total)) } else { average }
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

    /// Draws the summary and the chart below the summary.
    pub fn draw(&self, canvas: &mut Canvas<'_>, placement: PanePlacement, rows: &QueryResult, table: &Table) {
        let area = placement.area;
        // The chart needs a minimum number of rows below the summary.
        let number = self.y_columns.len().min(usize::from(area.height.saturating_sub(5)));
        for (row, (series, column)) in row_rects(area).zip(self.y_columns.iter().enumerate().take(number)) {
            canvas.draw_text(row, self.series_symbol(series), Role::Series(series));
            let text = Rect { x: row.x + 2, width: row.width.saturating_sub(2), ..row };
            canvas.draw_text(text, &self.summary(rows, table, *column), Role::Text);
        }
        let below = Rect { y: area.y + number as u16, height: area.height - number as u16, ..area };
        match self.kind {
            ChartKind::Line => self.draw_lines(canvas, below, rows, table),
            ChartKind::Bar => self.draw_bars(canvas, PanePlacement { area: below, ..placement }, rows, table),
        }
    }

    fn draw_lines(&self, canvas: &mut Canvas<'_>, area: Rect, rows: &QueryResult, table: &Table) {
        let order = self.row_order(rows, table);
        let numeric_x = self.x_column.filter(|at| is_numeric(rows, *at));
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
        let line = |(series, column): (usize, &usize)| Curve {
            is_scatter: is_dotted(series),
            ..Curve::from_points(points(*column), Role::Series(series))
        };
        let lines: Vec<Curve> = self.y_columns.iter().enumerate().map(line).collect();
        if lines.iter().map(|line| line.points.len()).sum::<usize>() < 2 {
            canvas.draw_text(area, "A line needs at least two points. Use bars (b).", Role::Dim);
            return;
        }
        let name = |place: f64| {
            let row = order.get(place.round().max(0.0) as usize);
            row.map_or(String::new(), |row| self.row_name(table, *row).chars().take(12).collect())
        };
        let write_x = |at: f64| if numeric_x.is_some() { format_axis_number(at) } else { name(at) };
        let heights = lines.iter().flat_map(|line| &line.points).map(|point| point.1);
        let x = XAxis { format: &write_x, required_values: &[] };
        let y = YAxis { unit: AxisUnit::Number, required_values: zero_if_near(heights) };
        draw_chart(canvas, area, &lines, &x, &y);
    }

    fn draw_bars(&self, canvas: &mut Canvas<'_>, placement: PanePlacement, rows: &QueryResult, table: &Table) {
        let (area, focused) = (placement.area, placement.focused);
        let shown = table.visible_rows();
        let names: Vec<String> = shown.iter().map(|row| self.row_name(table, *row)).collect();
        let selected = table.selected();
        let numbers = self.x_column.is_none_or(|x| is_numeric(rows, x));
        let side = if numbers { Align::Right } else { Align::Left };
        let bar = |place: usize, series: usize| {
            let (row, column) = (shown[place], self.y_columns[series]);
            Bar {
                name: if series == 0 { &names[place] } else { "" },
                name_align: side,
                value: value(rows, row, column),
                label: table.rows()[row].get(column).map_or("", |cell| &cell.text),
                series,
                selected: focused && series == 0 && selected == Some(row),
            }
        };
        let each = self.y_columns.len();
        let all = (0..shown.len()).flat_map(|place| (0..each).map(move |series| (place, series)));
        let scale = BarLayout::from_bars(all.clone().map(|(place, series)| bar(place, series)), area.width);
        let fit = (usize::from(area.height) / each).max(1);
        if focused {
            canvas.page_rows = fit as u16;
        }
        let place = selected.and_then(|row| shown.iter().position(|number| *number == row)).unwrap_or(0);
        let from = first_visible_row(place, fit, shown.len());
        canvas.draw_scroll_marks(area, from * each, shown.len() * each);
        for (row, (place, series)) in row_rects(area).zip(all.skip(from * each)) {
            scale.draw(canvas, row, &bar(place, series));
            canvas.register_click(row, Click::Row(placement.index, place));
        }
    }
}

/// Returns whether the sum of a column with this name is meaningful. Shares and prices are not summed.
fn is_additive(name: &str) -> bool {
    const NON_ADDITIVE_WORDS: [&str; 6] = ["percent", "share", "rate", "average", "price", "per"];
    !name.to_lowercase().split(|letter: char| !letter.is_alphanumeric()).any(|word| NON_ADDITIVE_WORDS.contains(&word))
}

/// Returns whether a series is dotted. Solid and dotted lines alternate to distinguish series without color.
fn is_dotted(series: usize) -> bool {
    series % 2 == 1
}

/// Formats a number on the x axis. Days and weeks are formatted in full, and large numbers are shortened.
fn format_axis_number(value: f64) -> String {
    if value.abs() < 10_000.0 { format_number((value * 10.0).round() / 10.0) } else { compact_number(value) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_record::folder::query_library::QueryHeader;

    fn result(columns: &[&str], rows: Vec<Vec<Cell>>) -> QueryResult {
        QueryResult { columns: columns.iter().map(|name| (*name).to_owned()).collect(), rows, ..QueryResult::default() }
    }

    fn leads_result() -> QueryResult {
        let row = |name: &str, leads: i64, spend: f64| {
            vec![Cell::Text(name.to_owned()), Cell::Integer(leads), Cell::Real(spend)]
        };
        result(&["channel", "leads", "spend"], vec![row("a", 5, 1.5), row("b", -3, 2.0), row("c", 8, 0.25)])
    }

    fn table_with_rows(rows: &QueryResult) -> Table {
        let mut table = Table::new(Vec::new());
        table.set_columns_and_rows(super::super::values::columns(rows), super::super::values::cells(rows));
        table
    }

    fn chart_line(text: &str) -> Option<ChartSpec> {
        QueryHeader::parse(&format!("-- chart: {text}")).chart
    }

    #[test]
    fn default_chart_plots_the_first_numeric_column() {
        let rows = leads_result();
        let plot = ResultChart::for_rows(&rows, None).expect("a chart");
        assert_eq!(plot, ResultChart { kind: ChartKind::Bar, x_column: Some(0), y_columns: vec![1] });
        let plot = ResultChart::for_rows(&rows, chart_line("line leads spend").as_ref()).expect("a chart");
        assert_eq!(plot, ResultChart { kind: ChartKind::Line, x_column: Some(1), y_columns: vec![2] });
        let plot = ResultChart::for_rows(&rows, chart_line("line nothing spend").as_ref()).expect("a chart");
        assert_eq!(plot.x_column, Some(0), "an unknown column leads to the default chart");
        let days =
            result(&["day", "cash"], (0..3).map(|at| vec![Cell::Integer(at), Cell::Real(1.0)]).collect());
        let plot = ResultChart::for_rows(&days, None).expect("a chart");
        assert_eq!(plot, ResultChart { kind: ChartKind::Line, x_column: Some(0), y_columns: vec![1] });
        let single = result(&["n"], vec![vec![Cell::Integer(1)]]);
        assert_eq!(ResultChart::for_rows(&single, None).map(|plot| plot.x_column), Some(None));
        assert_eq!(ResultChart::for_rows(&result(&["t"], vec![vec![Cell::Text("x".to_owned())]]), None), None);
        assert_eq!(ResultChart::for_rows(&result(&["t"], Vec::new()), None), None);
    }

    #[test]
    fn keys_change_columns_and_add_series() {
        let rows = leads_result();
        let mut plot = ResultChart::for_rows(&rows, None).expect("a chart");
        plot.next_y(&rows);
        assert_eq!(plot.y_columns, [2]);
        plot.next_y(&rows);
        assert_eq!(plot.y_columns, [1]);
        assert!(plot.add_series(&rows) && !plot.add_series(&rows));
        assert_eq!(plot.y_columns, [1, 2]);
        assert_eq!(plot.title(&rows), "█ leads · ▒ spend by channel");
        plot.remove_series();
        plot.remove_series();
        assert_eq!(plot.y_columns, [1]);
        let mut along = Vec::new();
        for _ in 0..3 {
            plot.next_x(&rows);
            along.push(plot.x_column);
        }
        assert_eq!(along, [Some(2), None, Some(0)]);
        plot.toggle_kind();
        assert_eq!(plot.title(&rows), "⎯ leads by channel");
    }

    #[test]
    fn summary_has_minimum_maximum_and_change() {
        let rows = leads_result();
        let table = table_with_rows(&rows);
        let mut plot = ResultChart::for_rows(&rows, None).expect("a chart");
        assert_eq!(plot.summary(&rows, &table, 1), "leads: min -3 (b) · max 8 (c) · total 10 · average 3.33");
        plot.toggle_kind();
        assert_eq!(
            plot.summary(&rows, &table, 2),
            "spend: min 0.25 at c · max 2.00 at b · last 0.25 · change ▼ 1.25"
        );
        let empty = result(&["t", "n"], vec![vec![Cell::Text("x".to_owned()), Cell::Null]]);
        assert_eq!(plot.summary(&empty, &table_with_rows(&empty), 1), "n: no numbers");
    }

    #[test]
    fn shares_and_prices_are_not_additive() {
        assert!(is_additive("leads") && is_additive("persons") && is_additive("dollars_a_month"));
        assert!(!is_additive("left_percent") && !is_additive("Average price"));
    }

    #[test]
    fn line_charts_sort_by_x() {
        let pairs = [(3, 30.0), (1, 10.0), (2, 20.0)];
        let rows = result(
            &["day", "cash"],
            pairs.into_iter().map(|(day, cash)| vec![Cell::Integer(day), Cell::Real(cash)]).collect(),
        );
        let plot = ResultChart::for_rows(&rows, None).expect("a chart");
        assert_eq!(plot.row_order(&rows, &table_with_rows(&rows)), [1, 2, 0]);
        assert!(plot.summary(&rows, &table_with_rows(&rows), 1).ends_with("last 30 · change ▲ 20"));
    }
}
