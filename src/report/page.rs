//! Format-independent model of a page: headings, sentences, tables and charts.

/// A page.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// Title.
    pub title: String,
    /// The main result in one sentence.
    pub headline: String,
    /// Short facts about the run.
    pub tags: Vec<String>,
    /// Content.
    pub blocks: Vec<Block>,
    /// Origin of the page.
    pub footer: String,
}

/// An element of a page.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// A heading.
    Heading(&'static str),
    /// A paragraph.
    Text(String),
    /// A remark in small print.
    Note(String),
    /// A warning.
    Warning(String),
    /// Key figures.
    Facts(Vec<NamedValue>),
    /// A table.
    Table(Table),
    /// Values as horizontal bars.
    Bars(Vec<Bar>),
    /// A chart.
    Chart(Chart),
    /// A section that can be collapsed.
    Folded {
        /// Title.
        title: String,
        /// Summary at the right end of the title line.
        note: String,
        /// Sentences.
        lines: Vec<String>,
        /// List items.
        points: Vec<String>,
    },
}

/// A named value.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedValue {
    /// Name.
    pub name: String,
    /// Value.
    pub value: String,
    /// Reference value or explanation; can be empty.
    pub note: String,
}

impl NamedValue {
    /// Returns a named value.
    pub fn new(name: impl Into<String>, value: impl Into<String>, note: impl Into<String>) -> NamedValue {
        NamedValue { name: name.into(), value: value.into(), note: note.into() }
    }
}

/// A table.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Column heads, and whether the column is numeric.
    pub columns: Vec<(&'static str, bool)>,
    /// Cells by row.
    pub rows: Vec<Vec<String>>,
}

/// A bar.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    /// Name.
    pub name: String,
    /// Formatted value.
    pub value_text: String,
    /// Length, 0 to 1.
    pub share: f64,
    /// Whether the bar is highlighted.
    pub is_highlighted: bool,
}

/// A chart over days or weeks.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Title.
    pub title: String,
    /// Text alternative of the chart.
    pub summary: String,
    /// Unit of the horizontal axis.
    pub x_label: &'static str,
    /// Whether values are dollars.
    pub is_in_dollars: bool,
    /// Limits of the vertical axis, if outliers would flatten the rest.
    pub y_limits: Option<(f64, f64)>,
    /// Data of the chart.
    pub plot: Plot,
}

/// Data of a chart.
#[derive(Debug, Clone, PartialEq)]
pub enum Plot {
    /// Lines, with an optional interval.
    Lines {
        /// Lines.
        curves: Vec<Curve>,
        /// An interval.
        band: Option<Band>,
    },
    /// Stacked bars; positive parts go up, negative ones down.
    Stacks {
        /// Position of each bar on the horizontal axis.
        positions: Vec<f64>,
        /// Parts.
        series: Vec<StackSeries>,
    },
}

/// A line of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name.
    pub name: String,
    /// Points.
    pub points: Vec<(f64, f64)>,
}

/// An interval of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// Name.
    pub name: String,
    /// Position, lower end, upper end.
    pub points: Vec<(f64, f64, f64)>,
}

/// A part of stacked bars.
#[derive(Debug, Clone, PartialEq)]
pub struct StackSeries {
    /// Name.
    pub name: String,
    /// One value for each bar.
    pub values: Vec<f64>,
}
