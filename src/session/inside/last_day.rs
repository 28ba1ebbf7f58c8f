//! The hidden state after the last day, as it stands: for policies and figures of debug runs.

use std::sync::Arc;

use crate::figures::mood::mood_of;
use crate::play::simulation::Simulation;
use crate::state::Session;
use novamind_record::mode::Mode;
use novamind_tools::Refusal;
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

/// A look behind the curtain, as of the last day.
#[derive(Clone, Copy)]
pub struct Xray<'a> {
    world: &'a World,
    params: &'a Arc<Params>,
    streams: &'a Streams,
    facts: &'a Facts,
    trace: &'a DayTrace,
    called: &'a [LedgerEntry],
    judgements: &'a [Vec<Judgement>],
}

impl Session {
    /// The hidden state; only in debug runs.
    ///
    /// # Errors
    /// `not_in_this_mode`.
    pub fn xray(&self) -> Result<Xray<'_>, Refusal> {
        if self.manifest.mode != Mode::Debug {
            return Err(Refusal::new("not_in_this_mode", "hidden state is shown in debug runs only"));
        }
        Ok(Xray::new(self))
    }
}

impl<'a> Xray<'a> {
    pub(crate) fn new(session: &'a Session) -> Xray<'a> {
        let Simulation { world, params, streams, facts, trace, feed, .. } = &session.simulation;
        Xray {
            world,
            params,
            streams,
            facts,
            trace,
            called: &session.history.called,
            judgements: &feed.judgements,
        }
    }

    /// Money that calls moved between the day before and the last day.
    pub fn called(&self) -> &'a [LedgerEntry] {
        self.called
    }

    /// The state.
    pub fn world(&self) -> &'a World {
        self.world
    }

    /// The facts of the last day.
    pub fn facts(&self) -> &'a Facts {
        self.facts
    }

    /// Parameters.
    pub fn params(&self) -> &'a Arc<Params> {
        self.params
    }

    /// The streams of chance.
    pub fn streams(&self) -> &'a Streams {
        self.streams
    }

    /// Factors of the last day's leads.
    pub fn lead_factors(&self, group: Group) -> &'a LeadFactors {
        &self.trace.leads[group]
    }

    /// Reputation of a group.
    pub fn reputation(&self, group: Group) -> f64 {
        self.world.market.reputation.of(group)
    }

    /// Macro multiplier of a group.
    pub fn macro_multiplier(&self, group: Group, dimension: Dimension) -> f64 {
        self.world.market.economy.multiplier(group, dimension, self.params)
    }

    /// Yield of a channel for a group: leads a day for 1,000 dollars a day.
    pub fn channel_yield(&self, channel: Channel, group: Group) -> f64 {
        self.world.market.yields[channel][group]
    }

    /// Mean satisfaction and relationship of a group's active subscribers; none without any.
    pub fn mood(&self, group: Group) -> Option<(f64, f64)> {
        mood_of(self.world, group)
    }

    /// Active subscriptions of a group.
    pub fn subscribers(&self, group: Group) -> u32 {
        self.world.customers.groups[group].active()
    }

    /// Active individual subscriptions on a plan.
    pub fn on_plan(&self, plan: Plan) -> u32 {
        let individuals = self.world.customers.blocks().filter(|(group, _)| !group.is_enterprise());
        individuals.map(|(_, block)| block.plan.iter().filter(|own| **own == plan).count() as u32).sum()
    }

    /// Blocks of a group.
    pub fn blocks(&self, group: Group) -> impl Iterator<Item = &'a Block> + Clone + use<'a> {
        self.world.customers.groups[group].blocks.iter()
    }

    /// Why the groups took a post of the player as they did, one judgement per group that was known; empty until the
    /// post was judged.
    pub fn judgements(&self, own_post: u32) -> &'a [Judgement] {
        let at = (own_post as usize).checked_sub(1);
        at.and_then(|at| self.judgements.get(at)).map_or(&[], Vec::as_slice)
    }

    /// Notices of the last day.
    pub fn notices(&self) -> &'a [Notice] {
        &self.facts.notices
    }
}
