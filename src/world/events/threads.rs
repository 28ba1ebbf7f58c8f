//! Negotiations with companies.

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

/// How an enterprise thread began.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum ThreadKind {
    /// A company asks for an offer.
    NewLead,
    /// A customer asks for the price of another plan.
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

    /// The kind with this word; case counts.
    pub fn parse(id: &str) -> Option<ThreadKind> {
        ThreadKind::ALL.into_iter().find(|kind| kind.id() == id)
    }

    /// Word as the tables write it.
    pub fn id(self) -> &'static str {
        match self {
            ThreadKind::NewLead => "new_lead",
            ThreadKind::PlanChange => "plan_change",
            ThreadKind::ChurnPrevention => "churn_prevention",
            ThreadKind::Renegotiation => "renegotiation",
        }
    }
}

/// Who wrote a turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Sender {
    /// The market: opening and closing turns.
    System,
    /// The company.
    Customer,
    /// The player.
    Agent,
}

impl Sender {
    /// Word as the tables write it.
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

/// What a turn says.
#[derive(Debug, Clone, PartialEq)]
pub enum TurnContent {
    /// Nothing: the turn only begins a thread.
    Opening,
    /// The player's offerings, one to three.
    Offer(Vec<Offering>),
    /// The player ends the thread.
    Rejection,
    /// A customer's price no longer fits what it gets.
    Threat,
    /// A customer asks for a price of another plan.
    PlanWish {
        /// The plan it is on.
        from: Plan,
        /// The plan it asks for.
        to: Plan,
    },
    /// A company names the price it would pay.
    Counter {
        /// What it would pay, and for which plan.
        asked: Offering,
        /// Price of the offering it answers.
        offered: f64,
    },
    /// A company takes an offering.
    Acceptance(Offering),
    /// The market records a deal.
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
            TurnContent::PlanWish { from, to } => (4u8, (*from, *to)).feed(hasher),
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
            4 => TurnContent::PlanWish { from: reader.read()?, to: reader.read()? },
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
    /// The company.
    pub customer: u32,
    /// Its group.
    pub group: Group,
    /// Picks of its profile, for its words.
    pub persona: PersonaPicks,
    /// How the thread began.
    pub kind: ThreadKind,
    /// Number of the turn within the thread, from 0.
    pub number: u32,
    /// Who wrote it.
    pub sender: Sender,
    /// Whole seats; 1 on turns that the player adds to a thread.
    pub seats: u32,
    /// What it says.
    pub content: TurnContent,
}

/// A deal that was closed; the terms of the subscription follow as changed terms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DealClosed {
    /// The company.
    pub customer: u32,
    /// How the thread began.
    pub kind: ThreadKind,
    /// A lead became a subscriber by it.
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
    /// Day on which the month ends that was agreed on; none if nobody was left to agree.
    pub contract_end_day: Option<u32>,
}
