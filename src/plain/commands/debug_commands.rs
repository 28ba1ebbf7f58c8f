//! Runs `find`, `who`, `diff` and `set`, which are also commands of the console (docs/debugging.md).

use serde_json::{Value, json};

use super::super::grammar::ParseError;
use super::super::response::CommandResponse;
use super::Interpreter;
use super::breakpoints::{condition_state_to_json, figure_writes_to_json};
use novamind_report::inspection::{InspectionCommand, InspectionOutput, difference_to_json};

impl Interpreter {
    /// Executes a debug command. Checks the permission before parsing the arguments.
    pub(super) fn run_debug_command(
        &mut self,
        word: &str,
        read: impl FnOnce() -> Result<InspectionCommand, ParseError>,
    ) -> Result<CommandResponse, ParseError> {
        if let Err(rejection) = InspectionCommand::check_permission(word, &self.session) {
            return Ok(CommandResponse::rejected(word, rejection));
        }
        Ok(match read()?.run(&mut self.session) {
            Ok(found) => CommandResponse::success(word, found.describe().join("\n"), result_to_json(&found)),
            Err(rejection) => CommandResponse::rejected(word, rejection),
        })
    }
}

fn result_to_json(found: &InspectionOutput) -> Value {
    match found {
        InspectionOutput::Days(condition, found, _) => {
            let days: Vec<Value> = found.iter().map(condition_state_to_json).collect();
            json!({ "condition": condition.to_string(), "days": days })
        }
        InspectionOutput::Writes(figure_writes) => figure_writes_to_json(figure_writes),
        InspectionOutput::Difference(one, other, found) => {
            json!({ "days": [one, other], "difference": difference_to_json(found) })
        }
        InspectionOutput::Parameters(changed) => json!(changed),
        InspectionOutput::Parameter(key, value) => json!({ "key": key, "value": value }),
        InspectionOutput::Set(set, _) => json!(set),
    }
}
