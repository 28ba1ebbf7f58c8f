//! `diff DAY DAY`: the differences between the ends of two days of the run (docs/debugging.md#two-days-and-two-runs).

use super::super::answers::Answer;
use super::super::grammar::{Argument, Problem};
use super::Interpreter;
use novamind_report::xray::AskedWords;

impl Interpreter {
    pub(super) fn difference(&mut self, arguments: &[Argument]) -> Result<Answer, Problem> {
        self.ask_words("diff", || AskedWords::diff(arguments))
    }
}
