//! `memo`: the notes of the run.

use serde_json::json;

use super::super::answers::Answer;
use super::Interpreter;
use novamind_tools::Refusal;

impl Interpreter {
    /// `memo`
    pub(super) fn show_memo(&self) -> Answer {
        match self.session.memo() {
            Ok(memo) if memo.is_empty() => {
                Answer::done("memo", "no notes yet".to_owned(), json!({ "memo": "" }))
            }
            Ok(memo) => Answer::done("memo", memo.clone(), json!({ "memo": memo })),
            Err(error) => Answer::refused("memo", Refusal::new("not_readable", error.to_string())),
        }
    }

    /// `memo TEXT`
    pub(super) fn add_to_memo(&mut self, line: &str) -> Answer {
        let memo = match self.session.memo() {
            Ok(memo) => memo,
            Err(error) => return Answer::refused("memo", Refusal::new("not_readable", error.to_string())),
        };
        let gap = if memo.is_empty() || memo.ends_with('\n') { "" } else { "\n" };
        let memo = format!("{memo}{gap}{line}\n");
        match self.session.set_memo(&memo) {
            Ok(()) => Answer::done("memo", "noted".to_owned(), json!({ "memo": memo })),
            Err(refusal) => Answer::refused("memo", refusal),
        }
    }
}
