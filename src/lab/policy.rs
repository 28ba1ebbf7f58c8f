//! Policy files (docs/interfaces/policies.md).

use std::fmt;

use serde::Deserialize;
use toml::Table;

use super::answers::EnterpriseRule;
use crate::session::Configuration;
use crate::shipped;
use crate::tools;
use crate::world::identifiers::Plan;
use crate::world::params::ParameterSource;

/// What drives a run without a person.
#[derive(Debug, Clone, PartialEq)]
pub struct Policy {
    /// Name.
    pub name: String,
    /// What it does.
    pub description: String,
    /// Start of the run; the command line overrides it.
    pub start: Start,
    /// The weekly routine of the paper's baseline.
    pub rule_based: Option<RuleBased>,
    /// Calls of tools on given days.
    pub calls: Vec<ScheduledCall>,
    /// Answers to companies.
    pub enterprise: Option<EnterpriseRule>,
}

/// Start of the run.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Start {
    /// Cash on day 0, dollars.
    pub cash: Option<f64>,
    /// Demand surges; absent: as the scenario says.
    pub surges: Option<bool>,
    /// Scenario.
    pub scenario: Option<String>,
    /// Last day.
    pub days: Option<u32>,
}

/// The weekly routine; every key has the value of the paper's best configuration unless it is given.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RuleBased {
    /// Prices, tiers and quotas.
    pub price_book: PriceBook,
    /// Groups that get development and ads.
    pub target: Target,
    /// Budgets of the target groups.
    pub spend: Spend,
    /// Spending is on while cash is above this, dollars; -1: always.
    pub cash_floor: f64,
    /// General development while on, dollars a day.
    pub global_development: f64,
    /// Operations.
    pub operations: OperationsRule,
    /// Capacity.
    pub capacity: CapacityRule,
}

impl Default for RuleBased {
    fn default() -> Self {
        RuleBased {
            price_book: PriceBook::Named(BookName::Mid),
            target: Target::S1Only,
            spend: Spend::Named(SpendName::Heavy),
            cash_floor: 100_000.0,
            global_development: 200.0,
            operations: OperationsRule::Named(OperationsName::Subscribers),
            capacity: CapacityRule::Utilisation,
        }
    }
}

/// Prices, tiers and quotas of the three plans.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged, expecting = "price_book must be cheap, mid or a table of prices, tiers and quotas by plan")]
pub enum PriceBook {
    /// A book of the paper.
    Named(BookName),
    /// One of the policy's own.
    Own {
        /// Dollars a month.
        prices: PerPlan<f64>,
        /// Model tiers.
        tiers: PerPlan<u8>,
        /// Units a day.
        quotas: PerPlan<u64>,
    },
}

/// The paper's price books.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BookName {
    /// A $8 / T1 / 50K, B $18 / T2 / 200K, C $40 / T3 / 1M.
    Cheap,
    /// A $12 / T1 / 60K, B $25 / T2 / 250K, C $55 / T4 / 1.2M.
    Mid,
}

/// One value per plan.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PerPlan<T> {
    /// Plan A.
    #[serde(rename = "A")]
    pub a: T,
    /// Plan B.
    #[serde(rename = "B")]
    pub b: T,
    /// Plan C.
    #[serde(rename = "C")]
    pub c: T,
}

impl<T: Copy> PerPlan<T> {
    /// The value of a plan.
    pub fn of(&self, plan: Plan) -> T {
        match plan {
            Plan::A => self.a,
            Plan::B => self.b,
            Plan::C => self.c,
        }
    }
}

impl PriceBook {
    /// Prices, tiers and quotas.
    pub fn book(&self) -> (PerPlan<f64>, PerPlan<u8>, PerPlan<u64>) {
        match self {
            PriceBook::Named(BookName::Cheap) => (
                PerPlan { a: 8.0, b: 18.0, c: 40.0 },
                PerPlan { a: 1, b: 2, c: 3 },
                PerPlan { a: 50_000, b: 200_000, c: 1_000_000 },
            ),
            PriceBook::Named(BookName::Mid) => (
                PerPlan { a: 12.0, b: 25.0, c: 55.0 },
                PerPlan { a: 1, b: 2, c: 4 },
                PerPlan { a: 60_000, b: 250_000, c: 1_200_000 },
            ),
            PriceBook::Own { prices, tiers, quotas } => (*prices, *tiers, *quotas),
        }
    }
}

/// Groups that get development and ads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Target {
    /// S1.
    S1Only,
    /// S1, and S3 from day 30 on.
    S1ThenS3,
    /// None.
    None,
}

/// Budgets of the target groups.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged, expecting = "spend must be light, medium, heavy or a table with the budgets of S1 and S3")]
pub enum Spend {
    /// A package of the paper.
    Named(SpendName),
    /// Budgets of the policy's own.
    Own {
        /// S1.
        #[serde(rename = "S1")]
        s1: Budget,
        /// S3.
        #[serde(rename = "S3")]
        s3: Budget,
    },
}

/// The paper's packages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SpendName {
    /// S1 $2,000 development and $250 ads a day, S3 $1,500 and $600.
    Light,
    /// S1 $4,000 and $500, S3 $3,000 and $1,200.
    Medium,
    /// S1 $6,000 and $750, S3 $4,500 and $1,800.
    Heavy,
}

/// Budgets of one group, dollars a day.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Budget {
    /// Targeted development.
    pub development: f64,
    /// Advertising.
    pub ads: f64,
}

impl Spend {
    /// Budgets of S1 and S3.
    pub fn budgets(&self) -> (Budget, Budget) {
        let package = |s1: (f64, f64), s3: (f64, f64)| {
            (Budget { development: s1.0, ads: s1.1 }, Budget { development: s3.0, ads: s3.1 })
        };
        match self {
            Spend::Named(SpendName::Light) => package((2000.0, 250.0), (1500.0, 600.0)),
            Spend::Named(SpendName::Medium) => package((4000.0, 500.0), (3000.0, 1200.0)),
            Spend::Named(SpendName::Heavy) => package((6000.0, 750.0), (4500.0, 1800.0)),
            Spend::Own { s1, s3 } => (*s1, *s3),
        }
    }
}

/// How much operations get.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(untagged, expecting = "operations must be subscribers or an amount of dollars a day")]
pub enum OperationsRule {
    /// max(100, 0.05 x active subscriptions).
    Named(OperationsName),
    /// A fixed number of dollars a day.
    Fixed(f64),
}

/// Name of the rule for operations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OperationsName {
    /// With the subscribers.
    Subscribers,
}

/// How capacity follows usage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CapacityRule {
    /// One tier a week towards the smallest that holds the week's usage at 80 %.
    Utilisation,
    /// The tier is never touched.
    Fixed,
}

/// A call on one or more decision days.
#[derive(Debug, Clone, PartialEq)]
pub struct ScheduledCall {
    /// First decision day.
    pub day: u32,
    /// Tool.
    pub tool: String,
    /// Arguments; symbols are resolved when the call is made.
    pub arguments: serde_json::Value,
    /// So often on each of its days.
    pub repeat: u32,
    /// Again every so many weeks; none: once.
    pub every_weeks: Option<u32>,
    /// Last day, included.
    pub until_day: Option<u32>,
    /// A refusal does not stop the run.
    pub may_fail: bool,
}

impl ScheduledCall {
    /// Whether the call is made on a decision day.
    pub fn is_due(&self, day: u32) -> bool {
        if day < self.day || self.until_day.is_some_and(|last| day > last) {
            return false;
        }
        match self.every_weeks {
            None => day == self.day,
            Some(weeks) => (day - self.day).is_multiple_of(7 * weeks),
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PolicyFile {
    name: String,
    #[serde(default)]
    description: String,
    #[serde(default)]
    start: Start,
    rule_based: Option<RuleBased>,
    #[serde(default)]
    call: Vec<toml::Spanned<CallEntry>>,
    enterprise: Option<toml::Spanned<EnterpriseRule>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CallEntry {
    day: u32,
    tool: String,
    #[serde(default)]
    args: Table,
    #[serde(default = "once")]
    repeat: u32,
    every_weeks: Option<u32>,
    until_day: Option<u32>,
    #[serde(default)]
    may_fail: bool,
}

fn once() -> u32 {
    1
}

/// What is wrong with a policy file, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PolicyError {
    /// File.
    pub source: String,
    /// Line, where it is known.
    pub line: Option<usize>,
    /// What is wrong.
    pub problem: String,
}

impl fmt::Display for PolicyError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(formatter, "{}, line {line}: {}", self.source, self.problem),
            None => write!(formatter, "{}: {}", self.source, self.problem),
        }
    }
}

impl std::error::Error for PolicyError {}

impl Policy {
    /// A policy by name (this person's directory first, then the shipped ones) or by path: anything with a
    /// separator, or ending in .toml.
    ///
    /// # Errors
    /// There is none, or it is wrong.
    pub fn find(name: &str, configuration: &Configuration) -> Result<Policy, PolicyError> {
        let wrong = |problem: String| PolicyError { source: name.to_owned(), line: None, problem };
        if name.ends_with(".toml") || name.contains(std::path::is_separator) {
            let text = std::fs::read_to_string(name).map_err(|error| wrong(error.to_string()))?;
            return Policy::parse(&ParameterSource { name: name.to_owned(), text });
        }
        let own =
            configuration.file(format!("policies/{name}.toml")).map_err(|error| wrong(error.to_string()))?;
        if let Some(source) = own {
            return Policy::parse(&source);
        }
        match shipped::policies().into_iter().find(|(shipped, _)| *shipped == name) {
            Some((_, text)) => {
                let file = format!("configs/policies/{name}.toml");
                Policy::parse(&ParameterSource { name: file, text: text.to_owned() })
            }
            None => {
                let mut known: Vec<String> =
                    shipped::policies().into_iter().map(|(name, _)| name.to_owned()).collect();
                known.extend(configuration.names("policies"));
                Err(wrong(format!("there is no such policy; there are {}", known.join(", "))))
            }
        }
    }

    /// Reads a policy file.
    ///
    /// # Errors
    /// Unknown keys, a day that is no decision day, unknown tools or arguments, and what contradicts itself.
    pub fn parse(source: &ParameterSource) -> Result<Policy, PolicyError> {
        let at = |span: Option<std::ops::Range<usize>>, problem: String| PolicyError {
            source: source.name.clone(),
            line: span.map(|span| source.text[..span.start.min(source.text.len())].matches('\n').count() + 1),
            problem,
        };
        let file: PolicyFile =
            toml::from_str(&source.text).map_err(|error| at(error.span(), error.message().to_owned()))?;
        let mut calls = Vec::new();
        for entry in file.call {
            let span = entry.span();
            calls.push(scheduled(entry.into_inner()).map_err(|problem| at(Some(span), problem))?);
        }
        let enterprise = match file.enterprise {
            None => None,
            Some(entry) => {
                let span = entry.span();
                Some(entry.into_inner().checked().map_err(|problem| at(Some(span), problem))?)
            }
        };
        if let Some(cash) = file.start.cash.filter(|cash| !cash.is_finite() || *cash <= 0.0) {
            return Err(at(None, format!("start.cash must be above 0, not {cash}")));
        }
        let (name, description) = (file.name, file.description);
        Ok(Policy { name, description, start: file.start, rule_based: file.rule_based, calls, enterprise })
    }
}

fn scheduled(entry: CallEntry) -> Result<ScheduledCall, String> {
    if !entry.day.is_multiple_of(7) {
        return Err(format!("day {} is no decision day; those are 0, 7, 14, …", entry.day));
    }
    if entry.until_day.is_some() && entry.every_weeks.is_none() {
        return Err("until_day needs every_weeks".to_owned());
    }
    if entry.every_weeks == Some(0) || entry.repeat == 0 {
        return Err("every_weeks and repeat are at least 1".to_owned());
    }
    let tool =
        tools::find(&entry.tool).filter(|tool| tool.spec().kind != tools::Kind::Time).ok_or_else(|| {
            let near = tools::catalogue::nearest(&entry.tool);
            let help = if near.is_empty() {
                String::new()
            } else {
                format!("; did you mean {}?", near.join(" or "))
            };
            format!("there is no tool {} for policies{help}", entry.tool)
        })?;
    let arguments = serde_json::to_value(&entry.args).map_err(|error| error.to_string())?;
    tools::Arguments::of(tool.spec(), &arguments, || tools::Numbers::shipped().into())
        .map_err(|refusal| refusal.to_string())?;
    if tool.spec().own_unknown {
        let known = |key: &String| tool.spec().arguments.iter().any(|argument| argument.name == key);
        if let Some(key) = entry.args.keys().find(|key| !known(key)) {
            return Err(format!("{} has no argument {key}", entry.tool));
        }
    }
    Ok(ScheduledCall {
        day: entry.day,
        tool: entry.tool,
        arguments,
        repeat: entry.repeat,
        every_weeks: entry.every_weeks,
        until_day: entry.until_day,
        may_fail: entry.may_fail,
    })
}

#[cfg(test)]
mod tests {
    use super::super::strong::STRONG;
    use super::*;

    fn parse(text: &str) -> Result<Policy, PolicyError> {
        Policy::parse(&ParameterSource { name: "mine.toml".to_owned(), text: text.to_owned() })
    }

    #[test]
    fn all_shipped_policies_are_read() {
        let configuration = Configuration::shipped();
        for (name, _) in shipped::policies() {
            let policy = Policy::find(name, &configuration).expect("a shipped policy");
            assert_eq!(policy.name, name);
            assert!(!policy.description.is_empty());
            let surges = (!STRONG.contains(&name)).then_some(name == "P1s");
            assert_eq!(policy.start.surges, surges, "{name}");
        }
        let best = Policy::find("baseline", &configuration).expect("the baseline");
        assert_eq!(best.rule_based, Some(RuleBased::default()));
        assert_eq!(Policy::find("P1a", &configuration).expect("P1a").rule_based, best.rule_based);
        assert!(Policy::find("P0", &configuration).expect("P0").rule_based.is_none());
    }

    #[test]
    fn wrong_policies_name_line_and_problem() {
        for (text, line, part) in [
            ("name = \"x\"\nwhat = 1\n", Some(2), "what"),
            ("name = \"x\"\n[rule_based]\nprice_book = \"dear\"\n", Some(3), "cheap, mid"),
            ("name = \"x\"\n[rule_based]\ntargets = \"none\"\n", Some(3), "targets"),
            ("name = \"x\"\n\n[[call]]\nday = 3\ntool = \"set_prices\"\n", Some(3), "decision day"),
            (
                "name = \"x\"\n[[call]]\nday = 7\nuntil_day = 14\ntool = \"set_prices\"\n",
                Some(2),
                "every_weeks",
            ),
            ("name = \"x\"\n[[call]]\nday = 7\ntool = \"set_price\"\n", Some(2), "set_prices"),
            ("name = \"x\"\n[[call]]\nday = 7\ntool = \"next_week\"\n", Some(2), "for policies"),
            (
                "name = \"x\"\n[[call]]\nday = 7\ntool = \"set_capacity_tier\"\nargs = { level = 1 }\n",
                Some(2),
                "level",
            ),
            (
                "name = \"x\"\n[[call]]\nday = 7\ntool = \"set_prices\"\nargs = { D = 1 }\n",
                Some(2),
                "argument D",
            ),
            ("name = \"x\"\n[start]\ncash = -5.0\n", None, "above 0"),
            ("name = \"x\"\n[enterprise]\nofferings = []\n", Some(2), "1 to 3"),
            ("name = \"x\"\n[enterprise]\nofferings = [{ plan = \"D\", price = 1 }]\n", Some(3), "D"),
            ("description = \"nobody\"\n", Some(1), "name"),
        ] {
            let error = parse(text).expect_err(text);
            assert_eq!(error.line, line, "{text}: {error}");
            assert!(error.problem.contains(part), "{text}: {error}");
        }
        let missing = Policy::find("nothing", &Configuration::shipped()).expect_err("no such policy");
        assert!(missing.problem.contains("P1a"), "{missing}");
    }

    #[test]
    fn calls_come_on_their_days() {
        let text = "name = \"x\"\n[[call]]\nday = 14\nevery_weeks = 2\nuntil_day = 50\ntool = \"set_prices\"\nargs = { A = 5 }\n";
        let call = &parse(text).expect("a policy").calls[0];
        let due: Vec<u32> = (0..100).filter(|day| call.is_due(*day)).collect();
        assert_eq!(due, [14, 28, 42]);
    }
}
