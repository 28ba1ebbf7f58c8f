//! The figures whose changes can be inspected.

use std::fmt;
use std::str::FromStr;

use crate::inspection::breakpoint::grammar::{ConditionParseError, TokenReader};
use novamind_world::identifiers::Group;

/// A figure whose changes can be inspected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WriteTarget {
    /// Reputation of a group.
    Reputation(Group),
    /// Cash of the company.
    Cash,
    /// Active subscriptions of a group.
    Subscribers(Group),
}

/// Names of the figures in their text form, without groups.
const NAMES: [&str; 3] = ["reputation", "cash", "subscribers"];

impl WriteTarget {
    /// Parses a figure and an optional day, for example `reputation(S3) 84`.
    ///
    /// # Errors
    /// Returns a syntax error with its position.
    pub fn parse_with_day(text: &str) -> Result<(WriteTarget, Option<u32>), ConditionParseError> {
        let mut words = TokenReader::new(text);
        let (name, column) = words.parse_name(&NAMES, |name| name, "a figure with recorded writes")?;
        let group = words.parse_group()?;
        let day = words.parse_whole_number()?;
        words.expect_end()?;
        let problem = |message: String| Err(ConditionParseError { message, column });
        let target = match (name, group) {
            ("cash", None) => WriteTarget::Cash,
            ("cash", Some(_)) => {
                return problem(
                    "cash is a figure of the whole company; write cash without a group".to_owned(),
                );
            }
            ("reputation", Some(group)) => WriteTarget::Reputation(group),
            (_, Some(group)) => WriteTarget::Subscribers(group),
            (name, None) => {
                return problem(format!("{name} is a figure of a group; write, for example, {name}(S1)"));
            }
        };
        Ok((target, day))
    }
}

impl FromStr for WriteTarget {
    type Err = ConditionParseError;

    fn from_str(text: &str) -> Result<WriteTarget, ConditionParseError> {
        WriteTarget::parse_with_day(text).map(|(target, _)| target)
    }
}

/// Formats the figure: `reputation(S3)` or `cash`.
impl fmt::Display for WriteTarget {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            WriteTarget::Reputation(group) => write!(formatter, "reputation({group})"),
            WriteTarget::Cash => formatter.write_str("cash"),
            WriteTarget::Subscribers(group) => write!(formatter, "subscribers({group})"),
        }
    }
}
