//! Parameters of the discovery and study of groups: `configs/world/discovery.toml`.

use super::check::parameters;

parameters! {
    /// Parameters of the discovery of groups (docs/mechanics/market/discovery.md).
    pub struct MarketResearch {
        /// Price of an attempt to discover a group, dollars.
        pub discovery_cost_level_1: f64 where 0.0..=1e12,
        /// Probability that an attempt discovers a group.
        pub market_research_discover_prob: f64 where 0.0..=1.0,
    }

    /// One study level of a group (docs/mechanics/market/discovery.md).
    pub struct InfoLevel {
        /// Study level, 1..=5.
        pub level: u8,
        /// Maximum relative error of an estimate at this level.
        pub noise: f64 where 0.0..=1.0,
        /// Price of a study of this level, dollars.
        pub cost: f64 where 0.0..=1e12,
        /// Days until a study of this level is finished.
        pub delay_days: u32 where 0.0..=100_000.0,
    }

    /// Target levels of studies and display of estimates (docs/mechanics/market/discovery.md).
    pub struct GroupResearch {
        /// Lowest target level of a study.
        pub min_target_level: u8 where 1.0..=5.0,
        /// Highest target level of a study.
        pub max_target_level: u8 where 1.0..=5.0,
        /// Largest word-of-mouth rate that is not reported, leads per subscriber per day.
        pub network_display_min: f64 where 0.0..=1e6,
        /// Largest reputation weight that is not reported.
        pub reputation_display_min: f64 where 0.0..=1e6,
        /// Decimals of the estimated budget.
        pub willingness_to_pay_decimals: u32 where 0.0..=15.0,
        /// Decimals of the estimated usage.
        pub usage_volume_decimals: u32 where 0.0..=15.0,
        /// Decimals of the estimated minimum quality.
        pub quality_floor_decimals: u32 where 0.0..=15.0,
        /// Decimals of the estimated aversion to long contracts.
        pub lockin_decimals: u32 where 0.0..=15.0,
        /// Decimals of the estimated market growth.
        pub growth_rate_decimals: u32 where 0.0..=15.0,
        /// Decimals of estimated word-of-mouth rates and reputation weights.
        pub influence_decimals: u32 where 0.0..=15.0,
        /// Decimals of the estimated reply delay.
        pub response_days_decimals: u32 where 0.0..=15.0,
    }
}
