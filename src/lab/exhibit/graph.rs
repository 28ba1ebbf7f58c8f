//! Graphs of an exhibit as terminal text and as SVG.

use super::Exhibit;
use super::text::broken;
use novamind_report::page::{Chart, Curve, Part, Plot};
use novamind_report::plot::{AxisScale, Drawn, Frame, bars, plot_in};
use novamind_report::svg::{Axes, ChartPart, standing_alone};

/// A graph of named series.
#[derive(Debug, Clone, PartialEq)]
pub struct Graph {
    /// Title.
    pub title: String,
    /// Description for screen readers.
    pub summary: String,
    /// Horizontal axis.
    pub across: GraphAxis,
    /// Vertical axis.
    pub up: GraphAxis,
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
    fn in_words(&self) -> String {
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
const SIGNS: [char; 16] = ['*', '+', 'o', 'x', '#', '~', '%', '@', '=', '&', 'a', 'b', 'c', 'd', 'e', 'f'];

const MOST_BARS: usize = 40;

impl Graph {
    /// Returns text with lines of at most `width` columns and a drawing of `rows` rows.
    pub fn as_text(&self, width: usize, rows: usize) -> String {
        let mut text = broken(&self.title, width).join("\n") + "\n";
        match (self.form, self.series.first()) {
            (GraphForm::Bars, Some(own)) => {
                text += &bars(&thinned(&own.points), width);
                text += &format!("{} by {}\n", self.up.label, self.across.label);
            }
            _ => {
                let signs = SIGNS.iter().cycle();
                let drawn: Vec<Drawn<'_>> = (self.series.iter().zip(signs))
                    .map(|(own, sign)| Drawn { sign: *sign, points: &own.points, is_line: true })
                    .collect();
                let frame = Frame { width, height: rows, across: self.across.scale, up: self.up.scale };
                text += &plot_in(&frame, &drawn);
                let names: Vec<String> = self
                    .series
                    .iter()
                    .zip(&drawn)
                    .map(|(own, drawn)| format!("{} {}", drawn.sign, own.name))
                    .collect();
                let legend =
                    format!("x: {}, y: {}: {}", self.across.in_words(), self.up.in_words(), names.join("; "));
                text += &(broken(&legend, width).join("\n") + "\n");
            }
        }
        text
    }

    fn part(&self) -> ChartPart {
        let curve = |own: &Series| Curve { name: own.name.clone(), points: own.points.clone() };
        let plot = match (self.form, self.series.first()) {
            (GraphForm::Bars, Some(own)) => Plot::Stacks {
                at: own.points.iter().map(|point| point.0).collect(),
                parts: vec![Part {
                    name: own.name.clone(),
                    values: own.points.iter().map(|point| point.1).collect(),
                }],
            },
            _ => Plot::Lines { curves: self.series.iter().map(curve).collect(), band: None },
        };
        let chart = Chart {
            title: format!("{}: {}", self.title, self.up.in_words()),
            summary: self.summary.clone(),
            across: self.across.label,
            dollars: self.up.label.starts_with("dollars"),
            within: None,
            plot,
        };
        ChartPart { chart, axes: Axes { across: self.across.scale, up: self.up.scale } }
    }
}

/// Merges neighboring bars until there are at most [`MOST_BARS`].
fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let together = points.len().div_ceil(MOST_BARS).max(1);
    let joined = |own: &[(f64, f64)]| {
        let middle = own.iter().map(|point| point.0).sum::<f64>() / own.len() as f64;
        (middle, own.iter().map(|point| point.1).sum())
    };
    points.chunks(together).map(joined).collect()
}

impl Exhibit {
    /// Returns its graphs as one standalone SVG, or `None` without graphs.
    pub fn as_svg(&self) -> Option<String> {
        let parts: Vec<ChartPart> = self.graphs.iter().map(Graph::part).collect();
        (!parts.is_empty()).then(|| standing_alone(&self.title, &parts))
    }
}
