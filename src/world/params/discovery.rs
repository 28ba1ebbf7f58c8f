//! Finding and studying groups: `configs/world/discovery.toml`.

use serde::{Deserialize, Serialize};

/// Finding groups (chapter 30 §11).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MarketResearch {
    /// Dollars per attempt.
    pub discovery_cost_level_1: f64,
    /// Chance that an attempt finds a group.
    pub market_research_discover_prob: f64,
}

/// One level of knowledge about a group (chapter 30 §12).
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
