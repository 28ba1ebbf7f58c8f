//! Facts about negotiations with enterprises.

use crate::canonical::{Canonical, CanonicalHasher, CanonicalReader, Restore, canonical, canonical_codes};
use crate::customers::persona::PersonaPicks;
use crate::identifiers::{Group, Plan};

canonical! {
    ThreadTurn { message, thread, customer, group, persona, kind, number, sender, seats, content }
    Offering { plan, price }
    DealClosed { customer, kind, activated, plan, price, agent_turns, days, seats, contract_end_day }
}
canonical_codes! {
    ThreadKind { NewLead, PlanChange, ChurnPrevention, Renegotiation }
    Sender { System, Customer, Agent }
}

/// How an enterprise thread started.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum ThreadKind {
    /// An enterprise requests an offer.
    NewLead,
    /// A customer requests the price of another plan.
    PlanChange,
    /// A customer threatens to leave.
    ChurnPrevention,
    /// The player offers a customer other terms.
    Renegotiation,
}

impl ThreadKind {
    /// All kinds.
    pub const ALL: [ThreadKind; 4] =
        [ThreadKind::NewLead, ThreadKind::PlanChange, ThreadKind::ChurnPrevention, ThreadKind::Renegotiation];

    /// Returns the kind with this identifier; case-sensitive.
    pub fn parse(id: &str) -> Option<ThreadKind> {
        ThreadKind::ALL.into_iter().find(|kind| kind.id() == id)
    }

    /// Identifier as stored in tables.
    pub fn id(self) -> &'static str {
        match self {
            ThreadKind::NewLead => "new_lead",
            ThreadKind::PlanChange => "plan_change",
            ThreadKind::ChurnPrevention => "churn_prevention",
            ThreadKind::Renegotiation => "renegotiation",
        }
    }
}

/// The sender of a turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Sender {
    /// The system: opening and closing turns.
    System,
    /// The enterprise.
    Customer,
    /// The player.
    Agent,
}

impl Sender {
    /// Identifier as stored in tables.
    pub fn id(self) -> &'static str {
        match self {
            Sender::System => "system",
            Sender::Customer => "customer",
            Sender::Agent => "agent",
        }
    }
}

/// A plan at a price.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Offering {
    /// Plan.
    pub plan: Plan,
    /// Dollars a month and seat.
    pub price: f64,
}

/// The content of a turn.
#[derive(Debug, Clone, PartialEq)]
pub enum TurnContent {
    /// Nothing: the turn only opens a thread.
    Opening,
    /// The player's offerings, one to three.
    Offer(Vec<Offering>),
    /// The player ends the thread.
    Rejection,
    /// A customer's price is too high for the quality it gets.
    Threat,
    /// A customer requests the price of another plan.
    PlanChangeRequest {
        /// The current plan.
        from: Plan,
        /// The requested plan.
        to: Plan,
    },
    /// An enterprise names the price it would pay.
    Counter {
        /// The named price and its plan.
        asked: Offering,
        /// Price of the offering that it answers.
        offered: f64,
    },
    /// An enterprise accepts an offering.
    Acceptance(Offering),
    /// The system records a deal.
    Closing(Offering),
}

impl Canonical for TurnContent {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        match self {
            TurnContent::Opening => 0u8.feed(hasher),
            TurnContent::Offer(offerings) => {
                1u8.feed(hasher);
                offerings.feed(hasher);
            }
            TurnContent::Rejection => 2u8.feed(hasher),
            TurnContent::Threat => 3u8.feed(hasher),
            TurnContent::PlanChangeRequest { from, to } => (4u8, (*from, *to)).feed(hasher),
            TurnContent::Counter { asked, offered } => (5u8, (*asked, *offered)).feed(hasher),
            TurnContent::Acceptance(offering) => (6u8, *offering).feed(hasher),
            TurnContent::Closing(offering) => (7u8, *offering).feed(hasher),
        }
    }
}

impl Restore for TurnContent {
    fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
        Some(match reader.read::<u8>()? {
            0 => TurnContent::Opening,
            1 => TurnContent::Offer(reader.read()?),
            2 => TurnContent::Rejection,
            3 => TurnContent::Threat,
            4 => TurnContent::PlanChangeRequest { from: reader.read()?, to: reader.read()? },
            5 => TurnContent::Counter { asked: reader.read()?, offered: reader.read()? },
            6 => TurnContent::Acceptance(reader.read()?),
            7 => TurnContent::Closing(reader.read()?),
            _ => return None,
        })
    }
}

/// One turn of an enterprise thread.
#[derive(Debug, Clone, PartialEq)]
pub struct ThreadTurn {
    /// Running number over all threads.
    pub message: u32,
    /// Running number of the thread.
    pub thread: u32,
    /// Customer number of the enterprise.
    pub customer: u32,
    /// Its group.
    pub group: Group,
    /// Profile attributes for the wording.
    pub persona: PersonaPicks,
    /// How the thread started.
    pub kind: ThreadKind,
    /// Number of the turn within the thread, from 0.
    pub number: u32,
    /// Sender of the turn.
    pub sender: Sender,
    /// Whole seats; 1 on turns that the player adds to a thread.
    pub seats: u32,
    /// The content.
    pub content: TurnContent,
}

/// A closed deal; the new terms of the subscription follow as changed terms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DealClosed {
    /// Customer number of the enterprise.
    pub customer: u32,
    /// How the thread started.
    pub kind: ThreadKind,
    /// Whether a lead became a subscriber.
    pub activated: bool,
    /// Plan.
    pub plan: Plan,
    /// Dollars a month and seat.
    pub price: f64,
    /// Turns of the player in the thread.
    pub agent_turns: u32,
    /// Days since the thread was opened.
    pub days: u32,
    /// Whole seats.
    pub seats: u32,
    /// Last day of the agreed month; `None` if the enterprise was already lost.
    pub contract_end_day: Option<u32>,
}
