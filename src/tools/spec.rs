//! What a tool is, as data: the single source for its form, its command, its route, its documentation and the
//! check of its arguments.

use super::tool_id::ToolId;
use novamind_base::notation::grouped;

/// Most dollars of a price, a discount or a daily budget.
pub const MOST_DOLLARS: f64 = 1e9;
/// Most units a day of a quota.
pub const MOST_UNITS: f64 = 1e15;

/// Everything there is to know about a tool but its code.
#[derive(Debug)]
pub struct Spec {
    /// Which one.
    pub id: ToolId,
    /// Three to five capitals by which it is found at once, for instance `PRC`.
    pub code: &'static str,
    /// Module of the client library it belongs to.
    pub module: Module,
    /// What calling it means.
    pub kind: Kind,
    /// One line.
    pub summary: &'static str,
    /// Arguments, in the order in which they are checked.
    pub arguments: &'static [Argument],
    /// Unknown arguments have a code of the tool's own.
    pub own_unknown: bool,
    /// The argument that a call without its name gives as a whole, for instance the matrix of ad spend.
    pub whole: Option<&'static str>,
    /// When the effect is felt.
    pub when: When,
    /// What the effect is.
    pub effect: &'static str,
    /// What it costs.
    pub cost: &'static str,
    /// Tables it writes.
    pub writes: &'static [&'static str],
    /// Codes of its refusals, in the order of its checks.
    pub refusals: &'static [&'static str],
    /// Fields of its result.
    pub returns: &'static [Output],
    /// Arguments of an example, as JSON.
    pub example: &'static str,
}

/// Modules of the tools.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Module {
    /// Prices, tiers, quotas, discounts.
    Pricing,
    /// Spend, ads, posts.
    Marketing,
    /// Targeted spend and readings.
    Analytics,
    /// R&D.
    Research,
    /// Finding and studying groups.
    Market,
    /// Capacity and costs.
    Infrastructure,
    /// Companies.
    Enterprise,
    /// Time and data.
    Time,
}

impl Spec {
    /// Name as calls write it, for instance `set_prices`.
    pub fn name(&self) -> &'static str {
        self.id.name()
    }

    /// Whether missing arguments have a code of the tool's own.
    pub fn own_missing(&self) -> bool {
        self.refusals.iter().any(|code| code.ends_with("_missing"))
    }
}

impl Module {
    /// All modules in the order in which they are shown.
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

    /// Name as calls write it.
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

/// What calling a tool means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Changes what holds from the next day on.
    Setting,
    /// Spends money at once.
    Purchase,
    /// Acts once and costs nothing.
    OneShot,
    /// Reads.
    Read,
    /// Lets time pass.
    Time,
    /// Works on what is kept with the run, never on the company.
    Engine,
}

impl Kind {
    /// Whether a call can change the company.
    pub fn acts(self) -> bool {
        !matches!(self, Kind::Read | Kind::Engine)
    }

    /// Word for documentation.
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

/// When the effect of a tool is felt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum When {
    /// From the next simulated day on.
    NextDay,
    /// On each customer's next bill.
    NextBilling,
    /// At once.
    Now,
    /// After a delay that the answer states.
    AtCompletion,
    /// When the customer answers.
    CustomerReply,
    /// It changes nothing.
    Never,
}

impl When {
    /// Word for documentation.
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
    /// A second name that older callers use.
    pub alias: Option<&'static str>,
    /// What it holds.
    pub kind: ArgumentKind,
    /// Its absence is refused: as `argument_missing`, or by a code of the tool's own.
    pub required: bool,
    /// Unit of its numbers.
    pub unit: &'static str,
    /// What it means.
    pub doc: &'static str,
}

/// What an argument holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ArgumentKind {
    /// A number.
    Number(Range),
    /// A whole number.
    Integer(Range),
    /// Text.
    Text,
    /// A list or an object of another shape, described in words.
    Structure(&'static str),
    /// A list of deals with prices, described in words.
    Deals(&'static str),
    /// A map from a key to a number.
    Map(Key, Range),
    /// A map of maps to a number.
    Matrix(Key, Key, Range),
}

impl ArgumentKind {
    /// The kind in words, for instance `map channel -> map group -> number, >= 0`.
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
    /// Least value.
    pub least: f64,
    /// Whether the least value itself is excluded.
    pub above: bool,
    /// Greatest value.
    pub most: f64,
    /// Size up to which numbers are taken, so that sums stay numbers.
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

    /// Whole numbers from one to another.
    pub const fn between(least: f64, most: f64) -> Range {
        Range { least, above: false, most, bound: f64::INFINITY }
    }

    /// Whether a number is allowed.
    pub fn holds(&self, value: f64) -> bool {
        value.is_finite()
            && value <= self.most
            && if self.above { value > self.least } else { value >= self.least }
    }

    /// Whether a number is not too large.
    pub fn fits(&self, value: f64) -> bool {
        value.abs() <= self.bound
    }

    /// The range in words with the size up to which numbers are taken.
    pub fn whole_words(&self) -> String {
        match self.bound.is_finite() {
            true => format!("{}, at most {}", self.words(), grouped(self.bound, 0)),
            false => self.words(),
        }
    }

    /// The range in words, for instance `> 0`, `0 to 7`, `any`.
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

/// What the keys of a map are.
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
    /// Word for documentation.
    pub fn id(self) -> &'static str {
        match self {
            Key::Group => "group",
            Key::Plan => "plan",
            Key::Channel => "channel",
            Key::Customer => "customer",
        }
    }
}

/// Kind of a field that holds a remark of the program: its words can change from version to version.
pub const REMARK: &str = "remark";

/// One field of a result.
#[derive(Debug)]
pub struct Output {
    /// Name.
    pub name: &'static str,
    /// Type in words, for instance `map plan -> number`.
    pub kind: &'static str,
    /// Unit or meaning.
    pub doc: &'static str,
}
