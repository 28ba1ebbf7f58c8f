//! Parameters of a run: `configs/world/run.toml`.

use serde::{Deserialize, Serialize};

use super::check::parameters;

parameters! {
    /// Length and end of a run.
    pub struct Run {
        /// Default seed of a new run.
        pub seed: u64,
        /// Default length in days; the size of competitor events grows towards it.
        pub total_days: u32 where 7.0..=100_000.0,
        /// Days per `next_week`; the last week of a run can be shorter.
        pub days_per_week: u32 where 7.0..=7.0,
        /// The run ends when cash is below this at the end of a day, in dollars.
        pub bankruptcy_cash_threshold: f64,
    }

    /// The company and its market on day 0 (`docs/mechanics/day.md#day-0`).
    pub struct Initial {
        /// Cash on day 0, in dollars.
        pub initial_cash: f64 where POSITIVE..=1e15,
        /// Opening price of plan A, dollars a month.
        pub default_price_a as "default_price_A": f64 where 0.0..=1e9,
        /// Opening price of plan B, dollars a month.
        pub default_price_b as "default_price_B": f64 where 0.0..=1e9,
        /// Opening price of plan C, dollars a month.
        pub default_price_c as "default_price_C": f64 where 0.0..=1e9,
        /// Opening model tier of plan A, 1..=5.
        pub default_tier_a as "default_tier_A": u8 where 1.0..=5.0,
        /// Opening model tier of plan B, 1..=5.
        pub default_tier_b as "default_tier_B": u8 where 1.0..=5.0,
        /// Opening model tier of plan C, 1..=5.
        pub default_tier_c as "default_tier_C": u8 where 1.0..=5.0,
        /// Opening quota of plan A, units a day.
        pub default_quota_a as "default_quota_A": u64 where 0.0..=1e15,
        /// Opening quota of plan B, units a day.
        pub default_quota_b as "default_quota_B": u64 where 0.0..=1e15,
        /// Opening quota of plan C, units a day.
        pub default_quota_c as "default_quota_C": u64 where 0.0..=1e15,
        /// Opening spend on operations, dollars a day.
        pub default_spend_operations: f64 where 0.0..=1e12,
        /// Opening spend on development, dollars a day.
        pub default_spend_development: f64 where 0.0..=1e12,
        /// Opening capacity tier, 0..=7.
        pub default_capacity_tier: u8 where 0.0..=7.0,
        /// Reputation of every group at the start, 0..=1.
        pub initial_reputation: f64 where 0.0..=1.0,
        /// Quality gained before day 1.
        pub q_shared_bonus: f64,
        /// Study level of the six initial groups.
        pub initial_group_info_level: u8 where 0.0..=5.0,
        /// Study level of the twenty groups to be discovered.
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
        /// Posts returned if no limit is given.
        pub get_social_posts_default_limit: u32 where 0.0..=1e9,
        /// Maximum rows of a query result.
        pub query_row_limit: u32 where 0.0..=1e9,
        /// A query is stopped after this many seconds.
        pub query_timeout_seconds: u32 where 0.0..=1e9,
        /// Characters shown of a daily calculation.
        pub dashboard_calculation_max_chars: u32 where 0.0..=1e9,
        /// Characters shown of an own post.
        pub dashboard_post_preview_chars: u32 where 0.0..=1e9,
        /// Horizons of the weekly cash forecasts, in days.
        pub prediction_horizons_days: Vec<u32> where 1.0..=100_000.0,
    }
}

/// Mechanics of the release with alternative forms (`docs/mechanics/README.md#the-release-and-the-paper`).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fidelity {
    /// Form of the participation curve.
    pub required_quality: RequiredQuality,
    /// The terms that the quota factor multiplies.
    pub perceived_quality: PerceivedQuality,
    /// Where overload and outages lower quality.
    pub service_penalty: ServicePenalty,
    /// The period that a quota limits.
    pub usage_quota: UsageQuota,
    /// How often accumulated drift counts for a customer.
    pub drift_counted: DriftCounted,
    /// From when a demand surge acts.
    pub surge_start: SurgeStart,
    /// Whether dead enterprise threads reappear.
    pub reappearing_threads: bool,
    /// On which days customers post.
    pub customer_posts: CustomerPosts,
    /// The judge of the player's posts.
    pub post_judge: PostJudge,
    /// Whether an enterprise rejects prices above its budget.
    pub deal_price_ceiling: bool,
    /// Where the errors of insights come from.
    pub insight_noise: InsightNoise,
}

/// Form of the participation curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RequiredQuality {
    /// Two logistic halves with a jump between them: the release.
    Piecewise,
    /// One blend of both sigmoids: the paper.
    Blended,
}

/// The terms that the quota factor multiplies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PerceivedQuality {
    /// Delivered quality, relationship and tenure: the release.
    Release,
    /// Also issues and ads: the paper.
    Paper,
}

/// Where overload and outages lower quality.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ServicePenalty {
    /// Only in daily satisfaction: the release.
    Satisfaction,
    /// In every judgement of quality: the paper.
    Everywhere,
}

/// The period that a quota limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum UsageQuota {
    /// Units a day: the release.
    Daily,
    /// Units of a billing period: the paper.
    Period,
}

/// How often accumulated drift counts for a customer who arrived later.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DriftCounted {
    /// At creation and again at every read: the release.
    EveryRead,
    /// Once.
    Once,
}

/// From when a demand surge acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SurgeStart {
    /// From the first day of the week in which it was drawn: the release.
    Week,
    /// From its own day: the paper.
    Day,
}

/// On which days customers post.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CustomerPosts {
    /// On the seventh day of a week: the release.
    Weekly,
    /// Every day: the paper.
    Daily,
}

/// The judge of the player's posts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PostJudge {
    /// The built-in judge without a language model.
    Offline,
    /// No judge.
    None,
}

/// Where the errors of insights come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InsightNoise {
    /// A separate draw for each run, group, level and value.
    Independent,
    /// One sequence for each group, the same in every run, at every level and on every day: the release.
    Release,
}

/// Recorded series that are replayed instead of being drawn (`docs/mechanics/randomness.md#recorded-series`).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeriesChoice {
    /// The record to replay.
    pub replayed: Replayed,
}

/// Recorded series that replace the draws that do not depend on the company.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Replayed {
    /// None: everything is drawn.
    None,
    /// The released simulator's seed 42.
    Seed42,
}
