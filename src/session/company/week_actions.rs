//! The player's actions since the last week, for undo and redo.

use super::irrevocable::IrrevocableAction;
use novamind_record::trajectory::record::Reversal;
use novamind_tools::ToolId;
use novamind_world::settings::Settings;

#[derive(Debug, Clone)]
pub(crate) struct WeekActions {
    pub(crate) settings: Settings,
    /// Setting calls that can be undone, newest last.
    pub(crate) undo: Vec<UndoStep>,
    /// Undo calls that can be redone, newest last.
    pub(crate) redo: Vec<UndoStep>,
    pub(crate) irrevocable_actions: Vec<IrrevocableAction>,
}

/// A call that changed settings, and the settings that are restored if the call is reverted.
#[derive(Debug, Clone)]
pub(crate) struct UndoStep {
    pub(crate) seq: u64,
    pub(crate) tool: ToolId,
    pub(crate) restored_settings: Settings,
}

impl WeekActions {
    /// Clears all actions and starts a new week with these settings.
    pub(crate) fn reset(&mut self, settings: Settings) {
        *self = WeekActions { settings, undo: Vec::new(), redo: Vec::new(), irrevocable_actions: Vec::new() };
    }

    pub(crate) fn record(&mut self, call: UndoStep, changed: bool, reversal: Option<Reversal>) {
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
