//! The queue of inspection questions. The worker answers one question at a time, and the answers are stored.

use super::{InspectionResult, Xray};
use crate::effect::Effect;
use novamind_tools::Rejection;
use novamind_worker::inspection::{BreakpointCommand, InspectionAnswer, InspectionQuestion};

impl Xray {
    pub(super) fn send_question(&mut self, question: InspectionQuestion) -> Vec<Effect> {
        vec![Effect::Ask(self.pending_question.ask(question))]
    }

    /// Sends a question immediately, or queues it after the current question. The new question replaces all waiting
    /// read-only questions.
    pub(super) fn enqueue_question(&mut self, question: InspectionQuestion) -> Vec<Effect> {
        if !self.pending_question.is_waiting() {
            return self.send_question(question);
        }
        self.queued.retain(|inspection_question| !is_read_only(inspection_question));
        self.queued.push_back(question);
        Vec::new()
    }

    /// Sends or queues a command that changes breakpoints.
    pub(super) fn send_breakpoint_work(&mut self, work: BreakpointCommand) -> Vec<Effect> {
        self.enqueue_question(InspectionQuestion::Breakpoints(work))
    }

    pub(super) fn pending_command(&self) -> Option<&str> {
        self.queued.iter().rev().chain(self.pending_question.question()).find_map(|question| match question {
            InspectionQuestion::Command(words, _) => Some(words.as_str()),
            _ => None,
        })
    }

    pub(super) fn handle_answer(&mut self, question: InspectionQuestion, found: Result<InspectionAnswer, Rejection>) -> Vec<Effect> {
        let shown = self.store_answer(question, found);
        match self.queued.pop_front() {
            Some(next) => self.send_question(next),
            None if shown => Vec::new(),
            None => self.request_inspection(),
        }
    }

    /// Stores an answer of the worker. Returns true if the current view shows the answer.
    fn store_answer(&mut self, mut question: InspectionQuestion, found: Result<InspectionAnswer, Rejection>) -> bool {
        let found = found.map_err(|rejection| rejection.message);
        if let InspectionQuestion::Command(_, inspection_command) = &question {
            if inspection_command.changes_run() {
                self.inspection = None;
            }
            self.command_output = Some(InspectionResult { question, found });
            return false;
        }
        if let InspectionQuestion::Breakpoints(work) = &mut question {
            // The answer is stored as the list of breakpoints, so that the change is not repeated.
            *work = BreakpointCommand::List;
            if let Ok(found) = &found {
                self.breakpoints = found.breakpoints.clone();
                self.fill_breakpoints();
            }
        }
        let is_wanted = self.current_question().as_ref() == Some(&question);
        if is_wanted {
            self.inspection = Some(InspectionResult { question, found });
        }
        is_wanted
    }
}

/// Returns whether a question changes neither the run nor the breakpoints.
fn is_read_only(question: &InspectionQuestion) -> bool {
    match question {
        InspectionQuestion::Command(_, inspection_command) => !inspection_command.changes_run(),
        InspectionQuestion::Breakpoints(work) => matches!(work, BreakpointCommand::List | BreakpointCommand::History),
        _ => true,
    }
}
