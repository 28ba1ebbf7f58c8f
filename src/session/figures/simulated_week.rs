//! A week that was simulated: what it was like for the company and for each group.

use super::groups::{GroupWeek, churn, mood_of};
use super::week::WeekFigures;
use novamind_world::customers::columns::Block;
use novamind_world::events::Category;
use novamind_world::identifiers::{ByGroup, Group};
use novamind_world::state::World;

/// What is paid at once, and for nothing that goes on.
const PURCHASES: [Category; 3] =
    [Category::ResearchProject, Category::MarketResearch, Category::GroupResearch];

/// Figures of a group over some days: what happened on them, and how things stand at the end of the last.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MeasuredGroup {
    /// Customers who came.
    pub leads: u32,
    /// Individuals who signed up, or companies whose first deal was accepted.
    pub signed: u32,
    /// Subscribers who cancelled.
    pub left: u32,
    /// Units used.
    pub usage: u64,
    /// Active subscriptions at the end.
    pub subscribers: u32,
    /// Those of them with an open issue.
    pub open_issues: u32,
    /// Reputation at the end.
    pub reputation: f64,
    /// Mean satisfaction of the subscribers; none without any.
    pub satisfaction: Option<f64>,
    /// Mean relationship of the subscribers, 0..=1; none without any.
    pub relationship: Option<f64>,
}

impl MeasuredGroup {
    /// Of a world at the end of days on which so much was counted.
    pub fn of(group: Group, counted: &GroupWeek, world: &World) -> MeasuredGroup {
        let (satisfaction, relationship) = mood_of(world, group).unzip();
        let own = &world.customers.groups[group];
        MeasuredGroup {
            leads: counted.leads,
            signed: counted.signed,
            left: counted.left,
            usage: counted.usage.0.iter().sum(),
            subscribers: own.active(),
            open_issues: own.blocks.iter().map(Block::open_issues).sum(),
            reputation: world.market.reputation.of(group),
            satisfaction,
            relationship,
        }
    }
}

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
