//! Settings as a list of numbers, so that two states can be compared: old -> new.

use serde::{Deserialize, Serialize};

use crate::notation::{Word, word};
use crate::world::identifiers::{Channel, Group, Plan};
use crate::world::settings::Settings;

/// A setting that differs between two states.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// Tool that sets it.
    #[serde(deserialize_with = "word")]
    pub tool: Word,
    /// Which one, for instance `price A` or `ads linkedin E1`.
    pub setting: String,
    /// Value before.
    pub old: f64,
    /// Value after.
    pub new: f64,
    /// Unit of both.
    #[serde(deserialize_with = "word")]
    pub unit: Word,
}

/// What was decided between two weeks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Decisions {
    /// Decision day.
    pub day: u32,
    /// Last day of the days that ran after it.
    pub until: u32,
    /// Settings that differ from those of the days before.
    pub changes: Vec<Change>,
    /// Purchases, posts and offers, in words.
    pub purchases: Vec<String>,
}

/// One setting of a state.
struct Item {
    tool: &'static str,
    setting: String,
    value: f64,
    unit: &'static str,
}

/// What differs, in the order of the tools; settings that exist in one state only count as 0 in the other.
pub fn changes(old: &Settings, new: &Settings) -> Vec<Change> {
    let (before, after) = (items(old), items(new));
    let value_in = |list: &[Item], wanted: &Item| {
        list.iter()
            .find(|item| item.tool == wanted.tool && item.setting == wanted.setting)
            .map(|item| item.value)
    };
    let mut found: Vec<Change> = Vec::new();
    for item in after.iter().chain(before.iter().filter(|item| value_in(&after, item).is_none())) {
        let (old, new) = (value_in(&before, item).unwrap_or(0.0), value_in(&after, item).unwrap_or(0.0));
        if old != new {
            found.push(Change { tool: item.tool, setting: item.setting.clone(), old, new, unit: item.unit });
        }
    }
    found
}

/// Running costs that follow from settings alone, dollars a day.
pub fn daily_cost(settings: &Settings, capacity_cost: f64) -> f64 {
    capacity_cost
        + settings.core.operations
        + settings.core.development
        + settings.targeted_ads.total()
        + settings.targeted_operations.total()
        + settings.targeted_development.total()
}

fn items(settings: &Settings) -> Vec<Item> {
    let mut list = Vec::new();
    let mut add = |tool, setting: String, value: f64, unit| list.push(Item { tool, setting, value, unit });
    let core = &settings.core;
    for plan in Plan::ALL {
        add("set_prices", format!("price {plan}"), core.prices[plan], "$/month");
    }
    for plan in Plan::ALL {
        add("set_model_tiers", format!("model tier {plan}"), f64::from(core.tiers[plan]), "tier");
    }
    for plan in Plan::ALL {
        add("set_usage_quotas", format!("quota {plan}"), core.quotas[plan].units(), "units/day");
    }
    add("set_daily_spend", "operations".to_owned(), core.operations, "$/day");
    add("set_daily_spend", "development".to_owned(), core.development, "$/day");
    add("set_capacity_tier", "capacity tier".to_owned(), f64::from(core.capacity_tier), "tier");
    for (channel, groups) in &settings.targeted_ads.targeted_spend {
        for (group, spend) in groups {
            add("set_targeted_ad_spend", format!("ads {channel} {group}"), *spend, "$/day");
        }
    }
    for (group, spend) in &settings.targeted_development.targeted_spend {
        add("set_targeted_dev_spend", format!("development {group}"), *spend, "$/day");
    }
    scoped_items(settings, &mut add);
    list
}

fn scoped_items(settings: &Settings, add: &mut impl FnMut(&'static str, String, f64, &'static str)) {
    let operations = &settings.targeted_operations;
    let tool = "set_targeted_ops_spend";
    operations
        .by_group
        .iter()
        .for_each(|(group, value)| add(tool, format!("operations {group}"), *value, "$/day"));
    operations
        .by_plan
        .iter()
        .for_each(|(plan, value)| add(tool, format!("operations plan {plan}"), *value, "$/day"));
    for (group, plans) in &operations.by_group_plan {
        plans
            .iter()
            .for_each(|(plan, value)| add(tool, format!("operations {group} {plan}"), *value, "$/day"));
    }
    for (customer, value) in &operations.by_customer {
        add(tool, format!("operations customer {customer}"), *value, "$/day");
    }
    let promotion = &settings.promotion;
    let tool = "set_promotion";
    add(tool, "discount".to_owned(), promotion.global, "$/month");
    promotion
        .by_group
        .iter()
        .for_each(|(group, value)| add(tool, format!("discount {group}"), *value, "$/month"));
    for (customer, value) in &promotion.by_customer {
        add(tool, format!("discount customer {customer}"), *value, "$/month");
    }
    for (group, plans) in &promotion.by_group_plan {
        plans
            .iter()
            .for_each(|(plan, value)| add(tool, format!("discount {group} {plan}"), *value, "$/month"));
    }
    let lead = &settings.lead_promotion;
    let tool = "set_lead_promotion";
    add(tool, "lead discount".to_owned(), lead.global, "$/month");
    lead.by_group
        .iter()
        .for_each(|(group, value)| add(tool, format!("lead discount {group}"), *value, "$/month"));
    lead.by_channel
        .iter()
        .for_each(|(channel, value)| add(tool, format!("lead discount {channel}"), *value, "$/month"));
    for (channel, groups) in &lead.by_channel_group {
        let label = |channel: &Channel, group: &Group| format!("lead discount {channel} {group}");
        groups.iter().for_each(|(group, value)| add(tool, label(channel, group), *value, "$/month"));
    }
    let ads = &settings.ads_strength;
    let tool = "set_ads_strength";
    add(tool, "in-app ads".to_owned(), ads.global, "load");
    ads.by_group.iter().for_each(|(group, value)| add(tool, format!("in-app ads {group}"), *value, "load"));
    for (customer, value) in &ads.by_customer {
        add(tool, format!("in-app ads customer {customer}"), *value, "load");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::params::Params;

    #[test]
    fn changes_name_what_differs_in_both_directions() {
        let params = Params::shipped();
        let old = Settings::opening(&params);
        let mut new = old.clone();
        new.core.prices[Plan::B] = 25.0;
        let s1 = Group::at(0).expect("S1");
        new.targeted_ads.targeted_spend.insert(Channel::Linkedin, [(s1, 40.0)].into_iter().collect());
        let there = changes(&old, &new);
        let as_text = |list: &[Change]| -> Vec<String> {
            list.iter().map(|change| format!("{} {} -> {}", change.setting, change.old, change.new)).collect()
        };
        assert_eq!(as_text(&there), ["price B 0 -> 25", "ads linkedin S1 0 -> 40"]);
        assert_eq!(as_text(&changes(&new, &old)), ["price B 25 -> 0", "ads linkedin S1 40 -> 0"]);
        assert!(changes(&new, &new).is_empty());
        assert_eq!(daily_cost(&new, 85.0), 125.0);
    }
}
