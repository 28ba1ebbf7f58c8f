//! The last change of the offer that can explain the decisions of customers.

use serde_json::{Map, Value};

use super::{ActionTarget, DiagnosisContext};
use crate::decision_periods::describe_change;
use novamind_base::formatting::json_number;
use novamind_session::identifiers::Group;
use novamind_session::{Decisions, SettingChange};
use novamind_tools::ToolId;

/// The last decision that changed settings by which customers judge an offer.
pub(super) struct OfferChange<'a> {
    day: u32,
    changes: Vec<&'a SettingChange>,
}

impl<'a> OfferChange<'a> {
    /// Returns the last decision after day `since` that changed a setting of `tools` from a value above 0.
    pub(super) fn find_last(
        situation: &'a DiagnosisContext<'_>,
        tools: &[ToolId],
        since: u32,
    ) -> Option<OfferChange<'a>> {
        let recent = |decided: &&Decisions| decided.day > since;
        situation.decisions.iter().rev().take_while(recent).find_map(|decided| {
            let is_judged =
                |change: &&SettingChange| tools.contains(&change.setting.tool()) && change.old != 0.0;
            let changes: Vec<&SettingChange> = decided.changes.iter().filter(is_judged).collect();
            (!changes.is_empty()).then_some(OfferChange { day: decided.day, changes })
        })
    }

    /// Describes the change: `On day 21 you changed price A: 11 → 45.`
    pub(super) fn describe(&self) -> String {
        let words: Vec<String> = self.changes.iter().take(2).map(|change| describe_change(change)).collect();
        let more = match self.changes.len().saturating_sub(2) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        format!("On day {} you changed {}{more}.", self.day, words.join(", "))
    }

    /// Returns the form that contains the first changed setting, filled with the earlier values of the plans. Returns
    /// the page of the group if the current settings already equal the earlier values.
    pub(super) fn restore_target(&self, situation: &DiagnosisContext<'_>, group: Group) -> ActionTarget {
        let Some(first) = self.changes.first() else { return ActionTarget::Group(group) };
        let tool = first.setting.tool();
        let mut arguments = match tool {
            ToolId::SetPrices | ToolId::SetModelTiers => Map::new(),
            ToolId::SetUsageQuotas => situation.session.company().current_arguments(ToolId::SetUsageQuotas),
            _ => return ActionTarget::Group(group),
        };
        for change in self.changes.iter().filter(|change| change.setting.tool() == tool) {
            if let Some(plan) = change.setting.plan() {
                arguments.insert(plan.id().to_owned(), json_number(change.old));
            }
        }
        let now = situation.session.company().current_arguments(tool);
        let is_restored =
            arguments.iter().all(|(key, value)| now.get(key).and_then(Value::as_f64) == value.as_f64());
        if is_restored {
            ActionTarget::Group(group)
        } else {
            ActionTarget::Call(tool, Value::Object(arguments))
        }
    }
}
