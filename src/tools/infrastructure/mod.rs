//! Capacity and the price list.

mod get_cost_info;
mod set_capacity_tier;

pub use get_cost_info::{CapacityTierFacts, GetCostInfo, ModelTierFacts, PriceList};
pub use set_capacity_tier::SetCapacityTier;
