//! `diff DAY DAY`: the differences between the ends of two days of the run (docs/debugging.md#two-days-and-two-runs).

use super::super::grammar::{Argument, ParseError};
use super::super::response::CommandResponse;
use super::Interpreter;
use novamind_report::inspection::InspectionCommand;

impl Interpreter {
    pub(super) fn difference(&mut self, arguments: &[Argument]) -> Result<CommandResponse, ParseError> {
        self.run_debug_command("diff", || InspectionCommand::parse_diff(arguments))
    }
}
