//! What a week booked, by category of the ledger.

use serde::{Deserialize, Serialize};

use novamind_world::events::Category;

/// Dollars booked by category; costs are negative. Their sum is the change of cash.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Booked([f64; Category::ALL.len()]);

impl Booked {
    /// Books an amount.
    pub fn add(&mut self, category: Category, dollars: f64) {
        self.0[category as usize] += dollars;
    }

    /// Dollars of a category.
    pub fn of(&self, category: Category) -> f64 {
        self.0[category as usize]
    }

    /// Everything that was booked together, dollars.
    pub fn sum(&self) -> f64 {
        self.0.iter().sum()
    }

    /// Every category that was booked, with its dollars.
    pub fn entries(&self) -> impl Iterator<Item = (Category, f64)> + '_ {
        Category::ALL.into_iter().map(|category| (category, self.of(category))).filter(|(_, sum)| *sum != 0.0)
    }
}
