//! Parameters of customers: `configs/world/customers.toml`.

use serde::{Deserialize, Serialize};

use super::check::parameters;

parameters! {
    /// The participation curve (docs/mechanics/customers/participation.md).
    pub struct Participation {
        /// Steepness of both halves of the curve.
        pub curve_gain: f64,
        /// Price / budget at the center of the lower half.
        pub curve_left_center: f64,
        /// Price / budget at the center of the upper half.
        pub curve_right_center: f64,
        /// Price / budget where the halves meet.
        pub curve_split: f64 where 0.0..=1.0,
        /// Each half spans the quality range divided by this.
        pub curve_half_divisor: f64 where 1.0..=100.0,
        /// Weight of the lower sigmoid in the blended form, 0..=1.
        pub blend_weight: f64 where 0.0..=1.0,
        /// Lower clamp of the logistic argument.
        pub sigmoid_input_min: f64,
        /// Upper clamp of the logistic argument.
        pub sigmoid_input_max: f64,
        /// A lead prefers a plan only with a surplus above this.
        pub lead_min_satisfaction_exclusive: f64,
    }

    /// Bounds of the traits a new customer draws (docs/mechanics/customers/generation.md).
    pub struct CustomerGeneration {
        /// Mean of the exponential part of the lower steepness.
        pub steepness_left_exp_scale: f64 where 0.0..=1e6,
        /// Offset added to the exponential part.
        pub steepness_left_offset: f64 where 0.0..=1e6,
        /// Lower bound.
        pub steepness_left_min: f64 where 0.0..=1e6,
        /// Upper bound.
        pub steepness_left_max: f64 where 0.0..=1e6,
        /// Mean of the exponential part of the upper steepness.
        pub steepness_right_exp_scale: f64 where 0.0..=1e6,
        /// Offset added to the exponential part.
        pub steepness_right_offset: f64 where 0.0..=1e6,
        /// Lower bound.
        pub steepness_right_min: f64 where 0.0..=1e6,
        /// Upper bound.
        pub steepness_right_max: f64 where 0.0..=1e6,
        /// Factor on the standard deviation of a group's budgets.
        pub c_max_std_multiplier: f64 where 0.0..=1e6,
        /// Minimum budget before and after drift, dollars a month.
        pub c_max_min: f64 where 0.0..=1e6,
        /// Lower bound of the minimum quality, before drift.
        pub q_min_min: f64 where 0.0..=1e6,
        /// Minimum width of the quality band.
        pub q_range_min: f64 where 0.0..=1e6,
        /// Minimum demand, units a day and seat.
        pub usage_demand_min: f64 where 0.0..=1e6,
        /// Minimum mean reply delay of an enterprise, in days.
        pub reply_delay_mean_min: f64 where 0.0..=1e6,
        /// Its standard deviation as a share of the group's standard deviation.
        pub reply_delay_mean_noise_std_factor: f64 where 0.0..=1e6,
        /// Minimum standard deviation of the reply delay, in days.
        pub reply_delay_std_min: f64 where 0.0..=1e6,
        /// Standard deviation of that, as a share of the group's.
        pub reply_delay_std_noise_std_factor: f64 where 0.0..=1e6,
        /// Lower bound of the first bid as a share of the highest acceptable price.
        pub initial_offer_factor_min: f64 where 0.0..=1e6,
        /// Its upper bound.
        pub initial_offer_factor_max: f64 where 0.0..=1e6,
        /// Lower bound of the maximum number of turns of an enterprise.
        pub max_negotiation_turns_min: u32 where 0.0..=1e6,
        /// Lower bound.
        pub ads_quality_sensitivity_min: f64 where 0.0..=1e6,
        /// Lower bound.
        pub ads_return_sensitivity_min: f64 where 0.0..=1e6,
        /// Standard deviation of a period's usage rate as a share of the customer's demand.
        pub daily_usage_rate_std_fraction: f64 where 0.0..=1e6,
        /// Lower bound of the usage rate, units a day.
        pub daily_usage_rate_min: f64 where 0.0..=1e6,
    }

    /// One of the 26 customer groups (docs/mechanics/customers/groups.md). Money and usage of enterprise groups are
    /// per seat.
    pub struct GroupParams {
        /// Identifier.
        pub id: String,
        /// Name shown to the player.
        pub name: String,
        /// Description of the people or enterprises in the group.
        pub description: String,
        /// Individuals or enterprises.
        pub segment: Segment,
        /// Whether the group is known from day 0.
        pub initially_known: bool,
        /// Whether posts of the group weigh more.
        pub influencer: bool,
        /// Mean of the minimum quality.
        pub q_min_mean: f64,
        /// Its standard deviation.
        pub q_min_std: f64 where 0.0..=1e9,
        /// Mean width of the quality band.
        pub q_range_mean: f64,
        /// Its standard deviation.
        pub q_range_std: f64 where 0.0..=1e9,
        /// Mean budget, dollars a month.
        pub c_max_mean: f64,
        /// Its standard deviation, before `c_max_std_multiplier`.
        pub c_max_std: f64 where 0.0..=1e9,
        /// Mean demand, units a day.
        pub usage_demand_mean: f64 where 0.0..=1e6,
        /// Its standard deviation.
        pub usage_demand_std: f64 where 0.0..=1e6,
        /// Customers or accounts in the market on day 0.
        pub base_market_cap: f64 where 0.0..=1e12,
        /// Growth of the market a year, as a share of the base.
        pub annual_cap_growth_rate: f64,
        /// Mean aversion to long contracts; shown as an estimate, otherwise without effect.
        pub lockin_penalty_mean: f64,
        /// Its standard deviation.
        pub lockin_penalty_std: f64 where 0.0..=1e9,
        /// Mean quality lost to ads at full strength.
        pub ads_quality_sensitivity_mean: f64,
        /// Its standard deviation.
        pub ads_quality_sensitivity_std: f64 where 0.0..=1e9,
        /// Mean revenue from ads at full strength, dollars a day and seat.
        pub ads_return_sensitivity_mean: f64,
        /// Its standard deviation.
        pub ads_return_sensitivity_std: f64 where 0.0..=1e9,
        /// Mean monthly probability that a payment fails permanently.
        pub involuntary_churn_mean: f64,
        /// Its standard deviation.
        pub involuntary_churn_std: f64 where 0.0..=1e9,
        /// Share of a competitor event that additionally raises this group's expectations.
        pub competitor_reactivity_q_bias: f64,
        /// Minimum seats of an enterprise.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub seat_count_min: Option<u32> where 1.0..=1e6,
        /// Maximum seats of an enterprise.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub seat_count_max: Option<u32> where 1.0..=1e6,
        /// Mean reply delay of an enterprise, in days.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub reply_delay_mean: Option<f64>,
        /// Its standard deviation.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub reply_delay_std: Option<f64> where 0.0..=1e9,
        /// Mean of the maximum number of turns of an enterprise.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub max_negotiation_turns_mean: Option<f64>,
        /// Its standard deviation.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub max_negotiation_turns_std: Option<f64> where 0.0..=1e9,
        /// Sensitivities to the economy; an absent dimension does not react.
        pub macro_beta: MacroBeta,
        /// Drift of the whole group.
        pub group_drift_per_day: GroupDrift,
        /// Drift of each subscriber; an absent rate also skips its bounds.
        pub individual_drift_per_day: IndividualDrift,
    }
}

/// Individuals decide alone, enterprises negotiate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Segment {
    /// One person, one seat.
    Individual,
    /// An organization with many seats.
    Enterprise,
}

/// Sensitivity of a group to the economy, per unit of (PMI - 50) / 50 (docs/mechanics/market/economy.md).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MacroBeta {
    /// Number of leads.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lead_generation: Option<f64>,
    /// Budget at a billing decision.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub willingness_to_pay: Option<f64>,
    /// Reply speed of a new enterprise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deal_velocity: Option<f64>,
    /// Drift of seats.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seat_count: Option<f64>,
}

/// Additive drift of a group a day (docs/mechanics/market/drift.md).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct GroupDrift {
    /// Dollars a month added to every budget.
    pub c_max_drift: f64,
    /// Quality added to every expectation.
    pub q_bias_drift: f64,
}

/// Compounding drift of a subscriber a day (docs/mechanics/market/drift.md).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IndividualDrift {
    /// Rate of the budget.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub c_max_drift: Option<f64>,
    /// Rate of both quality bounds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub q_bias_drift: Option<f64>,
    /// Rate of the lower steepness.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steepness_left_drift: Option<f64>,
    /// Rate of the seats.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seat_count_drift: Option<f64>,
}

/// Words of customer profiles: `configs/world/personas.toml` (docs/mechanics/customers/personas.md).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Personas {
    /// Axes common to individuals.
    pub individual: IndividualPersona,
    /// Axes common to enterprises.
    pub enterprise: EnterprisePersona,
    /// Parts of addresses.
    pub email: EmailParts,
    /// Axes of each group, in group order.
    pub group: Vec<GroupPersona>,
}

/// Profile words of individuals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IndividualPersona {
    /// Experience levels.
    pub experience_levels: Vec<String>,
    /// Levels of technical skill.
    pub tech_savvy: Vec<String>,
    /// Upper edges of usage, units a day.
    pub usage_thresholds: [f64; 3],
    /// Labels of usage.
    pub usage_labels: [String; 4],
    /// Upper edges of budget as factors of the group mean.
    pub budget_factors: [f64; 2],
    /// Labels of budget.
    pub budget_labels: [String; 3],
    /// Upper edges of the group's mean minimum quality.
    pub quality_thresholds: [f64; 3],
    /// Labels of expectations.
    pub quality_labels: [String; 4],
}

/// Profile words of enterprises.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EnterprisePersona {
    /// Experience of every contact.
    pub experience: String,
    /// Levels of technical skill.
    pub tech_savvy: Vec<String>,
    /// Number of seats from which the size has a plus sign.
    pub size_plus_from_seats: u32,
    /// Upper edges of the group's mean minimum quality.
    pub quality_thresholds: [f64; 3],
    /// Labels of expectations.
    pub quality_labels: [String; 4],
}

/// Parts of enterprise addresses (docs/mechanics/market/social/texts.md#addresses).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EmailParts {
    /// 48 first names.
    pub first_names: Vec<String>,
    /// 48 last names.
    pub last_names: Vec<String>,
    /// 20 domain names.
    pub company_domains: Vec<String>,
    /// 6 top-level domains.
    pub domain_suffixes: Vec<String>,
}

/// Profile words of one group, without the axes of the other segment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroupPersona {
    /// Identifier of the group.
    pub id: String,
    /// Industries.
    pub industry: Vec<String>,
    /// Roles.
    pub role: Vec<String>,
    /// Work styles of individuals.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub work_style: Vec<String>,
    /// Sizes of enterprises.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub company_size: Vec<String>,
    /// Cultures of enterprises.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub culture: Vec<String>,
    /// Decision styles of enterprises.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub decision_style: Vec<String>,
    /// Primary concerns of enterprises.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub primary_concern: Vec<String>,
}
