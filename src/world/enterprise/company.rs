//! Companies that negotiate: what stays the same about them, and where they stand.

use crate::canonical::{Canonical, CanonicalHasher, CanonicalReader, Restore, canonical};
use crate::customers::Customers;
use crate::customers::columns::Subscriber;
use crate::customers::persona::PersonaPicks;
use crate::customers::traits::Negotiator;
use crate::identifiers::Group;
use crate::params::{EnterpriseParams as Sales, Params};
use crate::random::{Part, Streams};

/// A company that has asked for an offer and is not forgotten yet.
#[derive(Debug, Clone, PartialEq)]
pub struct Company {
    /// Customer number.
    pub customer: u32,
    /// Group.
    pub group: Group,
    /// Running number within the group.
    pub n: u32,
    /// Subscription number.
    pub subscription: u32,
    /// How it negotiates.
    pub negotiator: Negotiator,
    /// Picks of its profile.
    pub persona: PersonaPicks,
    /// Day on which the month ends that was agreed on last; 0 before the first deal.
    pub contract_end_day: u32,
    /// Where it stands.
    pub standing: Standing,
}

/// Where a company stands.
#[derive(Debug, Clone, PartialEq)]
pub enum Standing {
    /// It negotiates about a first deal; the row it will have as a subscriber.
    Lead(Subscriber),
    /// It is a subscriber: its row stands in the columns.
    Subscriber,
    /// It was lost; its row as of then, while a thread of it still fires.
    Gone(Subscriber),
}

canonical! {
    Company { customer, group, n, subscription, negotiator, persona, contract_end_day, standing }
    Negotiator { reply_delay_mean, reply_delay_std, initial_offer_factor, max_negotiation_turns }
}

impl Canonical for Standing {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        match self {
            Standing::Lead(row) => (0u8, *row).feed(hasher),
            Standing::Subscriber => 1u8.feed(hasher),
            Standing::Gone(row) => (2u8, *row).feed(hasher),
        }
    }
}

impl Restore for Standing {
    fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
        Some(match reader.read::<u8>()? {
            0 => Standing::Lead(reader.read()?),
            1 => Standing::Subscriber,
            2 => Standing::Gone(reader.read()?),
            _ => return None,
        })
    }
}

impl Company {
    /// Its row, wherever that stands.
    pub fn row(&self, customers: &Customers) -> Option<Subscriber> {
        match self.standing {
            Standing::Lead(row) | Standing::Gone(row) => Some(row),
            Standing::Subscriber => customers.groups[self.group].row(self.n),
        }
    }

    /// Whether it has an active subscription.
    pub fn is_subscriber(&self) -> bool {
        self.standing == Standing::Subscriber
    }

    /// Sets its relationship, wherever its row stands.
    pub fn set_relationship(&mut self, relationship: f64, customers: &mut Customers) {
        match &mut self.standing {
            Standing::Lead(row) | Standing::Gone(row) => row.relationship = relationship,
            Standing::Subscriber => {
                let own = &mut customers.groups[self.group];
                if let Some((block, at)) = own.place(self.n) {
                    own.blocks[block].relationship[at] = relationship;
                }
            }
        }
    }

    /// By how much it misjudges quality in its first negotiation: one factor, for ever.
    pub fn first_impression(&self, params: &Params, streams: &Streams) -> f64 {
        let quality = &params.quality;
        streams
            .open_since(0, Part::NegotiationNoise, [self.group.index() as u64, u64::from(self.n)])
            .between(quality.initial_decision_noise_min, quality.initial_decision_noise_max)
    }
}

/// Relationship after a change, within its bounds.
pub fn moved_relationship(relationship: f64, change: f64, sales: &Sales) -> f64 {
    (relationship + change).clamp(sales.relationship_min, sales.relationship_max)
}
