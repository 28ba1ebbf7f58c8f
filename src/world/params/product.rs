//! Parameters of the product: `configs/world/product.toml`.

use super::check::parameters;

parameters! {
    /// Delivered and perceived quality (`docs/mechanics/product/quality.md`).
    pub struct Quality {
        /// Product quality before any improvement.
        pub base_product_quality: f64 where POSITIVE..=100.0,
        /// Quality bonus at relationship 1, penalty at 0.
        pub relationship_quality_bonus_max: f64,
        /// Relationship without bonus or penalty.
        pub relationship_neutral_point: f64,
        /// Scales the distance from the neutral point.
        pub relationship_scale: f64,
        /// A relationship of exactly 0 is read as this.
        pub fallback_relationship: f64,
        /// Tenure bonus: this times ln(1 + days / `stickiness_days_scale`).
        pub stickiness_log_scale: f64,
        /// Days that scale the tenure bonus.
        pub stickiness_days_scale: f64 where POSITIVE..=1e6,
        /// Quality lost per unit of overload.
        pub service_overload_weight: f64,
        /// Quality lost on a day with an outage.
        pub service_outage_weight: f64,
        /// Quality lost per day that an issue has been open.
        pub issue_penalty_per_open_day: f64,
        /// Lower clamp of quota / demand.
        pub quota_factor_min: f64,
        /// Upper clamp of quota / demand.
        pub quota_factor_max: f64,
        /// Minimum of the uniform factor by which a lead misjudges quality.
        pub initial_decision_noise_min: f64 where 0.0..=100.0,
        /// Maximum of that factor.
        pub initial_decision_noise_max: f64 where 0.0..=100.0,
        /// Minimum budget after the group's drift was added, dollars a month.
        pub read_time_c_max_min: f64,
        /// Lower clamp of quality in negotiations.
        pub negotiation_quality_min: f64,
        /// Upper clamp of quality in negotiations.
        pub negotiation_quality_max: f64,
    }

    /// Development and R&D (`docs/mechanics/product/development.md`).
    pub struct Development {
        /// Standard deviation of the daily noise of the shared quality.
        pub quality_shared_noise_scale: f64 where 0.0..=10.0,
        /// Shared gain a day: this times ln(1 + spend / `dev_spend_scale`).
        pub dev_improvement_coef: f64,
        /// Dollars a day that scale development.
        pub dev_spend_scale: f64 where POSITIVE..=1e12,
        /// The same for one group.
        pub targeted_dev_improvement_coef: f64,
        /// Dollars a day that scale targeted development.
        pub targeted_dev_spend_scale: f64 where POSITIVE..=1e12,
        /// Minimum duration of an R&D project, in days.
        pub rd_min_duration_days: u32 where 1.0..=100_000.0,
        /// Minimum gain of an R&D project.
        pub rd_min_quality_boost: f64,
        /// Decimals of the gain in the result of the tool.
        pub rd_report_decimals: u32 where 0.0..=12.0,
    }

    /// Service health (`docs/mechanics/product/service.md`).
    pub struct Operations {
        /// Daily probability of an outage, without spending.
        pub base_outage_prob: f64 where 0.0..=1.0,
        /// Operations in dollars a day that divide this probability by e.
        pub ops_outage_reduction_scale: f64 where POSITIVE..=1e12,
        /// Minimum daily probability of an outage, before overload.
        pub ops_outage_min_prob: f64 where 0.0..=1.0,
        /// Growth of the probability per unit of overload.
        pub outage_overload_factor: f64,
        /// Overload begins above this utilization.
        pub overload_reference_utilization: f64,
        /// Latency (95th percentile) without overload, in milliseconds.
        pub p95_base_ms: f64,
        /// Milliseconds added per unit of overload.
        pub p95_overload_factor: f64,
        /// Standard deviation of the latency, in milliseconds.
        pub p95_noise_std: f64,
        /// Share of failed requests without overload.
        pub error_rate_base: f64,
        /// Added per unit of overload.
        pub error_rate_overload_factor: f64,
        /// Standard deviation of the error rate.
        pub error_rate_noise_std: f64,
        /// Lower clamp of the error rate.
        pub error_rate_min: f64,
        /// Upper clamp of the error rate.
        pub error_rate_max: f64,
        /// Possible lengths of an outage, in minutes.
        pub downtime_minutes_choices: [u32; 3] where 0.0..=100_000.0,
        /// Their probabilities.
        pub downtime_minutes_probabilities: [f64; 3] where 0.0..=1.0,
        /// Old usage rows are deleted on days divisible by this.
        pub daily_usage_prune_every_days: u32 where 1.0..=100_000.0,
        /// Days of usage that are kept.
        pub daily_usage_keep_days: u32 where 1.0..=100_000.0,
    }

    /// In-app advertising (`docs/mechanics/product/ads.md`).
    pub struct Ads {
        /// Effective strength = ln(1 + k s) / ln(1 + k).
        pub log_curve_k: f64 where POSITIVE..=1e6,
        /// Lower clamp of the summed strength.
        pub strength_min: f64,
        /// Upper clamp of the summed strength.
        pub strength_max: f64,
    }

    /// One model tier: price and quality of the model behind a plan.
    pub struct ModelTier {
        /// Number of the tier.
        pub tier: u8,
        /// Kind of model.
        pub class: String,
        /// Compute cost, dollars per usage unit.
        pub unit_cost: f64 where 0.0..=1e6,
        /// Factor on product quality.
        pub quality_multiplier: f64 where 0.0..=100.0,
    }

    /// One capacity tier: units a day and their price.
    pub struct CapacityTier {
        /// Number of the tier.
        pub tier: u8,
        /// Units a day.
        pub capacity_units: u32 where 1.0..=4e9,
        /// Dollars a day.
        pub cost_per_day: u32 where 0.0..=4e9,
    }

    /// One R&D tier (`docs/mechanics/product/research.md`).
    pub struct ResearchTier {
        /// Number of the tier.
        pub tier: u8,
        /// Name.
        pub name: String,
        /// Price in dollars.
        pub cost: u32 where 0.0..=4e9,
        /// Mean duration before truncation, in days.
        pub mean_days: f64 where 0.0..=100_000.0,
        /// Standard deviation of the duration, in days.
        pub std_days: f64 where 0.0..=1e6,
        /// Mean gain.
        pub mean_quality_boost: f64,
        /// Standard deviation of the gain.
        pub std_quality_boost: f64 where 0.0..=1e6,
    }
}
