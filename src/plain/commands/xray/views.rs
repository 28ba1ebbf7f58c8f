//! `xray quality …` and the other x-ray views of groups, the market and random draws.

use serde_json::Value;

use super::super::super::grammar::{Argument, ParseError};
use super::super::super::response::CommandResponse;
use super::super::Interpreter;
use super::view_data::{
    competitors_to_json, drift_to_json, quality_to_json, reputation_to_json, satisfaction_to_json,
    spillover_to_json, streams_to_json,
};
use super::{parse_group_and_day, parse_whole_number};
use novamind_base::similar_names;
use novamind_insight::{Inspect, RandomPart};
use novamind_report::inspection::{
    describe_competitors, describe_drift, describe_next_draws, describe_quality, describe_reputation,
    describe_satisfaction, describe_spillover,
};
use novamind_session::identifiers::Group;
use novamind_tools::Rejection;

/// The response of a view, a rejection, or an error in the arguments.
type ViewResult = Result<Result<CommandResponse, Rejection>, ParseError>;

/// Returns the response that contains a view as text and as JSON.
fn view_response<T>(
    seen: Result<T, Rejection>,
    words: fn(&T) -> Vec<String>,
    data: fn(&T) -> Value,
) -> Result<CommandResponse, Rejection> {
    seen.map(|seen| CommandResponse::success("xray", words(&seen).join("\n"), data(&seen)))
}

impl Interpreter {
    /// Executes `xray quality GROUP [DAY]`.
    pub(super) fn show_quality(&mut self, arguments: &[Argument]) -> ViewResult {
        let (group, day) = parse_group_view("quality", arguments)?;
        Ok(view_response(
            self.session.inspect().quality_equation(group, day),
            describe_quality,
            quality_to_json,
        ))
    }

    /// Executes `xray satisfaction GROUP [DAY]`.
    pub(super) fn show_satisfaction(&mut self, arguments: &[Argument]) -> ViewResult {
        let (group, day) = parse_group_view("satisfaction", arguments)?;
        let seen = self.session.inspect().satisfaction_equation(group, day);
        Ok(view_response(seen, describe_satisfaction, satisfaction_to_json))
    }

    /// Executes `xray reputation GROUP [DAY]`.
    pub(super) fn show_reputation(&mut self, arguments: &[Argument]) -> ViewResult {
        let (group, day) = parse_group_view("reputation", arguments)?;
        let seen = self.session.inspect().reputation_equation(group, day);
        Ok(view_response(seen, describe_reputation, reputation_to_json))
    }

    /// Executes `xray spillover [DAY]`.
    pub(super) fn show_spillover(&mut self, arguments: &[Argument]) -> ViewResult {
        let day = parse_optional_day("spillover", arguments)?;
        Ok(view_response(self.session.inspect().spillover(day), describe_spillover, spillover_to_json))
    }

    /// Executes `xray rivals [DAY]`.
    pub(super) fn show_competitors(&mut self, arguments: &[Argument]) -> ViewResult {
        let day = parse_optional_day("rivals", arguments)?;
        Ok(view_response(
            self.session.inspect().competitor_state(day),
            describe_competitors,
            competitors_to_json,
        ))
    }

    /// Executes `xray drift [DAY]`.
    pub(super) fn show_drift(&mut self, arguments: &[Argument]) -> ViewResult {
        let day = parse_optional_day("drift", arguments)?;
        Ok(view_response(self.session.inspect().drift_state(day), describe_drift, drift_to_json))
    }

    /// Executes `xray streams PART [N]`.
    pub(super) fn show_streams(&mut self, arguments: &[Argument]) -> ViewResult {
        let (part, count) = parse_part_and_count(arguments)?;
        Ok(view_response(
            self.session.inspect().next_draws(part, count),
            describe_next_draws,
            streams_to_json,
        ))
    }
}

/// Parses the arguments of a view that needs a group and an optional day.
fn parse_group_view(view: &str, arguments: &[Argument]) -> Result<(Group, Option<u32>), ParseError> {
    parse_group_and_day(view, &arguments.iter().collect::<Vec<_>>())
}

/// Parses the argument of a view that accepts only an optional day.
fn parse_optional_day(view: &str, arguments: &[Argument]) -> Result<Option<u32>, ParseError> {
    match arguments {
        [] => Ok(None),
        [day] => parse_whole_number(day).map(Some),
        [_, second, ..] => {
            let text = format!("give a day, or no argument for the last day: xray {view} 84");
            Err(ParseError { text, column: second.column })
        }
    }
}

/// Parses the arguments of `xray streams`: a part of the world and an optional number of draws.
fn parse_part_and_count(arguments: &[Argument]) -> Result<(RandomPart, Option<usize>), ParseError> {
    let parts = RandomPart::ALL.map(RandomPart::id).join(", ");
    let usage = || ParseError {
        text: format!(
            "give a part and optionally a number of draws: xray streams service 4; the parts are {parts}"
        ),
        column: arguments.get(2).map_or(1, |argument| argument.column),
    };
    let (first, count) = match arguments {
        [first] => (first, None),
        [first, count] => (first, Some(count)),
        _ => return Err(usage()),
    };
    let id = first.value.as_str().filter(|_| first.key.is_none()).ok_or_else(usage)?;
    let part = RandomPart::parse(id).ok_or_else(|| {
        let near = similar_names(id, RandomPart::ALL.into_iter().map(RandomPart::id));
        let help = match near.is_empty() {
            true => format!("the parts are {parts}"),
            false => format!("did you mean {}?", near.join(" or ")),
        };
        ParseError { text: format!("there are no draws of {id}; {help}"), column: first.column }
    })?;
    let count = count.map(parse_whole_number).transpose()?;
    Ok((part, count.map(|count| count as usize)))
}
