//! What was done since the last week ran, so that settings can be taken back.

use super::irrevocable::Irrevocable;
use novamind_record::trajectory::record::Reversal;
use novamind_tools::ToolId;
use novamind_world::settings::Settings;

/// What happened since the last week ran.
#[derive(Debug, Clone)]
pub(crate) struct ThisWeek {
    /// Settings before the first call.
    pub(crate) settings: Settings,
    /// Setting calls that can be taken back, newest last.
    pub(crate) undo: Vec<Step>,
    /// Calls that took settings back and can be reversed themselves, newest last.
    pub(crate) redo: Vec<Step>,
    /// Purchases and the like, in words.
    pub(crate) done: Vec<Irrevocable>,
}

/// A call that changed settings, and the settings that reversing it restores.
#[derive(Debug, Clone)]
pub(crate) struct Step {
    /// Line of the call.
    pub(crate) seq: u64,
    pub(crate) tool: ToolId,
    pub(crate) restores: Settings,
}

impl ThisWeek {
    /// Nothing has happened since these settings were in force.
    pub(crate) fn begin(&mut self, settings: Settings) {
        *self = ThisWeek { settings, undo: Vec::new(), redo: Vec::new(), done: Vec::new() };
    }

    /// Keeps what a setting call did, so that it can be reversed.
    pub(crate) fn keep(&mut self, call: Step, changed: bool, reversal: Option<Reversal>) {
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
