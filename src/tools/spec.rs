//! The specification of a tool, from which its form, command, route, documentation and argument checks are derived.

use super::tool_id::ToolId;
use novamind_base::notation::grouped;

/// Maximum of a price, a discount or a daily budget, in dollars.
pub const MOST_DOLLARS: f64 = 1e9;
/// Maximum of a quota, in units per day.
pub const MOST_UNITS: f64 = 1e15;

/// The specification of a tool.
#[derive(Debug)]
pub struct Spec {
    /// Identifier.
    pub id: ToolId,
    /// Short code of three to five capitals, for example `PRC`.
    pub code: &'static str,
    /// Module of the client library.
    pub module: Module,
    /// Kind.
    pub kind: Kind,
    /// Summary in one line.
    pub summary: &'static str,
    /// Arguments, in the order in which they are checked.
    pub arguments: &'static [Argument],
    /// Whether the tool has its own rejection code for unknown arguments.
    pub own_unknown: bool,
    /// The argument that a call can give without its name, for example the matrix of ad spend.
    pub whole: Option<&'static str>,
    /// Time of the effect.
    pub when: When,
    /// Effect.
    pub effect: &'static str,
    /// Cost.
    pub cost: &'static str,
    /// Tables that it writes.
    pub writes: &'static [&'static str],
    /// Rejection codes, in the order of its checks.
    pub refusals: &'static [&'static str],
    /// Fields of the result.
    pub returns: &'static [Output],
    /// Arguments of an example, as JSON.
    pub example: &'static str,
}

/// Modules of the client library.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Module {
    /// Prices, tiers, quotas, discounts.
    Pricing,
    /// Budgets, advertising, posts.
    Marketing,
    /// Targeted budgets and posts of others.
    Analytics,
    /// R&D.
    Research,
    /// Discovery and market studies.
    Market,
    /// Capacity and costs.
    Infrastructure,
    /// Negotiations with enterprises.
    Enterprise,
    /// Time and data.
    Time,
}

impl Spec {
    /// Returns the name, for example `set_prices`.
    pub fn name(&self) -> &'static str {
        self.id.name()
    }

    /// Returns whether the tool has its own rejection code for missing arguments.
    pub fn own_missing(&self) -> bool {
        self.refusals.iter().any(|code| code.ends_with("_missing"))
    }
}

impl Module {
    /// All modules, in display order.
    pub const ALL: [Module; 8] = [
        Module::Pricing,
        Module::Marketing,
        Module::Analytics,
        Module::Research,
        Module::Market,
        Module::Infrastructure,
        Module::Enterprise,
        Module::Time,
    ];

    /// Returns the name.
    pub fn id(self) -> &'static str {
        match self {
            Module::Pricing => "pricing",
            Module::Marketing => "marketing",
            Module::Analytics => "analytics",
            Module::Research => "research",
            Module::Market => "market",
            Module::Infrastructure => "infrastructure",
            Module::Enterprise => "enterprise",
            Module::Time => "time",
        }
    }
}

/// Kinds of tools.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Changes a setting from the next day on.
    Setting,
    /// Spends money at once.
    Purchase,
    /// Acts once and costs nothing.
    OneShot,
    /// Reads.
    Read,
    /// Advances the simulation.
    Time,
    /// Works on the notebook and the documentation, never on the company.
    Engine,
}

impl Kind {
    /// Returns whether a call can change the company.
    pub fn acts(self) -> bool {
        !matches!(self, Kind::Read | Kind::Engine)
    }

    /// Returns the name in documentation.
    pub fn id(self) -> &'static str {
        match self {
            Kind::Setting => "setting",
            Kind::Purchase => "purchase",
            Kind::OneShot => "one_shot",
            Kind::Read => "read",
            Kind::Time => "time",
            Kind::Engine => "engine",
        }
    }
}

/// Time of the effect of a tool.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum When {
    /// From the next simulated day on.
    NextDay,
    /// On each customer's next bill.
    NextBilling,
    /// At once.
    Now,
    /// After a delay, which the result states.
    AtCompletion,
    /// When the customer replies.
    CustomerReply,
    /// No effect.
    Never,
}

impl When {
    /// Returns the name in documentation.
    pub fn id(self) -> &'static str {
        match self {
            When::NextDay => "next day",
            When::NextBilling => "next bill of each customer",
            When::Now => "at once",
            When::AtCompletion => "at completion",
            When::CustomerReply => "when the customer answers",
            When::Never => "changes nothing",
        }
    }
}

/// One argument.
#[derive(Debug)]
pub struct Argument {
    /// Name.
    pub name: &'static str,
    /// Second name, for older callers.
    pub alias: Option<&'static str>,
    /// Type.
    pub kind: ArgumentKind,
    /// Whether a call without it is rejected, as `argument_missing` or with the tool's own code.
    pub required: bool,
    /// Unit of its numbers.
    pub unit: &'static str,
    /// Meaning.
    pub doc: &'static str,
}

/// Type of an argument.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ArgumentKind {
    /// A number.
    Number(Range),
    /// An integer.
    Integer(Range),
    /// Text.
    Text,
    /// Another list or object, with a description.
    Structure(&'static str),
    /// A list of deals with prices, with a description.
    Deals(&'static str),
    /// A map from a key to a number.
    Map(Key, Range),
    /// A map of maps to a number.
    Matrix(Key, Key, Range),
}

impl ArgumentKind {
    /// Returns a description, for example `map channel -> map group -> number, >= 0`.
    pub fn words(&self) -> String {
        match self {
            ArgumentKind::Number(range) => format!("number, {}", range.whole_words()),
            ArgumentKind::Integer(range) => format!("whole number, {}", range.whole_words()),
            ArgumentKind::Text => "text".to_owned(),
            ArgumentKind::Structure(words) => (*words).to_owned(),
            ArgumentKind::Deals(words) => format!("{words}; prices at most {}", grouped(MOST_DOLLARS, 0)),
            ArgumentKind::Map(key, range) => format!("map {} -> number, {}", key.id(), range.whole_words()),
            ArgumentKind::Matrix(outer, inner, range) => {
                format!("map {} -> map {} -> number, {}", outer.id(), inner.id(), range.whole_words())
            }
        }
    }
}

/// Allowed numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Minimum.
    pub least: f64,
    /// Whether the minimum itself is excluded.
    pub above: bool,
    /// Maximum.
    pub most: f64,
    /// Maximum magnitude, which keeps sums exact.
    pub bound: f64,
}

impl Range {
    /// Dollars of at least 0.
    pub const AT_LEAST_ZERO: Range =
        Range { least: 0.0, above: false, most: f64::INFINITY, bound: MOST_DOLLARS };
    /// Dollars above 0.
    pub const ABOVE_ZERO: Range = Range { above: true, ..Range::AT_LEAST_ZERO };
    /// Units of at least 0.
    pub const UNITS: Range = Range { bound: MOST_UNITS, ..Range::AT_LEAST_ZERO };
    /// Numbers from 0 to 1.
    pub const SHARE: Range = Range::between(0.0, 1.0);

    /// Returns the range from `least` to `most`, inclusive.
    pub const fn between(least: f64, most: f64) -> Range {
        Range { least, above: false, most, bound: f64::INFINITY }
    }

    /// Returns whether a number is in the range.
    pub fn holds(&self, value: f64) -> bool {
        value.is_finite()
            && value <= self.most
            && if self.above { value > self.least } else { value >= self.least }
    }

    /// Returns whether a number is within the maximum magnitude.
    pub fn fits(&self, value: f64) -> bool {
        value.abs() <= self.bound
    }

    /// Returns a description with the maximum magnitude.
    pub fn whole_words(&self) -> String {
        match self.bound.is_finite() {
            true => format!("{}, at most {}", self.words(), grouped(self.bound, 0)),
            false => self.words(),
        }
    }

    /// Returns a description, for example `> 0`, `0 to 7`, `any`.
    pub fn words(&self) -> String {
        match (self.above, self.most.is_finite()) {
            _ if self.least.is_infinite() => "any".to_owned(),
            (true, false) => format!("> {}", self.least),
            (false, false) => format!(">= {}", self.least),
            (true, true) => format!("> {} to {}", self.least, self.most),
            (false, true) => format!("{} to {}", self.least, self.most),
        }
    }
}

/// Kind of the keys of a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Key {
    /// Known groups.
    Group,
    /// Plans.
    Plan,
    /// Advertising channels.
    Channel,
    /// Customer numbers.
    Customer,
}

impl Key {
    /// Returns the name in documentation.
    pub fn id(self) -> &'static str {
        match self {
            Key::Group => "group",
            Key::Plan => "plan",
            Key::Channel => "channel",
            Key::Customer => "customer",
        }
    }
}

/// Type of a result field with a remark, whose wording can change between versions.
pub const REMARK: &str = "remark";

/// One field of a result.
#[derive(Debug)]
pub struct Output {
    /// Name.
    pub name: &'static str,
    /// Description of the type, for example `map plan -> number`.
    pub kind: &'static str,
    /// Unit or meaning.
    pub doc: &'static str,
}
