//! Tools for capacity, and for the costs of capacity and models.

mod get_cost_info;
mod set_capacity_tier;

pub use get_cost_info::{CapacityTierFacts, GetCostInfo, ModelTierFacts, PriceList};
pub use set_capacity_tier::SetCapacityTier;
