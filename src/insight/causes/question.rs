//! Questions about why a figure of the company or of a group changed in a week.

use std::fmt;
use std::str::FromStr;

use crate::inspection::breakpoint::grammar::{ConditionParseError, TokenReader, describe_quantity_error};
use crate::inspection::breakpoint::measure::QuantityError;
use novamind_base::similar_names;
use novamind_record::figures::{FigureUnit, SimulatedWeek, WeekFigure};
use novamind_world::identifiers::Group;

/// A weekly figure of the company or of a group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WeekQuantity {
    figure: WeekFigure,
    group: Option<Group>,
}

impl WeekQuantity {
    /// Creates a figure of the company. Returns `None` if the figure exists only for groups.
    pub fn for_company(figure: WeekFigure) -> Option<WeekQuantity> {
        WeekQuantity::new(figure, None).ok()
    }

    /// Creates a figure of a group. Returns `None` if the figure exists only for the company.
    pub fn for_group(figure: WeekFigure, group: Group) -> Option<WeekQuantity> {
        WeekQuantity::new(figure, Some(group)).ok()
    }

    fn new(figure: WeekFigure, group: Option<Group>) -> Result<WeekQuantity, QuantityError> {
        match group {
            Some(_) if !figure.has_group_values() => Err(QuantityError::CompanyOnly),
            None if !figure.has_company_value() => Err(QuantityError::GroupOnly),
            _ => Ok(WeekQuantity { figure, group }),
        }
    }

    /// Returns the figure without its group.
    pub fn figure(&self) -> WeekFigure {
        self.figure
    }

    /// Returns the group of the figure, or `None` for the company.
    pub fn group(&self) -> Option<Group> {
        self.group
    }

    /// Returns the display name of the figure with its group: `weekly churn of S1`, `cash change`.
    pub fn name(&self) -> String {
        match self.group {
            Some(group) => format!("{} of {group}", self.figure.name()),
            None => self.figure.name().to_owned(),
        }
    }

    /// Returns the unit of the figure.
    pub fn unit(&self) -> FigureUnit {
        self.figure.unit()
    }

    /// Returns whether the figure is hidden in unfinished runs, except debug runs.
    pub fn is_hidden(&self) -> bool {
        self.figure.is_hidden()
    }

    /// Returns the value of the figure in a week, or NaN if the figure has no value.
    pub(super) fn value_in(&self, week: &SimulatedWeek) -> f64 {
        let value = match self.group {
            Some(group) => self.figure.group_reader().map(|read| read(&week.groups[group])),
            None => self.figure.company_reader().map(|read| read(week)),
        };
        value.unwrap_or(f64::NAN)
    }
}

/// Formats the identifier of the figure: `churn(S1)`, `cash_change`.
impl fmt::Display for WeekQuantity {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let id = self.figure.id();
        match self.group {
            Some(group) => write!(formatter, "{id}({group})"),
            None => formatter.write_str(&id),
        }
    }
}

/// A question about why a figure changed in a week.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WeekQuestion {
    /// The figure to explain.
    pub quantity: WeekQuantity,
    /// Number of the week to explain; `None` for the last completed week.
    pub week: Option<u32>,
}

impl FromStr for WeekQuestion {
    type Err = ConditionParseError;

    /// Parses a figure and an optional week, for example `churn(S1) 44` or `new subscribers`. The words of a figure
    /// name can be joined by spaces, hyphens or underscores.
    fn from_str(text: &str) -> Result<WeekQuestion, ConditionParseError> {
        let (name, rest) = text.split_at(name_length(text));
        let figure = parse_figure(name)?;
        let before = name.chars().count();
        let further =
            |problem: ConditionParseError| ConditionParseError { column: before + problem.column, ..problem };
        let mut words = TokenReader::new(rest);
        let group = words.parse_group().map_err(further)?;
        let week = words.parse_whole_number().map_err(further)?;
        words.expect_end().map_err(further)?;
        let quantity = WeekQuantity::new(figure, group).map_err(|no| ConditionParseError {
            message: describe_quantity_error(&figure.id(), no),
            column: 1,
        })?;
        Ok(WeekQuestion { quantity, week })
    }
}

/// Returns the length in bytes of the figure name at the start of `text`. The name ends before an opening parenthesis,
/// or before the last word if that word starts with a digit.
fn name_length(text: &str) -> usize {
    let week = || {
        let (name, last) = text.trim_end().rsplit_once(char::is_whitespace)?;
        last.starts_with(|first: char| first.is_ascii_digit()).then_some(name.len())
    };
    text.find('(').or_else(week).unwrap_or(text.len())
}

fn parse_figure(name: &str) -> Result<WeekFigure, ConditionParseError> {
    let problem = |message: String| Err(ConditionParseError { message, column: 1 });
    let words = name.trim().to_lowercase().replace(['_', '-'], " ");
    let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
    let ids: Vec<String> = WeekFigure::ALL.iter().map(|figure| figure.id()).collect();
    if words.is_empty() {
        return problem(format!("\"why\" needs a figure: {}", ids.join(", ")));
    }
    let called = |figure: &&WeekFigure| figure.name().eq_ignore_ascii_case(&words);
    if let Some(found) =
        WeekFigure::ALL.iter().find(called).copied().or_else(|| WeekFigure::parse_label(&words))
    {
        return Ok(found);
    }
    let near = similar_names(&words.replace(' ', "_"), ids.iter().map(String::as_str));
    problem(match near.is_empty() {
        true => format!("there is no figure {words}; the figures are {}", ids.join(", ")),
        false => format!("there is no figure {words}; did you mean {}?", near.join(" or ")),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<(String, Option<u32>), (String, usize)> {
        let read = text.parse::<WeekQuestion>();
        read.map(|week_question| (week_question.quantity.to_string(), week_question.week))
            .map_err(|problem| (problem.message, problem.column))
    }

    #[test]
    fn question_parses_figure_group_and_week() {
        for (text, id, week) in [
            ("cancellations", "cancellations", None),
            ("new subscribers 12", "new_subscribers", Some(12)),
            ("New_Subscribers  3", "new_subscribers", Some(3)),
            ("churn(S1) 44", "churn(S1)", Some(44)),
            ("weekly churn(S1)", "churn(S1)", None),
            ("new-subscribers ( s2 )7 ", "new_subscribers(S2)", Some(7)),
            ("reputation(E1)", "reputation(E1)", None),
            ("r&d 5", "R&D", Some(5)),
            ("cash", "cash_change", None),
        ] {
            assert_eq!(parse(text), Ok((id.to_owned(), week)), "{text}");
        }
        for figure in WeekFigure::ALL {
            let text = if figure.has_company_value() { figure.id() } else { format!("{}(S1)", figure.id()) };
            assert_eq!(parse(&text), Ok((text.clone(), None)));
        }
    }

    #[test]
    fn invalid_question_lists_valid_figures() {
        for (text, message, column) in [
            ("cancelations", "there is no figure cancelations; did you mean cancellations", 1),
            ("chrun(S1)", "there is no figure chrun; did you mean churn", 1),
            ("", "\"why\" needs a figure: cash_change, recurring_revenue", 1),
            ("zzzz", "there is no figure zzzz; the figures are cash_change", 1),
            ("usage 4x", "a whole number is expected, not 4x", 7),
            ("usage 99999999999", "a whole number is expected, not 99999999999", 7),
            ("churn(S1) 4 5", "unexpected 5 at the end", 13),
            ("churn(S12)", "S12 is not a group; did you mean S1", 7),
            ("churn(S1", "a closing bracket is missing", 9),
            ("churn()", "a group is missing", 7),
            ("reputation 3", "reputation is a figure of a group; write, for example, reputation(S1)", 1),
            ("payments(S1)", "payments is a figure of the whole company; write payments without a group", 1),
        ] {
            let (problem, at) = parse(text).expect_err("a problem");
            assert!(problem.starts_with(message) && at == column, "{text}: {problem} at {at}");
        }
    }
}
