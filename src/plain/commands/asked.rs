//! `find`, `who`, `diff` and `set`: commands that the console offers, too (docs/debugging.md).

use serde_json::{Value, json};

use super::super::answers::Answer;
use super::super::grammar::Problem;
use super::Interpreter;
use super::breakpoints::{judged_as_data, writes_as_data};
use novamind_report::xray::{AskedWords, WordsFound, difference_as_data};

impl Interpreter {
    /// Answers a command. The permission is checked before anything is parsed.
    pub(super) fn ask_words(
        &mut self,
        word: &str,
        read: impl FnOnce() -> Result<AskedWords, Problem>,
    ) -> Result<Answer, Problem> {
        if let Err(refusal) = AskedWords::refuse(word, &self.session) {
            return Ok(Answer::refused(word, refusal));
        }
        Ok(match read()?.answer(&mut self.session) {
            Ok(found) => Answer::done(word, found.in_words().join("\n"), as_data(&found)),
            Err(refusal) => Answer::refused(word, refusal),
        })
    }
}

fn as_data(found: &WordsFound) -> Value {
    match found {
        WordsFound::Days(condition, found, _) => {
            let days: Vec<Value> = found.iter().map(judged_as_data).collect();
            json!({ "condition": condition.to_string(), "days": days })
        }
        WordsFound::Writes(own) => writes_as_data(own),
        WordsFound::Difference(one, other, found) => {
            json!({ "days": [one, other], "difference": difference_as_data(found) })
        }
        WordsFound::Parameters(changed) => json!(changed),
        WordsFound::Parameter(key, value) => json!({ "key": key, "value": value }),
        WordsFound::Set(set, _) => json!(set),
    }
}
