//! A page of headings, sentences, tables and charts, independent of the output format.

/// A page that can be written as HTML or Markdown.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// Title of the page.
    pub title: String,
    /// The main result of the report in one sentence.
    pub headline: String,
    /// Short facts about the run, such as seed and scenario.
    pub tags: Vec<String>,
    /// Content of the page, in order.
    pub blocks: Vec<Block>,
    /// Origin of the page: program version and source of the data.
    pub footer: String,
}

/// An element of a page.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// Heading of a section.
    Heading(&'static str),
    /// Paragraph of text.
    Text(String),
    /// Paragraph in small print.
    Note(String),
    /// Paragraph that is marked as a warning.
    Warning(String),
    /// Key figures with their names.
    Facts(Vec<NamedValue>),
    /// Rows with column headings.
    Table(Table),
    /// Values as horizontal bars.
    Bars(Vec<Bar>),
    /// Curves or stacked bars.
    Chart(Chart),
    /// A section that can be collapsed.
    Collapsible {
        /// Title of the section.
        title: String,
        /// Summary that is shown at the right end of the title line.
        note: String,
        /// Paragraphs of the section.
        lines: Vec<String>,
        /// List items below the paragraphs.
        points: Vec<String>,
    },
}

/// A value with its name and a note.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedValue {
    /// Name of the value.
    pub name: String,
    /// Value as text, with its unit.
    pub value: String,
    /// Explanation or reference value; can be empty.
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
    /// Heading of each column, and whether its cells are numbers.
    pub columns: Vec<(&'static str, bool)>,
    /// Rows of the table, each with its cells.
    pub rows: Vec<Vec<String>>,
}

/// A horizontal bar.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    /// Name of the bar.
    pub name: String,
    /// Value as text, shown at the end of the bar.
    pub value_text: String,
    /// Length of the bar as a share of the longest possible bar, from 0 to 1.
    pub share: f64,
    /// Whether the bar stands out, as that of the reported run does.
    pub is_highlighted: bool,
}

/// A chart over days or weeks.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Title of the chart.
    pub title: String,
    /// Sentence that describes the chart for readers who cannot see it.
    pub summary: String,
    /// Label of the horizontal axis, such as its unit.
    pub x_label: &'static str,
    /// Whether values are dollars, which determines the labels of the vertical axis.
    pub is_in_dollars: bool,
    /// Limits of the vertical axis, for charts with outliers that would flatten the other values.
    pub y_limits: Option<(f64, f64)>,
    /// What the chart shows.
    pub plot: Plot,
}

/// What a chart draws.
#[derive(Debug, Clone, PartialEq)]
pub enum Plot {
    /// Lines, and optionally a shaded interval.
    Lines {
        /// Lines in the order of the legend.
        curves: Vec<Curve>,
        /// Shaded interval behind the lines, if any.
        band: Option<Band>,
    },
    /// Stacked bars. Positive values are stacked upward from zero, and negative values downward.
    Stacks {
        /// Position of each bar on the horizontal axis.
        positions: Vec<f64>,
        /// Series from the zero line outward, in the order of the legend.
        series: Vec<StackSeries>,
    },
}

/// A line of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name of the line in the legend.
    pub name: String,
    /// Horizontal position and value of each point.
    pub points: Vec<(f64, f64)>,
}

/// A shaded interval of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// Name of the interval in the legend.
    pub name: String,
    /// Horizontal position, lower endpoint and upper endpoint of each point of the interval.
    pub points: Vec<(f64, f64, f64)>,
}

/// A series of stacked bars.
#[derive(Debug, Clone, PartialEq)]
pub struct StackSeries {
    /// Name of the series in the legend.
    pub name: String,
    /// One value per bar.
    pub values: Vec<f64>,
}
