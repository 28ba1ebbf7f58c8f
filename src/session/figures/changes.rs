//! Differences between two states of the settings.

use serde::ser::SerializeStruct;
use serde::{Deserialize, Serialize, Serializer};

use super::setting::{SettingId, setting_values};
use novamind_world::settings::Settings;

/// A setting that differs between two states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SettingChange {
    /// Setting that changed.
    pub setting: SettingId,
    /// Value before the change.
    pub old: f64,
    /// Value after the change.
    pub new: f64,
}

/// Serializes the change for programs, with the tool and unit of the setting.
impl Serialize for SettingChange {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut fields = serializer.serialize_struct("Change", 5)?;
        fields.serialize_field("tool", &self.setting.tool())?;
        fields.serialize_field("setting", &self.setting.to_string())?;
        fields.serialize_field("old", &self.old)?;
        fields.serialize_field("new", &self.new)?;
        fields.serialize_field("unit", self.setting.unit().unwrap_or("tier"))?;
        fields.end()
    }
}

/// The player's decisions between two weeks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Decisions {
    /// Day on which the decisions were made.
    pub day: u32,
    /// Last day that was simulated after the decisions.
    pub until: u32,
    /// Changed settings.
    #[serde(with = "kept")]
    pub changes: Vec<SettingChange>,
    /// Descriptions of purchases, posts and offers.
    pub purchases: Vec<String>,
}

/// Serialization of changes in snapshots.
mod kept {
    use serde::{Deserialize, Deserializer, Serializer};

    use super::{SettingChange, SettingId};

    pub fn serialize<S: Serializer>(changes: &[SettingChange], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(changes.iter().map(|change| (change.setting, change.old, change.new)))
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<SettingChange>, D::Error> {
        let kept = Vec::<(SettingId, f64, f64)>::deserialize(deserializer)?;
        Ok(kept.into_iter().map(|(setting, old, new)| SettingChange { setting, old, new }).collect())
    }
}

/// Returns the changed settings, in the order of the tools. A setting that is missing in one of the states has value 0
/// in that state.
pub fn setting_changes(old: &Settings, new: &Settings) -> Vec<SettingChange> {
    let (before, after) = (setting_values(old), setting_values(new));
    let value_in = |list: &[(SettingId, f64)], wanted: SettingId| {
        list.iter().find(|(setting, _)| *setting == wanted).map(|(_, value)| *value)
    };
    let gone = before.iter().filter(|(setting, _)| value_in(&after, *setting).is_none());
    let mut found: Vec<SettingChange> = Vec::new();
    for (setting, _) in after.iter().chain(gone) {
        let old = value_in(&before, *setting).unwrap_or(0.0);
        let new = value_in(&after, *setting).unwrap_or(0.0);
        if old != new {
            found.push(SettingChange { setting: *setting, old, new });
        }
    }
    found
}

/// Returns the running costs that depend only on settings, in dollars per day.
pub fn daily_cost(settings: &Settings, capacity_cost: f64) -> f64 {
    capacity_cost
        + settings.core.operations
        + settings.core.development
        + settings.targeted_ads.total()
        + settings.targeted_operations.total()
        + settings.targeted_development.total()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use novamind_world::identifiers::{Channel, Group, Plan};
    use novamind_world::params::Params;

    #[test]
    fn setting_changes_list_differences_in_both_directions() {
        let params = Params::bundled();
        let old = Settings::initial(&params);
        let mut new = old.clone();
        new.core.prices[Plan::B] = 25.0;
        let s1 = Group::at(0).expect("S1");
        new.targeted_ads.targeted_spend.insert(Channel::Linkedin, [(s1, 40.0)].into_iter().collect());
        let there = setting_changes(&old, &new);
        let as_text = |list: &[SettingChange]| -> Vec<String> {
            list.iter().map(|change| format!("{} {} -> {}", change.setting, change.old, change.new)).collect()
        };
        assert_eq!(as_text(&there), ["price B 0 -> 25", "ads linkedin S1 0 -> 40"]);
        assert_eq!(as_text(&setting_changes(&new, &old)), ["price B 25 -> 0", "ads linkedin S1 40 -> 0"]);
        assert!(setting_changes(&new, &new).is_empty());
        let value =
            json!({"tool": "set_prices", "setting": "price B", "old": 0.0, "new": 25.0, "unit": "$/month"});
        assert_eq!(json!(there[0]), value);
        let decided = Decisions { day: 0, until: 7, changes: there, purchases: Vec::new() };
        let kept = serde_json::to_string(&decided).expect("text");
        assert_eq!(serde_json::from_str::<Decisions>(&kept).expect("the stored decisions"), decided);
        assert_eq!(daily_cost(&new, 85.0), 125.0);
    }
}
