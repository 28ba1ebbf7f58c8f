//! The specification of a tool, from which its form, command, route, documentation and argument checks are derived.

use super::tool_id::ToolId;
use novamind_base::formatting::grouped_number;

/// Maximum of a price, a discount or a daily budget, in dollars.
pub const MAX_DOLLARS: f64 = 1e9;
/// Maximum of a quota, in units per day.
pub const MAX_UNITS_PER_DAY: f64 = 1e15;

/// The specification of a tool.
#[derive(Debug)]
pub struct ToolSpec {
    /// Identifier.
    pub id: ToolId,
    /// Short code of three to five capitals, for example `PRC`.
    pub code: &'static str,
    /// Module of the client library.
    pub module: ToolModule,
    /// Kind.
    pub kind: ToolKind,
    /// Summary in one line.
    pub summary: &'static str,
    /// Arguments, in the order in which they are checked.
    pub arguments: &'static [Argument],
    /// Whether the tool has its own rejection code for unknown arguments.
    pub has_own_unknown_code: bool,
    /// The argument that a call can give without its name, for example the matrix of ad spend.
    pub unnamed_argument: Option<&'static str>,
    /// Time of the effect.
    pub effect_timing: EffectTiming,
    /// Effect.
    pub effect: &'static str,
    /// Cost.
    pub cost: &'static str,
    /// Tables that it writes.
    pub written_tables: &'static [&'static str],
    /// Rejection codes, in the order of its checks.
    pub rejection_codes: &'static [&'static str],
    /// Fields of the result.
    pub result_fields: &'static [ResultField],
    /// Arguments of an example, as JSON.
    pub example: &'static str,
}

/// Modules of the client library.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ToolModule {
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

impl ToolSpec {
    /// Returns the name, for example `set_prices`.
    pub fn name(&self) -> &'static str {
        self.id.name()
    }

    /// Returns the argument that may be given without its name: the only required one, the whole object, or the only
    /// one.
    pub fn positional_argument(&self) -> Option<&'static str> {
        let mut required = self.arguments.iter().filter(|argument| argument.required);
        let only = required.next().filter(|_| required.next().is_none()).map(|argument| argument.name);
        let sole = match self.arguments {
            [argument] => Some(argument.name),
            _ => None,
        };
        only.or(self.unnamed_argument).or(sole)
    }

    /// Returns whether the tool has its own rejection code for missing arguments.
    pub fn has_own_missing_code(&self) -> bool {
        self.rejection_codes.iter().any(|code| code.ends_with("_missing"))
    }
}

impl ToolModule {
    /// All modules, in display order.
    pub const ALL: [ToolModule; 8] = [
        ToolModule::Pricing,
        ToolModule::Marketing,
        ToolModule::Analytics,
        ToolModule::Research,
        ToolModule::Market,
        ToolModule::Infrastructure,
        ToolModule::Enterprise,
        ToolModule::Time,
    ];

    /// Returns the name.
    pub fn id(self) -> &'static str {
        match self {
            ToolModule::Pricing => "pricing",
            ToolModule::Marketing => "marketing",
            ToolModule::Analytics => "analytics",
            ToolModule::Research => "research",
            ToolModule::Market => "market",
            ToolModule::Infrastructure => "infrastructure",
            ToolModule::Enterprise => "enterprise",
            ToolModule::Time => "time",
        }
    }
}

/// Kinds of tools.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ToolKind {
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

impl ToolKind {
    /// Returns whether a call can change the company.
    pub fn changes_company(self) -> bool {
        !matches!(self, ToolKind::Read | ToolKind::Engine)
    }

    /// Returns the name in documentation.
    pub fn id(self) -> &'static str {
        match self {
            ToolKind::Setting => "setting",
            ToolKind::Purchase => "purchase",
            ToolKind::OneShot => "one_shot",
            ToolKind::Read => "read",
            ToolKind::Time => "time",
            ToolKind::Engine => "engine",
        }
    }
}

/// Time of the effect of a tool.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EffectTiming {
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

impl EffectTiming {
    /// Returns the name in documentation.
    pub fn id(self) -> &'static str {
        match self {
            EffectTiming::NextDay => "next day",
            EffectTiming::NextBilling => "next bill of each customer",
            EffectTiming::Now => "at once",
            EffectTiming::AtCompletion => "at completion",
            EffectTiming::CustomerReply => "when the customer answers",
            EffectTiming::Never => "changes nothing",
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
    pub description: &'static str,
}

/// Type of an argument.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ArgumentKind {
    /// A number.
    Number(NumberRange),
    /// An integer.
    Integer(NumberRange),
    /// Text.
    Text,
    /// Another list or object, with a description.
    Structure(&'static str),
    /// A list of deals with prices, with a description.
    Deals(&'static str),
    /// A map from a key to a number.
    Map(MapKey, NumberRange),
    /// A map of maps to a number.
    Matrix(MapKey, MapKey, NumberRange),
}

impl ArgumentKind {
    /// Returns a description, for example `map channel -> map group -> number, >= 0`.
    pub fn describe(&self) -> String {
        match self {
            ArgumentKind::Number(range) => format!("number, {}", range.describe_with_limit()),
            ArgumentKind::Integer(range) => format!("whole number, {}", range.describe_with_limit()),
            ArgumentKind::Text => "text".to_owned(),
            ArgumentKind::Structure(words) => (*words).to_owned(),
            ArgumentKind::Deals(words) => {
                format!("{words}; prices at most {}", grouped_number(MAX_DOLLARS, 0))
            }
            ArgumentKind::Map(key, range) => {
                format!("map {} -> number, {}", key.id(), range.describe_with_limit())
            }
            ArgumentKind::Matrix(outer, inner, range) => {
                format!("map {} -> map {} -> number, {}", outer.id(), inner.id(), range.describe_with_limit())
            }
        }
    }
}

/// Allowed numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NumberRange {
    /// Minimum.
    pub min: f64,
    /// Whether the minimum itself is excluded.
    pub excludes_min: bool,
    /// Maximum.
    pub max: f64,
    /// Maximum magnitude, which keeps sums exact.
    pub magnitude_limit: f64,
}

impl NumberRange {
    /// Dollars of at least 0.
    pub const AT_LEAST_ZERO: NumberRange =
        NumberRange { min: 0.0, excludes_min: false, max: f64::INFINITY, magnitude_limit: MAX_DOLLARS };
    /// Dollars above 0.
    pub const ABOVE_ZERO: NumberRange = NumberRange { excludes_min: true, ..NumberRange::AT_LEAST_ZERO };
    /// Units of at least 0.
    pub const UNITS: NumberRange =
        NumberRange { magnitude_limit: MAX_UNITS_PER_DAY, ..NumberRange::AT_LEAST_ZERO };
    /// Numbers from 0 to 1.
    pub const SHARE: NumberRange = NumberRange::between(0.0, 1.0);

    /// Returns the range from `least` to `most`, inclusive.
    pub const fn between(least: f64, most: f64) -> NumberRange {
        NumberRange { min: least, excludes_min: false, max: most, magnitude_limit: f64::INFINITY }
    }

    /// Returns whether a number is in the range.
    pub fn contains(&self, value: f64) -> bool {
        value.is_finite()
            && value <= self.max
            && if self.excludes_min { value > self.min } else { value >= self.min }
    }

    /// Returns whether a number is within the maximum magnitude.
    pub fn is_within_limit(&self, value: f64) -> bool {
        value.abs() <= self.magnitude_limit
    }

    /// Returns a description with the maximum magnitude.
    pub fn describe_with_limit(&self) -> String {
        match self.magnitude_limit.is_finite() {
            true => format!("{}, at most {}", self.describe(), grouped_number(self.magnitude_limit, 0)),
            false => self.describe(),
        }
    }

    /// Returns a description, for example `> 0`, `0 to 7`, `any`.
    pub fn describe(&self) -> String {
        match (self.excludes_min, self.max.is_finite()) {
            _ if self.min.is_infinite() => "any".to_owned(),
            (true, false) => format!("> {}", self.min),
            (false, false) => format!(">= {}", self.min),
            (true, true) => format!("> {} to {}", self.min, self.max),
            (false, true) => format!("{} to {}", self.min, self.max),
        }
    }
}

/// Kind of the keys of a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapKey {
    /// Known groups.
    Group,
    /// Plans.
    Plan,
    /// Advertising channels.
    Channel,
    /// Customer numbers.
    Customer,
}

impl MapKey {
    /// Returns the name in documentation.
    pub fn id(self) -> &'static str {
        match self {
            MapKey::Group => "group",
            MapKey::Plan => "plan",
            MapKey::Channel => "channel",
            MapKey::Customer => "customer",
        }
    }
}

/// Type of a result field with a remark, whose wording can change between versions.
pub const REMARK_TYPE: &str = "remark";

/// One field of a result.
#[derive(Debug)]
pub struct ResultField {
    /// Name.
    pub name: &'static str,
    /// Description of the type, for example `map plan -> number`.
    pub kind: &'static str,
    /// Unit or meaning.
    pub description: &'static str,
}
