//! What was done since the last week ran, so that settings can be taken back.

use super::irrevocable::Irrevocable;
use crate::session::trajectory::record::Reversal;
use crate::tools::ToolId;
use crate::world::settings::Settings;

/// What happened since the last week ran.
#[derive(Debug, Clone)]
pub(in crate::session) struct ThisWeek {
    /// Settings before the first call.
    pub(in crate::session) settings: Settings,
    /// Setting calls that can be taken back, newest last.
    pub(in crate::session) undo: Vec<Step>,
    /// Calls that took settings back and can be reversed themselves, newest last.
    pub(in crate::session) redo: Vec<Step>,
    /// Purchases and the like, in words.
    pub(in crate::session) done: Vec<Irrevocable>,
}

/// A call that changed settings, and the settings that reversing it restores.
#[derive(Debug, Clone)]
pub(in crate::session) struct Step {
    /// Line of the call.
    pub(in crate::session) seq: u64,
    pub(in crate::session) tool: ToolId,
    pub(in crate::session) restores: Settings,
}

impl ThisWeek {
    /// Nothing has happened since these settings were in force.
    pub(in crate::session) fn begin(&mut self, settings: Settings) {
        *self = ThisWeek { settings, undo: Vec::new(), redo: Vec::new(), done: Vec::new() };
    }

    /// Keeps what a setting call did, so that it can be reversed.
    pub(in crate::session) fn keep(&mut self, call: Step, changed: bool, reversal: Option<Reversal>) {
        if let Some(Reversal::Undoes(seq)) = reversal {
            self.undo.retain(|step| step.seq < seq);
        }
        if !changed {
            return;
        }
        match reversal {
            Some(Reversal::Undoes(_)) => return self.redo.push(call),
            Some(Reversal::Redoes(seq)) => self.redo.retain(|step| step.seq < seq),
            None => self.redo.clear(),
        }
        self.undo.push(call);
    }
}
