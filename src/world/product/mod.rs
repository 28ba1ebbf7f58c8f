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

/// The quality that development and R&D added, and the part that competitors can still copy
/// (`docs/mechanics/product/development.md#banks`).
#[derive(Debug, Clone, PartialEq)]
pub struct Product {
    /// General bonus: quality that was added for all groups, including noise.
    pub shared_bonus: f64,
    /// Group bonus: quality that was added for each group.
    pub group_bonus: ByGroup<f64>,
    /// Shared quality bank: general bonus that competitors have not copied yet.
    pub shared_bank: f64,
    /// Targeted quality banks: group bonus that competitors have not copied yet.
    pub group_bank: ByGroup<f64>,
    /// R&D projects, in the order of their start.
    pub research: Vec<Project>,
}

canonical! {
    Product { shared_bonus, group_bonus, shared_bank, group_bank, research }
}

impl Product {
    /// Returns the product on day 0.
    pub fn initial(params: &Params) -> Product {
        Product {
            shared_bonus: params.initial.q_shared_bonus,
            group_bonus: ByGroup::default(),
            shared_bank: 0.0,
            group_bank: ByGroup::default(),
            research: Vec::new(),
        }
    }

    /// Returns the product quality for a group, before multiplication by the model's multiplier.
    pub fn quality(&self, group: Group, params: &Params) -> f64 {
        params.quality.base_product_quality + self.shared_bonus + self.group_bonus[group]
    }
}
