//! The simulated company and its texts, with parameters and seed. A snapshot stores the simulation and its
//! [`History`](super::history::History).
//!
//! The texts, the facts hash and the database rows of a day do not affect the company. A thread computes this output
//! of a day while the next day is simulated.

use std::sync::Arc;

use serde_json::Value;

use super::facts_chain::{FactsChain, StateHash, state_hash};
use super::feed::{Feed, build_entry};
use super::overrides::Overrides;
use super::post_judging::RecordedScores;
use crate::database::EntryWriter;
use crate::figures::estimates::true_value_range;
use novamind_base::formatting::grouped_number;
use novamind_database::ProjectionEntry;
use novamind_record::folder::manifest::Manifest;
use novamind_record::trajectory::record::JudgedPost;
use novamind_tools::Rejection;
use novamind_voice::EnterpriseNames;
use novamind_world::command::{Command, ResolvedCommand};
use novamind_world::day::limits::{
    ExceededLimit, MAX_CUSTOMERS, MAX_LEADS_PER_DAY, exceeded_limit_on_next_day,
};
use novamind_world::day::observer::{DayObserver, NoObserver};
use novamind_world::day::{DayTrace, step_day_observed};
use novamind_world::events::{DayFigures, Facts};
use novamind_world::fixed_inputs::FixedInputs;
use novamind_world::identifiers::Group;
use novamind_world::params::Params;
use novamind_world::random::Streams;
use novamind_world::state::World;

/// The simulated company with its texts, parameters and random number streams.
pub struct Simulation {
    /// Parameters in force on the current day.
    pub params: Arc<Params>,
    /// Parameter changes since the start of the run.
    pub overrides: Overrides,
    /// Random number streams of the run.
    pub streams: Streams,
    /// State of the company and its market.
    pub world: World,
    /// Facts of the last day or call.
    pub facts: Arc<Facts>,
    /// Facts of the previous day; the memory is reused after the database writer has released it.
    previous_facts: Arc<Facts>,
    /// Details of the leads of the last day.
    pub(crate) trace: DayTrace,
    /// Names of enterprises.
    pub names: EnterpriseNames,
    /// Posts of the social feed.
    pub feed: Feed,
    pub(crate) recorded_scores: RecordedScores,
    pub(crate) facts_chain: FactsChain,
    /// Observer of the simulated days; has an effect only in inspections.
    pub(crate) watch: Arc<dyn DayObserver>,
}

impl Simulation {
    /// Creates the company of a run on day 0.
    pub fn new(manifest: &Manifest, params: Arc<Params>) -> Simulation {
        let mut facts = Facts::default();
        let world = World::new(manifest.total_days(), manifest.cash, &params, &mut facts);
        Simulation::from_state(manifest, params, (world, facts))
    }

    /// Creates the company of a run from a world state and the facts of the last day or call.
    pub(crate) fn from_state(
        manifest: &Manifest,
        params: Arc<Params>,
        (world, facts): (World, Facts),
    ) -> Simulation {
        Simulation {
            names: EnterpriseNames::new(manifest.seed, &params.personas.email),
            params,
            overrides: Overrides::default(),
            streams: Streams::new(manifest.seed),
            world,
            facts: facts.into(),
            previous_facts: Arc::default(),
            trace: DayTrace::default(),
            feed: Feed::default(),
            recorded_scores: RecordedScores::default(),
            facts_chain: FactsChain::default(),
            watch: Arc::new(NoObserver),
        }
    }

    /// Creates a company from the parameters, the world state and the earlier posts of a run.
    pub fn from_parts(
        (params, overrides): (Arc<Params>, Overrides),
        (streams, names): (Streams, EnterpriseNames),
        world: World,
        feed: Feed,
    ) -> Simulation {
        Simulation {
            params,
            overrides,
            streams,
            world,
            facts: Arc::default(),
            previous_facts: Arc::default(),
            trace: DayTrace::default(),
            names,
            feed,
            recorded_scores: RecordedScores::default(),
            facts_chain: FactsChain::default(),
            watch: Arc::new(NoObserver),
        }
    }

    /// Adds recorded scores for the player's posts.
    pub fn add_scores(&mut self, judged: &[JudgedPost]) {
        judged.iter().for_each(|judged_post| self.recorded_scores.add(judged_post.clone()));
    }

    /// Ends the hash chain of a week's facts.
    pub fn close_facts_chain(&mut self) {
        self.facts_chain.close();
    }

    /// Returns the number of active subscribers with an open issue.
    pub fn open_issues(&self) -> u32 {
        self.world.customers.blocks().map(|(_, block)| block.open_issues()).sum()
    }

    /// Returns the hash of the complete state, and the hash of each part by name.
    pub fn state_hash(&self) -> StateHash {
        state_hash(self.world.part_hashes(), self.facts_chain.hash())
    }

    /// Resolves a command, including its random draws, without applying it.
    pub fn resolve(&self, command: Command) -> ResolvedCommand {
        self.world.resolve(command, &self.params, &self.streams)
    }

    /// Returns the estimated range of a group's mean required quality, or `None` if the group is unknown.
    pub(crate) fn estimated_required_quality(&self, group: Group) -> Option<(f64, f64)> {
        match self.resolve(Command::ReadInsights(group)) {
            ResolvedCommand::ReadInsights(Some(insights)) => {
                Some(true_value_range(insights.quality_floor, insights.noise))
            }
            _ => None,
        }
    }

    /// Applies a resolved command to the world.
    pub fn apply_command(&mut self, resolved: ResolvedCommand, entries: EntryWriter<'_>) {
        self.world.apply(resolved, &self.params, reusable_facts(&mut self.facts, entries));
        self.watch.on_call_applied(&self.facts);
    }

    /// Returns the parts of the simulation that are needed for a change between two days, including facts to write to.
    pub(crate) fn parts_between_days(
        &mut self,
        entries: EntryWriter<'_>,
    ) -> (&mut World, &mut Facts, &Params, &Streams) {
        (&mut self.world, reusable_facts(&mut self.facts, entries), &self.params, &self.streams)
    }

    /// Replaces the parameters in force.
    pub fn set_params(&mut self, params: Arc<Params>, entries: EntryWriter<'_>) {
        if !Arc::ptr_eq(&self.params, &params) {
            entries.send(|| ProjectionEntry { params: Some(params.clone()), ..ProjectionEntry::default() });
            self.params = params;
        }
    }

    /// Checks that the leads and customers of the next day are within the program's limits.
    ///
    /// # Errors
    /// The rejection `too_many_leads`.
    pub fn check_lead_capacity(&self) -> Result<(), Rejection> {
        let (world, day) = (&self.world, self.world.day + 1);
        let due = self.overrides.params_due_on(day).unwrap_or(&self.params);
        let text = match exceeded_limit_on_next_day(world, due, &self.streams) {
            None => return Ok(()),
            Some(ExceededLimit::Leads) => {
                format!("more than {} leads", grouped_number(f64::from(MAX_LEADS_PER_DAY), 0))
            }
            Some(ExceededLimit::Customers) => {
                let max = grouped_number(f64::from(MAX_CUSTOMERS), 0);
                format!("so many leads that there could be more than {max} customers")
            }
            Some(ExceededLimit::Numbers) => "more leads than there are customer numbers".to_owned(),
        };
        let message = format!(
            "day {day} would bring {text}, which exceeds the limits of the program. Nothing after day {} is simulated. \
             Spend less on advertising, or revert the parameter that multiplies leads",
            world.day
        );
        Err(Rejection::new("too_many_leads", message))
    }

    /// Simulates a day with fixed inputs. In parallel, processes the facts of the previous day if `day_before`
    /// contains its notices.
    pub fn simulate_day(
        &mut self,
        fixed_inputs: &FixedInputs,
        entries: EntryWriter<'_>,
        day_before: Option<Vec<String>>,
    ) -> DayFigures {
        std::mem::swap(&mut self.facts, &mut self.previous_facts);
        // The facts of the previous day are processed with the parameters of that day.
        let due = self.overrides.take_due_params(self.world.day + 1).unwrap_or_else(|| self.params.clone());
        let Simulation {
            world,
            params,
            streams,
            facts,
            previous_facts: facts_before,
            feed,
            facts_chain,
            watch,
            ..
        } = self;
        let today = reusable_facts(facts, entries);
        let follow_up = FactsProcessor { feed, facts_chain, entries, params, streams };
        let ((figures, trace), ()) = rayon::join(
            || step_day_observed(world, &due, streams, fixed_inputs, today, &**watch),
            || follow_up.process(facts_before, day_before, None),
        );
        self.trace = trace;
        self.set_params(due, entries);
        figures
    }

    /// Processes the facts of a call with its notices. `settings` contains the settings after the call, if the call
    /// changed a setting.
    pub fn process_call(&mut self, entries: EntryWriter<'_>, notices: Vec<String>, settings: Option<Value>) {
        let Simulation { params, streams, facts, feed, facts_chain, .. } = self;
        FactsProcessor { feed, facts_chain, entries, params, streams }.process(
            facts,
            Some(notices),
            settings,
        );
    }

    /// Processes the facts of the last day, if `last_day` contains its notices.
    pub fn process_last_day(&mut self, entries: EntryWriter<'_>, last_day: Option<Vec<String>>) {
        let Simulation { params, streams, facts, feed, facts_chain, .. } = self;
        FactsProcessor { feed, facts_chain, entries, params, streams }.process(facts, last_day, None);
    }

    /// Processes the facts of the last day like [`Simulation::process_last_day`], and hashes the state in parallel.
    pub fn finish_days(&mut self, entries: EntryWriter<'_>, last_day: Option<Vec<String>>) -> StateHash {
        let Simulation { world, params, streams, facts, feed, facts_chain, .. } = self;
        let follow_up = FactsProcessor { feed, facts_chain, entries, params, streams };
        let (parts, ()) = rayon::join(|| world.part_hashes(), || follow_up.process(facts, last_day, None));
        state_hash(parts, self.facts_chain.hash())
    }
}

/// Returns facts to write to. Reuses `facts` if nothing else refers to them. Otherwise, replaces them with spare facts
/// of the database writer, or with new facts.
fn reusable_facts<'a>(facts: &'a mut Arc<Facts>, entries: EntryWriter<'_>) -> &'a mut Facts {
    if Arc::strong_count(facts) > 1 {
        *facts = entries.spare_facts().unwrap_or_default();
    }
    Arc::make_mut(facts)
}

struct FactsProcessor<'a> {
    feed: &'a mut Feed,
    facts_chain: &'a mut FactsChain,
    entries: EntryWriter<'a>,
    params: &'a Params,
    streams: &'a Streams,
}

impl FactsProcessor<'_> {
    /// Adds the facts to the feed, the hash chain and the database. The database writer shares the facts without
    /// copying them. Does nothing if `notices` is `None`.
    fn process(self, facts: &Arc<Facts>, notices: Option<Vec<String>>, settings: Option<Value>) {
        let Some(notices) = notices else { return };
        self.feed.add_posts(facts, self.params, self.streams);
        self.facts_chain.add(facts);
        let FactsProcessor { feed, params, entries, .. } = self;
        entries.send(|| ProjectionEntry { settings, ..build_entry(facts, notices, feed, params) });
    }
}
