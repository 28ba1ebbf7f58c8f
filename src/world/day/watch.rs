//! Seeing a day from within: what it sees it cannot change, so a day that is watched ends as one that is not.

use crate::context::DayContext;
use crate::customers::Customers;
use crate::customers::columns::Block;
use crate::enterprise::{Enterprise, Negotiation};
use crate::events::{DayFigures, Facts};
use crate::identifiers::{ByGroup, Group};
use crate::market::Market;
use crate::market::arrivals::Arrivals;
use crate::market::leads::LeadFactors;
use crate::morning::Morning;
use crate::params::Params;
use crate::reputation::{Mood, ReputationWrite};
use crate::retention::renewal::RenewalContext;
use crate::state::World;

/// Looks into a day while it is simulated. Blocks are shown on any thread, in any order.
pub trait DayWatch: Send + Sync {
    /// The morning has come: the world as it finds it, and what is frozen of it for the day.
    fn morning_came(&self, _world: &World, _morning: &Morning, _params: &Params) {}

    /// The satisfaction of a block is about to move.
    fn before_moods(&self, _group: Group, _block: &Block, _day: &DayContext<'_>) {}

    /// The subscribers of a block are about to decide: issues are settled, satisfaction has moved, nobody has left yet.
    fn before_decisions(&self, _group: Group, _block: &Block, _judgement: &RenewalContext<'_>) {}

    /// Companies are about to be lost, to answer, and to begin threads by themselves.
    fn before_negotiations(
        &self,
        _enterprise: &Enterprise,
        _customers: &Customers,
        _talks: &Negotiation<'_>,
    ) {
    }

    /// Reputations have moved for the last time today, by what subscribers contributed.
    fn reputation_settled(&self, _moods: &ByGroup<Mood>, _market: &Market, _params: &Params) {}

    /// The leads of the day are about to come: the market, the active subscriptions, the factors of each group.
    fn leads_expected(
        &self,
        _arrivals: &Arrivals<'_>,
        _subscribers: &ByGroup<u32>,
        _factors: &ByGroup<LeadFactors>,
    ) {
    }

    /// A call of the player was applied between two days, with the facts it left.
    fn called(&self, _facts: &Facts) {}

    /// A mechanism has moved a reputation: individuals of a block who left, a company that was lost, the mood of a
    /// group, what spills over from another.
    fn reputation_moved(&self, _write: &ReputationWrite<'_>) {}

    /// The figures of the day, before it is over.
    fn day_counted(&self, _figures: &DayFigures) {}

    /// The day is over: the world and the facts as they stay.
    fn day_over(&self, _world: &World, _params: &Params, _facts: &Facts) {}
}

/// Nobody looks.
#[derive(Debug, Clone, Copy)]
pub struct Unwatched;

impl DayWatch for Unwatched {}
