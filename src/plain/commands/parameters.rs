//! `set …`: parameters of a debug run, shown and changed while it goes on (docs/debugging.md#parameters).

use serde_json::{Value, json};

use super::super::answers::Answer;
use super::super::grammar::{Argument, Problem};
use super::{Interpreter, problem};
use crate::report::parameters::{changed_in_words, set_in_words};
use crate::session::ChangedParameter;

pub(super) const IN_FULL: &str = "\
set                       what differs from the scenario, and what is set from a later day on
set KEY                   a parameter, or a list or table of them, for instance set group.S1
set KEY VALUE             sets it from now on, for instance set group.S1.c_max_mean 300
set KEY VALUE from DAY    sets it from that day on, for instance set capacity_tier.3.capacity_units 90000 from 30
In debug runs only. The change is recorded: replays, branches and what-ifs make it again. Such a run is not ranked.";

const USAGE: &str = "name a parameter, its value and a day or none: set group.S1.c_max_mean 300 from 30";

/// What is asked for.
enum Request<'a> {
    List,
    Show(&'a str),
    Set(&'a str, &'a Value, Option<u32>),
}

impl Interpreter {
    /// `set [KEY [VALUE [from DAY]]]`
    pub(super) fn set(&mut self, arguments: &[Argument]) -> Result<Answer, Problem> {
        // Nothing is read of what is asked for before it is clear that it may be done.
        if let Err(refusal) = self.session.refuse_parameters() {
            return Ok(Answer::refused("set", refusal));
        }
        let answered = match request(arguments)? {
            Request::List => self.session.changed_parameters().map(|changed| {
                let list = |all: &[ChangedParameter]| all.iter().map(as_data).collect::<Vec<Value>>();
                let data = json!({
                    "scenario": changed.scenario,
                    "in_force": list(&changed.in_force),
                    "waiting": list(&changed.waiting),
                });
                Answer::done("set", changed_in_words(&changed).join("\n"), data)
            }),
            Request::Show(key) => self.session.parameter(key).map(|value| {
                Answer::done("set", format!("{key} = {value}"), json!({ "key": key, "value": value }))
            }),
            Request::Set(key, value, from) => {
                let today = self.session.day();
                let set = self.session.set_parameter(key, value, from);
                set.map(|set| Answer::done("set", set_in_words(&set, today), as_data(&set)))
            }
        };
        Ok(answered.unwrap_or_else(|refusal| Answer::refused("set", refusal)))
    }
}

fn request(arguments: &[Argument]) -> Result<Request<'_>, Problem> {
    let usage = || problem(arguments, USAGE);
    let (key, value, rest) = match arguments {
        [] => return Ok(Request::List),
        [Argument { key: None, value: Value::String(key), .. }] => return Ok(Request::Show(key)),
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
        [] => return Ok(Request::Set(key, value, None)),
        [own] if own.key.as_deref() == Some("from") => own,
        [from, own] if is_from(from) && own.key.is_none() => own,
        _ => return Err(usage()),
    };
    let number = day.value.as_u64().and_then(|number| u32::try_from(number).ok());
    match number {
        Some(number) => Ok(Request::Set(key, value, Some(number))),
        None => Err(Problem { text: "a day is a whole number".to_owned(), column: day.column }),
    }
}

fn as_data(own: &ChangedParameter) -> Value {
    json!({ "key": own.key, "old": own.old, "new": own.new, "from_day": own.from_day })
}
