//! `set …`: parameters of a debug run, shown and changed while it goes on (docs/debugging.md#parameters).

use super::super::answers::Answer;
use super::super::grammar::{Argument, Problem};
use super::Interpreter;
use novamind_report::xray::AskedWords;

pub(super) const IN_FULL: &str = "\
set                       what differs from the scenario, and what is set from a later day on
set KEY                   a parameter, or a list or table of them, for instance set group.S1
set KEY VALUE             sets it from now on, for instance set group.S1.c_max_mean 300
set KEY VALUE from DAY    sets it from that day on, for instance set capacity_tier.3.capacity_units 90000 from 30
In debug runs only. The change is recorded: replays, branches and what-ifs make it again. Such a run is not ranked.";

impl Interpreter {
    /// `set [KEY [VALUE [from DAY]]]`
    pub(super) fn set(&mut self, arguments: &[Argument]) -> Result<Answer, Problem> {
        self.ask_words("set", || AskedWords::set(arguments))
    }
}
