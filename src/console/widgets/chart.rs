//! Lines over days, with axes whose labels fit.

use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::symbols::Marker;
use ratatui::text::Span;
use ratatui::widgets::{Axis as ChartAxis, Chart, Dataset, GraphType, Widget};

use crate::console::canvas::Canvas;
use crate::console::theme::Role;

/// A line of a chart.
pub struct Line {
    /// Points; those that are no numbers are left out.
    pub points: Vec<(f64, f64)>,
    /// Meaning.
    pub role: Role,
    /// Single points instead of a line.
    pub scattered: bool,
}

impl Line {
    /// A line of values at 0, 1, 2, …
    pub fn of(values: &[f64], role: Role) -> Line {
        let points = values.iter().enumerate().map(|(at, value)| (at as f64, *value)).collect();
        Line { points, role, scattered: false }
    }

    /// A line through points.
    pub fn through(points: Vec<(f64, f64)>, role: Role) -> Line {
        Line { points, role, scattered: false }
    }
}

/// What an axis means.
pub struct Axis<'a> {
    /// Writes a value.
    pub write: &'a dyn Fn(f64) -> String,
    /// Values that must be on it.
    pub holds: &'a [f64],
}

/// Draws lines; says so when there is nothing to draw yet.
pub fn chart(canvas: &mut Canvas<'_>, area: Rect, lines: &[Line], x: &Axis<'_>, y: &Axis<'_>) {
    if area.width < 16 || area.height < 4 {
        return;
    }
    let points = || lines.iter().flat_map(|line| &line.points).filter(|point| point.1.is_finite());
    if points().count() < 2 {
        canvas.text(area, "nothing to draw yet: let a week pass (n)", Role::Dim);
        return;
    }
    let bounds = |values: &mut dyn Iterator<Item = f64>, axis: &Axis<'_>| {
        let (least, most) = values
            .chain(axis.holds.iter().copied())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| {
                (least.min(value), most.max(value))
            });
        if most > least { [least, most] } else { [least - 1.0, most + 1.0] }
    };
    let x_bounds = bounds(&mut points().map(|point| point.0), x);
    let y_bounds = rounded(bounds(&mut points().map(|point| point.1), y));
    let datasets: Vec<Dataset<'_>> = lines.iter().map(|line| dataset(canvas, line)).collect();
    let dim = canvas.style(Role::Dim);
    let labels = |axis: &Axis<'_>, [from, to]: [f64; 2], count: usize| {
        let label = |at: usize| {
            let value = from + (to - from) * at as f64 / (count - 1) as f64;
            Span::styled((axis.write)(value), dim)
        };
        (0..count).map(label).collect::<Vec<_>>()
    };
    let rows = if area.height >= 10 { 4 } else { 2 } + 1;
    let columns = if area.width >= 60 { 5 } else { 3 };
    let drawn = Chart::new(datasets)
        .x_axis(ChartAxis::default().bounds(x_bounds).labels(labels(x, x_bounds, columns)).style(dim))
        .y_axis(ChartAxis::default().bounds(y_bounds).labels(labels(y, y_bounds, rows)).style(dim))
        // Names stand in the title of the pane: a legend would cover the curves.
        .legend_position(None)
        .style(Style::new());
    drawn.render(area.intersection(canvas.buffer.area), canvas.buffer);
}

fn dataset<'a>(canvas: &Canvas<'_>, line: &'a Line) -> Dataset<'a> {
    Dataset::default()
        .data(&line.points)
        .marker(if line.scattered { Marker::Dot } else { canvas.marker })
        .graph_type(if line.scattered { GraphType::Scatter } else { GraphType::Line })
        .style(canvas.style(line.role))
}

/// Zero, where a curve comes near it: far above it, zero would only flatten the curve.
pub fn zero_if_near(values: impl Iterator<Item = f64> + Clone) -> &'static [f64] {
    let most = values.clone().fold(f64::NEG_INFINITY, f64::max);
    let least = values.fold(f64::INFINITY, f64::min);
    if least < 0.5 * most { &[0.0] } else { &[] }
}

/// Bounds widened to numbers that read well.
fn rounded([least, most]: [f64; 2]) -> [f64; 2] {
    let magnitude = libm::pow(10.0, libm::floor(libm::log10(most - least)));
    let step = magnitude / 2.0;
    // A hair of rounding must not add a whole step.
    [(least / step + 1e-9).floor() * step, (most / step - 1e-9).ceil() * step]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_end_at_round_numbers() {
        assert_eq!(rounded([0.0, 980.0]), [0.0, 1000.0]);
        assert_eq!(rounded([-35.0, 1_040_000.0]), [-500_000.0, 1_500_000.0]);
        let [least, most] = rounded([0.12, 0.14]);
        assert!((least - 0.12).abs() < 1e-12 && (most - 0.14).abs() < 1e-12);
    }
}
