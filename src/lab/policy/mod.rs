//! Policy files (docs/interfaces/policies.md).

mod rule_based;

use std::fmt;

use serde::Deserialize;
use toml::Table;

pub use rule_based::{CapacityRule, OperationsRule, PerPlan, PriceBook, RuleBased, TargetGroups};

use super::enterprise_answers::EnterpriseRule;
use novamind_record::folder::configuration::Configuration;
use novamind_world::params::ParameterSource;

/// A policy: a program that plays a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Policy {
    /// Name that the policy file gives, as one line of text.
    pub name: String,
    /// Description that the policy file gives; can be empty.
    pub description: String,
    /// Settings of the run at its start. The command line overrides these settings.
    pub start: PolicyStart,
    /// Settings of the paper's weekly routine; `None` to play without the routine.
    pub rule_based: Option<RuleBased>,
    /// Tool calls on given days.
    pub calls: Vec<ScheduledCall>,
    /// Rule that answers enterprises; `None` if the policy file has no section `[enterprise]`.
    pub enterprise: Option<EnterpriseRule>,
}

/// The settings of a run at its start.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PolicyStart {
    /// Cash on day 0, dollars; `None` to use the scenario's value.
    pub cash: Option<f64>,
    /// Whether demand surges occur; `None` to use the scenario's value.
    pub surges: Option<bool>,
    /// Name of the scenario that the run uses; `None` to use the default scenario.
    pub scenario: Option<String>,
    /// Last day of the run; `None` to use the scenario's value.
    pub days: Option<u32>,
}

/// A tool call on one or more decision days.
#[derive(Debug, Clone, PartialEq)]
pub struct ScheduledCall {
    /// First decision day of the call.
    pub day: u32,
    /// Name of the called tool, which must not be a tool that advances time.
    pub tool: String,
    /// Arguments of the call. Symbols are resolved at the time of the call.
    pub arguments: serde_json::Value,
    /// Number of calls on each of the days, at least 1.
    pub repeat: u32,
    /// Interval between repetitions in weeks; `None` if the call is not repeated.
    pub every_weeks: Option<u32>,
    /// Last day of the repetitions, inclusive; `None` to repeat the call until the run ends.
    pub until_day: Option<u32>,
    /// Whether the run continues if the call is rejected.
    pub may_fail: bool,
}

impl ScheduledCall {
    /// Returns whether the call is made on a decision day.
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
    start: PolicyStart,
    rule_based: Option<toml::Spanned<RuleBased>>,
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
    #[serde(default = "default_repeat")]
    repeat: u32,
    every_weeks: Option<u32>,
    until_day: Option<u32>,
    #[serde(default)]
    may_fail: bool,
}

fn default_repeat() -> u32 {
    1
}

/// An error in a policy file, with its location.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PolicyError {
    /// Path of the policy file, or the requested name if no file was found.
    pub source: String,
    /// Line of the error in the file, from 1; `None` if the line is unknown.
    pub line: Option<usize>,
    /// Description of the error.
    pub problem: String,
    /// Whether no policy with the requested name exists.
    pub is_unknown: bool,
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
    /// Finds a policy by name, first in the user's folder and then among the bundled policies. A name that
    /// contains a path separator or ends in `.toml` is read as a path.
    ///
    /// # Errors
    /// Fails if the policy does not exist or is invalid.
    pub fn find(name: &str, configuration: &Configuration) -> Result<Policy, PolicyError> {
        let wrong =
            |problem: String| PolicyError { source: name.to_owned(), line: None, problem, is_unknown: false };
        if name.ends_with(".toml") || name.contains(std::path::is_separator) {
            let text = std::fs::read_to_string(name).map_err(|error| wrong(error.to_string()))?;
            return Policy::parse(&ParameterSource { name: name.to_owned(), text });
        }
        let parameter_source = configuration
            .read_file(format!("policies/{name}.toml"))
            .map_err(|error| wrong(error.to_string()))?;
        if let Some(source) = parameter_source {
            return Policy::parse(&source);
        }
        match novamind_assets::policies().into_iter().find(|(bundled, _)| *bundled == name) {
            Some((_, text)) => {
                let file = format!("configs/policies/{name}.toml");
                Policy::parse(&ParameterSource { name: file, text: text.to_owned() })
            }
            None => {
                let mut known: Vec<String> =
                    novamind_assets::policies().into_iter().map(|(name, _)| name.to_owned()).collect();
                known.extend(configuration.toml_names("policies"));
                let problem = format!("unknown policy; available: {}", known.join(", "));
                Err(PolicyError { is_unknown: true, ..wrong(problem) })
            }
        }
    }

    /// Parses the text of a policy file.
    ///
    /// # Errors
    /// Fails on unknown keys, days that are not decision days, unknown tools or arguments, and contradictory settings.
    pub fn parse(source: &ParameterSource) -> Result<Policy, PolicyError> {
        let at = |span: Option<std::ops::Range<usize>>, problem: String| PolicyError {
            source: source.name.clone(),
            line: span.map(|span| source.text[..span.start.min(source.text.len())].matches('\n').count() + 1),
            problem,
            is_unknown: false,
        };
        let file: PolicyFile =
            toml::from_str(&source.text).map_err(|error| at(error.span(), error.message().to_owned()))?;
        let mut calls = Vec::new();
        for entry in file.call {
            let span = entry.span();
            calls.push(parse_scheduled_call(entry.into_inner()).map_err(|problem| at(Some(span), problem))?);
        }
        let enterprise = match file.enterprise {
            None => None,
            Some(entry) => {
                let span = entry.span();
                Some(entry.into_inner().validated().map_err(|problem| at(Some(span), problem))?)
            }
        };
        let rule_based = match file.rule_based {
            None => None,
            Some(rules) => {
                let span = rules.span();
                Some(rules.into_inner().validated().map_err(|problem| at(Some(span), problem))?)
            }
        };
        if let Some(cash) = file.start.cash.filter(|cash| !cash.is_finite() || *cash <= 0.0) {
            return Err(at(None, format!("start.cash must be above 0, not {cash}")));
        }
        let (name, description) = (file.name, file.description);
        if name.trim().is_empty() || name.chars().any(char::is_control) {
            return Err(at(None, "the name of a policy must be one line of text".to_owned()));
        }
        Ok(Policy { name, description, start: file.start, rule_based, calls, enterprise })
    }
}

fn parse_scheduled_call(entry: CallEntry) -> Result<ScheduledCall, String> {
    if !entry.day.is_multiple_of(7) {
        return Err(format!("day {} is not a decision day; use 0, 7, 14, …", entry.day));
    }
    if entry.until_day.is_some() && entry.every_weeks.is_none() {
        return Err("until_day needs every_weeks".to_owned());
    }
    if entry.every_weeks == Some(0) || entry.repeat == 0 {
        return Err("every_weeks and repeat must be at least 1".to_owned());
    }
    let tool = novamind_tools::find(&entry.tool)
        .filter(|tool| tool.spec().kind != novamind_tools::ToolKind::Time)
        .ok_or_else(|| {
            let near = novamind_tools::catalogue::similar_tools(&entry.tool);
            let help = if near.is_empty() {
                String::new()
            } else {
                format!("; did you mean {}?", near.join(" or "))
            };
            format!("unknown tool {} for policies{help}", entry.tool)
        })?;
    let arguments = serde_json::to_value(&entry.args).map_err(|error| error.to_string())?;
    novamind_tools::Arguments::parse(tool.spec(), &arguments, || {
        novamind_tools::ParameterNumbers::bundled().into()
    })
    .map_err(|rejection| rejection.to_string())?;
    if tool.spec().has_own_unknown_code {
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
    use super::super::strong_policies::STRONG_POLICIES;
    use super::*;

    fn parse(text: &str) -> Result<Policy, PolicyError> {
        Policy::parse(&ParameterSource { name: "mine.toml".to_owned(), text: text.to_owned() })
    }

    #[test]
    fn bundled_policies_are_valid() {
        let configuration = Configuration::bundled();
        for (name, _) in novamind_assets::policies() {
            let policy = Policy::find(name, &configuration).expect("a bundled policy");
            assert_eq!(policy.name, name);
            assert!(!policy.description.is_empty());
            let surges = (!STRONG_POLICIES.contains(&name)).then_some(name == "P1s");
            assert_eq!(policy.start.surges, surges, "{name}");
        }
        let best = Policy::find("baseline", &configuration).expect("the baseline");
        assert_eq!(best.rule_based, Some(RuleBased::default()));
        assert_eq!(Policy::find("P1a", &configuration).expect("P1a").rule_based, best.rule_based);
        assert!(Policy::find("P0", &configuration).expect("P0").rule_based.is_none());
    }

    #[test]
    fn invalid_policies_name_line_and_problem() {
        for (text, line, part) in [
            ("name = \"x\"\nwhat = 1\n", Some(2), "what"),
            ("name = \"x\"\n[rule_based]\nprice_book = \"dear\"\n", Some(3), "cheap, mid"),
            ("name = \"x\"\n[rule_based]\ntargets = \"none\"\n", Some(3), "targets"),
            ("name = \"x\"\n[rule_based]\ncash_floor = -7e99\n", Some(2), "-1 for always"),
            ("name = \"x\"\n[rule_based]\nglobal_development = nan\n", Some(2), "dollars a day"),
            ("name = \"x\"\n[rule_based]\noperations = -5\n", Some(2), "`operations`"),
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
        let missing = Policy::find("nothing", &Configuration::bundled()).expect_err("no such policy");
        assert!(missing.problem.contains("P1a"), "{missing}");
    }

    #[test]
    fn calls_are_due_on_their_days() {
        let text = "name = \"x\"\n[[call]]\nday = 14\nevery_weeks = 2\nuntil_day = 50\ntool = \"set_prices\"\nargs = { A = 5 }\n";
        let call = &parse(text).expect("a policy").calls[0];
        let due: Vec<u32> = (0..100).filter(|day| call.is_due(*day)).collect();
        assert_eq!(due, [14, 28, 42]);
    }
}
