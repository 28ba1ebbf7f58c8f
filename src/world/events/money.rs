//! Facts about cash.

use super::research::Study;
use crate::canonical::{Canonical, CanonicalHasher, CanonicalReader, Restore, canonical, canonical_codes};

canonical! {
    Payment { customer, amount }
    LedgerEntry { category, amount, note }
}
canonical_codes! {
    Category {
        InitialFunding, LeadAcquisitionCost, SubscriptionPayment, Capacity, Compute, Operations, Development, Advertising,
        AdRevenue, MarketResearch, GroupResearch, ResearchProject,
    }
}

/// A payment of a subscriber.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Payment {
    /// Number of the customer who paid.
    pub customer: u32,
    /// Dollars.
    pub amount: f64,
}

/// Category of a cash movement (`docs/mechanics/money.md`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Category {
    /// Initial funding.
    InitialFunding,
    /// Cost of a lead.
    LeadAcquisitionCost,
    /// Payment of a subscriber.
    SubscriptionPayment,
    /// Capacity of the day.
    Capacity,
    /// Compute of the day.
    Compute,
    /// Operations of the day.
    Operations,
    /// Development of the day.
    Development,
    /// Advertising of the day.
    Advertising,
    /// In-app ads of the day.
    AdRevenue,
    /// An attempt to discover a group.
    MarketResearch,
    /// A study of a group.
    GroupResearch,
    /// An R&D project.
    ResearchProject,
}

impl Category {
    /// All categories.
    pub const ALL: [Category; 12] = [
        Category::InitialFunding,
        Category::LeadAcquisitionCost,
        Category::SubscriptionPayment,
        Category::Capacity,
        Category::Compute,
        Category::Operations,
        Category::Development,
        Category::Advertising,
        Category::AdRevenue,
        Category::MarketResearch,
        Category::GroupResearch,
        Category::ResearchProject,
    ];

    /// Identifier as stored in tables.
    pub fn id(self) -> &'static str {
        match self {
            Category::InitialFunding => "initial_funding",
            Category::LeadAcquisitionCost => "lead_acquisition_cost",
            Category::SubscriptionPayment => "subscription_payment",
            Category::Capacity => "capacity",
            Category::Compute => "compute",
            Category::Operations => "operations",
            Category::Development => "development",
            Category::Advertising => "advertising",
            Category::AdRevenue => "ad_revenue",
            Category::MarketResearch => "market_research",
            Category::GroupResearch => "group_research",
            Category::ResearchProject => "research_project",
        }
    }
}

/// A cash movement other than a payment of a subscriber or a lead cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LedgerEntry {
    /// Category.
    pub category: Category,
    /// Dollars; costs are negative.
    pub amount: f64,
    /// Content of the note.
    pub note: LedgerNote,
}

/// Content of the note of a cash movement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LedgerNote {
    /// The general text of the category.
    General,
    /// The part targeted at groups, plans or customers.
    Targeted,
    /// Ad revenue from this many active subscribers.
    Subscribers(u32),
    /// An R&D project: tier and number.
    Project(u8, u32),
    /// A study of a group.
    Study(Study),
}

impl Canonical for LedgerNote {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        match *self {
            LedgerNote::General => (0u8, 0u32).feed(hasher),
            LedgerNote::Targeted => (1u8, 0u32).feed(hasher),
            LedgerNote::Subscribers(count) => (2u8, count).feed(hasher),
            LedgerNote::Project(tier, number) => (3u8, (tier, number)).feed(hasher),
            LedgerNote::Study(study) => (4u8, study).feed(hasher),
        }
    }
}

impl Restore for LedgerNote {
    fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
        Some(match reader.read::<u8>()? {
            0 => reader.read::<u32>().map(|_| LedgerNote::General)?,
            1 => reader.read::<u32>().map(|_| LedgerNote::Targeted)?,
            2 => LedgerNote::Subscribers(reader.read()?),
            3 => LedgerNote::Project(reader.read()?, reader.read()?),
            4 => LedgerNote::Study(reader.read()?),
            _ => return None,
        })
    }
}
