//! What the X-ray screen asks of the hidden state of a run, and what it is told: the words of plain mode.

use novamind_insight::{Breakpoint, Condition, DrawnPart, LeadFactor};
use novamind_report::xray::{AskedWords, SpillMap};
use novamind_session::identifiers::Group;

/// A look at hidden state. Days are those that are over.
#[derive(Debug, Clone, PartialEq)]
pub enum LookQuestion {
    /// The equation of a group's leads on a day, with factors held at values.
    Leads(Group, u32, Vec<(LeadFactor, f64)>),
    /// What was delivered to a group on a day.
    Quality(Group, u32),
    /// What moved the satisfaction of a group on a day.
    Satisfaction(Group, u32),
    /// What moved the reputation of a group on a day.
    Reputation(Group, u32),
    /// How changes of reputation spilled over on a day.
    Spillover(u32),
    /// What rivals could copy and did on a day.
    Rivals(u32),
    /// What the market has added to expectations and budgets up to a day.
    Drift(u32),
    /// The draws of a part on the day after a day.
    Draws(DrawnPart, u32),
    /// A customer on a day.
    Customer(u32, u32),
    /// Of breakpoints.
    Breakpoints(BreakpointWork),
    /// Words as plain mode takes them; as they were typed, and read.
    Words(String, AskedWords),
}

/// What is done with breakpoints, besides running to them.
#[derive(Debug, Clone, PartialEq)]
pub enum BreakpointWork {
    /// List them.
    List,
    /// Set one.
    Set(Condition),
    /// Remove one, by its number.
    Remove(u32),
    /// Say since when each is true or false.
    LookBack,
}

/// What a look has found.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LookFound {
    /// Words.
    pub lines: Vec<String>,
    /// Figures of days beside some of them.
    pub curves: Vec<LookCurve>,
    /// Spills as a map, which is shown in place of the words.
    pub map: Option<SpillMap>,
    /// The day that is shown, where it can be another one than was asked for: a customer who has left shows its last one.
    pub day: Option<u32>,
    /// The breakpoints that are set; only told where breakpoints are asked for.
    pub breakpoints: Vec<Breakpoint>,
}

/// A figure of days that end with the one that is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct LookCurve {
    /// Place of the line that tells of it.
    pub line: usize,
    /// The figure day by day; not a number where it has no value.
    pub days: Vec<f64>,
}

/// Days of a debug run that were simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct DaysRan {
    /// Why they stopped, in words.
    pub lines: Vec<String>,
    /// The run is over.
    pub is_over: bool,
}
