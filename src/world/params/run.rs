//! Parameters of a run: `configs/world/run.toml`.

use serde::{Deserialize, Serialize};

use super::check::parameters;

parameters! {
    /// Length and end of a run.
    pub struct Run {
        /// Default seed of a new run.
        pub seed: u64,
        /// Default length of a run in days. Competitor events grow until shortly before the last day.
        pub total_days: u32 where 7.0..=100_000.0,
        /// Rule that derives the last day from the length of a run.
        pub horizon_rule: HorizonRule,
        /// Days that one `next_week` call simulates. The last week of a run can be shorter.
        pub days_per_week: u32 where 7.0..=7.0,
        /// Bankruptcy threshold, dollars. The run ends when cash is below the threshold at the end of a day.
        pub bankruptcy_cash_threshold: f64,
    }

    /// The company and its market on day 0 (`docs/mechanics/day.md#day-0`).
    pub struct Initial {
        /// Cash on day 0, in dollars.
        pub initial_cash: f64 where POSITIVE..=1e15,
        /// Initial list price of plan A, dollars per month.
        pub default_price_a as "default_price_A": f64 where 0.0..=1e9,
        /// Initial list price of plan B, dollars per month.
        pub default_price_b as "default_price_B": f64 where 0.0..=1e9,
        /// Initial list price of plan C, dollars per month.
        pub default_price_c as "default_price_C": f64 where 0.0..=1e9,
        /// Initial model tier of plan A, 1..=5.
        pub default_tier_a as "default_tier_A": u8 where 1.0..=5.0,
        /// Initial model tier of plan B, 1..=5.
        pub default_tier_b as "default_tier_B": u8 where 1.0..=5.0,
        /// Initial model tier of plan C, 1..=5.
        pub default_tier_c as "default_tier_C": u8 where 1.0..=5.0,
        /// Initial quota of plan A, units per day.
        pub default_quota_a as "default_quota_A": u64 where 0.0..=1e15,
        /// Initial quota of plan B, units per day.
        pub default_quota_b as "default_quota_B": u64 where 0.0..=1e15,
        /// Initial quota of plan C, units per day.
        pub default_quota_c as "default_quota_C": u64 where 0.0..=1e15,
        /// Initial spending on operations, dollars per day.
        pub default_spend_operations: f64 where 0.0..=1e12,
        /// Initial spending on development, dollars per day.
        pub default_spend_development: f64 where 0.0..=1e12,
        /// Initial capacity tier, 0..=7.
        pub default_capacity_tier: u8 where 0.0..=7.0,
        /// Initial reputation of every group, 0..=1.
        pub initial_reputation: f64 where 0.0..=1.0,
        /// Quality that is added to the base quality for all groups on day 0.
        pub q_shared_bonus: f64,
        /// Study level of the six initial groups.
        pub initial_group_info_level: u8 where 0.0..=5.0,
        /// Study level of the twenty undiscovered groups.
        pub discoverable_group_info_level: u8 where 0.0..=5.0,
        /// Satisfaction of a new customer.
        pub customer_satisfaction: f64,
        /// Relationship of a new customer, 0..=1.
        pub customer_relationship: f64 where 0.0..=1.0,
    }

    /// Limits of tools, queries and texts.
    pub struct Limits {
        /// Maximum length of the player's posts, in code points.
        pub post_max_chars: u32 where 0.0..=1e9,
        /// Number of posts that `get_social_posts` returns if the call has no limit.
        pub get_social_posts_default_limit: u32 where 0.0..=1e9,
        /// Maximum number of rows of a query result.
        pub query_row_limit: u32 where 0.0..=1e9,
        /// Time limit of a query, in seconds.
        pub query_timeout_seconds: u32 where 0.0..=1e9,
        /// Maximum number of characters of a daily calculation that the dashboard shows.
        pub dashboard_calculation_max_chars: u32 where 0.0..=1e9,
        /// Maximum number of characters of the player's post that the dashboard shows.
        pub dashboard_post_preview_chars: u32 where 0.0..=1e9,
        /// Horizons of the weekly cash forecasts, in days.
        pub prediction_horizons_days: Vec<u32> where 1.0..=100_000.0,
    }
}

/// Rule that derives the last day from the length of a run (`docs/mechanics/day.md#last-day`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HorizonRule {
    /// The run ends on the last day of its length. The last week can be shorter.
    Exact,
    /// The length is rounded down to whole weeks, as the packaged agent runners of the released simulator do.
    WholeWeeksBelow,
    /// The last week is simulated completely, as the command line of the released simulator does.
    WholeWeeksAbove,
}

/// Last day of a run, and the length that scales competitor events.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Horizon {
    /// Last day of the run.
    pub last_day: u32,
    /// Length that scales the size, the frequency and the last possible day of competitor events, in days.
    pub total_days: u32,
}

impl Run {
    /// Returns the horizon of a run whose length is `days`. If `total_days` of the result is used as the length, the
    /// horizon is the same. If `last_day` of the result is used as the length, the last day is the same.
    pub fn horizon(&self, days: u32) -> Horizon {
        let week = self.days_per_week;
        match self.horizon_rule {
            HorizonRule::Exact => Horizon { last_day: days, total_days: days },
            HorizonRule::WholeWeeksBelow => {
                let whole = days - days % week;
                Horizon { last_day: whole, total_days: whole }
            }
            HorizonRule::WholeWeeksAbove => {
                Horizon { last_day: days.next_multiple_of(week), total_days: days }
            }
        }
    }
}

impl HorizonRule {
    /// Returns the name that parameters and tables use for the rule.
    pub fn name(self) -> &'static str {
        match self {
            HorizonRule::Exact => "exact",
            HorizonRule::WholeWeeksBelow => "whole_weeks_below",
            HorizonRule::WholeWeeksAbove => "whole_weeks_above",
        }
    }
}

/// Mechanics for which the released simulator and the paper have different forms
/// (`docs/mechanics/README.md#the-release-and-the-paper`).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fidelity {
    /// Formula that computes the required quality at a price.
    pub required_quality: RequiredQuality,
    /// Quality terms that are multiplied by the quota factor.
    pub perceived_quality: PerceivedQuality,
    /// Evaluations of quality that overload and outages affect.
    pub service_penalty: ServicePenalty,
    /// Period for which a quota is defined.
    pub usage_quota: UsageQuota,
    /// How often accumulated drift is added to a customer's curve.
    pub drift_counted: DriftCounted,
    /// Rule for the first day of a demand surge.
    pub surge_start: SurgeStart,
    /// Whether dead enterprise threads reappear.
    pub reappearing_threads: bool,
    /// Days on which customers post.
    pub customer_posts: CustomerPosts,
    /// The judge that evaluates the player's posts.
    pub post_judge: PostJudge,
    /// Whether an enterprise rejects prices above its budget.
    pub deal_price_ceiling: bool,
    /// Random draws of the errors of estimates.
    pub insight_noise: InsightNoise,
    /// List price of the current plan in an individual's billing decision.
    pub renewal_price: RenewalPrice,
    /// Upper limit of the quality that enterprises perceive in a negotiation.
    pub enterprise_quality_cap: EnterpriseQualityCap,
    /// Generation of the released interface.
    pub interface: Interface,
}

/// Formula that computes the required quality at a price, which is the form of the participation curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RequiredQuality {
    /// Two logistic halves with a jump between them, as in the released simulator.
    Piecewise,
    /// A blend of both halves, as in the paper.
    Blended,
}

/// Quality terms that are multiplied by the quota factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PerceivedQuality {
    /// Delivered quality, relationship and tenure, as in the released simulator.
    Release,
    /// All terms, including issues and ads, as in the paper.
    Paper,
}

/// Evaluations of quality that overload and outages affect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ServicePenalty {
    /// Overload and outages affect only daily satisfaction, as in the released simulator.
    Satisfaction,
    /// Overload and outages affect every evaluation of quality, as in the paper.
    Everywhere,
}

/// Period for which a quota is defined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum UsageQuota {
    /// Units per day, as in the released simulator.
    Daily,
    /// Units per billing period, as in the paper.
    Period,
}

/// How often drift from before a customer's arrival is added to the customer's curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DriftCounted {
    /// The drift is added when the customer is created and again whenever the curve is read, as in the released
    /// simulator.
    EveryRead,
    /// The drift is added only once.
    Once,
}

/// First day of a demand surge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SurgeStart {
    /// First day of the week in which the surge was drawn, as in the released simulator.
    Week,
    /// Day for which the surge was drawn, as in the paper.
    Day,
}

/// Days on which customers post.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CustomerPosts {
    /// Every seventh day, as in the released simulator.
    Weekly,
    /// Every day, as in the paper.
    Daily,
}

/// The judge that evaluates the player's posts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PostJudge {
    /// The built-in judge, which uses no language model.
    Offline,
    /// No judge: posts are not judged.
    None,
}

/// Random draws of the errors of estimates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InsightNoise {
    /// A separate draw for each run, group, level and value.
    Independent,
    /// One sequence of draws for each group. The sequence is the same in every run, at every level and on every day, as
    /// in the released simulator.
    Release,
}

/// List price of the current plan in an individual's billing decision.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RenewalPrice {
    /// Today's list price, as in release 1. Subscribers who would not pay an increased price cancel.
    List,
    /// The lower of today's list price and the list price stored with the subscription, as in release 2.
    LowerOfListAndStored,
}

/// Upper limit of the quality that enterprises perceive in a negotiation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EnterpriseQualityCap {
    /// `quality.negotiation_quality_max`, as in release 1.
    One,
    /// No upper limit, as in release 2.
    None,
}

/// Generation of the released interface: columns of tables, results of tools, texts of notifications and HTTP routes
/// (`docs/known-differences.md#the-two-releases`).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Interface {
    /// The release of 28 July 2026, revision d2b7b32.
    #[default]
    #[serde(rename = "release_1")]
    Release1,
    /// The later revision 538ad2b7.
    #[serde(rename = "release_2")]
    Release2,
}

impl Interface {
    /// Returns the identifier that parameters and data use for the generation.
    pub fn id(self) -> &'static str {
        match self {
            Interface::Release1 => "release_1",
            Interface::Release2 => "release_2",
        }
    }

    /// Returns the name that texts and tables use for the generation.
    pub fn name(self) -> &'static str {
        match self {
            Interface::Release1 => "release 1",
            Interface::Release2 => "release 2",
        }
    }
}

/// Recorded series that are replayed instead of being drawn (`docs/mechanics/randomness.md#recorded-series`).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeriesChoice {
    /// Series whose values replace random draws.
    pub replayed: Replayed,
}

/// Recorded series that can replace the draws that are independent of the company.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Replayed {
    /// No recorded series: all values are drawn.
    None,
    /// Series recorded from the released simulator with seed 42.
    Seed42,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Params;

    #[test]
    fn horizon_has_whole_weeks_unless_the_rule_is_exact() {
        use HorizonRule::{Exact, WholeWeeksAbove, WholeWeeksBelow};
        let mut run = Params::bundled().run;
        for (rule, days, last_day, total_days) in [
            (Exact, 500, 500, 500),
            // The packaged agent runners are configured with 497 days, the command line with 500 days.
            (WholeWeeksBelow, 500, 497, 497),
            (WholeWeeksAbove, 500, 504, 500),
            (Exact, 100, 100, 100),
            (WholeWeeksBelow, 100, 98, 98),
            (WholeWeeksAbove, 100, 105, 100),
            (WholeWeeksBelow, 497, 497, 497),
            (WholeWeeksAbove, 497, 497, 497),
            (WholeWeeksBelow, 504, 504, 504),
            (WholeWeeksAbove, 504, 504, 504),
            (WholeWeeksBelow, 7, 7, 7),
            (WholeWeeksAbove, 8, 14, 8),
            (WholeWeeksAbove, 100_000, 100_002, 100_000),
        ] {
            run.horizon_rule = rule;
            let horizon = run.horizon(days);
            assert_eq!(horizon, Horizon { last_day, total_days }, "{rule:?}, {days} days");
            assert_eq!(run.horizon(horizon.total_days), horizon, "{rule:?}, {days} days");
            assert_eq!(run.horizon(horizon.last_day).last_day, last_day, "{rule:?}, {days} days");
        }
    }
}
