//! Finding and studying groups: `configs/world/discovery.toml`.

use serde::{Deserialize, Serialize};

/// Finding groups (docs/mechanics/market/discovery.md).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MarketResearch {
    /// Dollars per attempt.
    pub discovery_cost_level_1: f64,
    /// Chance that an attempt finds a group.
    pub market_research_discover_prob: f64,
}

/// One level of knowledge about a group (docs/mechanics/market/discovery.md).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InfoLevel {
    /// Info level, 1..=5.
    pub level: u8,
    /// Largest relative error of an estimate at this level.
    pub noise: f64,
    /// Price in dollars.
    pub cost: f64,
    /// Days until a study of this level is finished.
    pub delay_days: u32,
}

/// What a study may aim at, and how its estimates are shown (docs/mechanics/market/discovery.md).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroupResearch {
    /// Lowest level a study may aim at.
    pub min_target_level: u8,
    /// Highest level a study may aim at.
    pub max_target_level: u8,
    /// Referral rates up to this one are not reported, leads a day and subscriber.
    pub network_display_min: f64,
    /// Weights of reputation up to this one are not reported.
    pub reputation_display_min: f64,
    /// Decimals of the budget.
    pub willingness_to_pay_decimals: u32,
    /// Decimals of the usage.
    pub usage_volume_decimals: u32,
    /// Decimals of the quality floor.
    pub quality_floor_decimals: u32,
    /// Decimals of the aversion to long contracts.
    pub lockin_decimals: u32,
    /// Decimals of the growth of the market.
    pub growth_rate_decimals: u32,
    /// Decimals of referral rates and weights of reputation.
    pub influence_decimals: u32,
    /// Decimals of the reply delay.
    pub response_days_decimals: u32,
}
