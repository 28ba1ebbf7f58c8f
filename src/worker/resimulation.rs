//! What is asked of the record of a run that is simulated again for the answer, and what was found.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use novamind_insight::{BranchComparison, DecisionEdit, Futures, PastDecision, WeekQuantity};

/// A question why a figure changed in a week.
pub struct WhyAsked {
    /// Tells its answer from others.
    pub number: u64,
    /// The figure.
    pub quantity: WeekQuantity,
    /// The week.
    pub week: u32,
    /// Ends the work.
    pub stop: Arc<AtomicBool>,
}

/// A question what would have been.
pub struct BranchesAsked {
    /// Tells its answer from others.
    pub number: u64,
    /// The question.
    pub question: BranchesQuestion,
    /// Ends the work.
    pub stop: Arc<AtomicBool>,
}

/// What is asked of the run's record.
#[derive(Debug, Clone, PartialEq)]
pub enum BranchesQuestion {
    /// Which calls can be decided otherwise.
    Decisions,
    /// What comes of alternatives from a week on; with futures, also under luck drawn anew.
    Compare {
        /// The week.
        week: u32,
        /// What each alternative decides otherwise.
        alternatives: Vec<Vec<DecisionEdit>>,
        /// How many futures.
        futures: Option<u32>,
    },
}

/// What was found.
#[derive(Debug, Clone)]
pub enum BranchesFound {
    /// The calls of the run, and of how many days its weeks are.
    Decisions(Vec<PastDecision>, u32),
    /// Branches side by side.
    Compared(Box<BranchComparison>, Option<Box<Futures>>),
}
