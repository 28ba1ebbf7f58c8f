//! Facts about the company and its environment: settings, service, research, notifications.

use super::economy::Reading;
use super::research::{Project, Study};
use crate::canonical::{Canonical, CanonicalHasher, CanonicalReader, Restore, canonical};
use crate::identifiers::Group;

canonical! {
    Reaction { post, views, mean, strongest }
    ServiceDay { total_usage, overload, outage, downtime_minutes, p95_ms, error_rate, capacity_tier, capacity_units }
}

/// Service health of a day.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ServiceDay {
    /// Units used by all customers.
    pub total_usage: u64,
    /// Usage above capacity as a share of capacity, 0 if capacity sufficed.
    pub overload: f64,
    /// Whether there was an outage.
    pub outage: bool,
    /// Downtime in minutes: 0, 10, 30 or 90.
    pub downtime_minutes: u32,
    /// Latency in milliseconds.
    pub p95_ms: f64,
    /// Share of failed requests, 0..=1.
    pub error_rate: f64,
    /// Capacity tier in force.
    pub capacity_tier: u8,
    /// Units a day of that tier.
    pub capacity_units: u32,
}

impl ServiceDay {
    /// Returns a day without load or problems.
    pub fn without_load() -> ServiceDay {
        ServiceDay {
            total_usage: 0,
            overload: 0.0,
            outage: false,
            downtime_minutes: 0,
            p95_ms: 0.0,
            error_rate: 0.0,
            capacity_tier: 0,
            capacity_units: 0,
        }
    }
}

/// An R&D project that started or finished.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ResearchChange {
    /// Paid for and started.
    Started(Project),
    /// Finished today.
    Completed(Project),
}

impl Canonical for ResearchChange {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        match self {
            ResearchChange::Started(project) => (0u8, *project).feed(hasher),
            ResearchChange::Completed(project) => (1u8, *project).feed(hasher),
        }
    }
}

impl Restore for ResearchChange {
    fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
        Some(match reader.read::<u8>()? {
            0 => ResearchChange::Started(reader.read()?),
            1 => ResearchChange::Completed(reader.read()?),
            _ => return None,
        })
    }
}

/// A notification for the inbox; the `voice` crate writes its text.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Notice {
    /// An enterprise requests an offer.
    EnterpriseLead,
    /// A lead was lost because the player did not answer for this many days.
    LeadLostByTimeout {
        /// Days since its last turn.
        days: u32,
    },
    /// A lead that was lost before is reported again, every day, because its thread keeps triggering.
    LeadLossRepeated {
        /// Days since the active turn of the thread.
        days: u32,
        /// Customer number of the enterprise.
        customer: u32,
        /// Why it was lost.
        cause: LossCause,
        /// Day of the unanswered message.
        message_day: u32,
    },
    /// An enterprise that requested an offer fell silent.
    LeadSilent,
    /// An enterprise made a counter-offer.
    CounterOffer {
        /// Customer number of the enterprise.
        customer: u32,
    },
    /// A customer threatens to leave.
    ChurnThreat {
        /// Customer number of the enterprise.
        customer: u32,
    },
    /// A customer requests another plan.
    PlanChangeRequest {
        /// Customer number of the enterprise.
        customer: u32,
        /// Whether the requested plan is higher.
        upgrade: bool,
    },
    /// A deal was closed at this price, dollars a month and seat.
    DealWon {
        /// Price.
        price: f64,
    },
    /// An R&D project is finished.
    ResearchComplete {
        /// Tier, 1..=20.
        tier: u8,
        /// Number of the project within the tier, from 1.
        number: u32,
    },
    /// A reading of the economy was published.
    EconomyUpdate(Reading),
    /// Market research discovered a group.
    GroupFound {
        /// The group.
        group: Group,
        /// Number of the attempt, from 1.
        attempt: u32,
    },
    /// A study of a group is finished.
    StudyComplete {
        /// The study.
        study: Study,
        /// Largest relative error of its estimates.
        noise: f64,
    },
    /// A post of the player was seen and judged.
    OwnPostSeen(Reaction),
}

/// Why a lead was lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LossCause {
    /// The enterprise did not answer the player's offer.
    Silence,
    /// The player did not answer the enterprise's message.
    Unanswered,
}

/// The public reaction to a post of the player.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reaction {
    /// Number of the post.
    pub post: u32,
    /// How often it was seen.
    pub views: u64,
    /// Mean reaction of the groups that judged it, -1..=1.
    pub mean: f64,
    /// The strongest reactions, in descending order.
    pub strongest: [Option<(Group, f64)>; 3],
}

impl Notice {
    /// Type as stored in tables.
    pub fn kind(&self) -> &'static str {
        match self {
            Notice::EnterpriseLead
            | Notice::CounterOffer { .. }
            | Notice::ChurnThreat { .. }
            | Notice::PlanChangeRequest { .. } => "large_customer_message",
            Notice::LeadLostByTimeout { .. } | Notice::LeadLossRepeated { .. } | Notice::LeadSilent => {
                "lead_lost"
            }
            Notice::DealWon { .. } => "deal_won",
            Notice::ResearchComplete { .. } => "research_complete",
            Notice::EconomyUpdate(_) => "macro_economic_update",
            Notice::GroupFound { .. } => "market_discovery",
            Notice::StudyComplete { .. } => "group_research_complete",
            Notice::OwnPostSeen(_) => "social_media",
        }
    }
}

impl Canonical for Notice {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        match *self {
            Notice::EnterpriseLead => 0u8.feed(hasher),
            // Trajectories do not distinguish the two causes.
            Notice::LeadLostByTimeout { days } | Notice::LeadLossRepeated { days, .. } => {
                (1u8, days).feed(hasher)
            }
            Notice::ResearchComplete { tier, number } => (2u8, (tier, number)).feed(hasher),
            Notice::EconomyUpdate(reading) => (3u8, reading).feed(hasher),
            Notice::GroupFound { group, attempt } => (4u8, (group, attempt)).feed(hasher),
            Notice::StudyComplete { study, noise } => (5u8, (study, noise)).feed(hasher),
            Notice::LeadSilent => 10u8.feed(hasher),
            Notice::CounterOffer { customer } => (11u8, customer).feed(hasher),
            Notice::ChurnThreat { customer } => (12u8, customer).feed(hasher),
            Notice::PlanChangeRequest { customer, upgrade } => (13u8, (customer, upgrade)).feed(hasher),
            Notice::DealWon { price } => (14u8, price).feed(hasher),
            Notice::OwnPostSeen(reaction) => (20u8, reaction).feed(hasher),
        }
    }
}

impl Restore for Notice {
    fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
        Some(match reader.read::<u8>()? {
            0 => Notice::EnterpriseLead,
            1 => Notice::LeadLostByTimeout { days: reader.read()? },
            2 => Notice::ResearchComplete { tier: reader.read()?, number: reader.read()? },
            3 => Notice::EconomyUpdate(reader.read()?),
            4 => Notice::GroupFound { group: reader.read()?, attempt: reader.read()? },
            5 => Notice::StudyComplete { study: reader.read()?, noise: reader.read()? },
            10 => Notice::LeadSilent,
            11 => Notice::CounterOffer { customer: reader.read()? },
            12 => Notice::ChurnThreat { customer: reader.read()? },
            13 => Notice::PlanChangeRequest { customer: reader.read()?, upgrade: reader.read()? },
            14 => Notice::DealWon { price: reader.read()? },
            20 => Notice::OwnPostSeen(reader.read()?),
            _ => return None,
        })
    }
}
