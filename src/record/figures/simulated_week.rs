//! Figures of a simulated week for the company and for each group.

use super::churn::churn;
use super::group_figures::GroupFigures;
use super::week::WeekFigures;
use novamind_world::events::Category;
use novamind_world::identifiers::{ByGroup, Group};

const PURCHASE_CATEGORIES: [Category; 3] =
    [Category::ResearchProject, Category::MarketResearch, Category::GroupResearch];

/// Figures of a group in a week.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WeekGroupFigures {
    /// Sums over the week, and the state at its end.
    pub figures: GroupFigures,
    /// Active subscriptions before the first day of the week.
    pub subscribers_before: u32,
}

impl WeekGroupFigures {
    /// Returns signups as a share of leads, or NaN if there were no leads.
    pub fn conversion(&self) -> f64 {
        f64::from(self.figures.signed) / f64::from(self.figures.leads)
    }

    /// Returns cancellations as a share of the subscribers before the week, or NaN if there were no subscribers.
    pub fn churn(&self) -> f64 {
        churn(self.figures.left.into(), self.subscribers_before.into()).unwrap_or(f64::NAN)
    }
}

/// Figures of a week, including hidden figures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimulatedWeek {
    /// Figures that are visible to the player.
    pub figures: WeekFigures,
    /// Mean satisfaction of individuals at the end of the week, or NaN if there are no subscribers.
    pub satisfaction: f64,
    /// Figures of each group.
    pub groups: ByGroup<WeekGroupFigures>,
}

impl SimulatedWeek {
    /// Returns the week without its one-time purchases.
    pub fn without_purchases(&self) -> SimulatedWeek {
        let mut figures = self.figures;
        for category in PURCHASE_CATEGORIES {
            let paid = figures.booked.category_total(category);
            figures.booked.add(category, -paid);
            figures.cash_change -= paid;
        }
        SimulatedWeek { figures, ..*self }
    }

    /// Returns a week with company figures and without group figures.
    pub fn from_company_figures(figures: WeekFigures) -> SimulatedWeek {
        SimulatedWeek { figures, satisfaction: f64::NAN, groups: ByGroup::default() }
    }

    /// Returns the number of leads in all groups.
    pub fn total_leads(&self) -> f64 {
        Group::all().map(|group| f64::from(self.groups[group].figures.leads)).sum()
    }

    /// Returns the churn of individuals, or NaN if there were no subscribers before the week.
    pub fn individual_churn(&self) -> f64 {
        let individuals = Group::all().filter(|group| !group.is_enterprise());
        let before: u32 = individuals.map(|group| self.groups[group].subscribers_before).sum();
        churn(self.figures.cancellations.into(), before.into()).unwrap_or(f64::NAN)
    }

    /// Returns the income of the week, in dollars.
    pub fn income(&self) -> f64 {
        self.figures.booked.nonzero_totals().map(|(_, dollars)| dollars.max(0.0)).sum()
    }

    /// Returns the costs of the week as a positive amount, in dollars.
    pub fn costs(&self) -> f64 {
        self.figures.booked.nonzero_totals().map(|(_, dollars)| (-dollars).max(0.0)).sum()
    }

    /// Returns the week's costs in a category as a positive amount, in dollars.
    pub fn category_costs(&self, category: Category) -> f64 {
        // Subtracting from 0.0 avoids negative zero.
        0.0 - self.figures.booked.category_total(category)
    }
}
