//! Actions since the last week, for undo and redo.

use super::irrevocable::Irrevocable;
use novamind_record::trajectory::record::Reversal;
use novamind_tools::ToolId;
use novamind_world::settings::Settings;

#[derive(Debug, Clone)]
pub(crate) struct ThisWeek {
    pub(crate) settings: Settings,
    /// Setting calls that can be undone, newest last.
    pub(crate) undo: Vec<Step>,
    /// Undo calls that can be redone, newest last.
    pub(crate) redo: Vec<Step>,
    pub(crate) done: Vec<Irrevocable>,
}

/// A call that changed settings, and the settings that reverting it restores.
#[derive(Debug, Clone)]
pub(crate) struct Step {
    pub(crate) seq: u64,
    pub(crate) tool: ToolId,
    pub(crate) restores: Settings,
}

impl ThisWeek {
    /// Starts a new week with these settings.
    pub(crate) fn begin(&mut self, settings: Settings) {
        *self = ThisWeek { settings, undo: Vec::new(), redo: Vec::new(), done: Vec::new() };
    }

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
