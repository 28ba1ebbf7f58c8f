//! Finding and studying groups: `configs/world/discovery.toml`.

use super::check::parameters;

parameters! {
    /// Finding groups (docs/mechanics/market/discovery.md).
    pub struct MarketResearch {
        /// Dollars per attempt.
        pub discovery_cost_level_1: f64 where 0.0..=1e12,
        /// Chance that an attempt finds a group.
        pub market_research_discover_prob: f64 where 0.0..=1.0,
    }

    /// One level of knowledge about a group (docs/mechanics/market/discovery.md).
    pub struct InfoLevel {
        /// Info level, 1..=5.
        pub level: u8,
        /// Largest relative error of an estimate at this level.
        pub noise: f64 where 0.0..=1.0,
        /// Price in dollars.
        pub cost: f64 where 0.0..=1e12,
        /// Days until a study of this level is finished.
        pub delay_days: u32 where 0.0..=100_000.0,
    }

    /// What a study may aim at, and how its estimates are shown (docs/mechanics/market/discovery.md).
    pub struct GroupResearch {
        /// Lowest level a study may aim at.
        pub min_target_level: u8 where 1.0..=5.0,
        /// Highest level a study may aim at.
        pub max_target_level: u8 where 1.0..=5.0,
        /// Referral rates up to this one are not reported, leads a day and subscriber.
        pub network_display_min: f64 where 0.0..=1e6,
        /// Weights of reputation up to this one are not reported.
        pub reputation_display_min: f64 where 0.0..=1e6,
        /// Decimals of the budget.
        pub willingness_to_pay_decimals: u32 where 0.0..=15.0,
        /// Decimals of the usage.
        pub usage_volume_decimals: u32 where 0.0..=15.0,
        /// Decimals of the quality floor.
        pub quality_floor_decimals: u32 where 0.0..=15.0,
        /// Decimals of the aversion to long contracts.
        pub lockin_decimals: u32 where 0.0..=15.0,
        /// Decimals of the growth of the market.
        pub growth_rate_decimals: u32 where 0.0..=15.0,
        /// Decimals of referral rates and weights of reputation.
        pub influence_decimals: u32 where 0.0..=15.0,
        /// Decimals of the reply delay.
        pub response_days_decimals: u32 where 0.0..=15.0,
    }
}
