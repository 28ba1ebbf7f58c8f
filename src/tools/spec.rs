//! The specification of tools, from which forms, commands, routes, documentation and argument checks are derived.

use super::tool_id::ToolId;
use novamind_base::formatting::grouped_number;

/// Maximum price, discount or daily budget, in dollars.
pub const MAX_DOLLARS: f64 = 1e9;
/// Maximum quota, in units per day.
pub const MAX_UNITS_PER_DAY: f64 = 1e15;

/// The specification of a tool.
#[derive(Debug)]
pub struct ToolSpec {
    /// Identifier of the tool.
    pub id: ToolId,
    /// Code of three to five capital letters, for example `PRC`.
    pub code: &'static str,
    /// Module of the client library that contains the tool.
    pub module: ToolModule,
    /// Kind of the tool, which determines whether a call can change the company.
    pub kind: ToolKind,
    /// Summary of the tool in one line.
    pub summary: &'static str,
    /// Arguments of the tool, in the order in which they are checked.
    pub arguments: &'static [Argument],
    /// Whether the tool rejects unknown arguments with a tool-specific code.
    pub has_own_unknown_code: bool,
    /// The argument that a call can give without its name, for example the matrix of advertising budgets.
    pub unnamed_argument: Option<&'static str>,
    /// Time at which a call takes effect.
    pub effect_timing: EffectTiming,
    /// Description of the tool's effect.
    pub effect: &'static str,
    /// Description of the tool's cost.
    pub cost: &'static str,
    /// Tables to which a call adds rows.
    pub written_tables: &'static [&'static str],
    /// Rejection codes, in the order of the checks.
    pub rejection_codes: &'static [&'static str],
    /// Fields of the tool's result.
    pub result_fields: &'static [ResultField],
    /// Arguments of an example call, as JSON.
    pub example: &'static str,
}

/// A module of the client library, which groups tools.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ToolModule {
    /// Prices, model tiers, quotas and discounts.
    Pricing,
    /// Budgets, advertising and posts of the company.
    Marketing,
    /// Targeted budgets, and posts of other authors.
    Analytics,
    /// R&D projects.
    Research,
    /// Discovery of groups and market studies.
    Market,
    /// Capacity and costs.
    Infrastructure,
    /// Negotiations with enterprises.
    Enterprise,
    /// Weeks, calculations, scripts, queries and documentation.
    Time,
}

impl ToolSpec {
    /// Returns the name of the tool, for example `set_prices`.
    pub fn name(&self) -> &'static str {
        self.id.name()
    }

    /// Returns the argument that may be given without its name: the only required argument, the whole object, or the
    /// only argument.
    pub fn positional_argument(&self) -> Option<&'static str> {
        let mut required = self.arguments.iter().filter(|argument| argument.required);
        let only = required.next().filter(|_| required.next().is_none()).map(|argument| argument.name);
        let sole = match self.arguments {
            [argument] => Some(argument.name),
            _ => None,
        };
        only.or(self.unnamed_argument).or(sole)
    }

    /// Returns whether the tool rejects missing arguments with a tool-specific code.
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

    /// Returns the name of the module.
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

/// The kind of a tool.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ToolKind {
    /// A tool that changes a setting from the next day on.
    Setting,
    /// A tool that spends money immediately.
    Purchase,
    /// A tool that acts once and costs nothing.
    OneShot,
    /// A tool that only reads.
    Read,
    /// A tool that advances the simulation.
    Time,
    /// A tool for the notebook or the documentation. Such a tool never affects the company.
    Engine,
}

impl ToolKind {
    /// Returns whether tools of this kind can change the company.
    pub fn changes_company(self) -> bool {
        !matches!(self, ToolKind::Read | ToolKind::Engine)
    }

    /// Returns the name of the kind, as the documentation shows it.
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

/// The time at which a tool call takes effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EffectTiming {
    /// The call takes effect from the next simulated day on.
    NextDay,
    /// The call takes effect on each customer's next bill.
    NextBilling,
    /// The call takes effect immediately.
    Now,
    /// The call takes effect after a delay. The result contains the delay.
    AtCompletion,
    /// The call takes effect when the customer replies.
    CustomerReply,
    /// The call has no effect on the company.
    Never,
}

impl EffectTiming {
    /// Returns a short description of the time, as the documentation shows it.
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

/// The specification of one argument of a tool.
#[derive(Debug)]
pub struct Argument {
    /// Name of the argument.
    pub name: &'static str,
    /// Second name of the argument, which older programs use.
    pub alias: Option<&'static str>,
    /// Type of the argument, with the range of its numbers.
    pub kind: ArgumentKind,
    /// Whether a call without the argument is rejected, with `argument_missing` or a tool-specific code.
    pub required: bool,
    /// Unit of the numbers in the argument; empty if they have no unit.
    pub unit: &'static str,
    /// Description of the argument.
    pub description: &'static str,
}

/// The type of an argument.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ArgumentKind {
    /// A number in a range.
    Number(NumberRange),
    /// An integer in a range.
    Integer(NumberRange),
    /// A text.
    Text,
    /// A list or object of another structure, with a description.
    Structure(&'static str),
    /// A list of deals that contain prices, with a description.
    Deals(&'static str),
    /// A map from keys to numbers.
    Map(MapKey, NumberRange),
    /// A map from keys to maps from keys to numbers.
    Matrix(MapKey, MapKey, NumberRange),
}

impl ArgumentKind {
    /// Returns a description of the type, for example `map channel -> map group -> number, >= 0`.
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

/// A range of allowed numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NumberRange {
    /// Minimum of the range.
    pub min: f64,
    /// Whether the minimum itself is excluded.
    pub excludes_min: bool,
    /// Maximum of the range.
    pub max: f64,
    /// Maximum absolute value of a number in a new call, which keeps sums exact.
    pub magnitude_limit: f64,
}

impl NumberRange {
    /// Range of dollar amounts of at least 0.
    pub const AT_LEAST_ZERO: NumberRange =
        NumberRange { min: 0.0, excludes_min: false, max: f64::INFINITY, magnitude_limit: MAX_DOLLARS };
    /// Range of dollar amounts above 0.
    pub const ABOVE_ZERO: NumberRange = NumberRange { excludes_min: true, ..NumberRange::AT_LEAST_ZERO };
    /// Range of usage of at least 0, in units per day.
    pub const UNITS: NumberRange =
        NumberRange { magnitude_limit: MAX_UNITS_PER_DAY, ..NumberRange::AT_LEAST_ZERO };
    /// Range of shares from 0 to 1.
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

    /// Returns a description of the range that includes the maximum magnitude.
    pub fn describe_with_limit(&self) -> String {
        match self.magnitude_limit.is_finite() {
            true => format!("{}, at most {}", self.describe(), grouped_number(self.magnitude_limit, 0)),
            false => self.describe(),
        }
    }

    /// Returns a description of the range, for example `> 0`, `0 to 7` or `any`.
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

/// The kind of keys in a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapKey {
    /// Keys that are ids of known groups.
    Group,
    /// Keys that are names of plans.
    Plan,
    /// Keys that are names of advertising channels.
    Channel,
    /// Keys that are customer numbers.
    Customer,
}

impl MapKey {
    /// Returns the name of the key kind, as the documentation shows it.
    pub fn id(self) -> &'static str {
        match self {
            MapKey::Group => "group",
            MapKey::Plan => "plan",
            MapKey::Channel => "channel",
            MapKey::Customer => "customer",
        }
    }
}

/// Type of a result field that contains a remark. The wording of remarks can change between versions.
pub const REMARK_TYPE: &str = "remark";

/// The specification of one field in a result.
#[derive(Debug)]
pub struct ResultField {
    /// Name of the field.
    pub name: &'static str,
    /// Description of the type, for example `map plan -> number`.
    pub kind: &'static str,
    /// Unit or meaning of the field.
    pub description: &'static str,
}
