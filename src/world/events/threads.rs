//! Negotiations with companies.

use crate::world::canonical::{canonical, canonical_codes};

canonical! {
    ThreadTurn { thread, customer, kind, number, sender, seats }
}
canonical_codes!(ThreadKind, Sender);

/// How an enterprise thread began.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum ThreadKind {
    /// A company asks for an offer.
    NewLead,
}

impl ThreadKind {
    /// Word as the tables write it.
    pub fn id(self) -> &'static str {
        match self {
            ThreadKind::NewLead => "new_lead",
        }
    }
}

/// Who wrote a turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Sender {
    /// The market: opening and closing turns.
    System,
}

impl Sender {
    /// Word as the tables write it.
    pub fn id(self) -> &'static str {
        match self {
            Sender::System => "system",
        }
    }
}

/// One turn of an enterprise thread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ThreadTurn {
    /// Running number of the thread.
    pub thread: u32,
    /// The company.
    pub customer: u32,
    /// How the thread began.
    pub kind: ThreadKind,
    /// Number of the turn within the thread, from 0.
    pub number: u32,
    /// Who wrote it.
    pub sender: Sender,
    /// Whole seats.
    pub seats: u32,
}
