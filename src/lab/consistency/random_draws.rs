//! Random outcomes of a play, which are read day by day from the world of the play.

use std::collections::BTreeMap;

use crate::policy::Policy;
use crate::runner::{RunError, RunSpec, advance_week, decide_with_answers, is_over, new_run};
use novamind_insight::{DrawEffect, Inspect, KeyedDraws, RandomPart};
use novamind_record::folder::configuration::Configuration;
use novamind_session::{DayReport, HiddenState, Session};
use novamind_tools::{Answer, DiscoveryAttempt, Rejection};
use novamind_world::identifiers::{Channel, Group};

/// The key of a random outcome: a day, an attempt, or a customer of a group.
pub type DrawKey = [u32; 2];

/// A random outcome as bit patterns of up to four numbers.
pub type DrawValue = [u64; 4];

/// Random outcomes by key.
pub type DrawMap = BTreeMap<DrawKey, DrawValue>;

/// Random outcomes of one play of a policy.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PlayDraws {
    /// Attempts of market research by number, from 1. The value is the discovered group, counted from 1, or 0.
    pub attempts: DrawMap,
    /// Customers by group and number in the group. The values are demand, seats and profile.
    pub customers: DrawMap,
    /// Values of the economy index by day.
    pub economy: DrawMap,
    /// Competitor events by day. The values are the size before copying and the share of the bank that can be copied.
    pub competitor_events: DrawMap,
    /// Demand surges by first day. The values are the last day and the factor.
    pub surges: DrawMap,
    /// Channel yields by day, group and channel, on days on which the yields change.
    pub yields: DrawMap,
    /// Probability of a failed payment by group and decision day.
    pub failed_payments: DrawMap,
    /// R&D projects by tier and order of start. The values are the duration in days and the quality gain.
    pub projects: DrawMap,
    /// Quality noise on the day after a decision day.
    pub noise: DrawMap,
    /// Outage threshold on the day after a decision day.
    pub outages: DrawMap,
    /// Hash of the whole state after the last day.
    pub state: DrawMap,
    /// State of the company at the end of the play.
    pub end: PlayEnd,
}

/// The result of a play.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PlayEnd {
    /// Last simulated day of the play.
    pub day: u32,
    /// Cash after the last simulated day, dollars.
    pub cash: f64,
    /// Number of leads during the play.
    pub customers: u64,
    /// Number of discovered groups.
    pub found: u32,
}

/// Plays a policy and records its random outcomes.
///
/// # Errors
/// Fails if the run cannot start or a tool rejects a call that must succeed.
pub fn play_recording_draws(
    policy: &Policy,
    spec: &RunSpec,
    configuration: &Configuration,
) -> Result<PlayDraws, RunError> {
    let mut session = Session::create(new_run(policy, spec), configuration)?;
    let mut luck = PlayDraws::default();
    let until = spec.stop_after_day.unwrap_or(u32::MAX);
    let refused = |session: &Session, tool: &str, rejection: Rejection| RunError::Refused {
        seed: spec.seed,
        day: session.day(),
        tool: tool.to_owned(),
        rejection: Box::new(rejection),
    };
    while !is_over(&session, spec) {
        decide_with_answers(policy, spec.seed, &mut session, &mut |answer| {
            luck.record_market_research(answer)
        })?;
        luck.record_next_draws(&mut session)
            .map_err(|rejection| refused(&session, "the x-ray", rejection))?;
        advance_week(policy, spec.seed, until, &mut session, &mut |report| luck.record_day(report))?;
    }
    luck.record_final_state(&session).map_err(|rejection| refused(&session, "the x-ray", rejection))?;
    Ok(luck)
}

impl PlayDraws {
    /// Records the result of a market research attempt.
    fn record_market_research(&mut self, answer: &Answer) {
        let Answer::ResearchMarket(attempt) = answer else { return };
        let found = match attempt {
            DiscoveryAttempt::Found { discovered_group_id } => discovered_group_id.index() as u64 + 1,
            DiscoveryAttempt::Nothing { .. } => 0,
        };
        self.attempts.insert([self.attempts.len() as u32 + 1, 0], [found, 0, 0, 0]);
    }

    /// Records those draws of the next day that the world does not store.
    fn record_next_draws(&mut self, session: &mut Session) -> Result<(), Rejection> {
        let day = session.day();
        for KeyedDraws { group, effect: follows, .. } in
            session.inspect().next_draws(RandomPart::Renewals, Some(1))?.streams
        {
            if let (Some(group), DrawEffect::FailedPayments { rate, .. }) = (group, follows) {
                self.failed_payments.insert([group.index() as u32, day], to_bits([rate]));
            }
        }
        for part in [RandomPart::Quality, RandomPart::Service] {
            for drawn in session.inspect().next_draws(part, Some(1))?.streams {
                match drawn.effect {
                    DrawEffect::Noise(noise) => self.noise.insert([day + 1, 0], to_bits([noise])),
                    DrawEffect::OutageAbove(chance) => self.outages.insert([day + 1, 0], to_bits([chance])),
                    _ => None,
                };
            }
        }
        Ok(())
    }

    fn record_day(&mut self, report: &DayReport<'_>) {
        let Some(xray) = report.xray else { return };
        let (day, params) = (report.figures.day, xray.params());
        for arrival in &xray.facts().arrivals {
            let key = [arrival.group.index() as u32, arrival.n];
            let [a, b, c, d, e, f, g] = arrival.persona.0;
            let profile = u64::from_le_bytes([a, b, c, d, e, f, g, 0]);
            let value = [arrival.usage_demand.to_bits(), u64::from(arrival.seats), profile, 0];
            self.customers.insert(key, value);
            self.end.customers += 1;
        }
        self.economy.insert([day, 0], to_bits([xray.world().market.economy.pmi]));
        if day.is_multiple_of(params.leads.monthly_channel_noise_interval_days) {
            self.record_yields(day, xray);
        }
    }

    fn record_yields(&mut self, day: u32, xray: HiddenState<'_>) {
        for group in Group::all() {
            for channel in Channel::ALL {
                let pair = (group.index() * Channel::ALL.len() + channel.index()) as u32;
                self.yields.insert([day, pair], to_bits([xray.channel_yield(channel, group)]));
            }
        }
    }

    /// Records the random outcomes that the world still stores at the end of the play.
    fn record_final_state(&mut self, session: &Session) -> Result<(), Rejection> {
        let world = session.debug_hidden_state()?.world();
        for event in &world.market.competitors {
            self.competitor_events.insert([event.day, 0], to_bits([event.sampled, event.u]));
        }
        for surge in &world.market.surges {
            self.surges.insert([surge.day, 0], [u64::from(surge.end_day), surge.multiplier.to_bits(), 0, 0]);
        }
        for project in &world.product.research {
            let key = [u32::from(project.tier), project.number];
            let days = u64::from(project.due_day - project.started_day);
            self.projects.insert(key, [days, project.boost.to_bits(), 0, 0]);
        }
        let (hash, _) = session.state_hash();
        let word = |at: usize| {
            let digits = hash.get(16 * at..16 * (at + 1)).unwrap_or_default();
            u64::from_str_radix(digits, 16).unwrap_or(0)
        };
        self.state.insert([session.day(), 0], std::array::from_fn(word));
        self.end.day = session.day();
        self.end.cash = session.cash_by_day().last().copied().unwrap_or_default();
        self.end.found = self.attempts.values().filter(|found| found[0] > 0).count() as u32;
        Ok(())
    }
}

fn to_bits<const COUNT: usize>(values: [f64; COUNT]) -> DrawValue {
    std::array::from_fn(|at| values.get(at).map_or(0, |value| value.to_bits()))
}
