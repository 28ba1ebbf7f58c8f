//! `xray quality …` and the other views of groups, of the market and of draws.

use serde_json::Value;

use super::super::super::answers::Answer;
use super::super::super::grammar::{Argument, Problem};
use super::super::Interpreter;
use super::view_data::{
    drift_as_data, quality_as_data, reputation_as_data, rivals_as_data, satisfaction_as_data,
    spillover_as_data, streams_as_data,
};
use super::{group_and_day, whole_number};
use novamind_base::nearest;
use novamind_insight::{DrawnPart, Inspect};
use novamind_report::xray::{
    drift_in_words, quality_in_words, reputation_in_words, rivals_in_words, satisfaction_in_words,
    spillover_in_words, streams_in_words,
};
use novamind_session::identifiers::Group;
use novamind_tools::Refusal;

/// The answer of a view, a rejection, or a usage problem.
type Viewed = Result<Result<Answer, Refusal>, Problem>;

/// Returns a view as text and data.
fn shown<T>(
    seen: Result<T, Refusal>,
    words: fn(&T) -> Vec<String>,
    data: fn(&T) -> Value,
) -> Result<Answer, Refusal> {
    seen.map(|seen| Answer::done("xray", words(&seen).join("\n"), data(&seen)))
}

impl Interpreter {
    /// `xray quality GROUP [DAY]`
    pub(super) fn quality(&mut self, arguments: &[Argument]) -> Viewed {
        let (group, day) = of_group("quality", arguments)?;
        Ok(shown(self.session.inspect().quality_equation(group, day), quality_in_words, quality_as_data))
    }

    /// `xray satisfaction GROUP [DAY]`
    pub(super) fn satisfaction(&mut self, arguments: &[Argument]) -> Viewed {
        let (group, day) = of_group("satisfaction", arguments)?;
        let seen = self.session.inspect().satisfaction_equation(group, day);
        Ok(shown(seen, satisfaction_in_words, satisfaction_as_data))
    }

    /// `xray reputation GROUP [DAY]`
    pub(super) fn reputation(&mut self, arguments: &[Argument]) -> Viewed {
        let (group, day) = of_group("reputation", arguments)?;
        let seen = self.session.inspect().reputation_equation(group, day);
        Ok(shown(seen, reputation_in_words, reputation_as_data))
    }

    /// `xray spillover [DAY]`
    pub(super) fn spillover(&mut self, arguments: &[Argument]) -> Viewed {
        let day = day_alone("spillover", arguments)?;
        Ok(shown(self.session.inspect().spillover(day), spillover_in_words, spillover_as_data))
    }

    /// `xray rivals [DAY]`
    pub(super) fn rivals(&mut self, arguments: &[Argument]) -> Viewed {
        let day = day_alone("rivals", arguments)?;
        Ok(shown(self.session.inspect().rival_state(day), rivals_in_words, rivals_as_data))
    }

    /// `xray drift [DAY]`
    pub(super) fn drift(&mut self, arguments: &[Argument]) -> Viewed {
        let day = day_alone("drift", arguments)?;
        Ok(shown(self.session.inspect().drift_state(day), drift_in_words, drift_as_data))
    }

    /// `xray streams PART [N]`
    pub(super) fn streams(&mut self, arguments: &[Argument]) -> Viewed {
        let (part, count) = part_and_count(arguments)?;
        Ok(shown(self.session.inspect().next_draws(part, count), streams_in_words, streams_as_data))
    }
}

/// Parses a group and an optional day.
fn of_group(view: &str, arguments: &[Argument]) -> Result<(Group, Option<u32>), Problem> {
    group_and_day(view, &arguments.iter().collect::<Vec<_>>())
}

/// Parses an optional day.
fn day_alone(view: &str, arguments: &[Argument]) -> Result<Option<u32>, Problem> {
    match arguments {
        [] => Ok(None),
        [day] => whole_number(day).map(Some),
        [_, second, ..] => {
            let text = format!("give a day, or nothing for the last one: xray {view} 84");
            Err(Problem { text, column: second.column })
        }
    }
}

/// Parses a part of the world and an optional number of draws.
fn part_and_count(arguments: &[Argument]) -> Result<(DrawnPart, Option<usize>), Problem> {
    let parts = DrawnPart::ALL.map(DrawnPart::id).join(", ");
    let usage = || Problem {
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
    let part = DrawnPart::parse(id).ok_or_else(|| {
        let near = nearest(id, DrawnPart::ALL.into_iter().map(DrawnPart::id));
        let help = match near.is_empty() {
            true => format!("the parts are {parts}"),
            false => format!("did you mean {}?", near.join(" or ")),
        };
        Problem { text: format!("there are no draws of {id}; {help}"), column: first.column }
    })?;
    let count = count.map(whole_number).transpose()?;
    Ok((part, count.map(|count| count as usize)))
}
