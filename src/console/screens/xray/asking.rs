//! Queue of questions: one is answered at a time, and results are stored.

use super::{Seen, Xray};
use crate::effect::Effect;
use novamind_tools::Refusal;
use novamind_worker::look_inside::{BreakpointWork, LookFound, LookQuestion};

impl Xray {
    pub(super) fn send(&mut self, question: LookQuestion) -> Vec<Effect> {
        vec![Effect::Ask(self.asked.ask(question))]
    }

    /// Sends a question at once or after the current one. A new read-only command replaces waiting ones.
    pub(super) fn send_in_turn(&mut self, question: LookQuestion) -> Vec<Effect> {
        if !self.asked.is_waiting() {
            return self.send(question);
        }
        self.waiting.retain(|own| !only_asks(own));
        self.waiting.push_back(question);
        Vec::new()
    }

    /// Queues a change of breakpoints.
    pub(super) fn work(&mut self, work: BreakpointWork) -> Vec<Effect> {
        self.send_in_turn(LookQuestion::Breakpoints(work))
    }

    pub(super) fn words_asked(&self) -> Option<&str> {
        self.waiting.iter().rev().chain(self.asked.question()).find_map(|question| match question {
            LookQuestion::Words(words, _) => Some(words.as_str()),
            _ => None,
        })
    }

    pub(super) fn take(&mut self, question: LookQuestion, found: Result<LookFound, Refusal>) -> Vec<Effect> {
        let shown = self.keep(question, found);
        match self.waiting.pop_front() {
            Some(next) => self.send(next),
            None if shown => Vec::new(),
            None => self.ask(),
        }
    }

    /// Stores an answer; returns true if the current view shows it.
    fn keep(&mut self, mut question: LookQuestion, found: Result<LookFound, Refusal>) -> bool {
        let found = found.map_err(|refusal| refusal.message);
        if let LookQuestion::Words(_, asked) = &question {
            if asked.changes_run() {
                self.seen = None;
            }
            self.said = Some(Seen { question, found });
            return false;
        }
        if let LookQuestion::Breakpoints(work) = &mut question {
            // Show the result like the list, and do not repeat the change.
            *work = BreakpointWork::List;
            if let Ok(found) = &found {
                self.breakpoints = found.breakpoints.clone();
                self.list_breakpoints();
            }
        }
        let is_wanted = self.wanted().as_ref() == Some(&question);
        if is_wanted {
            self.seen = Some(Seen { question, found });
        }
        is_wanted
    }
}

/// Returns whether a question changes nothing.
fn only_asks(question: &LookQuestion) -> bool {
    match question {
        LookQuestion::Words(_, asked) => !asked.changes_run(),
        LookQuestion::Breakpoints(work) => matches!(work, BreakpointWork::List | BreakpointWork::LookBack),
        _ => true,
    }
}
