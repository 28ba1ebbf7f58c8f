//! The next draws of a part of the world. Streams are keyed and keep no state, so the draws of the next day are known in advance,
//! unless they depend on open decisions.

use super::inspector::Inspector;
use novamind_session::{Look, Xray};
use novamind_tools::Refusal;
use novamind_world::identifiers::Group;
use novamind_world::market::competitors::move_of;
use novamind_world::market::economy::index_of;
use novamind_world::market::surges::{Surge, surge_of};
use novamind_world::product::development::daily_noise;
use novamind_world::product::research;
use novamind_world::random::{Part, word_below};
use novamind_world::retention::due_today;
use novamind_world::retention::renewal::{involuntary_rate_of, payment_rolls};

/// A part of the world whose next draws can be inspected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DrawnPart {
    /// Numbers of leads.
    Leads,
    /// Failed payments.
    Renewals,
    /// Outage, its length, latency, errors.
    Service,
    /// Daily noise of shared quality.
    Quality,
    /// R&D projects.
    Research,
    /// The next attempt of market research.
    Discovery,
    /// Demand surges.
    Surge,
    /// Index of the economy.
    Economy,
    /// Competitors.
    Rivals,
}

impl DrawnPart {
    /// All parts.
    pub const ALL: [DrawnPart; 9] = [
        DrawnPart::Leads,
        DrawnPart::Renewals,
        DrawnPart::Service,
        DrawnPart::Quality,
        DrawnPart::Research,
        DrawnPart::Discovery,
        DrawnPart::Surge,
        DrawnPart::Economy,
        DrawnPart::Rivals,
    ];

    /// Returns the name.
    pub fn id(self) -> &'static str {
        ["leads", "renewals", "service", "quality", "research", "discovery", "surge", "economy", "rivals"]
            [self as usize]
    }

    /// Returns the part with a name.
    pub fn parse(id: &str) -> Option<DrawnPart> {
        DrawnPart::ALL.into_iter().find(|part| part.id() == id)
    }

    /// Returns the random streams of the part, and the maximum number of draws of each.
    fn stream(self) -> (Part, usize) {
        match self {
            DrawnPart::Leads => (Part::LeadCount, 2),
            DrawnPart::Renewals => (Part::InvoluntaryMu, 1),
            DrawnPart::Service => (Part::Service, 4),
            DrawnPart::Quality => (Part::QualityNoise, 1),
            DrawnPart::Research => (Part::Research, 2),
            DrawnPart::Discovery => (Part::MarketResearch, 2),
            DrawnPart::Surge => (Part::Surge, 3),
            DrawnPart::Economy => (Part::Macro, 1),
            DrawnPart::Rivals => (Part::CompetitorEvent, 3),
        }
    }

    /// Whether a recorded series can be replayed in place of its draws.
    fn can_be_replayed(self) -> bool {
        use DrawnPart::{Discovery, Economy, Renewals, Rivals, Surge};
        matches!(self, Renewals | Discovery | Surge | Economy | Rivals)
    }
}

/// One draw of a stream.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Draw {
    /// As a uniform number, in [0, 1).
    pub uniform: f64,
    /// As a standard normal number.
    pub normal: f64,
}

/// The consequence of the draws of a stream.
#[derive(Debug, Clone, PartialEq)]
pub enum Follows {
    /// Number of leads, if the expectation equals that of the last day.
    Leads {
        /// Leads expected on the last day.
        expected: f64,
        /// Resulting leads.
        number: u32,
    },
    /// Failed payments.
    FailedPayments {
        /// Rate of failed payments in the month.
        rate: f64,
        /// Numbers of the customers whose payment fails on the day.
        customers: Vec<u32>,
    },
    /// Outage probability above which an outage occurs.
    OutageAbove(f64),
    /// Noise of shared quality.
    Noise(f64),
    /// An R&D project of the tier.
    Project {
        /// Tier, 1..=20.
        tier: u8,
        /// Duration, days.
        days: u32,
        /// Quality gain.
        gain: f64,
    },
    /// The discovered group, if any.
    Found(Option<Group>),
    /// A demand surge, if there is one.
    Surge(Option<Surge>),
    /// Index of the economy.
    Index {
        /// Current value.
        before: f64,
        /// Value of the next day.
        after: f64,
    },
    /// A competitor move, if there is one: its size before copying, and the share of the shared bank that can be copied.
    RivalMove(Option<(f64, f64)>),
}

/// A stream that the next day opens.
#[derive(Debug, Clone, PartialEq)]
pub struct KeyedDraws {
    /// Name of the stream (docs/mechanics/randomness.md).
    pub stream: &'static str,
    /// Keys of the stream.
    pub key: Vec<(&'static str, u64)>,
    /// The group of the stream, if any.
    pub group: Option<Group>,
    /// First draws.
    pub draws: Vec<Draw>,
    /// Consequence of the draws.
    pub follows: Follows,
}

/// The next draws of a part.
#[derive(Debug, Clone, PartialEq)]
pub struct NextDraws {
    /// The part.
    pub part: DrawnPart,
    /// Day of the draws.
    pub day: u32,
    /// Whether the run has ended, so that the day will not be simulated.
    pub is_over: bool,
    /// Whether a recorded series replaces these draws on the days that it covers.
    pub is_replayed: bool,
    /// The streams.
    pub streams: Vec<KeyedDraws>,
}

/// Maximum number of draws of a stream.
pub const MOST_DRAWS: usize = 1000;

impl Inspector<'_> {
    /// Returns the next draws of a part. `count` limits the draws of each stream; the default is the maximum of the part. Records
    /// the inspection.
    ///
    /// # Errors
    /// `not_in_this_mode`, `not_saved`, `out_of_range` if `count` is 0 or more than [`MOST_DRAWS`].
    pub fn next_draws(&mut self, part: DrawnPart, count: Option<usize>) -> Result<NextDraws, Refusal> {
        self.run.refuse_to_look_inside()?;
        let (_, usual) = part.stream();
        let count = count.unwrap_or(usual);
        if !(1..=MOST_DRAWS).contains(&count) {
            let message = format!("choose a number of draws from 1 to {MOST_DRAWS}");
            return Err(Refusal::at("draws", "out_of_range", message));
        }
        let day = self.run.day() + 1;
        let look = Look::begin_at(self.run, "streams", part.id(), day)?;
        let streams = streams_of(look.inside(self.run), part, day, count);
        let replays = look.inside(self.run).params().replayed_series().is_some();
        Ok(NextDraws {
            part,
            day,
            is_over: self.run.ended().is_some(),
            is_replayed: replays && part.can_be_replayed(),
            streams,
        })
    }
}

fn streams_of(inside: Xray<'_>, part: DrawnPart, day: u32, count: usize) -> Vec<KeyedDraws> {
    let (world, params, streams) = (inside.world(), inside.params(), inside.streams());
    let of_day = |follows| vec![keyed(inside, part, [("day", day.into())], None, count, follows)];
    match part {
        DrawnPart::Leads => {
            let known = Group::all().filter(|group| world.market.is_known(*group));
            let number = |group| {
                let key = [("day", day.into()), by(group)];
                keyed(inside, part, key, Some(group), count, leads_of(inside, group, day))
            };
            known.map(number).collect()
        }
        DrawnPart::Renewals => {
            let month = day / params.involuntary_churn.month_days;
            let failing = |group| {
                let key = [by(group), ("month", month.into())];
                keyed(inside, part, key, Some(group), count, failed_payments(inside, group, day))
            };
            Group::all().filter(|group| !group.is_enterprise()).map(failing).collect()
        }
        DrawnPart::Research => {
            let tiers = 1..=params.research_tier.len() as u8;
            tiers.map(|tier| research_of(inside, tier, count)).collect()
        }
        DrawnPart::Discovery => {
            let found = world.market.next_attempt(params, streams).found;
            let key = [("attempt", world.market.attempts.into())];
            vec![keyed(inside, part, key, None, count, Follows::Found(found))]
        }
        DrawnPart::Service => {
            of_day(Follows::OutageAbove(streams.open(Part::Service, [day.into()]).uniform()))
        }
        DrawnPart::Quality => of_day(Follows::Noise(daily_noise(day, params, streams))),
        DrawnPart::Surge => of_day(Follows::Surge(surge_of(day, params, streams))),
        DrawnPart::Economy => {
            let before = world.market.economy.pmi;
            of_day(Follows::Index { before, after: index_of(day, before, params, streams) })
        }
        DrawnPart::Rivals => of_day(rivals_on(inside, day)),
    }
}

fn keyed<const KEYS: usize>(
    inside: Xray<'_>,
    part: DrawnPart,
    key: [(&'static str, u64); KEYS],
    group: Option<Group>,
    count: usize,
    follows: Follows,
) -> KeyedDraws {
    let (random, _) = part.stream();
    let mut stream = inside.streams().open(random, key.map(|(_, value)| value));
    let mut draw = || {
        let word = stream.word();
        Draw { uniform: word.uniform(), normal: word.standard_normal() }
    };
    let draws = (0..count).map(|_| draw()).collect();
    KeyedDraws { stream: random.name(), key: key.to_vec(), group, draws, follows }
}

fn rivals_on(inside: Xray<'_>, day: u32) -> Follows {
    let (world, params, streams) = (inside.world(), inside.params(), inside.streams());
    let last_event = world.market.competitors.last().map(|event| event.day);
    let made = move_of(day, world.total_days, last_event, params, streams);
    Follows::RivalMove(made.map(|made| (made.sampled, made.u)))
}

fn leads_of(inside: Xray<'_>, group: Group, day: u32) -> Follows {
    let expected = inside.lead_factors(group).expected();
    let keys = [u64::from(day), group.index() as u64];
    let number = inside.streams().open(Part::LeadCount, keys).poisson(expected) as u32;
    Follows::Leads { expected, number }
}

/// Returns the customers whose payment fails if it is due. The roll of each customer has its position in the block.
fn failed_payments(inside: Xray<'_>, group: Group, day: u32) -> Follows {
    let (params, streams) = (inside.params(), inside.streams());
    let rate = involuntary_rate_of(group, day, params, streams);
    let mut customers = Vec::new();
    for (number, block) in inside.world().customers.groups[group].blocks.iter().enumerate() {
        let due = due_today(block, day, params);
        if rate > 0.0 && !due.is_empty() {
            let rolls = payment_rolls(group, number as u32, day, streams);
            let failing = due.into_iter().filter(|at| word_below(rolls[block.place(*at)], rate));
            customers.extend(failing.map(|at| block.customer[at]));
        }
    }
    Follows::FailedPayments { rate, customers }
}

fn research_of(inside: Xray<'_>, tier: u8, count: usize) -> KeyedDraws {
    let (world, params, streams) = (inside.world(), inside.params(), inside.streams());
    let project = research::draw(&world.product, world.day, tier, params, streams);
    let key = [("tier", u64::from(tier)), ("earlier starts", u64::from(project.number - 1))];
    let days = project.due_day - project.started_day;
    let follows = Follows::Project { tier, days, gain: project.boost };
    keyed(inside, DrawnPart::Research, key, None, count, follows)
}

fn by(group: Group) -> (&'static str, u64) {
    ("group", group.index() as u64)
}
