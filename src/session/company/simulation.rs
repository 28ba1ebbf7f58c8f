//! What is simulated: the company and what people write about it, under the parameters and the seed of the run. Together
//! with its [`History`](super::history::History) this is what a snapshot keeps.
//!
//! What follows from a day or a call (words of posts, the hash of the facts, rows for the database) changes nothing of
//! the company, so the day after is simulated meanwhile.

use std::sync::Arc;

use serde_json::Value;

use super::facts_chain::{FactsChain, StateHash, state_hash};
use super::feed::{Feed, entry_of};
use super::judging::RecordedScores;
use super::overrides::Overrides;
use crate::database::Entries;
use crate::figures::estimates::truth_behind;
use novamind_base::notation::grouped;
use novamind_database::Entry;
use novamind_record::folder::manifest::Manifest;
use novamind_record::trajectory::record::JudgedPost;
use novamind_tools::Refusal;
use novamind_voice::CompanyNames;
use novamind_world::command::{Command, ResolvedCommand};
use novamind_world::day::room::{MOST_CUSTOMERS, MOST_LEADS_A_DAY, NoRoom, room_for_next_day};
use novamind_world::day::watch::{DayWatch, Unwatched};
use novamind_world::day::{DayTrace, step_day_watched};
use novamind_world::events::{DayFigures, Facts};
use novamind_world::held::Held;
use novamind_world::identifiers::Group;
use novamind_world::params::Params;
use novamind_world::random::Streams;
use novamind_world::state::World;

/// The company, its words, and how far it has come.
pub struct Simulation {
    /// Parameters in force.
    pub params: Arc<Params>,
    /// What was set of them since the run began.
    pub overrides: Overrides,
    /// The streams of chance.
    pub streams: Streams,
    /// The company and its market.
    pub world: World,
    /// Facts of the last day or call.
    pub facts: Arc<Facts>,
    /// Those of the day before it, which are filled again once nobody reads them.
    facts_before: Arc<Facts>,
    /// How the leads of the last day came about.
    pub(crate) trace: DayTrace,
    /// What companies are called.
    pub names: CompanyNames,
    /// What people wrote in public, in words.
    pub feed: Feed,
    /// What a language model made of the player's posts.
    pub(crate) scores: RecordedScores,
    /// Hashes of this week's facts.
    pub(crate) facts_chain: FactsChain,
    /// Who looks into the days that are simulated: nobody, but for the x-ray.
    pub(crate) watch: Arc<dyn DayWatch>,
}

impl Simulation {
    /// The company of a run on day 0.
    pub fn open(manifest: &Manifest, params: Arc<Params>) -> Simulation {
        let mut facts = Facts::default();
        let world = World::open(manifest.days, manifest.cash, &params, &mut facts);
        Simulation::of(manifest, params, (world, facts))
    }

    /// A company of a run that has come somewhere, with the facts of its last day or call.
    pub(crate) fn of(manifest: &Manifest, params: Arc<Params>, (world, facts): (World, Facts)) -> Simulation {
        Simulation {
            names: CompanyNames::new(manifest.seed, &params.personas.email),
            params,
            overrides: Overrides::default(),
            streams: Streams::new(manifest.seed),
            world,
            facts: facts.into(),
            facts_before: Arc::default(),
            trace: DayTrace::default(),
            feed: Feed::default(),
            scores: RecordedScores::default(),
            facts_chain: FactsChain::default(),
            watch: Arc::new(Unwatched),
        }
    }

    /// A company at some moment of a run, and what was written in public until then.
    pub fn at(
        (params, overrides): (Arc<Params>, Overrides),
        (streams, names): (Streams, CompanyNames),
        world: World,
        feed: Feed,
    ) -> Simulation {
        Simulation {
            params,
            overrides,
            streams,
            world,
            facts: Arc::default(),
            facts_before: Arc::default(),
            trace: DayTrace::default(),
            names,
            feed,
            scores: RecordedScores::default(),
            facts_chain: FactsChain::default(),
            watch: Arc::new(Unwatched),
        }
    }

    /// Adds recorded scores of the player's posts.
    pub fn take_scores(&mut self, judged: &[JudgedPost]) {
        judged.iter().for_each(|own| self.scores.take_in(own.clone()));
    }

    /// Ends the chain of facts of a week.
    pub fn close_facts(&mut self) {
        self.facts_chain.close();
    }

    /// Active subscribers with an open issue.
    pub fn open_issues(&self) -> u32 {
        self.world.customers.blocks().map(|(_, block)| block.open_issues()).sum()
    }

    /// Hash of the whole state with one hash per part, by name.
    pub fn state_hash(&self) -> StateHash {
        state_hash(self.world.part_hashes(), self.facts_chain.hash())
    }

    /// A command with its draws made; nothing happens.
    pub fn resolve(&self, command: Command) -> ResolvedCommand {
        self.world.resolve(command, &self.params, &self.streams)
    }

    /// Least and greatest mean floor of a group behind its estimate; none while it is unknown.
    pub(crate) fn estimated_floor(&self, group: Group) -> Option<(f64, f64)> {
        match self.resolve(Command::ReadInsights(group)) {
            ResolvedCommand::ReadInsights(Some(insights)) => {
                Some(truth_behind(insights.quality_floor, insights.noise))
            }
            _ => None,
        }
    }

    /// Does what a command does.
    pub fn apply(&mut self, resolved: ResolvedCommand, entries: Entries<'_>) {
        self.world.apply(resolved, &self.params, to_fill(&mut self.facts, entries));
        self.watch.called(&self.facts);
    }

    /// The world, and facts to be filled, for what happens between two days.
    pub(crate) fn between_days(
        &mut self,
        entries: Entries<'_>,
    ) -> (&mut World, &mut Facts, &Params, &Streams) {
        (&mut self.world, to_fill(&mut self.facts, entries), &self.params, &self.streams)
    }

    /// Goes on with other parameters.
    pub fn use_params(&mut self, params: Arc<Params>, entries: Entries<'_>) {
        if !Arc::ptr_eq(&self.params, &params) {
            entries.write(|| Entry { params: Some(params.clone()), ..Entry::default() });
            self.params = params;
        }
    }

    /// Refuses the next day where more people would come than memory holds.
    ///
    /// # Errors
    /// `too_many_leads`.
    pub fn refuse_crowded_day(&self) -> Result<(), Refusal> {
        let (world, day) = (&self.world, self.world.day + 1);
        let due = self.overrides.due_on(day).unwrap_or(&self.params);
        let told = match room_for_next_day(world, due, &self.streams) {
            None => return Ok(()),
            Some(NoRoom::Leads) => format!("more than {} leads", grouped(f64::from(MOST_LEADS_A_DAY), 0)),
            Some(NoRoom::Customers) => {
                let most = grouped(f64::from(MOST_CUSTOMERS), 0);
                format!("so many leads that there could be more than {most} customers")
            }
            Some(NoRoom::Numbers) => "more leads than there are numbers for customers".to_owned(),
        };
        let message = format!(
            "day {day} would bring {told}, and memory does not hold them; nothing after day {} is simulated. Spend less on \
             advertising, or take back the parameter that multiplies leads",
            world.day
        );
        Err(Refusal::new("too_many_leads", message))
    }

    /// Simulates a day with what is held of its inputs, and meanwhile what follows from the day before, if that is left,
    /// with its notices.
    pub fn simulate_day(
        &mut self,
        held: &Held,
        entries: Entries<'_>,
        day_before: Option<Vec<String>>,
    ) -> DayFigures {
        std::mem::swap(&mut self.facts, &mut self.facts_before);
        // The day before is told with the parameters it ran with.
        let due = self.overrides.due(self.world.day + 1).unwrap_or_else(|| self.params.clone());
        let Simulation { world, params, streams, facts, facts_before, feed, facts_chain, watch, .. } = self;
        let today = to_fill(facts, entries);
        let follow_up = FollowUp { feed, facts_chain, entries, params, streams };
        let ((figures, trace), ()) = rayon::join(
            || step_day_watched(world, &due, streams, held, today, &**watch),
            || follow_up.follow(facts_before, day_before, None),
        );
        self.trace = trace;
        self.use_params(due, entries);
        figures
    }

    /// What follows from a call, with its notices and the settings family that it left if it set one.
    pub fn follow_call(&mut self, entries: Entries<'_>, notices: Vec<String>, settings: Option<Value>) {
        let Simulation { params, streams, facts, feed, facts_chain, .. } = self;
        FollowUp { feed, facts_chain, entries, params, streams }.follow(facts, Some(notices), settings);
    }

    /// What follows from the last day of some, if there was any, with its notices.
    pub fn follow_last_day(&mut self, entries: Entries<'_>, last_day: Option<Vec<String>>) {
        let Simulation { params, streams, facts, feed, facts_chain, .. } = self;
        FollowUp { feed, facts_chain, entries, params, streams }.follow(facts, last_day, None);
    }

    /// The same; meanwhile the state is hashed.
    pub fn end_days(&mut self, entries: Entries<'_>, last_day: Option<Vec<String>>) -> StateHash {
        let Simulation { world, params, streams, facts, feed, facts_chain, .. } = self;
        let follow_up = FollowUp { feed, facts_chain, entries, params, streams };
        let (parts, ()) = rayon::join(|| world.part_hashes(), || follow_up.follow(facts, last_day, None));
        state_hash(parts, self.facts_chain.hash())
    }
}

/// Facts to be filled: these if nobody reads them any more, else some that the writer of the database has done with, or
/// new ones. The facts of a day that is not handed over yet stay.
fn to_fill<'a>(facts: &'a mut Arc<Facts>, entries: Entries<'_>) -> &'a mut Facts {
    if Arc::strong_count(facts) > 1 {
        *facts = entries.spare_facts().unwrap_or_default();
    }
    Arc::make_mut(facts)
}

/// The parts that a day leaves its traces in.
struct FollowUp<'a> {
    feed: &'a mut Feed,
    facts_chain: &'a mut FactsChain,
    entries: Entries<'a>,
    params: &'a Params,
    streams: &'a Streams,
}

impl FollowUp<'_> {
    /// Facts are not copied for the database: the writer reads what the session still shows, and the session fills new
    /// ones while the writer needs these.
    /// Nothing follows where there are no notices: nothing is left to be followed.
    fn follow(self, facts: &Arc<Facts>, notices: Option<Vec<String>>, settings: Option<Value>) {
        let Some(notices) = notices else { return };
        self.feed.word(facts, self.params, self.streams);
        self.facts_chain.add(facts);
        let FollowUp { feed, params, entries, .. } = self;
        entries.write(|| Entry { settings, ..entry_of(facts, notices, feed, params) });
    }
}
