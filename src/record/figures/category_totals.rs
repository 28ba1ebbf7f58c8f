//! Ledger totals of a week by category.

use serde::{Deserialize, Serialize};

use novamind_world::events::Category;

/// Ledger totals in dollars by category; costs are negative. The sum of all totals is the cash change.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct CategoryTotals([f64; Category::ALL.len()]);

impl CategoryTotals {
    /// Adds an amount in dollars to the total of a category.
    pub fn add(&mut self, category: Category, dollars: f64) {
        self.0[category as usize] += dollars;
    }

    /// Returns the total of a category, in dollars.
    pub fn category_total(&self, category: Category) -> f64 {
        self.0[category as usize]
    }

    /// Returns the sum of all categories, in dollars.
    pub fn sum(&self) -> f64 {
        self.0.iter().sum()
    }

    /// Returns each category with a nonzero total, and its total in dollars.
    pub fn nonzero_totals(&self) -> impl Iterator<Item = (Category, f64)> + '_ {
        Category::ALL
            .into_iter()
            .map(|category| (category, self.category_total(category)))
            .filter(|(_, sum)| *sum != 0.0)
    }
}
