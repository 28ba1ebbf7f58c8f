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

/// Reason why a thread was opened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum ThreadKind {
    /// An enterprise lead requests an offer.
    NewLead,
    /// A subscribed enterprise asks for the price of a different plan.
    PlanChange,
    /// A subscribed enterprise threatens to cancel.
    ChurnPrevention,
    /// The player offers new terms to a subscribed enterprise.
    Renegotiation,
}

impl ThreadKind {
    /// All kinds, in declaration order.
    pub const ALL: [ThreadKind; 4] =
        [ThreadKind::NewLead, ThreadKind::PlanChange, ThreadKind::ChurnPrevention, ThreadKind::Renegotiation];

    /// Returns the kind with this identifier, which is case-sensitive.
    pub fn parse(id: &str) -> Option<ThreadKind> {
        ThreadKind::ALL.into_iter().find(|kind| kind.id() == id)
    }

    /// Returns the identifier that tables use for the kind.
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
    /// The system, which adds opening and closing turns.
    System,
    /// The enterprise.
    Customer,
    /// The player.
    Agent,
}

impl Sender {
    /// Returns the identifier that tables use for the sender.
    pub fn id(self) -> &'static str {
        match self {
            Sender::System => "system",
            Sender::Customer => "customer",
            Sender::Agent => "agent",
        }
    }
}

/// A plan that is offered at a price.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Offering {
    /// Plan to which the price applies.
    pub plan: Plan,
    /// Price, dollars per seat per month.
    pub price: f64,
}

/// The content of a turn.
#[derive(Debug, Clone, PartialEq)]
pub enum TurnContent {
    /// No content. The turn only opens a thread.
    Opening,
    /// One to three offerings of the player.
    Offer(Vec<Offering>),
    /// Rejection by the player, which ends the thread.
    Rejection,
    /// Threat to cancel, because the price is too high for the quality.
    Threat,
    /// Request for the price of a different plan.
    PlanChangeRequest {
        /// Plan that the enterprise subscribes to.
        from: Plan,
        /// Plan that the enterprise requests.
        to: Plan,
    },
    /// Counter-offer with the price that the enterprise asks for.
    Counter {
        /// Asked price and its plan.
        asked: Offering,
        /// Price of the offering to which the enterprise replies.
        offered: f64,
    },
    /// Acceptance of an offering by the enterprise.
    Acceptance(Offering),
    /// Confirmation of a deal by the system.
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
    /// Number of the turn among the turns of all threads.
    pub message: u32,
    /// Number of the thread among all threads of the run, from 1.
    pub thread: u32,
    /// Customer number of the enterprise.
    pub customer: u32,
    /// Group of the enterprise.
    pub group: Group,
    /// Profile attributes of the enterprise, for the wording of its message.
    pub persona: PersonaPicks,
    /// Reason why the thread was opened.
    pub kind: ThreadKind,
    /// Number of the turn within the thread, from 0.
    pub number: u32,
    /// Side that added the turn: the system, the enterprise or the player.
    pub sender: Sender,
    /// Number of whole seats; 1 in turns that the player adds to a thread.
    pub seats: u32,
    /// What the turn offers, asks or states, as data for its text.
    pub content: TurnContent,
}

/// A deal with an enterprise. The new terms of the subscription are recorded as [`TermsChanged`](super::TermsChanged).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DealClosed {
    /// Customer number of the enterprise.
    pub customer: u32,
    /// Reason why the thread was opened.
    pub kind: ThreadKind,
    /// Whether the deal made a lead a subscriber.
    pub activated: bool,
    /// Plan that the enterprise accepted.
    pub plan: Plan,
    /// Agreed price, dollars per seat per month.
    pub price: f64,
    /// Number of the player's turns in the thread.
    pub agent_turns: u32,
    /// Days since the thread was opened.
    pub days: u32,
    /// Number of whole seats.
    pub seats: u32,
    /// Last day of the agreed month; `None` if the enterprise was already lost.
    pub contract_end_day: Option<u32>,
}
