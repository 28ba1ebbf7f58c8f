//! `memo`: shows the notes of the run, or adds a line.

use serde_json::json;

use super::super::response::CommandResponse;
use super::Interpreter;
use novamind_tools::Rejection;

impl Interpreter {
    /// Executes `memo`.
    pub(super) fn show_notes(&self) -> CommandResponse {
        match self.session.notes() {
            Ok(memo) if memo.is_empty() => {
                CommandResponse::success("memo", "no notes yet".to_owned(), json!({ "memo": "" }))
            }
            Ok(memo) => CommandResponse::success("memo", memo.clone(), json!({ "memo": memo })),
            Err(error) => {
                CommandResponse::rejected("memo", Rejection::new("not_readable", error.to_string()))
            }
        }
    }

    /// Executes `memo TEXT`.
    pub(super) fn add_note(&mut self, line: &str) -> CommandResponse {
        let memo = match self.session.notes() {
            Ok(memo) => memo,
            Err(error) => {
                return CommandResponse::rejected("memo", Rejection::new("not_readable", error.to_string()));
            }
        };
        let gap = if memo.is_empty() || memo.ends_with('\n') { "" } else { "\n" };
        let memo = format!("{memo}{gap}{line}\n");
        match self.session.set_notes(&memo) {
            Ok(()) => CommandResponse::success("memo", "noted".to_owned(), json!({ "memo": memo })),
            Err(rejection) => CommandResponse::rejected("memo", rejection),
        }
    }
}
