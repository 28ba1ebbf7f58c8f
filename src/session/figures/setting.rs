//! Identifiers and names of settings.

use std::fmt::{self, Display, Formatter};

use serde::{Deserialize, Serialize};

use novamind_tools::ToolId;
use novamind_world::identifiers::{Channel, Group, Plan};
use novamind_world::settings::Settings;

/// A setting of the company, with the plan, group or customers to which it applies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum SettingId {
    /// List price of a plan, dollars per month.
    Price(Plan),
    /// Model tier of a plan.
    ModelTier(Plan),
    /// Quota of a plan, units per day.
    Quota(Plan),
    /// Operations spending, dollars per day.
    Operations,
    /// Development spending, dollars per day.
    Development,
    /// Capacity tier of the company.
    CapacityTier,
    /// Advertising budget of a channel for a group, dollars per day.
    Advertising(Channel, Group),
    /// Development spending for a group, dollars per day.
    TargetedDevelopment(Group),
    /// Operations spending for the open issues of an audience, dollars per day.
    TargetedOperations(Audience),
    /// Ongoing discount for an audience, dollars per month.
    Discount(Audience),
    /// Discount for new leads of an audience, dollars per month.
    LeadDiscount(Audience),
    /// Strength of in-app advertising for an audience, 0 to 1.
    AdsStrength(Audience),
}

/// The customers to which a setting applies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Audience {
    /// All customers.
    Everybody,
    /// All customers of a group.
    Group(Group),
    /// All subscribers of a plan.
    Plan(Plan),
    /// Subscribers to a plan who belong to a group.
    GroupPlan(Group, Plan),
    /// A single customer.
    Customer(i64),
    /// Leads that arrive through a channel.
    Channel(Channel),
    /// Leads of a group that arrive through a channel.
    ChannelGroup(Channel, Group),
}

impl SettingId {
    /// Returns the tool that changes the setting.
    pub fn tool(self) -> ToolId {
        match self {
            SettingId::Price(_) => ToolId::SetPrices,
            SettingId::ModelTier(_) => ToolId::SetModelTiers,
            SettingId::Quota(_) => ToolId::SetUsageQuotas,
            SettingId::Operations | SettingId::Development => ToolId::SetDailySpend,
            SettingId::CapacityTier => ToolId::SetCapacityTier,
            SettingId::Advertising(..) => ToolId::SetTargetedAdSpend,
            SettingId::TargetedDevelopment(_) => ToolId::SetTargetedDevSpend,
            SettingId::TargetedOperations(_) => ToolId::SetTargetedOpsSpend,
            SettingId::Discount(_) => ToolId::SetPromotion,
            SettingId::LeadDiscount(_) => ToolId::SetLeadPromotion,
            SettingId::AdsStrength(_) => ToolId::SetAdsStrength,
        }
    }

    /// Returns the unit of the setting, or `None` if the name of the setting implies the unit.
    pub fn unit(self) -> Option<&'static str> {
        match self {
            SettingId::ModelTier(_) | SettingId::CapacityTier => None,
            SettingId::Price(_) | SettingId::Discount(_) | SettingId::LeadDiscount(_) => Some("$/month"),
            SettingId::Quota(_) => Some("units/day"),
            SettingId::AdsStrength(_) => Some("strength"),
            SettingId::Operations
            | SettingId::Development
            | SettingId::Advertising(..)
            | SettingId::TargetedDevelopment(_)
            | SettingId::TargetedOperations(_) => Some("$/day"),
        }
    }

    /// Returns the two parts of the setting's name: family and member, for example `ads linkedin` and `E1`. The member
    /// is empty if the setting applies to all customers.
    pub fn name_parts(self) -> (String, String) {
        let of = |family: &str, member: String| (family.to_owned(), member.trim_start().to_owned());
        match self {
            SettingId::Price(plan) => of("price", plan.to_string()),
            SettingId::ModelTier(plan) => of("model tier", plan.to_string()),
            SettingId::Quota(plan) => of("quota", plan.to_string()),
            SettingId::Operations => of("operations", String::new()),
            SettingId::Development => of("development", String::new()),
            SettingId::CapacityTier => of("capacity tier", String::new()),
            SettingId::Advertising(channel, group) => of(&format!("ads {channel}"), group.to_string()),
            SettingId::TargetedDevelopment(group) => of("development", group.to_string()),
            SettingId::TargetedOperations(audience) => of("operations", audience.to_string()),
            SettingId::Discount(audience) => of("discount", audience.to_string()),
            SettingId::LeadDiscount(audience) => of("lead discount", audience.to_string()),
            SettingId::AdsStrength(audience) => of("in-app ads", audience.to_string()),
        }
    }

    /// Returns the plan to which the setting belongs if the setting is a price, model tier or quota, and `None`
    /// otherwise.
    pub fn plan(self) -> Option<Plan> {
        match self {
            SettingId::Price(plan) | SettingId::ModelTier(plan) | SettingId::Quota(plan) => Some(plan),
            _ => None,
        }
    }
}

/// Formats the name of the setting, for example `price A` or `ads linkedin E1`.
impl Display for SettingId {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        let (family, member) = self.name_parts();
        out.write_str(&family)?;
        if member.is_empty() { Ok(()) } else { write!(out, " {member}") }
    }
}

/// Formats the suffix of a setting's name that identifies the audience. The suffix is empty for all customers.
impl Display for Audience {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Audience::Everybody => Ok(()),
            Audience::Group(group) => write!(out, " {group}"),
            Audience::Plan(plan) => write!(out, " plan {plan}"),
            Audience::GroupPlan(group, plan) => write!(out, " {group} {plan}"),
            Audience::Customer(number) => write!(out, " customer {number}"),
            Audience::Channel(channel) => write!(out, " {channel}"),
            Audience::ChannelGroup(channel, group) => write!(out, " {channel} {group}"),
        }
    }
}

/// Returns all settings with their values, in the order of the tools.
pub fn setting_values(settings: &Settings) -> Vec<(SettingId, f64)> {
    let core = &settings.core;
    let mut all: Vec<(SettingId, f64)> = Vec::new();
    all.extend(Plan::ALL.map(|plan| (SettingId::Price(plan), core.prices[plan])));
    all.extend(Plan::ALL.map(|plan| (SettingId::ModelTier(plan), f64::from(core.tiers[plan]))));
    all.extend(Plan::ALL.map(|plan| (SettingId::Quota(plan), core.quotas[plan].units())));
    all.push((SettingId::Operations, core.operations));
    all.push((SettingId::Development, core.development));
    all.push((SettingId::CapacityTier, f64::from(core.capacity_tier)));
    for (channel, groups) in &settings.targeted_ads.targeted_spend {
        all.extend(groups.iter().map(|(group, spend)| (SettingId::Advertising(*channel, *group), *spend)));
    }
    let development = settings.targeted_development.targeted_spend.iter();
    all.extend(development.map(|(group, spend)| (SettingId::TargetedDevelopment(*group), *spend)));
    all.extend(
        operations_by_audience(settings)
            .map(|(audience, spend)| (SettingId::TargetedOperations(audience), spend)),
    );
    all.extend(
        discounts_by_audience(settings).map(|(audience, dollars)| (SettingId::Discount(audience), dollars)),
    );
    all.extend(
        lead_discounts_by_audience(settings)
            .map(|(audience, dollars)| (SettingId::LeadDiscount(audience), dollars)),
    );
    all.extend(
        ads_strength_by_audience(settings)
            .map(|(audience, strength)| (SettingId::AdsStrength(audience), strength)),
    );
    all
}

fn operations_by_audience(settings: &Settings) -> impl Iterator<Item = (Audience, f64)> {
    let targeted_operations = &settings.targeted_operations;
    let groups = targeted_operations.by_group.iter().map(|(group, value)| (Audience::Group(*group), *value));
    let plans = targeted_operations.by_plan.iter().map(|(plan, value)| (Audience::Plan(*plan), *value));
    let both = targeted_operations.by_group_plan.iter().flat_map(|(group, plans)| {
        plans.iter().map(|(plan, value)| (Audience::GroupPlan(*group, *plan), *value))
    });
    let customers = targeted_operations
        .by_customer
        .iter()
        .map(|(customer, value)| (Audience::Customer(*customer), *value));
    groups.chain(plans).chain(both).chain(customers)
}

fn discounts_by_audience(settings: &Settings) -> impl Iterator<Item = (Audience, f64)> {
    let promotion = &settings.promotion;
    let everybody = std::iter::once((Audience::Everybody, promotion.global));
    let groups = promotion.by_group.iter().map(|(group, value)| (Audience::Group(*group), *value));
    let customers =
        promotion.by_customer.iter().map(|(customer, value)| (Audience::Customer(*customer), *value));
    let both = promotion.by_group_plan.iter().flat_map(|(group, plans)| {
        plans.iter().map(|(plan, value)| (Audience::GroupPlan(*group, *plan), *value))
    });
    everybody.chain(groups).chain(customers).chain(both)
}

fn lead_discounts_by_audience(settings: &Settings) -> impl Iterator<Item = (Audience, f64)> {
    let lead_promotion = &settings.lead_promotion;
    let everybody = std::iter::once((Audience::Everybody, lead_promotion.global));
    let groups = lead_promotion.by_group.iter().map(|(group, value)| (Audience::Group(*group), *value));
    let channels =
        lead_promotion.by_channel.iter().map(|(channel, value)| (Audience::Channel(*channel), *value));
    let both = lead_promotion.by_channel_group.iter().flat_map(|(channel, groups)| {
        groups.iter().map(|(group, value)| (Audience::ChannelGroup(*channel, *group), *value))
    });
    everybody.chain(groups).chain(channels).chain(both)
}

fn ads_strength_by_audience(settings: &Settings) -> impl Iterator<Item = (Audience, f64)> {
    let ads_strength = &settings.ads_strength;
    let everybody = std::iter::once((Audience::Everybody, ads_strength.global));
    let groups = ads_strength.by_group.iter().map(|(group, value)| (Audience::Group(*group), *value));
    let customers =
        ads_strength.by_customer.iter().map(|(customer, value)| (Audience::Customer(*customer), *value));
    everybody.chain(groups).chain(customers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn setting_names_include_the_audience() {
        let e1: Group = Group::parse("E1").expect("a group");
        let named = [
            (SettingId::Price(Plan::A), "price A"),
            (SettingId::Operations, "operations"),
            (SettingId::TargetedOperations(Audience::Plan(Plan::A)), "operations plan A"),
            (SettingId::TargetedOperations(Audience::GroupPlan(e1, Plan::A)), "operations E1 A"),
            (SettingId::Advertising(Channel::Linkedin, e1), "ads linkedin E1"),
            (SettingId::Discount(Audience::Everybody), "discount"),
            (SettingId::Discount(Audience::Customer(7)), "discount customer 7"),
            (
                SettingId::LeadDiscount(Audience::ChannelGroup(Channel::Linkedin, e1)),
                "lead discount linkedin E1",
            ),
            (SettingId::AdsStrength(Audience::Group(e1)), "in-app ads E1"),
        ];
        for (setting, name) in named {
            assert_eq!(setting.to_string(), name);
        }
    }
}
