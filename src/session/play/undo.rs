//! Undo and redo of the setting changes of the current week.
//!
//! Undo and redo are regular calls that restore values with the tool that set them. The line of an undo or redo names
//! the call that is undone or redone. Calls without effect are skipped.

use std::collections::BTreeSet;

use serde_json::{Map, Value};

use super::Session;
use super::tool_call::CallMetadata;
use crate::company::week_actions::UndoStep;
use crate::figures::changes::{SettingChange, setting_changes};
use crate::figures::journal::JournalEntry;
use novamind_record::trajectory::record::{Reversal, Via};
use novamind_tools::{Rejection, ToolId};
use novamind_world::settings::Settings;

/// Returns the line numbers of the calls that were undone. A redo has a separate line.
pub fn undone_call_lines(journal: &[JournalEntry]) -> BTreeSet<u64> {
    let mut undone = BTreeSet::new();
    for entry in journal {
        if let JournalEntry::Call { reversal: Some(Reversal::Undoes(seq)), .. } = entry {
            undone.insert(*seq);
        }
    }
    undone
}

impl Session {
    /// Undoes the last call of this week that changed a setting. Returns the restored settings.
    ///
    /// # Errors
    /// `nothing_to_undo`, `cannot_undo` if no call can restore the old value, and the rejections of the call.
    pub fn undo(&mut self, via: Via) -> Result<Vec<SettingChange>, Rejection> {
        let Some(step) = self.history.week_actions.undo.last().cloned() else {
            let message =
                "no setting has changed since the last week; purchases, posts and offers cannot be undone";
            return Err(Rejection::new("nothing_to_undo", message));
        };
        self.restore(&step, via, Reversal::Undoes(step.seq))
    }

    /// Redoes the last undone call of this week. Returns the restored settings.
    ///
    /// # Errors
    /// `nothing_to_redo`, and the rejections of the call.
    pub fn redo(&mut self, via: Via) -> Result<Vec<SettingChange>, Rejection> {
        let Some(step) = self.history.week_actions.redo.last().cloned() else {
            let message = "no call was undone since the last setting change";
            return Err(Rejection::new("nothing_to_redo", message));
        };
        self.restore(&step, via, Reversal::Redoes(step.seq))
    }

    fn restore(
        &mut self,
        step: &UndoStep,
        via: Via,
        reversal: Reversal,
    ) -> Result<Vec<SettingChange>, Rejection> {
        let before = self.simulation.world.settings.clone();
        let arguments = restoring_arguments(step.tool, &before, &step.restored_settings)?;
        let marks = CallMetadata { reversal: Some(reversal), request: None };
        self.call_with_metadata(step.tool.name(), &Value::Object(arguments), via, marks)?;
        Ok(setting_changes(&before, &self.simulation.world.settings))
    }
}

fn restoring_arguments(
    id: ToolId,
    now: &Settings,
    restored: &Settings,
) -> Result<Map<String, Value>, Rejection> {
    let tool = id.tool();
    let mut arguments = tool.current_arguments(restored);
    if id == ToolId::SetPrices {
        let held = tool.current_arguments(now);
        arguments.retain(|plan, price| held.get(plan) != Some(price));
        if let Some((plan, _)) = arguments.iter().find(|(_, price)| price.as_f64() == Some(0.0)) {
            let message = format!(
                "plan {plan} had no price before this call, and a price cannot be set to 0; set another price instead"
            );
            return Err(Rejection::for_field(plan.clone(), "cannot_undo", message));
        }
    }
    Ok(arguments)
}
