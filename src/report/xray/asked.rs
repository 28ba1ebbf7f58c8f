//! Debug commands that inspect hidden state or change a parameter, with their results, shared by plain mode and the
//! console (docs/debugging.md).

use serde_json::Value;

use super::{days_in_words, found_in_words, writes_in_words};
use crate::parameters::{changed_in_words, set_in_words};
use novamind_base::nearest;
use novamind_base::notation::written::{Argument, Problem, Reader};
use novamind_insight::{Condition, ConditionProblem, Difference, Inspect, Judged, WhoWrites, WriteTarget};
use novamind_session::{ChangedParameter, ChangedParameters, Session};
use novamind_tools::Refusal;

const USAGE_OF_DIFF: &str = "specify two days: diff 83 84";
const USAGE_OF_SET: &str =
    "specify a parameter, its value and optionally a day: set group.S1.c_max_mean 300 from 30";

/// A parsed debug command.
#[derive(Debug, Clone, PartialEq)]
pub enum AskedWords {
    /// `find CONDITION`: the days on which a condition became true.
    Find(Condition),
    /// `who FIGURE [DAY]`: the writes to a figure on a day, the last day by default.
    Who(WriteTarget, Option<u32>),
    /// `diff DAY DAY`: the differences between the ends of two days.
    Diff(u32, u32),
    /// `set`: lists the changed parameters.
    Parameters,
    /// `set KEY`: shows a parameter.
    Parameter(String),
    /// `set KEY VALUE [from DAY]`: changes a parameter.
    Set(String, Value, Option<u32>),
}

/// Result of a debug command.
#[derive(Debug, Clone)]
pub enum WordsFound {
    /// The days, and the last simulated day.
    Days(Condition, Vec<Judged>, u32),
    /// The writes.
    Writes(WhoWrites),
    /// Differences between two days.
    Difference(u32, u32, Difference),
    /// Changed parameters.
    Parameters(ChangedParameters),
    /// A parameter and its value.
    Parameter(String, Value),
    /// The change, with the current day.
    Set(ChangedParameter, u32),
}

impl AskedWords {
    /// First words of the commands.
    pub const FIRST: [&str; 4] = ["find", "who", "diff", "set"];

    /// Parses a line that starts with one of these words.
    ///
    /// # Errors
    /// Returns the problem and its column.
    pub fn read(line: &str) -> Result<AskedWords, Problem> {
        let mut reader = Reader::of(line);
        reader.skip_blanks();
        let (begin, word) = (reader.column(), reader.word());
        match word.as_str() {
            "find" | "who" => {
                reader.skip_blanks();
                let (rest, column) = (reader.rest(), reader.column());
                if word == "find" { AskedWords::find(rest, column) } else { AskedWords::who(rest, column) }
            }
            "diff" => AskedWords::diff(&reader.arguments()?),
            "set" => AskedWords::set(&reader.arguments()?),
            other => {
                let all = AskedWords::FIRST.join(", ");
                let text = match nearest(other, AskedWords::FIRST.into_iter())[..] {
                    [] => format!("a line must start with {all}"),
                    ref near => format!("{other} is not one of {all}; did you mean {}?", near.join(" or ")),
                };
                Err(Problem { text, column: begin })
            }
        }
    }

    /// Parses the arguments of `find`, which start at `column`.
    ///
    /// # Errors
    /// Returns the problem and its column.
    pub fn find(rest: &str, column: usize) -> Result<AskedWords, Problem> {
        rest.parse().map(AskedWords::Find).map_err(|problem| in_line(problem, column))
    }

    /// Parses the arguments of `who`.
    ///
    /// # Errors
    /// Returns the problem and its column.
    pub fn who(rest: &str, column: usize) -> Result<AskedWords, Problem> {
        let read = WriteTarget::parse_with_day(rest);
        read.map(|(target, day)| AskedWords::Who(target, day)).map_err(|problem| in_line(problem, column))
    }

    /// Parses the arguments of `diff`.
    ///
    /// # Errors
    /// Returns the problem and its column.
    pub fn diff(arguments: &[Argument]) -> Result<AskedWords, Problem> {
        let days: Vec<u32> = arguments.iter().map(Argument::whole_number).collect::<Result<_, _>>()?;
        match days[..] {
            [one, other] => Ok(AskedWords::Diff(one, other)),
            _ => Err(Problem::of(arguments, USAGE_OF_DIFF)),
        }
    }

    /// Parses the arguments of `set`.
    ///
    /// # Errors
    /// Returns the problem and its column.
    pub fn set(arguments: &[Argument]) -> Result<AskedWords, Problem> {
        let usage = || Problem::of(arguments, USAGE_OF_SET);
        let (key, value, rest) = match arguments {
            [] => return Ok(AskedWords::Parameters),
            [Argument { key: None, value: Value::String(key), .. }] => {
                return Ok(AskedWords::Parameter(key.clone()));
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
            [] => return Ok(AskedWords::Set(key.clone(), value.clone(), None)),
            [own] if own.key.as_deref() == Some("from") => own,
            [from, own] if is_from(from) && own.key.is_none() => own,
            _ => return Err(usage()),
        };
        let number = day.value.as_u64().and_then(|number| u32::try_from(number).ok());
        match number {
            Some(number) => Ok(AskedWords::Set(key.clone(), value.clone(), Some(number))),
            None => Err(Problem { text: "the day must be a whole number".to_owned(), column: day.column }),
        }
    }

    /// Returns whether the command changes the run.
    pub fn changes_run(&self) -> bool {
        matches!(self, AskedWords::Set(..))
    }

    /// Rejects a command that the run does not permit, whatever its arguments.
    ///
    /// # Errors
    /// Returns `not_in_this_mode`.
    pub fn refuse(word: &str, session: &Session) -> Result<(), Refusal> {
        if word == "set" {
            session.company().debug_parameters().map(drop)
        } else {
            session.refuse_to_look_inside()
        }
    }

    /// Executes the command. Inspections and changes are recorded.
    ///
    /// # Errors
    /// Returns those of [`Inspector::find_days`], [`Inspector::who_writes`], [`Inspector::difference_of_days`],
    /// [`CompanyView::debug_parameters`] and [`Session::set_parameter`].
    ///
    /// [`CompanyView::debug_parameters`]: novamind_session::CompanyView::debug_parameters
    /// [`Inspector::find_days`]: novamind_insight::Inspector::find_days
    /// [`Inspector::who_writes`]: novamind_insight::Inspector::who_writes
    /// [`Inspector::difference_of_days`]: novamind_insight::Inspector::difference_of_days
    pub fn answer(&self, session: &mut Session) -> Result<WordsFound, Refusal> {
        let today = session.day();
        match self {
            AskedWords::Find(condition) => session
                .inspect()
                .find_days(*condition)
                .map(|found| WordsFound::Days(*condition, found, today)),
            AskedWords::Who(target, day) => {
                session.inspect().who_writes(*target, *day).map(WordsFound::Writes)
            }
            AskedWords::Diff(one, other) => session
                .inspect()
                .difference_of_days(*one, *other)
                .map(|found| WordsFound::Difference(*one, *other, found)),
            AskedWords::Parameters => {
                session.company().debug_parameters().and_then(|own| own.changed()).map(WordsFound::Parameters)
            }
            AskedWords::Parameter(key) => session
                .company()
                .debug_parameters()
                .and_then(|own| own.value(key))
                .map(|value| WordsFound::Parameter(key.clone(), value)),
            AskedWords::Set(key, value, from) => {
                session.set_parameter(key, value, *from).map(|set| WordsFound::Set(set, today))
            }
        }
    }
}

impl WordsFound {
    /// Returns the result as lines of text.
    pub fn in_words(&self) -> Vec<String> {
        match self {
            WordsFound::Days(condition, found, last) => found_in_words(condition, found, *last),
            WordsFound::Writes(own) => writes_in_words(own),
            WordsFound::Difference(one, other, found) => days_in_words(found, (*one, *other)),
            WordsFound::Parameters(changed) => changed_in_words(changed),
            WordsFound::Parameter(key, value) => vec![format!("{key} = {value}")],
            WordsFound::Set(set, today) => vec![set_in_words(set, *today)],
        }
    }
}

/// Shifts the column of a problem to its position in the line.
fn in_line(problem: ConditionProblem, column: usize) -> Problem {
    Problem { text: problem.message, column: column + problem.column - 1 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use serde_json::json;

    #[test]
    fn words_are_read_as_they_are_typed() {
        let read =
            |line: &str| AskedWords::read(line).unwrap_or_else(|problem| panic!("{line}: {problem:?}"));
        assert_eq!(read(" diff 83 84 # the days"), AskedWords::Diff(83, 84));
        assert_eq!(read("set"), AskedWords::Parameters);
        assert_eq!(read("set group.S1"), AskedWords::Parameter("group.S1".to_owned()));
        let set = AskedWords::Set("run.x".to_owned(), json!([1, 2]), Some(30));
        assert_eq!(read("set run.x [1,2] from 30"), set);
        assert_eq!(read("set run.x=[1,2] from=30"), set);
        assert!(matches!(read("find churn(S1) > 5% over 7"), AskedWords::Find(_)));
        assert!(matches!(
            read("who reputation(S3) 84"),
            AskedWords::Who(WriteTarget::Reputation(_), Some(84))
        ));
        assert!([set.changes_run(), !read("set").changes_run()].iter().all(|holds| *holds));
    }

    #[test]
    fn what_cannot_be_read_names_the_column() {
        for (line, column, part) in [
            ("", 1, "a line must start with find"),
            ("fond x", 1, "did you mean find?"),
            ("find leads >", 13, ""),
            ("who nobody", 5, ""),
            ("diff 3", 6, "two days"),
            ("diff 3 x", 8, "whole number"),
            ("set group.S1.c_max_mean 3 from x", 32, "whole number"),
        ] {
            let problem = AskedWords::read(line).expect_err(line);
            assert!(problem.text.contains(part), "{line}: {problem:?}");
            assert_eq!(problem.column, column, "{line}: {problem:?}");
        }
    }

    proptest! {
        #[test]
        fn no_line_panics(first in "find|who|diff|set|x", rest in "\\PC{0,40}") {
            let _ = AskedWords::read(&format!("{first} {rest}"));
        }
    }
}
