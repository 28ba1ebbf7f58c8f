//! Comparison of branches: curves of a figure, its values at milestones, and the differences.

use ratatui::layout::Rect;

use crate::action::Action;
use novamind_insight::{BranchComparison, BranchFigure, DecisionEdit, Futures};
use novamind_record::figures::FigureUnit;
use novamind_report::whatif::{
    DecisionNotation, branch_line, comparison_cell, comparison_cell_lines, describe_bankruptcies,
    describe_decisions, difference_line, futures_cell, futures_cell_lines, futures_heading, milestone_label,
    period, unplayed_weeks_line,
};
use novamind_session::EnterpriseNames;
use novamind_tui::canvas::{Canvas, Click, row_rects, truncate_to_width};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::draw_chart;
use novamind_tui::widgets::{AxisUnit, Curve, XAxis, YAxis};

const MIN_CHART_ROWS: u16 = 6;
const MAX_CHART_ROWS: u16 = 16;

const WEEK_HEADER: &str = "after week";

pub(super) struct ComparisonView {
    comparison: BranchComparison,
    futures: Option<Futures>,
    days_per_week: u32,
    figure: usize,
    selected: usize,
    /// Confidence interval of the selected branch's difference, computed once rather than in every frame.
    confidence_text: Option<String>,
}

impl ComparisonView {
    pub(super) fn new(
        comparison: BranchComparison,
        futures: Option<Futures>,
        days_per_week: u32,
        figure: usize,
    ) -> ComparisonView {
        let selected = 1.min(comparison.branches.len().saturating_sub(1));
        let sure = None;
        let mut figures =
            ComparisonView { comparison, futures, days_per_week, figure, selected, confidence_text: sure };
        figures.update_confidence_text();
        figures
    }

    pub(super) fn figure(&self) -> usize {
        self.figure
    }

    fn shown_figure(&self) -> BranchFigure {
        self.comparison.figures[self.figure % self.comparison.figures.len()]
    }

    pub(super) fn figure_label(&self) -> String {
        let (name, percent) =
            (self.shown_figure().name(), if is_share(self.shown_figure()) { ", %" } else { "" });
        format!("{name}{percent}")
    }

    pub(super) fn selected_edits(&self) -> Vec<DecisionEdit> {
        self.comparison.branches.get(self.selected).map_or(Vec::new(), |branch| branch.edits.clone())
    }

    pub(super) fn select(&mut self, branch: usize) {
        self.selected = branch.min(self.comparison.branches.len().saturating_sub(1));
        self.update_confidence_text();
    }

    fn show_figure(&mut self, figure: usize) {
        self.figure = figure % self.comparison.figures.len();
        self.update_confidence_text();
    }

    fn update_confidence_text(&mut self) {
        let differs = self
            .comparison
            .branches
            .get(self.selected)
            .is_some_and(|branch_figures| !branch_figures.edits.is_empty());
        let line = |futures| difference_line(&self.comparison, futures, self.selected, self.shown_figure());
        self.confidence_text = self.futures.as_ref().filter(|_| differs).and_then(line);
    }

    pub(super) fn handle_action(&mut self, action: Action) {
        match action {
            Action::NextFigure | Action::Right => self.show_figure(self.figure + 1),
            Action::Left => self.show_figure(self.figure + self.comparison.figures.len() - 1),
            Action::Up => self.select(self.selected.saturating_sub(1)),
            Action::Down => self.select(self.selected + 1),
            Action::First => self.select(0),
            Action::Last => self.select(usize::MAX),
            _ => {}
        }
    }

    /// Draws the comparison. `labels` are the names of the branches.
    pub(super) fn draw(
        &self,
        canvas: &mut Canvas<'_>,
        area: Rect,
        labels: &[String],
        names: &EnterpriseNames,
    ) {
        let mut rest = area;
        let lines = self.lines_per_milestone(area);
        let milestones = self.comparison.milestone_days(self.days_per_week).len() * lines;
        let table = milestones as u16 + 1;
        // In a small window, the first line is omitted to leave space for the table.
        if area.height > table + self.comparison.branches.len() as u16 {
            let row = split_top(&mut rest, 1);
            let heading = period(&self.comparison, self.days_per_week);
            canvas.draw_text(row, &truncate_to_width(&heading, row.width as usize), Role::Dim);
        }
        self.draw_branches(canvas, &mut rest, labels);
        let room = rest.height.saturating_sub(table + 2);
        if room >= MIN_CHART_ROWS {
            let height = room.saturating_sub(room / 3).min(MAX_CHART_ROWS);
            self.draw_chart(canvas, split_top(&mut rest, height));
        }
        self.draw_table(canvas, split_top(&mut rest, table), lines);
        let texts = self.selection_lines(names);
        let lines = texts.iter().flat_map(|text| wrap(text, rest.width as usize));
        for (row, line) in row_rects(rest).zip(lines) {
            canvas.draw_text(row, &line, Role::Dim);
        }
    }

    fn draw_branches(&self, canvas: &mut Canvas<'_>, rest: &mut Rect, labels: &[String]) {
        for number in 0..self.comparison.branches.len() {
            let row = split_top(rest, 1);
            let here = number == self.selected;
            let mark = if here { "›" } else { " " };
            let label = labels.get(number).map_or("", String::as_str);
            let text = format!("{mark} {}", branch_line(&self.comparison, number, label, self.days_per_week));
            let role = if here { Role::Selection } else { Role::Series(number) };
            canvas.draw_text(row, &truncate_to_width(&text, row.width as usize), role);
            canvas.register_click(row, Click::Row(0, number));
        }
    }

    fn draw_chart(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let figure = self.shown_figure();
        let curve = |number: usize| -> Vec<(f64, f64)> {
            match &self.futures {
                Some(futures) => futures
                    .intervals(number, figure)
                    .map(|(day, band)| (f64::from(day), band.median))
                    .collect(),
                None => self.comparison.branches[number]
                    .values_by_week(figure)
                    .map(|(day, value)| (f64::from(day), value))
                    .collect(),
            }
        };
        let scale = if is_share(figure) { 100.0 } else { 1.0 };
        let points = |number| {
            let finite = curve(number).into_iter().filter(|(_, value)| value.is_finite());
            finite.map(|(day, value)| (day, scale * value)).collect()
        };
        let lines: Vec<Curve> = (0..self.comparison.branches.len())
            .map(|number| {
                let name = CURVE_NAMES.get(number).copied().unwrap_or_default();
                Curve::from_points(points(number), Role::Series(number)).with_name(name)
            })
            .collect();
        let unit = match figure.unit() {
            FigureUnit::Dollars => AxisUnit::Dollars,
            FigureUnit::Count | FigureUnit::Share | FigureUnit::PreciseShare | FigureUnit::Level => {
                AxisUnit::Number
            }
        };
        // The end of the record is marked, because later days were not played.
        let end = [f64::from(self.comparison.recorded_until)];
        let is_inside =
            (self.comparison.from..self.comparison.until).contains(&self.comparison.recorded_until);
        let required_values = if is_inside { &end[..] } else { &[] };
        let format = |day: f64| match end.contains(&day) && is_inside {
            true => format!("played to day {day:.0}"),
            false => format!("day {day:.0}"),
        };
        let x = XAxis { format: &format, required_values };
        draw_chart(canvas, area, &lines, &x, &YAxis { unit, required_values: &[] });
    }

    fn draw_table(&self, canvas: &mut Canvas<'_>, area: Rect, lines: usize) {
        let figure = self.shown_figure();
        let days = self.comparison.milestone_days(self.days_per_week);
        let first = self.week_column_width().min(area.width);
        let width = (area.width - first) / self.comparison.branches.len().max(1) as u16;
        let place =
            |row: Rect, number: usize| Rect { x: row.x + first + number as u16 * width, width, ..row };
        let mut rows = row_rects(area);
        let Some(header) = rows.next() else { return };
        canvas.draw_text(header, WEEK_HEADER, Role::Header);
        for number in 0..self.comparison.branches.len() {
            canvas.draw_text(place(header, number), &format!(" {number}"), Role::Header);
        }
        for day in days {
            let rows: Vec<Rect> = rows.by_ref().take(lines).collect();
            let Some(first_row) = rows.first() else { return };
            let week = milestone_label(&self.comparison, day, self.days_per_week);
            canvas.draw_text(*first_row, &week, Role::Dim);
            for number in 0..self.comparison.branches.len() {
                for (row, text) in rows.iter().zip(self.format_milestone(number, figure, day, lines)) {
                    let text = format!(" {}", truncate_to_width(&text, usize::from(width).saturating_sub(1)));
                    canvas.draw_text(place(*row, number), &text, Role::Text);
                }
            }
        }
    }

    fn week_column_width(&self) -> u16 {
        let days = self.comparison.milestone_days(self.days_per_week).into_iter();
        let labels =
            days.map(|day| milestone_label(&self.comparison, day, self.days_per_week).chars().count());
        labels.chain([WEEK_HEADER.len()]).max().unwrap_or(0) as u16
    }

    /// Formats a figure of a branch at a milestone in one or two lines.
    fn format_milestone(&self, number: usize, figure: BranchFigure, day: u32, lines: usize) -> Vec<String> {
        match &self.futures {
            Some(futures) if lines > 1 => futures_cell_lines(futures, number, figure, day).into(),
            Some(futures) => vec![futures_cell(futures, number, figure, day)],
            None => {
                let (comparison, branch) = (&self.comparison, &self.comparison.branches[number]);
                match lines > 1 {
                    true => comparison_cell_lines(comparison, branch, figure, day).into(),
                    false => vec![comparison_cell(comparison, branch, figure, day)],
                }
            }
        }
    }

    /// Returns the number of lines per milestone: two if a figure does not fit into one line.
    fn lines_per_milestone(&self, area: Rect) -> usize {
        let width = area.width.saturating_sub(self.week_column_width())
            / self.comparison.branches.len().max(1) as u16;
        let days = self.comparison.milestone_days(self.days_per_week);
        let cells = (0..self.comparison.branches.len())
            .flat_map(|number| days.iter().map(move |day| (number, *day)))
            .map(|(number, day)| {
                self.format_milestone(number, self.shown_figure(), day, 1).concat().chars().count()
            });
        let is_truncated = cells.max().is_some_and(|longest| longest >= usize::from(width));
        let has_room = usize::from(area.height) > 2 * days.len() + self.comparison.branches.len();
        if is_truncated && (has_room || self.futures.is_some()) { 2 } else { 1 }
    }

    /// Describes the uncertainty of the difference and the edits of the selected branch.
    fn selection_lines(&self, names: &EnterpriseNames) -> Vec<String> {
        let Some(branch) = self.comparison.branches.get(self.selected) else { return Vec::new() };
        let mut texts = Vec::new();
        if let Some(futures) = &self.futures {
            texts.push(futures_heading(futures));
            texts.extend(self.confidence_text.iter().map(|line| format!("at the end: {line}")));
            texts.extend(
                (0..self.comparison.branches.len()).filter_map(|at| describe_bankruptcies(futures, at)),
            );
        }
        texts.extend(describe_decisions(branch, self.days_per_week, DecisionNotation::Words(names)));
        texts.extend(unplayed_weeks_line(&self.comparison, self.days_per_week));
        texts
    }
}

/// Names of the curves: the numbers of the branches, as in the list above the chart.
const CURVE_NAMES: [&str; 10] = ["0", "1", "2", "3", "4", "5", "6", "7", "8", "9"];

fn is_share(figure: BranchFigure) -> bool {
    matches!(figure.unit(), FigureUnit::Share | FigureUnit::PreciseShare)
}

/// Removes rows from the top of an area and returns them.
fn split_top(rest: &mut Rect, height: u16) -> Rect {
    let height = height.min(rest.height);
    let taken = Rect { height, ..*rest };
    (rest.y, rest.height) = (rest.y + height, rest.height - height);
    taken
}
