//! Input of the x-ray screen: groups and customers with an optional day, days, components, conditions,
//! numbers, commands.

use super::view::{Choices, View};
use novamind_base::nearest;
use novamind_insight::{Condition, ConditionProblem, DrawnPart, LeadFactor};
use novamind_report::xray::AskedWords;
use novamind_session::identifiers::Group;
use novamind_tui::widgets::Field;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Expected {
    /// A group with an optional day.
    Group,
    /// A component with random draws.
    Part,
    /// A customer number with an optional day.
    Customer,
    Day,
    Condition,
    Days,
    /// The fixed value of a factor of the leads.
    Held(LeadFactor),
    /// A command that inspects, or sets a parameter.
    Words,
}

/// Parsed input.
#[derive(Debug, Clone, PartialEq)]
pub enum Typed {
    /// A group, with the day if one was typed.
    Group(Group, Option<u32>),
    /// A component with random draws.
    Part(DrawnPart),
    /// A customer number, with the day if one was typed.
    Customer(u32, Option<u32>),
    Day(u32),
    Condition(Condition),
    /// A number of days, at least 1.
    Days(u32),
    /// A factor and its fixed value.
    Held(LeadFactor, f64),
    /// A command as text and parsed.
    Words(String, AskedWords),
}

#[derive(Debug)]
pub struct TypedLine {
    pub expected: Expected,
    pub field: Field,
}

/// Prompts for the value of a factor, in the order of the equation.
const HELD: [&str; LeadFactor::ALL.len()] = [
    "R fixed at (1)",
    "D fixed at (1)",
    "C fixed at (1)",
    "M fixed at (1)",
    "A fixed at (1)",
    "Z fixed at (1)",
];

impl Expected {
    /// Returns the kind of input of a view; `None` if it has nothing to choose.
    pub fn in_view(view: View) -> Option<Expected> {
        match (view, view.choices()) {
            (View::Customer, _) => Some(Expected::Customer),
            (View::Words, _) => Some(Expected::Words),
            (_, Choices::Nothing) if view.has_day() => Some(Expected::Day),
            (_, Choices::Groups) => Some(Expected::Group),
            (_, Choices::Parts) => Some(Expected::Part),
            (_, Choices::Breakpoints) => Some(Expected::Condition),
            (_, Choices::Nothing) => None,
        }
    }

    pub fn prompt(self) -> &'static str {
        match self {
            Expected::Group => "group [day]",
            Expected::Part => "component",
            Expected::Customer => "customer [day]",
            Expected::Day => "day",
            Expected::Condition => "stop when",
            Expected::Days => "days to run",
            Expected::Held(factor) => HELD[factor as usize],
            Expected::Words => "find, who, diff or set",
        }
    }

    /// Parses a line.
    ///
    /// # Errors
    /// The expected input, with a suggestion if one is similar.
    pub fn read(self, text: &str) -> Result<Typed, String> {
        let text = text.trim();
        match self {
            Expected::Group => {
                let (id, day) = with_day(text)?;
                let found = Group::all().find(|group| group.id().eq_ignore_ascii_case(id));
                let ids = || Group::all().map(Group::id);
                let typed = found.map(|group| Typed::Group(group, day));
                typed.ok_or_else(|| unknown("group", id, &nearest(id, ids())))
            }
            Expected::Part => {
                let ids = || DrawnPart::ALL.into_iter().map(DrawnPart::id);
                let found = DrawnPart::parse(&text.to_ascii_lowercase());
                found.map(Typed::Part).ok_or_else(|| unknown("component", text, &nearest(text, ids())))
            }
            Expected::Customer => {
                let (number, day) = with_day(text)?;
                let customer = number.parse().map(|customer| Typed::Customer(customer, day));
                customer.map_err(|_| "type a customer number, for example 4711".to_owned())
            }
            Expected::Day => day_of(text).map(Typed::Day),
            Expected::Condition => text.parse().map(Typed::Condition).map_err(problem_in_words),
            Expected::Held(factor) => match text {
                "" => Ok(Typed::Held(factor, 1.0)),
                text => {
                    let value = text.parse().ok().filter(|value: &f64| value.is_finite() && *value >= 0.0);
                    let value = value.map(|value| Typed::Held(factor, value));
                    value.ok_or_else(|| format!("{factor} needs a number of at least 0"))
                }
            },
            Expected::Words => {
                let read = AskedWords::read(text).map(|asked| Typed::Words(text.to_owned(), asked));
                read.map_err(|problem| problem.text)
            }
            Expected::Days => {
                let days = text.parse().ok().filter(|days| *days > 0);
                days.map(Typed::Days).ok_or_else(|| "type a number of days, for example 28".to_owned())
            }
        }
    }
}

impl Typed {
    /// Checks that the day has been simulated.
    ///
    /// # Errors
    /// The range of simulated days.
    pub fn within(self, last_day: u32) -> Result<Typed, String> {
        match self {
            Typed::Group(_, Some(day)) | Typed::Customer(_, Some(day)) | Typed::Day(day)
                if !(1..=last_day).contains(&day) =>
            {
                Err(match last_day {
                    0 => "no day has been simulated yet".to_owned(),
                    last => format!("there is no day {day}; choose a day from 1 to {last}"),
                })
            }
            typed => Ok(typed),
        }
    }
}

/// Returns the first word, and the day after it, if there is one.
fn with_day(text: &str) -> Result<(&str, Option<u32>), String> {
    match text.split_once(char::is_whitespace) {
        Some((first, day)) => Ok((first, Some(day_of(day.trim())?))),
        None => Ok((text, None)),
    }
}

fn day_of(text: &str) -> Result<u32, String> {
    text.parse().map_err(|_| "a day is a whole number, for example 84".to_owned())
}

fn problem_in_words(problem: ConditionProblem) -> String {
    problem.message
}

fn unknown(what: &str, text: &str, near: &[&str]) -> String {
    match near {
        [] => format!("there is no {what} {text}"),
        near => format!("there is no {what} {text}; did you mean {}?", near.join(" or ")),
    }
}
