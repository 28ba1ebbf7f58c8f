//! What is typed on the X-ray screen: a group or the number of a customer with a day or none, a day, a part, a condition, a
//! number, words.

use super::view::{Choices, View};
use novamind_base::nearest;
use novamind_report::xray::AskedWords;
use novamind_session::identifiers::Group;
use novamind_insight::{Condition, ConditionProblem, DrawnPart, LeadFactor};
use novamind_tui::widgets::Field;

/// What is expected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Expected {
    /// A group, and a day or none.
    Group,
    /// A part of the world that draws.
    Part,
    /// The number of a customer, and a day or none.
    Customer,
    /// A day.
    Day,
    /// The condition of a breakpoint.
    Condition,
    /// A number of days.
    Days,
    /// The value at which a factor of the leads is held.
    Held(LeadFactor),
    /// Words that ask, or set a parameter.
    Words,
}

/// What was typed.
#[derive(Debug, Clone, PartialEq)]
pub enum Typed {
    /// A group, and the day on which it is looked at, if one was typed.
    Group(Group, Option<u32>),
    /// A part of the world that draws.
    Part(DrawnPart),
    /// The number of a customer, and the day on which it is looked at, if one was typed.
    Customer(u32, Option<u32>),
    /// A day.
    Day(u32),
    /// The condition of a breakpoint.
    Condition(Condition),
    /// A number of days, at least 1.
    Days(u32),
    /// A factor, and the value at which it is held.
    Held(LeadFactor, f64),
    /// Words, as they were typed and read.
    Words(String, AskedWords),
}

/// A line that is being typed.
#[derive(Debug)]
pub struct TypedLine {
    /// What is expected.
    pub expected: Expected,
    /// The line.
    pub field: Field,
}

/// What stands before the value of a factor, in the order of the equation.
const HELD: [&str; LeadFactor::ALL.len()] =
    ["R held at (1)", "D held at (1)", "C held at (1)", "M held at (1)", "A held at (1)", "Z held at (1)"];

impl Expected {
    /// What can be typed in a view; none where there is nothing to choose.
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

    /// What stands before the line.
    pub fn prompt(self) -> &'static str {
        match self {
            Expected::Group => "group [day]",
            Expected::Part => "part",
            Expected::Customer => "customer [day]",
            Expected::Day => "day",
            Expected::Condition => "stop when",
            Expected::Days => "days to run",
            Expected::Held(factor) => HELD[factor as usize],
            Expected::Words => "find, who, diff or set",
        }
    }

    /// Reads a line.
    ///
    /// # Errors
    /// What is expected, or what was meant perhaps.
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
                found.map(Typed::Part).ok_or_else(|| unknown("part", text, &nearest(text, ids())))
            }
            Expected::Customer => {
                let (number, day) = with_day(text)?;
                let customer = number.parse().map(|customer| Typed::Customer(customer, day));
                customer.map_err(|_| "type the number of a customer, for instance 4711".to_owned())
            }
            Expected::Day => day_of(text).map(Typed::Day),
            Expected::Condition => text.parse().map(Typed::Condition).map_err(problem_in_words),
            Expected::Held(factor) => match text {
                "" => Ok(Typed::Held(factor, 1.0)),
                text => {
                    let value = text.parse().ok().filter(|value: &f64| value.is_finite() && *value >= 0.0);
                    let value = value.map(|value| Typed::Held(factor, value));
                    value.ok_or_else(|| format!("{factor} is held at a number of at least 0"))
                }
            },
            Expected::Words => {
                let read = AskedWords::read(text).map(|asked| Typed::Words(text.to_owned(), asked));
                read.map_err(|problem| problem.text)
            }
            Expected::Days => {
                let days = text.parse().ok().filter(|days| *days > 0);
                days.map(Typed::Days).ok_or_else(|| "type a number of days, for instance 28".to_owned())
            }
        }
    }
}

impl Typed {
    /// The same, if its day has run.
    ///
    /// # Errors
    /// Which days there are.
    pub fn within(self, last_day: u32) -> Result<Typed, String> {
        match self {
            Typed::Group(_, Some(day)) | Typed::Customer(_, Some(day)) | Typed::Day(day)
                if !(1..=last_day).contains(&day) =>
            {
                Err(match last_day {
                    0 => "no day has run yet".to_owned(),
                    last => format!("there is no day {day}; choose a day from 1 to {last}"),
                })
            }
            typed => Ok(typed),
        }
    }
}

/// The first word, and the day behind it, if there is one.
fn with_day(text: &str) -> Result<(&str, Option<u32>), String> {
    match text.split_once(char::is_whitespace) {
        Some((first, day)) => Ok((first, Some(day_of(day.trim())?))),
        None => Ok((text, None)),
    }
}

fn day_of(text: &str) -> Result<u32, String> {
    text.parse().map_err(|_| "a day is a whole number, for instance 84".to_owned())
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
