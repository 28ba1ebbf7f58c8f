//! Input on the x-ray screen: groups and customers with an optional day, days, components, conditions, numbers and
//! commands.

use super::view::{ViewChoices, XrayView};
use novamind_base::similar_names;
use novamind_insight::{Condition, ConditionParseError, RandomPart, LeadFactor};
use novamind_report::inspection::InspectionCommand;
use novamind_session::identifiers::Group;
use novamind_tui::widgets::TextField;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InputKind {
    /// A group with an optional day.
    Group,
    /// A component with random draws.
    Part,
    /// A customer number with an optional day.
    Customer,
    Day,
    Condition,
    Days,
    /// The fixed value of a factor in the equation of leads.
    HeldValue(LeadFactor),
    /// A command that inspects hidden state or sets a parameter.
    Command,
}

/// A parsed input line.
#[derive(Debug, Clone, PartialEq)]
pub enum ParsedInput {
    /// A group, with the day if one was typed.
    Group(Group, Option<u32>),
    /// A component with random draws.
    Part(RandomPart),
    /// A customer number, with the day if one was typed.
    Customer(u32, Option<u32>),
    Day(u32),
    Condition(Condition),
    /// A number of days, at least 1.
    Days(u32),
    /// A factor in the equation of leads and its fixed value.
    HeldValue(LeadFactor, f64),
    /// A command as text and in parsed form.
    Command(String, InspectionCommand),
}

#[derive(Debug)]
pub struct InputLine {
    pub kind: InputKind,
    pub field: TextField,
}

/// Prompts for the value of a factor, in the order of the equation.
const FACTOR_LABELS: [&str; LeadFactor::ALL.len()] = [
    "R fixed at (1)",
    "D fixed at (1)",
    "C fixed at (1)",
    "M fixed at (1)",
    "A fixed at (1)",
    "Z fixed at (1)",
];

impl InputKind {
    /// Returns the kind of input that a view accepts, or `None` if the view accepts no input.
    pub fn for_view(view: XrayView) -> Option<InputKind> {
        match (view, view.choices()) {
            (XrayView::Customer, _) => Some(InputKind::Customer),
            (XrayView::Commands, _) => Some(InputKind::Command),
            (_, ViewChoices::Nothing) if view.has_day() => Some(InputKind::Day),
            (_, ViewChoices::Groups) => Some(InputKind::Group),
            (_, ViewChoices::Components) => Some(InputKind::Part),
            (_, ViewChoices::Breakpoints) => Some(InputKind::Condition),
            (_, ViewChoices::Nothing) => None,
        }
    }

    pub fn prompt(self) -> &'static str {
        match self {
            InputKind::Group => "group [day]",
            InputKind::Part => "component",
            InputKind::Customer => "customer [day]",
            InputKind::Day => "day",
            InputKind::Condition => "stop when",
            InputKind::Days => "days to run",
            InputKind::HeldValue(factor) => FACTOR_LABELS[factor as usize],
            InputKind::Command => "find, who, diff or set",
        }
    }

    /// Parses an input line.
    ///
    /// # Errors
    /// The input is invalid. The message names the expected input, and a similar name if there is one.
    pub fn parse(self, text: &str) -> Result<ParsedInput, String> {
        let text = text.trim();
        match self {
            InputKind::Group => {
                let (id, day) = split_day(text)?;
                let found = Group::all().find(|group| group.id().eq_ignore_ascii_case(id));
                let ids = || Group::all().map(Group::id);
                let typed = found.map(|group| ParsedInput::Group(group, day));
                typed.ok_or_else(|| unknown_name_error("group", id, &similar_names(id, ids())))
            }
            InputKind::Part => {
                let ids = || RandomPart::ALL.into_iter().map(RandomPart::id);
                let found = RandomPart::parse(&text.to_ascii_lowercase());
                found.map(ParsedInput::Part).ok_or_else(|| unknown_name_error("component", text, &similar_names(text, ids())))
            }
            InputKind::Customer => {
                let (number, day) = split_day(text)?;
                let customer = number.parse().map(|customer| ParsedInput::Customer(customer, day));
                customer.map_err(|_| "type a customer number, for example 4711".to_owned())
            }
            InputKind::Day => parse_day(text).map(ParsedInput::Day),
            InputKind::Condition => text.parse().map(ParsedInput::Condition).map_err(condition_problem_text),
            InputKind::HeldValue(factor) => match text {
                "" => Ok(ParsedInput::HeldValue(factor, 1.0)),
                text => {
                    let value = text.parse().ok().filter(|value: &f64| value.is_finite() && *value >= 0.0);
                    let value = value.map(|value| ParsedInput::HeldValue(factor, value));
                    value.ok_or_else(|| format!("{factor} needs a number of at least 0"))
                }
            },
            InputKind::Command => {
                let read = InspectionCommand::parse(text).map(|inspection_command| ParsedInput::Command(text.to_owned(), inspection_command));
                read.map_err(|problem| problem.text)
            }
            InputKind::Days => {
                let days = text.parse().ok().filter(|days| *days > 0);
                days.map(ParsedInput::Days).ok_or_else(|| "type a number of days, for example 28".to_owned())
            }
        }
    }
}

impl ParsedInput {
    /// Checks that the day in the input has been simulated.
    ///
    /// # Errors
    /// The day has not been simulated. The message contains the range of simulated days.
    pub fn check_day(self, last_day: u32) -> Result<ParsedInput, String> {
        match self {
            ParsedInput::Group(_, Some(day)) | ParsedInput::Customer(_, Some(day)) | ParsedInput::Day(day)
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

/// Returns the first word, and the day after the first word if there is one.
fn split_day(text: &str) -> Result<(&str, Option<u32>), String> {
    match text.split_once(char::is_whitespace) {
        Some((first, day)) => Ok((first, Some(parse_day(day.trim())?))),
        None => Ok((text, None)),
    }
}

fn parse_day(text: &str) -> Result<u32, String> {
    text.parse().map_err(|_| "a day is a whole number, for example 84".to_owned())
}

fn condition_problem_text(problem: ConditionParseError) -> String {
    problem.message
}

fn unknown_name_error(what: &str, text: &str, near: &[&str]) -> String {
    match near {
        [] => format!("there is no {what} {text}"),
        near => format!("there is no {what} {text}; did you mean {}?", near.join(" or ")),
    }
}
