//! Facts about payments and other cash movements.

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
    /// Amount of the payment, dollars.
    pub amount: f64,
}

/// Category of a cash movement (`docs/mechanics/money.md`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Category {
    /// Cash with which the company starts on day 0.
    InitialFunding,
    /// Cost of every lead, in addition to advertising.
    LeadAcquisitionCost,
    /// Payment of a subscriber.
    SubscriptionPayment,
    /// Daily cost of capacity.
    Capacity,
    /// Daily cost of compute.
    Compute,
    /// Daily spending on operations.
    Operations,
    /// Daily spending on development.
    Development,
    /// Daily spending on advertising.
    Advertising,
    /// Daily revenue from in-app advertising.
    AdRevenue,
    /// Price of an attempt to discover a group.
    MarketResearch,
    /// Price of a market study.
    GroupResearch,
    /// Price of an R&D project.
    ResearchProject,
}

impl Category {
    /// All categories, in declaration order.
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

    /// Returns the identifier that tables use for the category.
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
    /// What the money was spent on or received for.
    pub category: Category,
    /// Amount in dollars. Costs are negative.
    pub amount: f64,
    /// Data from which the note of the entry is written.
    pub note: LedgerNote,
}

/// Data from which the note on a cash movement is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LedgerNote {
    /// The default note of the category.
    General,
    /// Spending that targets groups, plans or customers.
    Targeted,
    /// Number of active subscribers, for ad revenue.
    Subscribers(u32),
    /// Tier and number of an R&D project.
    Project(u8, u32),
    /// The market study that was paid for.
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
