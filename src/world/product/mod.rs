//! The product: usage, service, quality, development, research and ad revenue.

pub mod ads;
pub mod development;
pub mod research;
pub mod research_distribution;
pub mod service;
pub mod usage;

use super::canonical::canonical;
use super::events::Project;
use super::identifiers::{ByGroup, Group};
use super::params::Params;

/// The results of development, and the part of them that competitors can still copy
/// (`docs/mechanics/product/development.md#banks`).
#[derive(Debug, Clone, PartialEq)]
pub struct Product {
    /// Quality gained for all groups, including noise.
    pub shared_bonus: f64,
    /// Quality gained for single groups.
    pub group_bonus: ByGroup<f64>,
    /// Shared improvements that no competitor has copied yet.
    pub shared_bank: f64,
    /// Targeted improvements that no competitor has copied yet.
    pub group_bank: ByGroup<f64>,
    /// R&D projects, in order of their start.
    pub research: Vec<Project>,
}

canonical! {
    Product { shared_bonus, group_bonus, shared_bank, group_bank, research }
}

impl Product {
    /// Returns the product of day 0.
    pub fn initial(params: &Params) -> Product {
        Product {
            shared_bonus: params.initial.q_shared_bonus,
            group_bonus: ByGroup::default(),
            shared_bank: 0.0,
            group_bank: ByGroup::default(),
            research: Vec::new(),
        }
    }

    /// Returns the product quality for a group before the model's multiplier.
    pub fn quality(&self, group: Group, params: &Params) -> f64 {
        params.quality.base_product_quality + self.shared_bonus + self.group_bonus[group]
    }
}
