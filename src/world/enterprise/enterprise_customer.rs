//! Enterprises that negotiate: their fixed traits and their status.

use crate::canonical::{Canonical, CanonicalHasher, CanonicalReader, Restore, canonical};
use crate::customers::Customers;
use crate::customers::columns::Subscriber;
use crate::customers::persona::PersonaPicks;
use crate::customers::traits::Negotiator;
use crate::identifiers::Group;
use crate::params::{EnterpriseParams as Sales, Params};
use crate::random::{Part, Streams};

/// An enterprise that requested an offer and whose state is still tracked.
#[derive(Debug, Clone, PartialEq)]
pub struct EnterpriseCustomer {
    /// Customer number, unique across all groups.
    pub customer: u32,
    /// Group to which the enterprise belongs.
    pub group: Group,
    /// Sequence number of the enterprise within its group.
    pub n: u32,
    /// Number of the subscription row, which the enterprise keeps from lead to cancellation.
    pub subscription: u32,
    /// Negotiation traits of the enterprise.
    pub negotiator: Negotiator,
    /// Profile attributes of the enterprise.
    pub persona: PersonaPicks,
    /// Last day of the most recently agreed month; 0 before the first deal.
    pub contract_end_day: u32,
    /// Current status of the enterprise.
    pub status: EnterpriseStatus,
}

/// Status of an enterprise: lead, subscriber or lost.
#[derive(Debug, Clone, PartialEq)]
pub enum EnterpriseStatus {
    /// A lead that negotiates its first deal, with the row that it will have as a subscriber.
    Lead(Subscriber),
    /// A subscriber. Its row is in the columns.
    Subscriber,
    /// A lost enterprise with its last row, which is kept while one of its threads can still trigger.
    Lost(Subscriber),
}

canonical! {
    EnterpriseCustomer { customer, group, n, subscription, negotiator, persona, contract_end_day, status }
    Negotiator { reply_delay_mean, reply_delay_std, initial_offer_factor, max_negotiation_turns }
}

impl Canonical for EnterpriseStatus {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        match self {
            EnterpriseStatus::Lead(row) => (0u8, *row).feed(hasher),
            EnterpriseStatus::Subscriber => 1u8.feed(hasher),
            EnterpriseStatus::Lost(row) => (2u8, *row).feed(hasher),
        }
    }
}

impl Restore for EnterpriseStatus {
    fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
        Some(match reader.read::<u8>()? {
            0 => EnterpriseStatus::Lead(reader.read()?),
            1 => EnterpriseStatus::Subscriber,
            2 => EnterpriseStatus::Lost(reader.read()?),
            _ => return None,
        })
    }
}

impl EnterpriseCustomer {
    /// Returns the row of the enterprise, from its status or from the columns.
    pub fn row(&self, customers: &Customers) -> Option<Subscriber> {
        match self.status {
            EnterpriseStatus::Lead(row) | EnterpriseStatus::Lost(row) => Some(row),
            EnterpriseStatus::Subscriber => customers.groups[self.group].subscriber(self.n),
        }
    }

    /// Returns whether the enterprise has an active subscription.
    pub fn is_subscriber(&self) -> bool {
        self.status == EnterpriseStatus::Subscriber
    }

    /// Sets the relationship of the enterprise, in its status or in the columns.
    pub fn set_relationship(&mut self, relationship: f64, customers: &mut Customers) {
        match &mut self.status {
            EnterpriseStatus::Lead(row) | EnterpriseStatus::Lost(row) => row.relationship = relationship,
            EnterpriseStatus::Subscriber => {
                let group_customers = &mut customers.groups[self.group];
                if let Some((block, at)) = group_customers.subscriber_position(self.n) {
                    group_customers.blocks[block].relationship[at] = relationship;
                }
            }
        }
    }

    /// Returns the factor by which the enterprise misjudges quality in its first negotiation. The factor is constant
    /// for each enterprise.
    pub fn first_impression_factor(&self, params: &Params, streams: &Streams) -> f64 {
        let quality = &params.quality;
        streams
            .open_for_day(0, Part::NegotiationNoise, [self.group.index() as u64, u64::from(self.n)])
            .between(quality.initial_decision_noise_min, quality.initial_decision_noise_max)
    }
}

/// Returns the relationship after a change, clamped to its bounds.
pub fn adjust_relationship(relationship: f64, change: f64, sales: &Sales) -> f64 {
    (relationship + change).clamp(sales.relationship_min, sales.relationship_max)
}
