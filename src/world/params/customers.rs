//! Parameters of customers: `configs/world/customers.toml`.

use serde::{Deserialize, Serialize};

use super::check::parameters;

parameters! {
    /// Shape of the participation curve (docs/mechanics/customers/participation.md).
    pub struct Participation {
        /// Factor by which the steepness of each half of the curve is multiplied.
        pub curve_gain: f64,
        /// Price as a share of the budget at the center of the lower half of the curve.
        pub curve_left_center: f64,
        /// Price as a share of the budget at the center of the upper half of the curve.
        pub curve_right_center: f64,
        /// Price as a share of the budget at which the two halves of the curve meet.
        pub curve_split: f64 where 0.0..=1.0,
        /// Number by which the quality range is divided to obtain the span of each half of the curve.
        pub curve_half_divisor: f64 where 1.0..=100.0,
        /// Weight of the lower sigmoid in the blended curve of the paper, 0..=1.
        pub blend_weight: f64 where 0.0..=1.0,
        /// Lower bound of the logistic function's argument.
        pub sigmoid_input_min: f64,
        /// Upper bound of the logistic function's argument.
        pub sigmoid_input_max: f64,
        /// Surplus that a plan must exceed for a lead to prefer it to plan A.
        pub lead_min_satisfaction_exclusive: f64,
    }

    /// Bounds of the traits that are drawn for a new customer (docs/mechanics/customers/generation.md).
    pub struct CustomerGeneration {
        /// Mean of the exponential part of the lower steepness.
        pub steepness_left_exp_scale: f64 where 0.0..=1e6,
        /// Offset that is added to the exponential part of the lower steepness.
        pub steepness_left_offset: f64 where 0.0..=1e6,
        /// Lower bound of the lower steepness.
        pub steepness_left_min: f64 where 0.0..=1e6,
        /// Upper bound of the lower steepness.
        pub steepness_left_max: f64 where 0.0..=1e6,
        /// Mean of the exponential part of the upper steepness.
        pub steepness_right_exp_scale: f64 where 0.0..=1e6,
        /// Offset that is added to the exponential part of the upper steepness.
        pub steepness_right_offset: f64 where 0.0..=1e6,
        /// Lower bound of the upper steepness.
        pub steepness_right_min: f64 where 0.0..=1e6,
        /// Upper bound of the upper steepness.
        pub steepness_right_max: f64 where 0.0..=1e6,
        /// Factor by which the standard deviation of a group's budgets is multiplied.
        pub c_max_std_multiplier: f64 where 0.0..=1e6,
        /// Minimum budget before and after drift, dollars per month.
        pub c_max_min: f64 where 0.0..=1e6,
        /// Lower bound of the minimum quality, before drift.
        pub q_min_min: f64 where 0.0..=1e6,
        /// Minimum width of the quality band.
        pub q_range_min: f64 where 0.0..=1e6,
        /// Minimum demand, units per seat per day.
        pub usage_demand_min: f64 where 0.0..=1e6,
        /// Minimum mean reply delay of an enterprise, in days.
        pub reply_delay_mean_min: f64 where 0.0..=1e6,
        /// Standard deviation of the mean reply delay, as a share of the group's standard deviation.
        pub reply_delay_mean_noise_std_factor: f64 where 0.0..=1e6,
        /// Minimum standard deviation of the reply delay, in days.
        pub reply_delay_std_min: f64 where 0.0..=1e6,
        /// Standard deviation of the reply delay's standard deviation, as a share of the group's standard deviation.
        pub reply_delay_std_noise_std_factor: f64 where 0.0..=1e6,
        /// Lower bound of the first asked price, as a share of the highest acceptable price.
        pub initial_offer_factor_min: f64 where 0.0..=1e6,
        /// Upper bound of the first asked price, as a share of the highest acceptable price.
        pub initial_offer_factor_max: f64 where 0.0..=1e6,
        /// Lower bound of the maximum number of turns of an enterprise.
        pub max_negotiation_turns_min: u32 where 0.0..=1e6,
        /// Lower bound of the quality loss from ads at full strength.
        pub ads_quality_sensitivity_min: f64 where 0.0..=1e6,
        /// Lower bound of the ad revenue at full strength.
        pub ads_return_sensitivity_min: f64 where 0.0..=1e6,
        /// Standard deviation of the usage rate of a billing period, as a share of the customer's demand.
        pub daily_usage_rate_std_fraction: f64 where 0.0..=1e6,
        /// Lower bound of the usage rate, units per day.
        pub daily_usage_rate_min: f64 where 0.0..=1e6,
    }

    /// Parameters of one of the 26 customer groups (docs/mechanics/customers/groups.md). Money and usage of enterprise
    /// groups are per seat.
    pub struct GroupParams {
        /// Identifier of the group.
        pub id: String,
        /// Display name of the group.
        pub name: String,
        /// Description of the people or enterprises in the group.
        pub description: String,
        /// Segment of the group: individuals or enterprises.
        pub segment: Segment,
        /// Whether the group is known from day 0.
        pub initially_known: bool,
        /// Whether the group's members are more likely to post.
        pub influencer: bool,
        /// Mean of the minimum quality.
        pub q_min_mean: f64,
        /// Standard deviation of the minimum quality.
        pub q_min_std: f64 where 0.0..=1e9,
        /// Mean width of the quality band.
        pub q_range_mean: f64,
        /// Standard deviation of the width of the quality band.
        pub q_range_std: f64 where 0.0..=1e9,
        /// Mean budget, dollars per month.
        pub c_max_mean: f64,
        /// Standard deviation of the budget, before multiplication by `c_max_std_multiplier`.
        pub c_max_std: f64 where 0.0..=1e9,
        /// Mean demand, units per day.
        pub usage_demand_mean: f64 where 0.0..=1e6,
        /// Standard deviation of the demand.
        pub usage_demand_std: f64 where 0.0..=1e6,
        /// Size of the group's market on day 0, in individuals or enterprises.
        pub base_market_cap: f64 where 0.0..=1e12,
        /// Annual growth of the group's market, as a share of its size on day 0.
        pub annual_cap_growth_rate: f64,
        /// Mean aversion to long contracts. The value is shown as an estimate and has no other effect.
        pub lockin_penalty_mean: f64,
        /// Standard deviation of the aversion to long contracts.
        pub lockin_penalty_std: f64 where 0.0..=1e9,
        /// Mean quality loss from ads at full strength.
        pub ads_quality_sensitivity_mean: f64,
        /// Standard deviation of the quality loss from ads.
        pub ads_quality_sensitivity_std: f64 where 0.0..=1e9,
        /// Mean ad revenue at full strength, dollars per seat per day.
        pub ads_return_sensitivity_mean: f64,
        /// Standard deviation of the ad revenue.
        pub ads_return_sensitivity_std: f64 where 0.0..=1e9,
        /// Mean monthly probability that a payment fails permanently.
        pub involuntary_churn_mean: f64,
        /// Standard deviation of the monthly probability of failed payments.
        pub involuntary_churn_std: f64 where 0.0..=1e9,
        /// Additional rise of this group's expectations, as a share of a competitor event's gain in quality.
        pub competitor_reactivity_q_bias: f64,
        /// Minimum number of seats of an enterprise.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub seat_count_min: Option<u32> where 1.0..=1e6,
        /// Maximum number of seats of an enterprise.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub seat_count_max: Option<u32> where 1.0..=1e6,
        /// Mean reply delay of an enterprise, in days.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub reply_delay_mean: Option<f64>,
        /// Standard deviation of an enterprise's reply delay, in days.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub reply_delay_std: Option<f64> where 0.0..=1e9,
        /// Mean of the maximum number of turns of an enterprise.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub max_negotiation_turns_mean: Option<f64>,
        /// Standard deviation of the maximum number of turns.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub max_negotiation_turns_std: Option<f64> where 0.0..=1e9,
        /// Sensitivities to the economy. The group does not react in a dimension that is absent.
        pub macro_beta: MacroBeta,
        /// Drift of the whole group, per day.
        pub group_drift_per_day: GroupDrift,
        /// Drift of each subscriber, per day. A value whose rate is absent neither drifts nor is clamped.
        pub individual_drift_per_day: IndividualDrift,
    }
}

/// Segment of the market: individuals, who do not negotiate, or enterprises, which do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Segment {
    /// A person with one seat.
    Individual,
    /// An organization with many seats.
    Enterprise,
}

/// Sensitivity of a group to the economy, per unit of (PMI - 50) / 50 (docs/mechanics/market/economy.md).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MacroBeta {
    /// Sensitivity of the number of leads.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lead_generation: Option<f64>,
    /// Sensitivity of the budget at a billing decision.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub willingness_to_pay: Option<f64>,
    /// Sensitivity of a new enterprise to the speed of replies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deal_velocity: Option<f64>,
    /// Sensitivity of the drift of seats.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seat_count: Option<f64>,
}

/// Additive drift of a group per day (docs/mechanics/market/drift.md).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct GroupDrift {
    /// Dollars per month added to every budget.
    pub c_max_drift: f64,
    /// Quality added to the expectations of every customer.
    pub q_bias_drift: f64,
}

/// Compounding drift of a subscriber per day (docs/mechanics/market/drift.md).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IndividualDrift {
    /// Daily drift rate of the budget.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub c_max_drift: Option<f64>,
    /// Daily drift rate of both quality bounds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub q_bias_drift: Option<f64>,
    /// Daily drift rate of the lower steepness.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steepness_left_drift: Option<f64>,
    /// Daily drift rate of the seats.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seat_count_drift: Option<f64>,
}

/// Words of customer profiles: `configs/world/personas.toml` (docs/mechanics/customers/personas.md).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Personas {
    /// Profile words that all individual groups share.
    pub individual: IndividualPersona,
    /// Profile words that all enterprise groups share.
    pub enterprise: EnterprisePersona,
    /// Word lists for email addresses of enterprises.
    pub email: EmailParts,
    /// Profile words of each group, in group order.
    pub group: Vec<GroupPersona>,
}

/// Profile words that all individual groups share.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IndividualPersona {
    /// Levels of work experience.
    pub experience_levels: Vec<String>,
    /// Levels of technical skill.
    pub tech_savvy: Vec<String>,
    /// Upper bounds of the usage labels, units per day.
    pub usage_thresholds: [f64; 3],
    /// Labels for usage, lowest first.
    pub usage_labels: [String; 4],
    /// Upper bounds of the budget labels, as multiples of the group mean.
    pub budget_factors: [f64; 2],
    /// Labels for budget, lowest first.
    pub budget_labels: [String; 3],
    /// Upper bounds of the expectation labels, compared with the group's mean minimum quality.
    pub quality_thresholds: [f64; 3],
    /// Labels for expectations, lowest first.
    pub quality_labels: [String; 4],
}

/// Profile words that all enterprise groups share.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EnterprisePersona {
    /// Experience level of every contact person.
    pub experience: String,
    /// Levels of technical skill.
    pub tech_savvy: Vec<String>,
    /// Minimum number of seats at which the company size is shown with a plus sign.
    pub size_plus_from_seats: u32,
    /// Upper bounds of the expectation labels, compared with the group's mean minimum quality.
    pub quality_thresholds: [f64; 3],
    /// Labels for expectations, lowest first.
    pub quality_labels: [String; 4],
}

/// Word lists for email addresses of enterprises (docs/mechanics/market/social/texts.md#addresses).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EmailParts {
    /// 48 first names for the local part of an address.
    pub first_names: Vec<String>,
    /// 48 last names for the local part of an address.
    pub last_names: Vec<String>,
    /// 20 company words for the domain of an address.
    pub company_domains: Vec<String>,
    /// 6 top-level domains.
    pub domain_suffixes: Vec<String>,
}

/// Profile words of one group. Attributes of the other segment are empty.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroupPersona {
    /// Identifier of the group.
    pub id: String,
    /// Industries of the group.
    pub industry: Vec<String>,
    /// Job roles in the group.
    pub role: Vec<String>,
    /// Work styles; only for individuals.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub work_style: Vec<String>,
    /// Company sizes; only for enterprises.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub company_size: Vec<String>,
    /// Company cultures; only for enterprises.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub culture: Vec<String>,
    /// Decision styles; only for enterprises.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub decision_style: Vec<String>,
    /// Primary concerns; only for enterprises.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub primary_concern: Vec<String>,
}
