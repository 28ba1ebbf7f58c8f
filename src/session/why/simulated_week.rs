//! A week that was simulated: what it was like for the company and for each group.

use crate::counterfactual::branch::BranchOutcome;
use crate::counterfactual::kept_state::KeptState;
use crate::figures::churn::churn;
use crate::figures::week::WeekFigures;
use crate::xray::measured_group::MeasuredGroup;
use novamind_world::events::Category;
use novamind_world::identifiers::{ByGroup, Group};

/// What is paid at once, and for nothing that goes on.
const PURCHASES: [Category; 3] =
    [Category::ResearchProject, Category::MarketResearch, Category::GroupResearch];

/// A group in a week.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct GroupOfWeek {
    /// Its figures.
    pub measured: MeasuredGroup,
    /// Active subscriptions before its first day.
    pub subscribers_before: u32,
}

impl GroupOfWeek {
    /// Of the leads, those who signed; not a number without leads.
    pub(super) fn conversion(&self) -> f64 {
        f64::from(self.measured.signed) / f64::from(self.measured.leads)
    }

    /// Cancellations as a share of the subscribers before; not a number without any.
    pub(super) fn churn(&self) -> f64 {
        churn(self.measured.left.into(), self.subscribers_before.into()).unwrap_or(f64::NAN)
    }
}

/// Figures of a week, hidden ones included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SimulatedWeek {
    /// Those that a player sees.
    pub figures: WeekFigures,
    /// Mean satisfaction of individuals at its end; not a number without any.
    pub satisfaction: f64,
    /// Those of the groups.
    pub groups: ByGroup<GroupOfWeek>,
}

impl SimulatedWeek {
    /// The last week of days that were simulated after a moment; they are no more than this week.
    pub(super) fn of(before: &KeptState, outcome: &BranchOutcome) -> SimulatedWeek {
        let measured = outcome.groups.last().copied().unwrap_or_default();
        SimulatedWeek {
            figures: outcome.weeks.last().copied().unwrap_or_default(),
            satisfaction: outcome.satisfaction.last().copied().unwrap_or(f64::NAN),
            groups: ByGroup::from_fn(|group| GroupOfWeek {
                measured: measured[group],
                subscribers_before: before.world.customers.groups[group].active(),
            }),
        }
    }

    /// The same week, had nothing been bought in it: what was paid at once, and comes back in no other week.
    pub(super) fn without_purchases(&self) -> SimulatedWeek {
        let mut figures = self.figures;
        for category in PURCHASES {
            let paid = figures.booked.of(category);
            figures.booked.add(category, -paid);
            figures.cash_change -= paid;
        }
        SimulatedWeek { figures, ..*self }
    }

    /// A week of which only the figures of the company are known.
    pub(super) fn without_groups(figures: WeekFigures) -> SimulatedWeek {
        SimulatedWeek { figures, satisfaction: f64::NAN, groups: ByGroup::default() }
    }

    /// All customers who came.
    pub(super) fn leads(&self) -> f64 {
        Group::all().map(|group| f64::from(self.groups[group].measured.leads)).sum()
    }

    /// Cancellations of individuals as a share of those who subscribed before; not a number without any.
    pub(super) fn churn(&self) -> f64 {
        let individuals = Group::all().filter(|group| !group.is_enterprise());
        let before: u32 = individuals.map(|group| self.groups[group].subscribers_before).sum();
        churn(self.figures.cancellations.into(), before.into()).unwrap_or(f64::NAN)
    }

    /// What was booked as income, dollars.
    pub(super) fn income(&self) -> f64 {
        self.figures.booked.entries().map(|(_, dollars)| dollars.max(0.0)).sum()
    }

    /// What was booked as costs, dollars.
    pub(super) fn costs(&self) -> f64 {
        self.figures.booked.entries().map(|(_, dollars)| (-dollars).max(0.0)).sum()
    }

    /// What was booked as costs of a category, dollars.
    pub(super) fn spent(&self, category: Category) -> f64 {
        // Without the sign of a nothing.
        0.0 - self.figures.booked.of(category)
    }
}
