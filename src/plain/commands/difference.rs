//! `diff DAY DAY`: what differs between the ends of two days of the run (docs/debugging.md#two-days-and-two-runs).

use serde_json::{Value, json};

use super::super::answers::Answer;
use super::super::grammar::{Argument, Problem};
use super::xray::whole_number;
use super::{Interpreter, problem};
use crate::report::xray::{difference_as_data, difference_in_words};

impl Interpreter {
    pub(super) fn difference(&mut self, arguments: &[Argument]) -> Result<Answer, Problem> {
        if let Err(refusal) = self.session.refuse_to_look_inside() {
            return Ok(Answer::refused("diff", refusal));
        }
        let days: Vec<u32> = arguments.iter().map(whole_number).collect::<Result<_, _>>()?;
        let [one, other] = days[..] else { return Err(problem(arguments, "name two days: diff 83 84")) };
        Ok(match self.session.difference_of_days(one, other) {
            Ok(found) => {
                let names = (format!("day {one}"), format!("day {other}"));
                let lines = difference_in_words(&found, (&names.0, &names.1));
                let data: Value = json!({ "days": [one, other], "difference": difference_as_data(&found) });
                Answer::done("diff", lines.join("\n"), data)
            }
            Err(refusal) => Answer::refused("diff", refusal),
        })
    }
}
