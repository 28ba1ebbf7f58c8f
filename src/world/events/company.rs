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
    /// Whether the service had an outage.
    pub outage: bool,
    /// Downtime in minutes: 0, 10, 30 or 90.
    pub downtime_minutes: u32,
    /// 95th percentile of the latency, in milliseconds.
    pub p95_ms: f64,
    /// Share of failed requests, 0..=1.
    pub error_rate: f64,
    /// Capacity tier that the company rented, 0..=7.
    pub capacity_tier: u8,
    /// Capacity of the tier, units per day.
    pub capacity_units: u32,
}

impl ServiceDay {
    /// Returns the service health of a day without usage or problems.
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

/// The start or completion of an R&D project.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ResearchChange {
    /// A project that was paid for and started.
    Started(Project),
    /// A project that was completed today.
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
    /// Request of an enterprise for an offer.
    EnterpriseLead,
    /// Loss of a lead because the player did not answer before the deadline.
    LeadLostByTimeout {
        /// Days since the last turn of the thread.
        days: u32,
    },
    /// Report of a lost lead, repeated daily while the lead's thread still triggers.
    LeadLossRepeated {
        /// Days since the active turn of the lead's thread.
        days: u32,
        /// Customer number of the enterprise.
        customer: u32,
        /// Reason why the lead was lost.
        cause: LossCause,
        /// Day of the unanswered message.
        message_day: u32,
    },
    /// End of a lead's thread because the enterprise did not reply.
    LeadSilent,
    /// Counter-offer of an enterprise.
    CounterOffer {
        /// Customer number of the enterprise.
        customer: u32,
    },
    /// Threat of a subscribed enterprise to cancel.
    ChurnThreat {
        /// Customer number of the enterprise.
        customer: u32,
    },
    /// Request of a subscribed enterprise for a different plan.
    PlanChangeRequest {
        /// Customer number of the enterprise.
        customer: u32,
        /// Whether the requested plan comes after the current plan in the order A, B, C.
        upgrade: bool,
    },
    /// Deal with an enterprise.
    DealWon {
        /// Agreed price, dollars per seat per month.
        price: f64,
    },
    /// Completion of an R&D project.
    ResearchComplete {
        /// Tier of the project, 1..=20.
        tier: u8,
        /// Number of the project within the tier, from 1.
        number: u32,
    },
    /// Publication of a PMI reading.
    EconomyUpdate(Reading),
    /// Discovery of a group by market research.
    GroupFound {
        /// Group that the player knows from now on.
        group: Group,
        /// Number of the market research attempt, from 1.
        attempt: u32,
    },
    /// Completion of a market study.
    StudyComplete {
        /// Group, levels and due day of the study.
        study: Study,
        /// Largest relative error of the study's estimates.
        noise: f64,
    },
    /// Public reaction to a post of the player.
    OwnPostSeen(Reaction),
}

/// Reason why a lead was lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LossCause {
    /// The enterprise did not reply to the player's offer.
    Silence,
    /// The player did not answer the enterprise's message.
    Unanswered,
}

/// The public reaction to a post of the player.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reaction {
    /// Number of the post among the player's posts, from 1.
    pub post: u32,
    /// Number of views of the post.
    pub views: u64,
    /// Mean reaction of the groups that judged the post, -1..=1.
    pub mean: f64,
    /// The groups with the strongest reactions, in descending order of strength.
    pub strongest: [Option<(Group, f64)>; 3],
}

impl Notice {
    /// Returns the notice type that tables store.
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
            // Trajectories do not distinguish a first report from a repeated one.
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
