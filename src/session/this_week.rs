//! What was done since the last week ran, so that settings can be taken back.

use super::trajectory::record::Reversal;
use crate::tools::ToolId;
use crate::world::settings::Settings;

/// What happened since the last week ran.
#[derive(Debug, Clone)]
pub(super) struct ThisWeek {
    /// Settings before the first call.
    pub(super) settings: Settings,
    /// Setting calls that can be taken back, newest last.
    pub(super) undo: Vec<Step>,
    /// Calls that took settings back and can be reversed themselves, newest last.
    pub(super) redo: Vec<Step>,
    /// Purchases and the like, in words.
    pub(super) done: Vec<String>,
}

/// A call that changed settings, and the settings that reversing it restores.
#[derive(Debug, Clone)]
pub(super) struct Step {
    /// Line of the call.
    pub(super) seq: u64,
    pub(super) tool: ToolId,
    pub(super) restores: Settings,
}

impl ThisWeek {
    /// Keeps what a setting call did, so that it can be reversed.
    pub(super) fn keep(&mut self, call: Step, changed: bool, reversal: Option<Reversal>) {
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
