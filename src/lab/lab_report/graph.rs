//! Graphs of a report as terminal text and as SVG.

use super::LabReport;
use super::text::wrap_text;
use novamind_report::page::{Chart, Curve, Plot, StackSeries};
use novamind_report::plot::{AxisScale, PlotArea, PlotSeries, bars, plot_in};
use novamind_report::svg::{AxisScales, ScaledChart, standalone_svg};

/// A graph of named series.
#[derive(Debug, Clone, PartialEq)]
pub struct Graph {
    /// Title.
    pub title: String,
    /// Description for screen readers.
    pub summary: String,
    /// Horizontal axis.
    pub x_axis: GraphAxis,
    /// Vertical axis.
    pub y_axis: GraphAxis,
    /// Series; bars use only the first.
    pub series: Vec<Series>,
    /// Drawing style.
    pub form: GraphForm,
}

/// An axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GraphAxis {
    /// Label.
    pub label: &'static str,
    /// Scale.
    pub scale: AxisScale,
}

impl GraphAxis {
    /// Returns the label, marked if the scale is logarithmic.
    fn describe(&self) -> String {
        match self.scale {
            AxisScale::Logarithmic => format!("{} (logarithmic)", self.label),
            AxisScale::Linear | AxisScale::Whole => self.label.to_owned(),
        }
    }
}

/// A series of points.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name.
    pub name: String,
    /// Points from left to right.
    pub points: Vec<(f64, f64)>,
}

/// Drawing style of series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GraphForm {
    /// Joined points.
    Lines,
    /// One bar per point; for histograms, x is the middle of the bin.
    Bars,
}

/// Characters of the series in a terminal, in order.
const SERIES_MARKS: [char; 16] =
    ['*', '+', 'o', 'x', '#', '~', '%', '@', '=', '&', 'a', 'b', 'c', 'd', 'e', 'f'];

const MAX_BARS: usize = 40;

impl Graph {
    /// Returns text with lines of at most `width` columns and a drawing of `rows` rows.
    pub fn to_text(&self, width: usize, rows: usize) -> String {
        let mut text = wrap_text(&self.title, width).join("\n") + "\n";
        match (self.form, self.series.first()) {
            (GraphForm::Bars, Some(series)) => {
                text += &bars(&merge_bars(&series.points), width);
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

/// Merges neighboring bars until there are at most [`MAX_BARS`].
fn merge_bars(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let together = points.len().div_ceil(MAX_BARS).max(1);
    let joined = |bars: &[(f64, f64)]| {
        let middle = bars.iter().map(|point| point.0).sum::<f64>() / bars.len() as f64;
        (middle, bars.iter().map(|point| point.1).sum())
    };
    points.chunks(together).map(joined).collect()
}

impl LabReport {
    /// Returns its graphs as one standalone SVG, or `None` without graphs.
    pub fn to_svg(&self) -> Option<String> {
        let parts: Vec<ScaledChart> = self.graphs.iter().map(Graph::to_scaled_chart).collect();
        (!parts.is_empty()).then(|| standalone_svg(&self.title, &parts))
    }
}
