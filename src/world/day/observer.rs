//! Observation of a day during its simulation. Observers cannot change the world, so an observed day has the same
//! result.

use crate::context::DayContext;
use crate::customers::Customers;
use crate::customers::columns::Block;
use crate::enterprise::{Enterprise, NegotiationContext};
use crate::events::{DayFigures, Facts};
use crate::identifiers::{ByGroup, Group};
use crate::market::Market;
use crate::market::arrivals::ArrivalContext;
use crate::market::leads::LeadFactors;
use crate::morning::Morning;
use crate::params::Params;
use crate::reputation::{ReputationContribution, ReputationWrite};
use crate::retention::renewal::RenewalContext;
use crate::state::World;

/// An observer of a day's simulation. Methods that receive a block are called on any thread and in any order.
pub trait DayObserver: Send + Sync {
    /// Called at the start of the day, with the world and the values that are fixed for the day.
    fn on_morning(&self, _world: &World, _morning: &Morning, _params: &Params) {}

    /// Called before the satisfaction of a block is updated.
    fn before_satisfaction(&self, _group: Group, _block: &Block, _day: &DayContext<'_>) {}

    /// Called before the subscribers of a block decide, after satisfaction and issues are updated.
    fn before_decisions(&self, _group: Group, _block: &Block, _context: &RenewalContext<'_>) {}

    /// Called before the negotiations of the day. In the negotiations, enterprises reply, open threads and are lost.
    fn before_negotiations(
        &self,
        _enterprise: &Enterprise,
        _customers: &Customers,
        _talks: &NegotiationContext<'_>,
    ) {
    }

    /// Called after the subscribers' contributions were applied, which is the last reputation change of the day.
    fn after_reputation_changes(
        &self,
        _contributions: &ByGroup<ReputationContribution>,
        _market: &Market,
        _params: &Params,
    ) {
    }

    /// Called before leads arrive, with the market, the active subscriptions and the factors of each group.
    fn on_expected_leads(
        &self,
        _arrivals: &ArrivalContext<'_>,
        _subscribers: &ByGroup<u32>,
        _factors: &ByGroup<LeadFactors>,
    ) {
    }

    /// Called after a tool call between two days, with the facts that the call recorded.
    fn on_call_applied(&self, _facts: &Facts) {}

    /// Called after a mechanism changed a reputation: cancellations of a block, a lost enterprise, a group's
    /// own contributions, or spillover.
    fn on_reputation_change(&self, _write: &ReputationWrite<'_>) {}

    /// Called shortly before the end of the day, with the figures of the day.
    fn on_day_figures(&self, _figures: &DayFigures) {}

    /// Called at the end of the day, with the final world and facts.
    fn on_day_end(&self, _world: &World, _params: &Params, _facts: &Facts) {}
}

/// An observer that does nothing.
#[derive(Debug, Clone, Copy)]
pub struct NoObserver;

impl DayObserver for NoObserver {}
