//! Format-independent model of a page: headings, sentences, tables and charts.

/// A page of a report, independent of the output format.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// Title of the page.
    pub title: String,
    /// The main result of the report in one sentence.
    pub headline: String,
    /// Short facts about the run.
    pub tags: Vec<String>,
    /// Content of the page, in order.
    pub blocks: Vec<Block>,
    /// Origin of the page: program version and source of the data.
    pub footer: String,
}

/// An element of a page.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// A heading.
    Heading(&'static str),
    /// A paragraph.
    Text(String),
    /// A note in small print.
    Note(String),
    /// A warning.
    Warning(String),
    /// Key figures with their names.
    Facts(Vec<NamedValue>),
    /// A table.
    Table(Table),
    /// Values as horizontal bars.
    Bars(Vec<Bar>),
    /// A chart.
    Chart(Chart),
    /// A section that can be collapsed.
    Collapsible {
        /// Title of the section.
        title: String,
        /// Summary at the right end of the title line.
        note: String,
        /// Paragraphs of the section.
        lines: Vec<String>,
        /// Items of the list in the section.
        points: Vec<String>,
    },
}

/// A value with its name and a note.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedValue {
    /// Name of the value.
    pub name: String,
    /// Formatted value.
    pub value: String,
    /// Reference value or explanation of the value; can be empty.
    pub note: String,
}

impl NamedValue {
    /// Creates a value with a name and a note.
    pub fn new(name: impl Into<String>, value: impl Into<String>, note: impl Into<String>) -> NamedValue {
        NamedValue { name: name.into(), value: value.into(), note: note.into() }
    }
}

/// A table of a page.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Heading of each column, and whether the column is numeric.
    pub columns: Vec<(&'static str, bool)>,
    /// Rows of the table, each with its cells.
    pub rows: Vec<Vec<String>>,
}

/// A horizontal bar.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    /// Name of the bar.
    pub name: String,
    /// Formatted value of the bar.
    pub value_text: String,
    /// Length of the bar as a share of the full width, from 0 to 1.
    pub share: f64,
    /// Whether the bar is highlighted.
    pub is_highlighted: bool,
}

/// A chart over days or weeks.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Title of the chart.
    pub title: String,
    /// Text alternative of the chart.
    pub summary: String,
    /// Unit of the horizontal axis.
    pub x_label: &'static str,
    /// Whether values are dollars.
    pub is_in_dollars: bool,
    /// Limits of the vertical axis; `None` unless outliers would flatten the other values.
    pub y_limits: Option<(f64, f64)>,
    /// Data of the chart as lines or stacked bars.
    pub plot: Plot,
}

/// Data of a chart.
#[derive(Debug, Clone, PartialEq)]
pub enum Plot {
    /// Lines with an optional shaded interval.
    Lines {
        /// Lines of the chart.
        curves: Vec<Curve>,
        /// Shaded interval behind the lines, if any.
        band: Option<Band>,
    },
    /// Stacked bars. Positive values are stacked upwards, and negative values are stacked downwards.
    Stacks {
        /// Position of each bar on the horizontal axis.
        positions: Vec<f64>,
        /// Series of values that are stacked.
        series: Vec<StackSeries>,
    },
}

/// A line of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name of the line in the legend.
    pub name: String,
    /// Points of the line, as position and value.
    pub points: Vec<(f64, f64)>,
}

/// A shaded interval of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// Name of the interval in the legend.
    pub name: String,
    /// Position, lower endpoint and upper endpoint of the interval.
    pub points: Vec<(f64, f64, f64)>,
}

/// A series of stacked bars.
#[derive(Debug, Clone, PartialEq)]
pub struct StackSeries {
    /// Name of the series in the legend.
    pub name: String,
    /// One value for each bar.
    pub values: Vec<f64>,
}
