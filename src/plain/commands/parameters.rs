//! `set …`: shows and changes parameters of a debug run in progress (docs/debugging.md#parameters).

use super::super::grammar::{Argument, ParseError};
use super::super::response::CommandResponse;
use super::Interpreter;
use novamind_report::inspection::InspectionCommand;

pub(super) const HELP: &str = "\
set                       list the differences from the scenario, and changes from a later day on
set KEY                   show a parameter, or a list or table of them, for example set group.S1
set KEY VALUE             set the parameter from now on, for example set group.S1.c_max_mean 300
set KEY VALUE from DAY    set the parameter from that day on, for example set capacity_tier.3.capacity_units 90000 from 30
In debug runs only. The change is recorded; replays, branches and what-ifs repeat it. Such a run is not ranked.";

impl Interpreter {
    /// Executes `set [KEY [VALUE [from DAY]]]`.
    pub(super) fn set_parameter(&mut self, arguments: &[Argument]) -> Result<CommandResponse, ParseError> {
        self.run_debug_command("set", || InspectionCommand::parse_set(arguments))
    }
}
