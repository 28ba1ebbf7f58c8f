//! Ledger totals of a week by category.

use serde::{Deserialize, Serialize};

use novamind_world::events::Category;

/// Ledger totals in dollars by category; costs are negative. Their sum is the change of cash.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct CategoryTotals([f64; Category::ALL.len()]);

impl CategoryTotals {
    /// Adds an amount to a category.
    pub fn add(&mut self, category: Category, dollars: f64) {
        self.0[category as usize] += dollars;
    }

    /// Returns the dollars of a category.
    pub fn total_of(&self, category: Category) -> f64 {
        self.0[category as usize]
    }

    /// Returns the sum of all categories, in dollars.
    pub fn sum(&self) -> f64 {
        self.0.iter().sum()
    }

    /// Returns the categories with entries, with their dollars.
    pub fn entries(&self) -> impl Iterator<Item = (Category, f64)> + '_ {
        Category::ALL
            .into_iter()
            .map(|category| (category, self.total_of(category)))
            .filter(|(_, sum)| *sum != 0.0)
    }
}
