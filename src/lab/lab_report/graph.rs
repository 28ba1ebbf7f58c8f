//! Graphs of a report, drawn as terminal text and as SVG.

use super::LabReport;
use super::text::wrap_text;
use novamind_report::page::{Chart, Curve, Plot, StackSeries};
use novamind_report::plot::{AxisScale, PlotArea, PlotSeries, horizontal_bars, plot_in};
use novamind_report::svg::{AxisScales, ScaledChart, standalone_svg};

/// A graph with one or more named series.
#[derive(Debug, Clone, PartialEq)]
pub struct Graph {
    /// Title of the graph.
    pub title: String,
    /// Description of the graph for screen readers.
    pub summary: String,
    /// Horizontal axis of the graph.
    pub x_axis: GraphAxis,
    /// Vertical axis of the graph.
    pub y_axis: GraphAxis,
    /// Series of the graph; a bar graph uses only the first.
    pub series: Vec<Series>,
    /// Form in which the series are drawn.
    pub form: GraphForm,
}

/// An axis of a graph.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GraphAxis {
    /// Label of the axis. A vertical axis whose label starts with `dollars` shows amounts in dollars.
    pub label: &'static str,
    /// Scale of the axis.
    pub scale: AxisScale,
}

impl GraphAxis {
    /// Returns the label of the axis, with a note if the scale is logarithmic.
    fn describe(&self) -> String {
        match self.scale {
            AxisScale::Logarithmic => format!("{} (logarithmic)", self.label),
            AxisScale::Linear | AxisScale::Whole => self.label.to_owned(),
        }
    }
}

/// A named series of points.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name that the legend shows for the series.
    pub name: String,
    /// Points of the series, from left to right.
    pub points: Vec<(f64, f64)>,
}

/// The form in which series are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GraphForm {
    /// Lines that join the points.
    Lines,
    /// One bar per point. In a histogram, x is the center of the bin.
    Bars,
}

/// Characters that mark the points of each series in a terminal.
const SERIES_MARKS: [char; 16] =
    ['*', '+', 'o', 'x', '#', '~', '%', '@', '=', '&', 'a', 'b', 'c', 'd', 'e', 'f'];

const MAX_BARS: usize = 40;

impl Graph {
    /// Draws the graph as text. Lines have at most `width` columns, and the drawing has `rows` rows.
    pub fn to_text(&self, width: usize, rows: usize) -> String {
        let mut text = wrap_text(&self.title, width).join("\n") + "\n";
        match (self.form, self.series.first()) {
            (GraphForm::Bars, Some(series)) => {
                text += &horizontal_bars(&merge_bars(&series.points), width);
                text += &format!("{} by {}\n", self.y_axis.label, self.x_axis.label);
            }
            _ => {
                let signs = SERIES_MARKS.iter().cycle();
                let drawn: Vec<PlotSeries<'_>> = (self.series.iter().zip(signs))
                    .map(|(series, sign)| PlotSeries { mark: *sign, points: &series.points, is_line: true })
                    .collect();
                let frame =
                    PlotArea { width, height: rows, x_scale: self.x_axis.scale, y_scale: self.y_axis.scale };
                text += &plot_in(&frame, &drawn);
                let names: Vec<String> = self
                    .series
                    .iter()
                    .zip(&drawn)
                    .map(|(series, drawn)| format!("{} {}", drawn.mark, series.name))
                    .collect();
                let legend = format!(
                    "x: {}, y: {}: {}",
                    self.x_axis.describe(),
                    self.y_axis.describe(),
                    names.join("; ")
                );
                text += &(wrap_text(&legend, width).join("\n") + "\n");
            }
        }
        text
    }

    fn to_scaled_chart(&self) -> ScaledChart {
        let curve = |series: &Series| Curve { name: series.name.clone(), points: series.points.clone() };
        let plot = match (self.form, self.series.first()) {
            (GraphForm::Bars, Some(series)) => Plot::Stacks {
                positions: series.points.iter().map(|point| point.0).collect(),
                series: vec![StackSeries {
                    name: series.name.clone(),
                    values: series.points.iter().map(|point| point.1).collect(),
                }],
            },
            _ => Plot::Lines { curves: self.series.iter().map(curve).collect(), band: None },
        };
        let chart = Chart {
            title: format!("{}: {}", self.title, self.y_axis.describe()),
            summary: self.summary.clone(),
            x_label: self.x_axis.label,
            is_in_dollars: self.y_axis.label.starts_with("dollars"),
            y_limits: None,
            plot,
        };
        ScaledChart { chart, axes: AxisScales { x: self.x_axis.scale, y: self.y_axis.scale } }
    }
}

/// Merges adjacent bars until at most [`MAX_BARS`] remain.
fn merge_bars(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let together = points.len().div_ceil(MAX_BARS).max(1);
    let joined = |bars: &[(f64, f64)]| {
        let middle = bars.iter().map(|point| point.0).sum::<f64>() / bars.len() as f64;
        (middle, bars.iter().map(|point| point.1).sum())
    };
    points.chunks(together).map(joined).collect()
}

impl LabReport {
    /// Returns all graphs of the report as one standalone SVG, or `None` if the report has no graphs.
    pub fn to_svg(&self) -> Option<String> {
        let parts: Vec<ScaledChart> = self.graphs.iter().map(Graph::to_scaled_chart).collect();
        (!parts.is_empty()).then(|| standalone_svg(&self.title, &parts))
    }
}
