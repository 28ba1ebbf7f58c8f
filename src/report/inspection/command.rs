//! Debug commands that inspect hidden state or change a parameter, and the results of these commands. Plain mode and
//! the console share them (docs/debugging.md).

use serde_json::Value;

use super::{describe_condition_days, describe_day_difference, describe_writes};
use crate::parameters::{describe_changed_parameter, describe_changed_parameters};
use novamind_base::formatting::arguments::{Argument, LineParser, ParseError};
use novamind_base::similar_names;
use novamind_insight::{
    Condition, ConditionParseError, ConditionState, DayDifference, FigureWrites, Inspect, WriteTarget,
};
use novamind_session::{ChangedParameter, ChangedParameters, Session};
use novamind_tools::Rejection;

const DIFF_USAGE: &str = "specify two days: diff 83 84";
const SET_USAGE: &str =
    "specify a parameter, its value and optionally a day: set group.S1.c_max_mean 300 from 30";

/// A parsed command that inspects hidden state or changes a parameter.
#[derive(Debug, Clone, PartialEq)]
pub enum InspectionCommand {
    /// `find CONDITION`: the days on which a condition became true.
    Find(Condition),
    /// `who FIGURE [DAY]`: the writes to a figure on a day, by default the last day.
    Who(WriteTarget, Option<u32>),
    /// `diff DAY DAY`: the differences between the ends of two days.
    Diff(u32, u32),
    /// `set`: the list of changed parameters.
    Parameters,
    /// `set KEY`: the value of a parameter.
    Parameter(String),
    /// `set KEY VALUE [from DAY]`: a change to a parameter.
    Set(String, Value, Option<u32>),
}

/// Result of a debug command.
#[derive(Debug, Clone)]
pub enum InspectionOutput {
    /// The days on which a condition became true, and the last simulated day.
    Days(Condition, Vec<ConditionState>, u32),
    /// The writes to a figure on a day.
    Writes(FigureWrites),
    /// The differences between the ends of two days.
    Difference(u32, u32, DayDifference),
    /// The parameters that the run has changed.
    Parameters(ChangedParameters),
    /// The key of a parameter and its value.
    Parameter(String, Value),
    /// The changed parameter, and the current day.
    Set(ChangedParameter, u32),
}

impl InspectionCommand {
    /// First word of each command.
    pub const COMMAND_NAMES: [&str; 4] = ["find", "who", "diff", "set"];

    /// Parses a command line, which starts with one of [`InspectionCommand::COMMAND_NAMES`].
    ///
    /// # Errors
    /// Returns an error that states the problem and its column.
    pub fn parse(line: &str) -> Result<InspectionCommand, ParseError> {
        let mut reader = LineParser::new(line);
        reader.skip_whitespace();
        let (begin, word) = (reader.column(), reader.parse_word());
        match word.as_str() {
            "find" | "who" => {
                reader.skip_whitespace();
                let (rest, column) = (reader.remaining(), reader.column());
                if word == "find" {
                    InspectionCommand::parse_find(rest, column)
                } else {
                    InspectionCommand::parse_who(rest, column)
                }
            }
            "diff" => InspectionCommand::parse_diff(&reader.parse_arguments()?),
            "set" => InspectionCommand::parse_set(&reader.parse_arguments()?),
            other => {
                let all = InspectionCommand::COMMAND_NAMES.join(", ");
                let text = match similar_names(other, InspectionCommand::COMMAND_NAMES.into_iter())[..] {
                    [] => format!("a line must start with {all}"),
                    ref near => format!("{other} is not one of {all}; did you mean {}?", near.join(" or ")),
                };
                Err(ParseError { text, column: begin })
            }
        }
    }

    /// Parses the arguments of `find`, which start at `column`.
    ///
    /// # Errors
    /// Returns an error that states the problem and its column.
    pub fn parse_find(rest: &str, column: usize) -> Result<InspectionCommand, ParseError> {
        rest.parse().map(InspectionCommand::Find).map_err(|problem| at_line_column(problem, column))
    }

    /// Parses the arguments of `who`.
    ///
    /// # Errors
    /// Returns an error that states the problem and its column.
    pub fn parse_who(rest: &str, column: usize) -> Result<InspectionCommand, ParseError> {
        let read = WriteTarget::parse_with_day(rest);
        read.map(|(target, day)| InspectionCommand::Who(target, day))
            .map_err(|problem| at_line_column(problem, column))
    }

    /// Parses the arguments of `diff`.
    ///
    /// # Errors
    /// Returns an error that states the problem and its column.
    pub fn parse_diff(arguments: &[Argument]) -> Result<InspectionCommand, ParseError> {
        let days: Vec<u32> = arguments.iter().map(Argument::as_u32).collect::<Result<_, _>>()?;
        match days[..] {
            [one, other] => Ok(InspectionCommand::Diff(one, other)),
            _ => Err(ParseError::at_first_argument(arguments, DIFF_USAGE)),
        }
    }

    /// Parses the arguments of `set`.
    ///
    /// # Errors
    /// Returns an error that states the problem and its column.
    pub fn parse_set(arguments: &[Argument]) -> Result<InspectionCommand, ParseError> {
        let usage = || ParseError::at_first_argument(arguments, SET_USAGE);
        let (key, value, rest) = match arguments {
            [] => return Ok(InspectionCommand::Parameters),
            [Argument { key: None, value: Value::String(key), .. }] => {
                return Ok(InspectionCommand::Parameter(key.clone()));
            }
            [Argument { key: Some(key), value, .. }, rest @ ..] => (key, value, rest),
            [
                Argument { key: None, value: Value::String(key), .. },
                Argument { key: None, value, .. },
                rest @ ..,
            ] => (key, value, rest),
            _ => return Err(usage()),
        };
        let is_from = |argument: &Argument| argument.key.is_none() && argument.value == "from";
        let day = match rest {
            [] => return Ok(InspectionCommand::Set(key.clone(), value.clone(), None)),
            [day_argument] if day_argument.key.as_deref() == Some("from") => day_argument,
            [from, day_argument] if is_from(from) && day_argument.key.is_none() => day_argument,
            _ => return Err(usage()),
        };
        let number = day.value.as_u64().and_then(|number| u32::try_from(number).ok());
        match number {
            Some(number) => Ok(InspectionCommand::Set(key.clone(), value.clone(), Some(number))),
            None => Err(ParseError { text: "the day must be a whole number".to_owned(), column: day.column }),
        }
    }

    /// Returns whether the command changes a parameter of the run.
    pub fn changes_run(&self) -> bool {
        matches!(self, InspectionCommand::Set(..))
    }

    /// Checks whether the run permits the command that starts with `word`. Does not parse the arguments of the command.
    ///
    /// # Errors
    /// Returns `not_in_this_mode` if the command is not permitted.
    pub fn check_permission(word: &str, session: &Session) -> Result<(), Rejection> {
        if word == "set" {
            session.company().debug_parameters().map(drop)
        } else {
            session.check_inspection()
        }
    }

    /// Executes the command and records the inspection or the change.
    ///
    /// # Errors
    /// Returns the errors of [`Inspector::find_condition_days`], [`Inspector::figure_writes`],
    /// [`Inspector::compare_days`], [`CompanyView::debug_parameters`] and [`Session::set_parameter`].
    ///
    /// [`CompanyView::debug_parameters`]: novamind_session::CompanyView::debug_parameters
    /// [`Inspector::find_condition_days`]: novamind_insight::Inspector::find_condition_days
    /// [`Inspector::figure_writes`]: novamind_insight::Inspector::figure_writes
    /// [`Inspector::compare_days`]: novamind_insight::Inspector::compare_days
    pub fn run(&self, session: &mut Session) -> Result<InspectionOutput, Rejection> {
        let today = session.day();
        match self {
            InspectionCommand::Find(condition) => session
                .inspect()
                .find_condition_days(*condition)
                .map(|found| InspectionOutput::Days(*condition, found, today)),
            InspectionCommand::Who(target, day) => {
                session.inspect().figure_writes(*target, *day).map(InspectionOutput::Writes)
            }
            InspectionCommand::Diff(one, other) => session
                .inspect()
                .compare_days(*one, *other)
                .map(|found| InspectionOutput::Difference(*one, *other, found)),
            InspectionCommand::Parameters => session
                .company()
                .debug_parameters()
                .and_then(|debug_parameters| debug_parameters.changes())
                .map(InspectionOutput::Parameters),
            InspectionCommand::Parameter(key) => session
                .company()
                .debug_parameters()
                .and_then(|parameters| parameters.value(key))
                .map(|value| InspectionOutput::Parameter(key.clone(), value)),
            InspectionCommand::Set(key, value, from) => {
                session.set_parameter(key, value, *from).map(|set| InspectionOutput::Set(set, today))
            }
        }
    }
}

impl InspectionOutput {
    /// Returns the result of the command as lines of text.
    pub fn describe(&self) -> Vec<String> {
        match self {
            InspectionOutput::Days(condition, found, last) => {
                describe_condition_days(condition, found, *last)
            }
            InspectionOutput::Writes(figure_writes) => describe_writes(figure_writes),
            InspectionOutput::Difference(one, other, found) => describe_day_difference(found, (*one, *other)),
            InspectionOutput::Parameters(changed) => describe_changed_parameters(changed),
            InspectionOutput::Parameter(key, value) => vec![format!("{key} = {value}")],
            InspectionOutput::Set(set, today) => vec![describe_changed_parameter(set, *today)],
        }
    }
}

/// Converts a column that counts from the start of an argument to a column of the whole line.
fn at_line_column(problem: ConditionParseError, column: usize) -> ParseError {
    ParseError { text: problem.message, column: column + problem.column - 1 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use serde_json::json;

    #[test]
    fn parse_accepts_every_command() {
        let read = |line: &str| {
            InspectionCommand::parse(line).unwrap_or_else(|problem| panic!("{line}: {problem:?}"))
        };
        assert_eq!(read(" diff 83 84 # the days"), InspectionCommand::Diff(83, 84));
        assert_eq!(read("set"), InspectionCommand::Parameters);
        assert_eq!(read("set group.S1"), InspectionCommand::Parameter("group.S1".to_owned()));
        let set = InspectionCommand::Set("run.x".to_owned(), json!([1, 2]), Some(30));
        assert_eq!(read("set run.x [1,2] from 30"), set);
        assert_eq!(read("set run.x=[1,2] from=30"), set);
        assert!(matches!(read("find churn(S1) > 5% over 7"), InspectionCommand::Find(_)));
        assert!(matches!(
            read("who reputation(S3) 84"),
            InspectionCommand::Who(WriteTarget::Reputation(_), Some(84))
        ));
        assert!([set.changes_run(), !read("set").changes_run()].iter().all(|holds| *holds));
    }

    #[test]
    fn parse_errors_name_the_column() {
        for (line, column, part) in [
            ("", 1, "a line must start with find"),
            ("fond x", 1, "did you mean find?"),
            ("find leads >", 13, ""),
            ("who nobody", 5, ""),
            ("diff 3", 6, "two days"),
            ("diff 3 x", 8, "whole number"),
            ("set group.S1.c_max_mean 3 from x", 32, "whole number"),
        ] {
            let problem = InspectionCommand::parse(line).expect_err(line);
            assert!(problem.text.contains(part), "{line}: {problem:?}");
            assert_eq!(problem.column, column, "{line}: {problem:?}");
        }
    }

    proptest! {
        #[test]
        fn parse_never_panics(first in "find|who|diff|set|x", rest in "\\PC{0,40}") {
            let _ = InspectionCommand::parse(&format!("{first} {rest}"));
        }
    }
}
