//! Parameters of the product: `configs/world/product.toml`.

use super::check::parameters;

parameters! {
    /// Parameters of delivered and perceived quality (`docs/mechanics/product/quality.md`).
    pub struct Quality {
        /// Product quality before any development.
        pub base_product_quality: f64 where POSITIVE..=100.0,
        /// Largest quality bonus, at relationship 1. At relationship 0, the penalty has the same size.
        pub relationship_quality_bonus_max: f64,
        /// Neutral relationship, which has neither a bonus nor a penalty.
        pub relationship_neutral_point: f64,
        /// Scale of the distance from the neutral relationship.
        pub relationship_scale: f64,
        /// Value that replaces a relationship of exactly 0.
        pub fallback_relationship: f64,
        /// Factor of ln(1 + days / `stickiness_days_scale`) in the tenure bonus.
        pub stickiness_log_scale: f64,
        /// Scale of tenure in the tenure bonus, in days.
        pub stickiness_days_scale: f64 where POSITIVE..=1e6,
        /// Quality loss per unit of overload.
        pub service_overload_weight: f64,
        /// Quality loss on a day with an outage.
        pub service_outage_weight: f64,
        /// Quality loss per day that an issue has been open.
        pub issue_penalty_per_open_day: f64,
        /// Lower bound of quota / demand.
        pub quota_factor_min: f64,
        /// Upper bound of quota / demand.
        pub quota_factor_max: f64,
        /// Minimum of the uniform factor by which a lead misjudges quality.
        pub initial_decision_noise_min: f64 where 0.0..=100.0,
        /// Maximum of the uniform factor by which a lead misjudges quality.
        pub initial_decision_noise_max: f64 where 0.0..=100.0,
        /// Minimum budget after the group's drift is added, dollars per month.
        pub read_time_c_max_min: f64,
        /// Lower bound of quality in negotiations.
        pub negotiation_quality_min: f64,
        /// Upper bound of quality in negotiations.
        pub negotiation_quality_max: f64,
    }

    /// Parameters of development and R&D (`docs/mechanics/product/development.md`).
    pub struct Development {
        /// Standard deviation of the daily noise of the shared quality.
        pub quality_shared_noise_scale: f64 where 0.0..=10.0,
        /// Factor of ln(1 + spend / `dev_spend_scale`) in the daily gain from general development.
        pub dev_improvement_coef: f64,
        /// Scale of spending on general development, dollars per day.
        pub dev_spend_scale: f64 where POSITIVE..=1e12,
        /// Factor of the daily gain from targeted development.
        pub targeted_dev_improvement_coef: f64,
        /// Scale of spending on targeted development, dollars per day.
        pub targeted_dev_spend_scale: f64 where POSITIVE..=1e12,
        /// Minimum duration of an R&D project, in days.
        pub rd_min_duration_days: u32 where 1.0..=100_000.0,
        /// Minimum quality gain of an R&D project.
        pub rd_min_quality_boost: f64,
        /// Decimals of the quality gain in the result of a tool call.
        pub rd_report_decimals: u32 where 0.0..=12.0,
    }

    /// Parameters of service health (`docs/mechanics/product/service.md`).
    pub struct Operations {
        /// Daily probability of an outage if nothing is spent on operations.
        pub base_outage_prob: f64 where 0.0..=1.0,
        /// Spending on operations that divides the outage probability by e, dollars per day.
        pub ops_outage_reduction_scale: f64 where POSITIVE..=1e12,
        /// Minimum daily probability of an outage, before overload.
        pub ops_outage_min_prob: f64 where 0.0..=1.0,
        /// Relative increase of the outage probability per unit of overload.
        pub outage_overload_factor: f64,
        /// Utilization above which overload begins.
        pub overload_reference_utilization: f64,
        /// Latency (95th percentile) without overload, in milliseconds.
        pub p95_base_ms: f64,
        /// Increase of the latency per unit of overload, in milliseconds.
        pub p95_overload_factor: f64,
        /// Standard deviation of the latency, in milliseconds.
        pub p95_noise_std: f64,
        /// Share of failed requests without overload.
        pub error_rate_base: f64,
        /// Share of failed requests that each unit of overload adds.
        pub error_rate_overload_factor: f64,
        /// Standard deviation of the error rate.
        pub error_rate_noise_std: f64,
        /// Lower bound of the error rate.
        pub error_rate_min: f64,
        /// Upper bound of the error rate.
        pub error_rate_max: f64,
        /// Possible durations of an outage, in minutes.
        pub downtime_minutes_choices: [u32; 3] where 0.0..=100_000.0,
        /// Probability of each duration of an outage.
        pub downtime_minutes_probabilities: [f64; 3] where 0.0..=1.0,
        /// Days between deletions of old usage rows.
        pub daily_usage_prune_every_days: u32 where 1.0..=100_000.0,
        /// Number of days for which usage rows are kept.
        pub daily_usage_keep_days: u32 where 1.0..=100_000.0,
    }

    /// Parameters of in-app advertising (`docs/mechanics/product/ads.md`).
    pub struct Ads {
        /// Constant k of the effective strength ln(1 + k s) / ln(1 + k), where s is the summed strength.
        pub log_curve_k: f64 where POSITIVE..=1e6,
        /// Lower bound of the summed strength.
        pub strength_min: f64,
        /// Upper bound of the summed strength.
        pub strength_max: f64,
    }

    /// One model tier: cost and quality of the model behind a plan.
    pub struct ModelTier {
        /// Number of the model tier, 1..=5.
        pub tier: u8,
        /// Class of the model, for instance `Haiku/Flash`.
        pub class: String,
        /// Compute cost, dollars per usage unit.
        pub unit_cost: f64 where 0.0..=1e6,
        /// Factor by which the model multiplies product quality.
        pub quality_multiplier: f64 where 0.0..=100.0,
    }

    /// One capacity tier: its capacity and its cost.
    pub struct CapacityTier {
        /// Number of the capacity tier, 0..=7.
        pub tier: u8,
        /// Capacity of the tier, units per day.
        pub capacity_units: u32 where 1.0..=4e9,
        /// Cost of the tier, dollars per day.
        pub cost_per_day: u32 where 0.0..=4e9,
    }

    /// One R&D tier (`docs/mechanics/product/research.md`).
    pub struct ResearchTier {
        /// Number of the R&D tier, 1..=20.
        pub tier: u8,
        /// Display name, for instance `Evaluation & Testing Pipeline`.
        pub name: String,
        /// Price of a project, dollars.
        pub cost: u32 where 0.0..=4e9,
        /// Mean duration of a project before truncation, in days.
        pub mean_days: f64 where 0.0..=100_000.0,
        /// Standard deviation of a project's duration, in days.
        pub std_days: f64 where 0.0..=1e6,
        /// Mean quality gain of a project.
        pub mean_quality_boost: f64,
        /// Standard deviation of a project's quality gain.
        pub std_quality_boost: f64 where 0.0..=1e6,
    }
}
