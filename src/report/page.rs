//! A page before it is written: headings, sentences, tables and charts, without a format.

/// A page.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// What it is about.
    pub title: String,
    /// The one sentence to take away.
    pub headline: String,
    /// What kind of run it is, in short facts.
    pub tags: Vec<String>,
    /// The rest.
    pub blocks: Vec<Block>,
    /// Who made it.
    pub foot: String,
}

/// A part of a page.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// A heading.
    Heading(&'static str),
    /// Sentences.
    Text(String),
    /// A remark in small letters.
    Note(String),
    /// A warning.
    Warning(String),
    /// Names with their values, to be seen at a glance: name, value, what it means.
    Facts(Vec<Fact>),
    /// A table.
    Table(Table),
    /// Values as bars beside each other.
    Bars(Vec<Bar>),
    /// A chart.
    Chart(Chart),
    /// Something with a title that can be folded away.
    Folded {
        /// Title.
        title: String,
        /// What is worth knowing about it at the right end.
        note: String,
        /// Sentences.
        lines: Vec<String>,
        /// Points of a list.
        points: Vec<String>,
    },
}

/// A value with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct Fact {
    /// Name.
    pub name: String,
    /// Value.
    pub value: String,
    /// What to compare it with; may be empty.
    pub note: String,
}

impl Fact {
    /// A value with its name.
    pub fn new(name: impl Into<String>, value: impl Into<String>, note: impl Into<String>) -> Fact {
        Fact { name: name.into(), value: value.into(), note: note.into() }
    }
}

/// A table.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Heads of the columns, and whether they hold numbers.
    pub columns: Vec<(&'static str, bool)>,
    /// Cells by row.
    pub rows: Vec<Vec<String>>,
}

/// A bar.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    /// Name.
    pub name: String,
    /// Value as it is written.
    pub shown: String,
    /// Length, 0 to 1.
    pub share: f64,
    /// It is the one that matters.
    pub own: bool,
}

/// A chart over days or weeks.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// What it shows.
    pub title: String,
    /// The same in a sentence, for those who cannot see it.
    pub summary: String,
    /// What the horizontal axis counts.
    pub across: &'static str,
    /// Values are dollars.
    pub dollars: bool,
    /// Values that the vertical axis may not leave, if far ones would flatten the rest.
    pub within: Option<(f64, f64)>,
    /// What is drawn.
    pub plot: Plot,
}

/// What a chart draws.
#[derive(Debug, Clone, PartialEq)]
pub enum Plot {
    /// Lines, over an interval if there is one.
    Lines {
        /// Lines.
        curves: Vec<Curve>,
        /// An interval.
        band: Option<Band>,
    },
    /// Bars of parts on each other; parts above zero go up, the others down.
    Stacks {
        /// Place of each bar on the horizontal axis.
        at: Vec<f64>,
        /// Parts.
        parts: Vec<Part>,
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
    /// Place, lower end, upper end.
    pub points: Vec<(f64, f64, f64)>,
}

/// A part of stacked bars.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Name.
    pub name: String,
    /// One value for each bar.
    pub values: Vec<f64>,
}
