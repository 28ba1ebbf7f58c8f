//! Parameters of retention: `configs/world/retention.toml`.

use super::check::parameters;

parameters! {
    /// Parameters of the daily update of satisfaction (`docs/mechanics/retention/satisfaction.md`).
    pub struct Satisfaction {
        /// Weight of today's satisfaction in the moving average.
        pub satisfaction_ema_alpha: f64 where 0.0..=1.0,
    }

    /// Parameters of support issues (`docs/mechanics/retention/issues.md`).
    pub struct Issues {
        /// Daily probability of an issue at full satisfaction.
        pub base_issue_rate: f64,
        /// Increase of the issue probability per point of missing satisfaction.
        pub issue_quality_factor: f64,
        /// Increase of the issue probability on a day with an outage.
        pub issue_outage_factor: f64,
        /// Satisfaction that counts as full.
        pub issue_satisfaction_reference: f64,
        /// Lower bound of the issue probability.
        pub issue_probability_min: f64 where 0.0..=1.0,
        /// Upper bound of the issue probability.
        pub issue_probability_max: f64 where 0.0..=1.0,
        /// Issues resolved per day if nothing is spent.
        pub issue_resolution_base_rate: f64 where 0.0..=1e9,
        /// Issues of individuals resolved per dollar of operations.
        pub individual_ops_scale: f64 where 0.0..=1e6,
        /// Issues of enterprises resolved per dollar of operations.
        pub enterprise_ops_scale: f64 where 0.0..=1e6,
        /// Maximum issue age, in days, at which a resolution raises the relationship.
        pub quick_resolution_threshold_days: u32,
        /// Maximum issue age, in days, at which a resolution counts as a first-day resolution.
        pub quick_boost_first_day: u32,
        /// Gain in relationship from a resolution on the first day.
        pub quick_resolution_boost_1day: f64,
        /// Gain in relationship from a later quick resolution.
        pub quick_resolution_boost_2day: f64,
        /// Loss of relationship per day with an open issue.
        pub relationship_decay_per_unresolved_day: f64 where 0.0..=1.0,
        /// Lower bound of a relationship.
        pub relationship_min: f64 where 0.0..=1.0,
        /// Upper bound of a relationship.
        pub relationship_max: f64 where 0.0..=1.0,
        /// Issue age of a new issue, in days.
        pub new_issue_open_days: u32 where 1.0..=1_000.0,
    }

    /// Parameters of billing (`docs/mechanics/retention/billing.md`).
    pub struct Billing {
        /// Days between two bills.
        pub billing_period_days: u32 where 30.0..=30.0,
        /// Minimum price after discounts, dollars per month.
        pub effective_price_min: f64,
        /// Minimum budget stored with a bill, dollars per month.
        pub billing_c_max_min: f64,
    }

    /// Minimum sums of discounts (`docs/mechanics/retention/billing.md#promotions`).
    pub struct Promotions {
        /// Minimum sum of ongoing discounts, dollars per month.
        pub promotion_min: f64,
        /// Minimum sum of lead discounts, dollars per month.
        pub lead_promotion_min: f64,
    }

    /// Involuntary cancellations after failed payments (`docs/mechanics/retention/involuntary-churn.md`).
    pub struct InvoluntaryChurn {
        /// Whether payments can fail permanently.
        pub enable_involuntary_churn: bool,
        /// Number of days for which the rate of failed payments is constant.
        pub month_days: u32 where 1.0..=100_000.0,
        /// Lower bound of the monthly rate of failed payments.
        pub mu_min: f64 where 0.0..=1.0,
        /// Upper bound of the monthly rate of failed payments.
        pub mu_max: f64 where 0.0..=1.0,
    }
}
