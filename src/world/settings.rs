//! The player's settings (`docs/interfaces/tools.md`).
//!
//! A setting that is made on a decision day takes effect on the next day and stays in force until it is changed. The
//! world stores only current values; tables store the history.

use indexmap::IndexMap;
use serde::Serialize;

use super::canonical::{Canonical, CanonicalHasher, CanonicalReader, Restore, canonical};
use super::identifiers::{ByPlan, Channel, Group, Plan};
use super::params::Params;
use super::quota::Quota;

/// Dollars or strength for each group, in the order in which the player listed the groups.
pub type PerGroup = IndexMap<Group, f64>;
/// Dollars for each plan.
pub type PerPlan = IndexMap<Plan, f64>;
/// Dollars or strength for each customer number. Unassigned numbers are allowed and have no effect.
pub type PerCustomer = IndexMap<i64, f64>;

/// All current settings of the player.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Prices, tiers, quotas, daily spending and capacity, which are one row of `config_history`.
    pub core: CoreSettings,
    /// Ongoing discounts for subscribers.
    pub promotion: Promotion,
    /// First-bill discounts for new leads.
    pub lead_promotion: LeadPromotion,
    /// Strength of in-app advertising.
    pub ads_strength: AdsStrength,
    /// Advertising budgets, dollars per day.
    pub targeted_ads: TargetedAds,
    /// Targeted operations, dollars per day.
    pub targeted_operations: TargetedOperations,
    /// Targeted development, dollars per day.
    pub targeted_development: TargetedDevelopment,
}

/// The settings that `config_history` records.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoreSettings {
    /// List prices, dollars per month.
    pub prices: ByPlan<f64>,
    /// Model tier of each plan, 1..=5.
    pub tiers: ByPlan<u8>,
    /// Quotas, units per customer per day.
    pub quotas: ByPlan<Quota>,
    /// General spending on operations, dollars per day.
    pub operations: f64,
    /// Spending on general development, dollars per day.
    pub development: f64,
    /// Rented capacity tier, 0..=7.
    pub capacity_tier: u8,
}

/// Ongoing discounts, dollars per seat per month. The discounts of all scopes are added, with a minimum of 0.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Promotion {
    /// Discount for all subscribers.
    pub global: f64,
    /// Discounts for the subscribers of each group.
    pub by_group: PerGroup,
    /// Discounts for individual customers.
    pub by_customer: PerCustomer,
    /// Discounts for the subscribers of a group on a plan.
    pub by_group_plan: IndexMap<Group, PerPlan>,
}

/// Discounts for a lead's choice and first bill, dollars per month. The discounts of all scopes are added, with a
/// minimum of 0.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct LeadPromotion {
    /// Discount for every lead.
    pub global: f64,
    /// Discounts for the leads of each group.
    pub by_group: PerGroup,
    /// Discounts for the leads of each advertising channel.
    pub by_channel: IndexMap<Channel, f64>,
    /// Discounts for the leads of a group that arrive through a channel.
    pub by_channel_group: IndexMap<Channel, PerGroup>,
}

/// Strengths of in-app advertising, each 0..=1. The strengths of all scopes are added and clamped.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct AdsStrength {
    /// Strength for all subscribers.
    pub global: f64,
    /// Strengths for the subscribers of each group.
    pub by_group: PerGroup,
    /// Strengths for individual customers.
    pub by_customer: PerCustomer,
}

/// Advertising budgets by channel and group, dollars per day.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct TargetedAds {
    /// Budget for each channel and group.
    pub targeted_spend: IndexMap<Channel, PerGroup>,
}

/// Operations budgets for parts of the open issues, dollars per day. Each budget is a separate support pool.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct TargetedOperations {
    /// Budgets for the issues of each group.
    pub by_group: PerGroup,
    /// Budgets for the issues of each plan.
    pub by_plan: PerPlan,
    /// Budgets for the issues of a group on a plan.
    pub by_group_plan: IndexMap<Group, PerPlan>,
    /// Budgets for the issues of individual customers.
    pub by_customer: PerCustomer,
}

/// Development targeted at groups, dollars per day.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct TargetedDevelopment {
    /// Development budget for each group.
    pub targeted_spend: PerGroup,
}

canonical! {
    Settings { core, promotion, lead_promotion, ads_strength, targeted_ads, targeted_operations, targeted_development }
    CoreSettings { prices, tiers, quotas, operations, development, capacity_tier }
    Promotion { global, by_group, by_customer, by_group_plan }
    LeadPromotion { global, by_group, by_channel, by_channel_group }
    AdsStrength { global, by_group, by_customer }
    TargetedAds { targeted_spend }
    TargetedOperations { by_group, by_plan, by_group_plan, by_customer }
    TargetedDevelopment { targeted_spend }
}

fn value_or_zero<K: std::hash::Hash + Eq>(map: &IndexMap<K, f64>, key: &K) -> f64 {
    map.get(key).copied().unwrap_or(0.0)
}

fn total<K>(map: &IndexMap<K, f64>) -> f64 {
    map.values().sum()
}

fn initial_quotas(params: &Params) -> ByPlan<Quota> {
    let initial = &params.initial;
    let units = [initial.default_quota_a, initial.default_quota_b, initial.default_quota_c];
    ByPlan(units.map(|units| Quota::from_units(units as f64).unwrap_or_default()))
}

impl Settings {
    /// Returns the settings on day 0.
    pub fn initial(params: &Params) -> Settings {
        let initial = &params.initial;
        let core = CoreSettings {
            prices: ByPlan([initial.default_price_a, initial.default_price_b, initial.default_price_c]),
            tiers: ByPlan([initial.default_tier_a, initial.default_tier_b, initial.default_tier_c]),
            quotas: initial_quotas(params),
            operations: initial.default_spend_operations,
            development: initial.default_spend_development,
            capacity_tier: initial.default_capacity_tier,
        };
        Settings {
            core,
            promotion: Promotion::default(),
            lead_promotion: LeadPromotion::default(),
            ads_strength: AdsStrength::default(),
            targeted_ads: TargetedAds::default(),
            targeted_operations: TargetedOperations::default(),
            targeted_development: TargetedDevelopment::default(),
        }
    }
}

impl Settings {
    /// Returns the largest discount of any scope, dollars per month.
    pub fn largest_discount(&self) -> f64 {
        let ongoing = &self.promotion;
        let first_bill_discounts = &self.lead_promotion;
        let largest = |map: &mut dyn Iterator<Item = &f64>| map.copied().fold(0.0, f64::max);
        [
            ongoing.global,
            first_bill_discounts.global,
            largest(&mut ongoing.by_group.values()),
            largest(&mut ongoing.by_customer.values()),
            largest(&mut ongoing.by_group_plan.values().flat_map(IndexMap::values)),
            largest(&mut first_bill_discounts.by_group.values()),
            largest(&mut first_bill_discounts.by_channel.values()),
            largest(&mut first_bill_discounts.by_channel_group.values().flat_map(IndexMap::values)),
        ]
        .into_iter()
        .fold(0.0, f64::max)
    }

    /// Replaces a family of settings.
    pub fn apply(&mut self, change: SettingsChange) {
        match change {
            SettingsChange::Core(value) => self.core = value,
            SettingsChange::Promotion(value) => self.promotion = value,
            SettingsChange::LeadPromotion(value) => self.lead_promotion = value,
            SettingsChange::AdsStrength(value) => self.ads_strength = value,
            SettingsChange::TargetedAds(value) => self.targeted_ads = value,
            SettingsChange::TargetedOperations(value) => self.targeted_operations = value,
            SettingsChange::TargetedDevelopment(value) => self.targeted_development = value,
        }
    }
}

impl Promotion {
    /// Returns the sum of all discounts for a customer on a plan, P(i, g, p), before the minimum of 0 is applied.
    pub fn sum(&self, customer: u32, group: Group, plan: Plan) -> f64 {
        self.global
            + value_or_zero(&self.by_group, &group)
            + value_or_zero(&self.by_customer, &i64::from(customer))
            + self.by_group_plan.get(&group).map_or(0.0, |plans| value_or_zero(plans, &plan))
    }
}

impl LeadPromotion {
    /// Returns the sum of all discounts for a lead, LP(g, ch), before the minimum of 0 is applied. If there is no
    /// channel, channel discounts do not count.
    pub fn sum(&self, group: Group, channel: Option<Channel>) -> f64 {
        let by_channel = channel.map_or(0.0, |channel| {
            value_or_zero(&self.by_channel, &channel)
                + self.by_channel_group.get(&channel).map_or(0.0, |groups| value_or_zero(groups, &group))
        });
        self.global + value_or_zero(&self.by_group, &group) + by_channel
    }
}

impl AdsStrength {
    /// Returns the strength in decisions and negotiations: global + group, not clamped.
    pub fn for_group(&self, group: Group) -> f64 {
        self.global + value_or_zero(&self.by_group, &group)
    }

    /// Returns the additional strength for a customer.
    pub fn for_customer(&self, customer: u32) -> f64 {
        value_or_zero(&self.by_customer, &i64::from(customer))
    }

    /// Returns whether any customer can see ads.
    pub fn is_used(&self) -> bool {
        self.global > 0.0 || !self.by_group.is_empty() || !self.by_customer.is_empty()
    }
}

impl TargetedAds {
    /// Returns the advertising budget for a channel and group, dollars per day.
    pub fn spend(&self, channel: Channel, group: Group) -> f64 {
        self.targeted_spend.get(&channel).map_or(0.0, |groups| value_or_zero(groups, &group))
    }

    /// Returns the sum of all advertising budgets, dollars per day.
    pub fn total(&self) -> f64 {
        self.targeted_spend.values().map(total).sum()
    }
}

impl TargetedOperations {
    /// Returns the sum of all operations budgets, dollars per day.
    pub fn total(&self) -> f64 {
        total(&self.by_group)
            + total(&self.by_plan)
            + self.by_group_plan.values().map(total).sum::<f64>()
            + total(&self.by_customer)
    }
}

impl TargetedDevelopment {
    /// Returns the sum of all development budgets, dollars per day.
    pub fn total(&self) -> f64 {
        total(&self.targeted_spend)
    }
}

/// The new values of a family of settings.
#[derive(Debug, Clone, PartialEq)]
pub enum SettingsChange {
    /// Core settings, which are a row of `config_history`.
    Core(CoreSettings),
    /// Ongoing discounts for subscribers.
    Promotion(Promotion),
    /// First-bill discounts for new leads.
    LeadPromotion(LeadPromotion),
    /// Strength of in-app advertising.
    AdsStrength(AdsStrength),
    /// Advertising budgets by channel and group.
    TargetedAds(TargetedAds),
    /// Budgets for targeted operations.
    TargetedOperations(TargetedOperations),
    /// Budgets for targeted development.
    TargetedDevelopment(TargetedDevelopment),
}

impl SettingsChange {
    /// Returns the family as JSON with the field names of `config_overrides.settings_json`, or `None` for the core
    /// settings, which have a separate table.
    pub fn family_json(&self) -> Option<serde_json::Value> {
        let value = match self {
            SettingsChange::Core(_) => return None,
            SettingsChange::Promotion(value) => serde_json::to_value(value),
            SettingsChange::LeadPromotion(value) => serde_json::to_value(value),
            SettingsChange::AdsStrength(value) => serde_json::to_value(value),
            SettingsChange::TargetedAds(value) => serde_json::to_value(value),
            SettingsChange::TargetedOperations(value) => serde_json::to_value(value),
            SettingsChange::TargetedDevelopment(value) => serde_json::to_value(value),
        };
        Some(value.expect("settings have text keys and finite numbers"))
    }
}

impl Canonical for SettingsChange {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        match self {
            SettingsChange::Core(value) => (0u8, *value).feed(hasher),
            SettingsChange::Promotion(value) => (1u8, value.clone()).feed(hasher),
            SettingsChange::LeadPromotion(value) => (2u8, value.clone()).feed(hasher),
            SettingsChange::AdsStrength(value) => (3u8, value.clone()).feed(hasher),
            SettingsChange::TargetedAds(value) => (4u8, value.clone()).feed(hasher),
            SettingsChange::TargetedOperations(value) => (5u8, value.clone()).feed(hasher),
            SettingsChange::TargetedDevelopment(value) => (6u8, value.clone()).feed(hasher),
        }
    }
}

impl Restore for SettingsChange {
    fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
        Some(match reader.read::<u8>()? {
            0 => SettingsChange::Core(reader.read()?),
            1 => SettingsChange::Promotion(reader.read()?),
            2 => SettingsChange::LeadPromotion(reader.read()?),
            3 => SettingsChange::AdsStrength(reader.read()?),
            4 => SettingsChange::TargetedAds(reader.read()?),
            5 => SettingsChange::TargetedOperations(reader.read()?),
            6 => SettingsChange::TargetedDevelopment(reader.read()?),
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn group(id: &str) -> Group {
        Group::parse(id).expect("a group")
    }

    #[test]
    fn promotion_sum_adds_all_scopes() {
        let promotion = Promotion {
            global: 5.0,
            by_group: PerGroup::from([(group("S1"), 2.0)]),
            by_customer: PerCustomer::from([(7, 1.5)]),
            by_group_plan: IndexMap::from([(group("S1"), PerPlan::from([(Plan::A, 3.0)]))]),
        };
        for (customer, id, plan, expected) in [
            (1, "E1", Plan::A, 5.0),
            (1, "S1", Plan::B, 7.0),
            (1, "S1", Plan::A, 10.0),
            (7, "S1", Plan::A, 11.5),
            (7, "E1", Plan::C, 6.5),
        ] {
            assert_eq!(promotion.sum(customer, group(id), plan), expected);
        }
    }

    #[test]
    fn lead_promotion_sum_adds_all_scopes() {
        let promotion = LeadPromotion {
            global: 4.0,
            by_group: PerGroup::from([(group("S1"), 1.0)]),
            by_channel: IndexMap::from([(Channel::Linkedin, 2.0)]),
            by_channel_group: IndexMap::from([(
                Channel::Linkedin,
                PerGroup::from([(group("S1"), 0.5), (group("E1"), 15.0)]),
            )]),
        };
        for (id, channel, expected) in [
            ("S1", None, 5.0),
            ("S1", Some(Channel::Linkedin), 7.5),
            ("E1", Some(Channel::Linkedin), 21.0),
            ("S2", Some(Channel::Linkedin), 6.0),
            ("S2", Some(Channel::SearchAds), 4.0),
            ("E1", None, 4.0),
        ] {
            assert_eq!(promotion.sum(group(id), channel), expected);
        }
    }
}
