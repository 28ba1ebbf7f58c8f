//! The next random draws of a part of the world. Random streams are keyed and keep no state. The draws of the next day
//! are therefore known in advance, unless they depend on open decisions.

use super::inspector::Inspector;
use novamind_session::{HiddenState, InspectionPermit};
use novamind_tools::Rejection;
use novamind_world::identifiers::Group;
use novamind_world::market::competitors::move_on_day;
use novamind_world::market::economy::index_on_day;
use novamind_world::market::surges::{Surge, surge_on_day};
use novamind_world::product::development::daily_noise;
use novamind_world::product::research;
use novamind_world::random::{Part, bernoulli_from_word};
use novamind_world::retention::due_today;
use novamind_world::retention::renewal::{group_involuntary_rate, payment_failure_words};

/// A part of the simulation whose next random draws can be inspected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RandomPart {
    /// Number of leads in each group.
    Leads,
    /// Failed payments of individuals.
    Renewals,
    /// Outages: occurrence, length, latency and error rate.
    Service,
    /// Daily noise of shared quality.
    Quality,
    /// Duration and gain of R&D projects.
    Research,
    /// Result of the next market research attempt.
    Discovery,
    /// Start and strength of demand surges.
    Surge,
    /// Noise of the economy index.
    Economy,
    /// Size and timing of competitor moves.
    Competitors,
}

impl RandomPart {
    /// All parts of the world that make random draws.
    pub const ALL: [RandomPart; 9] = [
        RandomPart::Leads,
        RandomPart::Renewals,
        RandomPart::Service,
        RandomPart::Quality,
        RandomPart::Research,
        RandomPart::Discovery,
        RandomPart::Surge,
        RandomPart::Economy,
        RandomPart::Competitors,
    ];

    /// Returns the id that commands and texts use for the part.
    pub fn id(self) -> &'static str {
        ["leads", "renewals", "service", "quality", "research", "discovery", "surge", "economy", "rivals"]
            [self as usize]
    }

    /// Returns the part with the given id.
    pub fn parse(id: &str) -> Option<RandomPart> {
        RandomPart::ALL.into_iter().find(|part| part.id() == id)
    }

    /// Returns the random streams of the part, and the maximum number of draws per stream.
    fn stream_and_draws(self) -> (Part, usize) {
        match self {
            RandomPart::Leads => (Part::LeadCount, 2),
            RandomPart::Renewals => (Part::InvoluntaryMu, 1),
            RandomPart::Service => (Part::Service, 4),
            RandomPart::Quality => (Part::QualityNoise, 1),
            RandomPart::Research => (Part::Research, 2),
            RandomPart::Discovery => (Part::MarketResearch, 2),
            RandomPart::Surge => (Part::Surge, 3),
            RandomPart::Economy => (Part::Macro, 1),
            RandomPart::Competitors => (Part::CompetitorEvent, 3),
        }
    }

    /// Returns whether a recorded series can replace the draws of the part.
    fn is_replayable(self) -> bool {
        use RandomPart::{Competitors, Discovery, Economy, Renewals, Surge};
        matches!(self, Renewals | Discovery | Surge | Economy | Competitors)
    }
}

/// A draw from a random stream.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Draw {
    /// The draw as a uniform variate in [0, 1).
    pub uniform: f64,
    /// The draw as a standard normal variate.
    pub normal: f64,
}

/// The effect that the draws of a stream have on the simulation.
#[derive(Debug, Clone, PartialEq)]
pub enum DrawEffect {
    /// Number of leads, assuming the expected leads of the last day.
    Leads {
        /// Expected leads of the last day.
        expected: f64,
        /// Number of leads that the draws produce.
        number: u32,
    },
    /// Payments of individuals that fail on the day.
    FailedPayments {
        /// Probability of a failed payment in the month.
        rate: f64,
        /// Numbers of the customers whose payment fails on the day.
        customers: Vec<u32>,
    },
    /// Drawn threshold. An outage occurs if the outage probability is above the threshold.
    OutageAbove(f64),
    /// Daily noise of the shared quality.
    Noise(f64),
    /// Duration and quality gain of an R&D project.
    Project {
        /// Tier of the R&D project, 1..=20.
        tier: u8,
        /// Duration of the R&D project, days.
        days: u32,
        /// Quality gain of the R&D project.
        gain: f64,
    },
    /// Group that market research would discover; `None` if it would discover no group.
    Found(Option<Group>),
    /// Demand surge that starts on the day; `None` if no surge starts.
    Surge(Option<Surge>),
    /// Change in the economy index.
    Index {
        /// Current value of the index.
        before: f64,
        /// Value of the index on the next day.
        after: f64,
    },
    /// Competitor move on the day, if any: its size before copying, and the share of the shared quality bank that can
    /// be copied.
    CompetitorMove(Option<(f64, f64)>),
}

/// A random stream that the next day opens, with its first draws.
#[derive(Debug, Clone, PartialEq)]
pub struct KeyedDraws {
    /// Name of the stream (docs/mechanics/randomness.md).
    pub stream: &'static str,
    /// Names and values of the stream's keys.
    pub key: Vec<(&'static str, u64)>,
    /// Group whose draws the stream contains; `None` if the draws do not belong to a group.
    pub group: Option<Group>,
    /// First draws of the stream.
    pub draws: Vec<Draw>,
    /// Effect of the draws on the simulation.
    pub effect: DrawEffect,
}

/// The next draws of a part of the world.
#[derive(Debug, Clone, PartialEq)]
pub struct NextDraws {
    /// The part whose draws are listed.
    pub part: RandomPart,
    /// Day on which the draws are used.
    pub day: u32,
    /// Whether the run has ended, in which case the day will not be simulated.
    pub is_over: bool,
    /// Whether a recorded series replaces the draws on the days that the series covers.
    pub is_replayed: bool,
    /// Random streams of the part.
    pub streams: Vec<KeyedDraws>,
}

/// Maximum number of draws that can be requested per stream.
pub const MAX_DRAWS: usize = 1000;

impl Inspector<'_> {
    /// Returns the next draws of a part of the world. `count` limits the draws of each stream; the default is the
    /// maximum of the part. Records the inspection.
    ///
    /// # Errors
    /// `not_in_this_mode`, `not_saved`, `out_of_range` if `count` is 0 or more than [`MAX_DRAWS`].
    pub fn next_draws(&mut self, part: RandomPart, count: Option<usize>) -> Result<NextDraws, Rejection> {
        self.run.check_inspection()?;
        let (_, usual) = part.stream_and_draws();
        let count = count.unwrap_or(usual);
        if !(1..=MAX_DRAWS).contains(&count) {
            let message = format!("choose a number of draws from 1 to {MAX_DRAWS}");
            return Err(Rejection::for_field("draws", "out_of_range", message));
        }
        let day = self.run.day() + 1;
        let permit = InspectionPermit::start_at_current_state(self.run, "streams", part.id(), day)?;
        let streams = next_streams(permit.hidden_state(self.run), part, day, count);
        let replays = permit.hidden_state(self.run).params().replayed_series().is_some();
        Ok(NextDraws {
            part,
            day,
            is_over: self.run.ended().is_some(),
            is_replayed: replays && part.is_replayable(),
            streams,
        })
    }
}

fn next_streams(inside: HiddenState<'_>, part: RandomPart, day: u32, count: usize) -> Vec<KeyedDraws> {
    let (world, params, streams) = (inside.world(), inside.params(), inside.streams());
    let of_day = |follows| vec![keyed_draws(inside, part, [("day", day.into())], None, count, follows)];
    match part {
        RandomPart::Leads => {
            let known = Group::all().filter(|group| world.market.is_known(*group));
            let number = |group| {
                let key = [("day", day.into()), group_key(group)];
                keyed_draws(inside, part, key, Some(group), count, lead_effect(inside, group, day))
            };
            known.map(number).collect()
        }
        RandomPart::Renewals => {
            let month = day / params.involuntary_churn.month_days;
            let failing = |group| {
                let key = [group_key(group), ("month", month.into())];
                keyed_draws(inside, part, key, Some(group), count, failed_payment_effect(inside, group, day))
            };
            Group::all().filter(|group| !group.is_enterprise()).map(failing).collect()
        }
        RandomPart::Research => {
            let tiers = 1..=params.research_tier.len() as u8;
            tiers.map(|tier| research_draws(inside, tier, count)).collect()
        }
        RandomPart::Discovery => {
            let found = world.market.next_attempt(params, streams).found;
            let key = [("attempt", world.market.attempts.into())];
            vec![keyed_draws(inside, part, key, None, count, DrawEffect::Found(found))]
        }
        RandomPart::Service => {
            of_day(DrawEffect::OutageAbove(streams.open(Part::Service, [day.into()]).uniform()))
        }
        RandomPart::Quality => of_day(DrawEffect::Noise(daily_noise(day, params, streams))),
        RandomPart::Surge => of_day(DrawEffect::Surge(surge_on_day(day, params, streams))),
        RandomPart::Economy => {
            let before = world.market.economy.pmi;
            of_day(DrawEffect::Index { before, after: index_on_day(day, before, params, streams) })
        }
        RandomPart::Competitors => of_day(competitor_effect(inside, day)),
    }
}

fn keyed_draws<const KEYS: usize>(
    inside: HiddenState<'_>,
    part: RandomPart,
    key: [(&'static str, u64); KEYS],
    group: Option<Group>,
    count: usize,
    follows: DrawEffect,
) -> KeyedDraws {
    let (random, _) = part.stream_and_draws();
    let mut stream = inside.streams().open(random, key.map(|(_, value)| value));
    let mut draw = || {
        let word = stream.word();
        Draw { uniform: word.uniform(), normal: word.standard_normal() }
    };
    let draws = (0..count).map(|_| draw()).collect();
    KeyedDraws { stream: random.name(), key: key.to_vec(), group, draws, effect: follows }
}

fn competitor_effect(inside: HiddenState<'_>, day: u32) -> DrawEffect {
    let (world, params, streams) = (inside.world(), inside.params(), inside.streams());
    let last_event = world.market.competitors.last().map(|event| event.day);
    let made = move_on_day(day, world.total_days, last_event, params, streams);
    DrawEffect::CompetitorMove(made.map(|made| (made.sampled, made.u)))
}

fn lead_effect(inside: HiddenState<'_>, group: Group, day: u32) -> DrawEffect {
    let expected = inside.lead_factors(group).expected();
    let keys = [u64::from(day), group.index() as u64];
    let number = inside.streams().open(Part::LeadCount, keys).poisson(expected) as u32;
    DrawEffect::Leads { expected, number }
}

/// Returns the customers whose payment would fail on the day if the payment were due. Each customer uses the draw at
/// the customer's position in the block.
fn failed_payment_effect(inside: HiddenState<'_>, group: Group, day: u32) -> DrawEffect {
    let (params, streams) = (inside.params(), inside.streams());
    let rate = group_involuntary_rate(group, day, params, streams);
    let mut customers = Vec::new();
    for (number, block) in inside.world().customers.groups[group].blocks.iter().enumerate() {
        let due = due_today(block, day, params);
        if rate > 0.0 && !due.is_empty() {
            let rolls = payment_failure_words(group, number as u32, day, streams);
            let failing =
                due.into_iter().filter(|at| bernoulli_from_word(rolls[block.word_position(*at)], rate));
            customers.extend(failing.map(|at| block.customer[at]));
        }
    }
    DrawEffect::FailedPayments { rate, customers }
}

fn research_draws(inside: HiddenState<'_>, tier: u8, count: usize) -> KeyedDraws {
    let (world, params, streams) = (inside.world(), inside.params(), inside.streams());
    let project = research::draw_project(&world.product, world.day, tier, params, streams);
    let key = [("tier", u64::from(tier)), ("earlier starts", u64::from(project.number - 1))];
    let days = project.due_day - project.started_day;
    let follows = DrawEffect::Project { tier, days, gain: project.boost };
    keyed_draws(inside, RandomPart::Research, key, None, count, follows)
}

fn group_key(group: Group) -> (&'static str, u64) {
    ("group", group.index() as u64)
}
