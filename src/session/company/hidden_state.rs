//! A view of the hidden state after the last day, for policies and for figures of debug runs.

use std::sync::Arc;

use super::history::History;
use super::simulation::Simulation;
use crate::figures::groups::mean_satisfaction;
use novamind_voice::judge::Judgement;
use novamind_world::customers::columns::Block;
use novamind_world::day::DayTrace;
use novamind_world::events::{Facts, LedgerEntry, Notice};
use novamind_world::identifiers::{Channel, Group, Plan};
use novamind_world::market::economy::Dimension;
use novamind_world::market::leads::LeadFactors;
use novamind_world::params::Params;
use novamind_world::random::Streams;
use novamind_world::state::World;

/// A read-only view of the hidden state after the last day.
#[derive(Clone, Copy)]
pub struct HiddenState<'a> {
    world: &'a World,
    params: &'a Arc<Params>,
    streams: &'a Streams,
    facts: &'a Facts,
    trace: &'a DayTrace,
    call_ledger: &'a [LedgerEntry],
    judgements: &'a [Vec<Judgement>],
}

impl<'a> HiddenState<'a> {
    pub(crate) fn new(simulation: &'a Simulation, history: &'a History) -> HiddenState<'a> {
        let Simulation { world, params, streams, facts, trace, feed, .. } = simulation;
        HiddenState {
            world,
            params,
            streams,
            facts,
            trace,
            call_ledger: &history.call_ledger,
            judgements: &feed.judgements,
        }
    }

    /// Returns the ledger entries of the calls between the last simulated day and the day before.
    pub fn call_ledger(&self) -> &'a [LedgerEntry] {
        self.call_ledger
    }

    /// Returns the state of the company and its market.
    pub fn world(&self) -> &'a World {
        self.world
    }

    /// Returns the facts of the last day.
    pub fn facts(&self) -> &'a Facts {
        self.facts
    }

    /// Returns the parameters in force on the last day.
    pub fn params(&self) -> &'a Arc<Params> {
        self.params
    }

    /// Returns the random number streams of the run.
    pub fn streams(&self) -> &'a Streams {
        self.streams
    }

    /// Returns the factors that determine a group's leads on the last day.
    pub fn lead_factors(&self, group: Group) -> &'a LeadFactors {
        &self.trace.leads[group]
    }

    /// Returns the reputation of the company in a group.
    pub fn reputation(&self, group: Group) -> f64 {
        self.world.market.reputation.get(group)
    }

    /// Returns the multiplier that the economy applies to a dimension of a group.
    pub fn macro_multiplier(&self, group: Group, dimension: Dimension) -> f64 {
        self.world.market.economy.multiplier(group, dimension, self.params)
    }

    /// Returns the yield of a channel for a group: leads per day at a spending of 1,000 dollars per day.
    pub fn channel_yield(&self, channel: Channel, group: Group) -> f64 {
        self.world.market.yields[channel][group]
    }

    /// Returns the mean satisfaction and the mean relationship of a group's active subscribers; `None` if there are no
    /// active subscribers.
    pub fn mean_satisfaction(&self, group: Group) -> Option<(f64, f64)> {
        mean_satisfaction(self.world, group)
    }

    /// Returns the number of active subscriptions of a group.
    pub fn subscribers(&self, group: Group) -> u32 {
        self.world.customers.groups[group].active_count()
    }

    /// Returns the number of active individual subscriptions of a plan.
    pub fn subscribers_on_plan(&self, plan: Plan) -> u32 {
        let individuals = self.world.customers.blocks().filter(|(group, _)| !group.is_enterprise());
        individuals
            .map(|(_, block)| block.plan.iter().filter(|current_plan| **current_plan == plan).count() as u32)
            .sum()
    }

    /// Returns the storage blocks of a group's customers.
    pub fn blocks(&self, group: Group) -> impl Iterator<Item = &'a Block> + Clone + use<'a> {
        self.world.customers.groups[group].blocks.iter()
    }

    /// Returns the judgements of a post of the player, one per group that was known on the day of the post. The result
    /// is empty if the post has not been judged yet. Posts are numbered from 1.
    pub fn judgements(&self, own_post: u32) -> &'a [Judgement] {
        let at = (own_post as usize).checked_sub(1);
        at.and_then(|at| self.judgements.get(at)).map_or(&[], Vec::as_slice)
    }

    /// Returns the notices of the last day.
    pub fn notices(&self) -> &'a [Notice] {
        &self.facts.notices
    }
}
