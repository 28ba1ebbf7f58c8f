//! Parameters of retention: `configs/world/retention.toml`.

use super::check::parameters;

parameters! {
    /// Daily satisfaction (`docs/mechanics/retention/satisfaction.md`).
    pub struct Satisfaction {
        /// Weight of today in the moving average.
        pub satisfaction_ema_alpha: f64 where 0.0..=1.0,
    }

    /// Support issues (`docs/mechanics/retention/issues.md`).
    pub struct Issues {
        /// Daily probability of an issue at full satisfaction.
        pub base_issue_rate: f64,
        /// Increase per point of missing satisfaction.
        pub issue_quality_factor: f64,
        /// Increase on a day with an outage.
        pub issue_outage_factor: f64,
        /// Satisfaction that counts as full.
        pub issue_satisfaction_reference: f64,
        /// Lower clamp of the probability.
        pub issue_probability_min: f64 where 0.0..=1.0,
        /// Upper clamp of the probability.
        pub issue_probability_max: f64 where 0.0..=1.0,
        /// Issues resolved a day without spending.
        pub issue_resolution_base_rate: f64 where 0.0..=1e9,
        /// Issues of individuals resolved per dollar of operations.
        pub individual_ops_scale: f64 where 0.0..=1e6,
        /// Issues of enterprises resolved per dollar of operations.
        pub enterprise_ops_scale: f64 where 0.0..=1e6,
        /// A resolution within this many open days raises the relationship.
        pub quick_resolution_threshold_days: u32,
        /// Open days up to which the gain is larger.
        pub quick_boost_first_day: u32,
        /// Relationship gained by a solution on the first day.
        pub quick_resolution_boost_1day: f64,
        /// Relationship gained by a later quick solution.
        pub quick_resolution_boost_2day: f64,
        /// Relationship lost per day without a solution.
        pub relationship_decay_per_unresolved_day: f64 where 0.0..=1.0,
        /// Lower bound of a relationship.
        pub relationship_min: f64 where 0.0..=1.0,
        /// Upper bound of a relationship.
        pub relationship_max: f64 where 0.0..=1.0,
        /// Open days of a fresh issue.
        pub new_issue_open_days: u32 where 1.0..=1_000.0,
    }

    /// Billing (`docs/mechanics/retention/billing.md`).
    pub struct Billing {
        /// Days between two bills.
        pub billing_period_days: u32 where 30.0..=30.0,
        /// Minimum price after discounts, dollars a month.
        pub effective_price_min: f64,
        /// Minimum budget stored with a bill, dollars a month.
        pub billing_c_max_min: f64,
    }

    /// Minimums of summed discounts (`docs/mechanics/retention/billing.md#promotions`).
    pub struct Promotions {
        /// Minimum of summed ongoing discounts, dollars a month.
        pub promotion_min: f64,
        /// Minimum of summed lead discounts, dollars a month.
        pub lead_promotion_min: f64,
    }

    /// Cancellations by failed payments (`docs/mechanics/retention/involuntary-churn.md`).
    pub struct InvoluntaryChurn {
        /// Whether payments can fail.
        pub enable_involuntary_churn: bool,
        /// Days for which a rate is constant.
        pub month_days: u32 where 1.0..=100_000.0,
        /// Lower clamp of the monthly rate.
        pub mu_min: f64 where 0.0..=1.0,
        /// Upper clamp of the monthly rate.
        pub mu_max: f64 where 0.0..=1.0,
    }
}
