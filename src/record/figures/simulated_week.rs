//! A week that was simulated: what it was like for the company and for each group.

use super::churn::churn;
use super::measured_group::MeasuredGroup;
use super::week::WeekFigures;
use novamind_world::events::Category;
use novamind_world::identifiers::{ByGroup, Group};

/// What is paid at once, and for nothing that goes on.
const PURCHASES: [Category; 3] =
    [Category::ResearchProject, Category::MarketResearch, Category::GroupResearch];

/// A group in a week.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GroupOfWeek {
    /// Its figures.
    pub measured: MeasuredGroup,
    /// Active subscriptions before its first day.
    pub subscribers_before: u32,
}

impl GroupOfWeek {
    /// Of the leads, those who signed; not a number without leads.
    pub fn conversion(&self) -> f64 {
        f64::from(self.measured.signed) / f64::from(self.measured.leads)
    }

    /// Cancellations as a share of the subscribers before; not a number without any.
    pub fn churn(&self) -> f64 {
        churn(self.measured.left.into(), self.subscribers_before.into()).unwrap_or(f64::NAN)
    }
}

/// Figures of a week, hidden ones included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimulatedWeek {
    /// Those that a player sees.
    pub figures: WeekFigures,
    /// Mean satisfaction of individuals at its end; not a number without any.
    pub satisfaction: f64,
    /// Those of the groups.
    pub groups: ByGroup<GroupOfWeek>,
}

impl SimulatedWeek {
    /// The same week, had nothing been bought in it: what was paid at once, and comes back in no other week.
    pub fn without_purchases(&self) -> SimulatedWeek {
        let mut figures = self.figures;
        for category in PURCHASES {
            let paid = figures.booked.of(category);
            figures.booked.add(category, -paid);
            figures.cash_change -= paid;
        }
        SimulatedWeek { figures, ..*self }
    }

    /// A week of which only the figures of the company are known.
    pub fn without_groups(figures: WeekFigures) -> SimulatedWeek {
        SimulatedWeek { figures, satisfaction: f64::NAN, groups: ByGroup::default() }
    }

    /// All customers who came.
    pub fn leads(&self) -> f64 {
        Group::all().map(|group| f64::from(self.groups[group].measured.leads)).sum()
    }

    /// Cancellations of individuals as a share of those who subscribed before; not a number without any.
    pub fn churn(&self) -> f64 {
        let individuals = Group::all().filter(|group| !group.is_enterprise());
        let before: u32 = individuals.map(|group| self.groups[group].subscribers_before).sum();
        churn(self.figures.cancellations.into(), before.into()).unwrap_or(f64::NAN)
    }

    /// What was booked as income, dollars.
    pub fn income(&self) -> f64 {
        self.figures.booked.entries().map(|(_, dollars)| dollars.max(0.0)).sum()
    }

    /// What was booked as costs, dollars.
    pub fn costs(&self) -> f64 {
        self.figures.booked.entries().map(|(_, dollars)| (-dollars).max(0.0)).sum()
    }

    /// What was booked as costs of a category, dollars.
    pub fn spent(&self, category: Category) -> f64 {
        // Without the sign of a nothing.
        0.0 - self.figures.booked.of(category)
    }
}
