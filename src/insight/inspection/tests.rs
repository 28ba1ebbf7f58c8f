//! Inspections show the values that the simulator used, in the equations of a recorded run and the draws of simulated
//! days.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use serde_json::json;

use super::next_draws::{DrawEffect, NextDraws, RandomPart};
use super::quality_equation::QualityEquation;
use super::satisfaction_equation::SatisfactionTerm;
use crate::inspection::inspector::Inspect;
use novamind_record::folder::configuration::Configuration;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Via;
use novamind_session::{Access, HiddenState, InspectionPermit, NewRun, Session, Storage};
use novamind_world::customers::columns::Block;
use novamind_world::customers::drift::{DriftTotals, Expectation};
use novamind_world::day::observer::DayObserver;
use novamind_world::events::{EndCause, Facts};
use novamind_world::identifiers::{ByGroup, ByPlan, Group, Plan};
use novamind_world::market::arrivals::ArrivalContext;
use novamind_world::market::competitors::{CompetitorEvent, next_move};
use novamind_world::market::leads::LeadFactors;
use novamind_world::market::surges::surge_on_day;
use novamind_world::params::Params;
use novamind_world::product::development::development_gain;
use novamind_world::product::service::{error_rate, outage_probability, p95_latency};
use novamind_world::random::{Part, Streams};
use novamind_world::retention::renewal::RenewalContext;
use novamind_world::state::World;

const COMPARED_DAYS: [u32; 8] = [1, 2, 31, 62, 66, 91, 98, 119];

/// Opens a copy of a recorded run in which every setting is used.
fn recorded_run(place: &Path) -> Session {
    let from = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/recorded/everything");
    let folder = place.join("everything");
    std::fs::create_dir(&folder).expect("a folder");
    for name in ["run.toml", "trajectory.jsonl"] {
        std::fs::copy(from.join(name), folder.join(name)).expect("a copy");
    }
    Session::open(&folder, Access::Write, true).expect("it opens")
}

/// Values of a day, observed in the simulator.
#[derive(Clone, Default)]
struct ObservedDay {
    delivered: ByGroup<ByPlan<f64>>,
    expectations: ByGroup<Expectation>,
    service_penalty: f64,
    /// Satisfaction of all subscribers after the daily change, by block.
    satisfaction_updates: BTreeMap<(Group, u32), Vec<f64>>,
    satisfaction_at_day_end: ByGroup<Vec<f64>>,
    reputation: ByGroup<f64>,
    /// Number of cancellations that affect reputation, by group.
    gave_up: ByGroup<u32>,
    shared: (f64, f64),
    group_banks: ByGroup<(f64, f64)>,
    drift: DriftTotals,
    events: Vec<CompetitorEvent>,
}

/// An observer of the simulator's values that is independent of the hidden-day recorder.
#[derive(Default)]
struct WorldObserver {
    today: Mutex<ObservedDay>,
    days: Mutex<Vec<ObservedDay>>,
}

impl DayObserver for WorldObserver {
    fn before_decisions(&self, group: Group, block: &Block, _: &RenewalContext<'_>) {
        let mut today = self.today.lock().expect("a lock");
        today.satisfaction_updates.insert((group, block.n[0]), block.satisfaction.clone());
    }

    fn on_expected_leads(&self, arrivals: &ArrivalContext<'_>, _: &ByGroup<u32>, _: &ByGroup<LeadFactors>) {
        let (mut today, morning) = (self.today.lock().expect("a lock"), arrivals.day.morning);
        today.delivered = ByGroup::from_fn(|group| ByPlan::from_fn(|plan| morning.delivered(group, plan)));
        today.expectations = morning.expectations;
        today.service_penalty = arrivals.day.service_penalty;
    }

    fn on_day_end(&self, world: &World, _: &Params, facts: &Facts) {
        let mut today = std::mem::take(&mut *self.today.lock().expect("a lock"));
        today.satisfaction_at_day_end = ByGroup::from_fn(|group| {
            let blocks = world.customers.groups[group].blocks.iter();
            blocks.flat_map(|block| block.satisfaction.iter().copied()).collect()
        });
        today.reputation = ByGroup::from_fn(|group| world.market.reputation.get(group));
        let harmful = |cause: EndCause| matches!(cause, EndCause::Price | EndCause::Quality);
        for ending in facts.endings.iter().filter(|ending| harmful(ending.cause)) {
            today.gave_up[ending.group] += 1;
        }
        let product = &world.product;
        today.shared = (product.shared_bonus, product.shared_bank);
        today.group_banks = ByGroup::from_fn(|group| (product.group_bonus[group], product.group_bank[group]));
        today.drift = world.market.drift.clone();
        today.events = world.market.competitors.clone();
        self.days.lock().expect("a lock").push(today);
    }
}

/// Returns the recorded run and its observed days, starting with day 1.
fn run_and_days(place: &Path) -> (Session, Vec<ObservedDay>) {
    let mut session = recorded_run(place);
    let used = Arc::new(WorldObserver::default());
    let permit = InspectionPermit::start(&mut session, "metrics", "days", None).expect("an inspection");
    permit.replay_until(&session, permit.day(), used.clone()).expect("it is simulated again");
    let days = std::mem::take(&mut *used.days.lock().expect("a lock"));
    assert_eq!(days.len(), 119);
    (session, days)
}

fn assert_close(value: f64, other: f64) {
    assert!((value - other).abs() <= 1e-12, "{value} {other}");
}

#[test]
fn quality_equation_equals_delivered_quality_bit_for_bit() {
    let place = tempfile::tempdir().expect("a folder");
    let (mut session, days) = run_and_days(place.path());
    let mut researched = 0;
    for day in COMPARED_DAYS {
        let used = &days[day as usize - 1];
        for group in Group::all() {
            let quality_equation: QualityEquation =
                session.inspect().quality_equation(group, Some(day)).expect("an inspection");
            for plan in Plan::ALL {
                let plan_quality = quality_equation.plans[plan];
                let product = quality_equation.product_quality(plan_quality.multiplier);
                assert_eq!(product.to_bits(), used.delivered[group][plan].to_bits(), "{group} {plan} {day}");
                assert_eq!(plan_quality.delivered.to_bits(), product.to_bits());
            }
            assert_eq!(quality_equation.expectation, used.expectations[group]);
            assert_eq!(quality_equation.service_penalty.to_bits(), used.service_penalty.to_bits());
            let gains = quality_equation.gains;
            assert_close(
                gains.opening + gains.research + gains.development + gains.noise,
                quality_equation.shared,
            );
            // The daily noise has a standard deviation of 0.001.
            assert!(gains.noise.abs() < 0.005 * f64::from(day).sqrt(), "{gains:?}");
            researched += u32::from(gains.research > 0.0);
        }
    }
    assert!(researched > 26 && days.iter().any(|day| day.service_penalty > 0.0));
}

#[test]
fn satisfaction_terms_add_up_to_the_mean() {
    let place = tempfile::tempdir().expect("a folder");
    let (mut session, days) = run_and_days(place.path());
    let mut compared = 0;
    for day in COMPARED_DAYS {
        let used = &days[day as usize - 1];
        for group in Group::all() {
            let satisfaction_equation =
                session.inspect().satisfaction_equation(group, Some(day)).expect("an inspection");
            let satisfactions = &used.satisfaction_at_day_end[group];
            assert_eq!(satisfaction_equation.subscribers as usize, satisfactions.len());
            let mean = satisfactions.iter().sum::<f64>() / satisfactions.len() as f64;
            assert_eq!(
                satisfaction_equation.end_of_day.map(f64::to_bits),
                (!satisfactions.is_empty()).then_some(mean.to_bits())
            );
            let moved: Vec<f64> = (used.satisfaction_updates.iter())
                .filter(|((of, _), _)| *of == group)
                .flat_map(|(_, block)| block.iter().copied())
                .collect();
            assert_eq!(satisfaction_equation.included_subscribers() as usize, moved.len());
            assert_eq!(
                satisfaction_equation.included_subscribers() + satisfaction_equation.joined,
                satisfaction_equation.subscribers + satisfaction_equation.departed
            );
            let (Some(before), Some(after), Some(instant)) = (
                satisfaction_equation.before(),
                satisfaction_equation.after(),
                satisfaction_equation.instant_satisfaction(),
            ) else {
                assert!(moved.is_empty());
                continue;
            };
            assert_close(after, moved.iter().sum::<f64>() / moved.len() as f64);
            assert_close(
                after,
                (1.0 - satisfaction_equation.weight) * before + satisfaction_equation.weight * instant,
            );
            assert_close(
                instant,
                SatisfactionTerm::ALL.iter().filter_map(|term| satisfaction_equation.term(*term)).sum(),
            );
            let earlier = &days[day as usize - 2].satisfaction_at_day_end[group];
            assert_close(before, earlier.iter().sum::<f64>() / earlier.len() as f64);
            compared += 1;
        }
    }
    assert!(compared > 35, "{compared}");
}

#[test]
fn reputation_terms_add_up_to_the_reputation() {
    let place = tempfile::tempdir().expect("a folder");
    let (mut session, days) = run_and_days(place.path());
    let (mut gave_up, mut lost, mut number, mut dropped) = (0, 0, 0, 0);
    for day in COMPARED_DAYS.into_iter().chain(100..118) {
        let used = &days[day as usize - 1];
        let all = session.inspect().spillover(Some(day)).expect("an inspection");
        for group in Group::all() {
            let reputation_equation =
                session.inspect().reputation_equation(group, Some(day)).expect("an inspection");
            assert_eq!(
                reputation_equation.after.to_bits(),
                used.reputation[group].to_bits(),
                "{group} on day {day}"
            );
            if day > 1 {
                assert_eq!(
                    reputation_equation.before.to_bits(),
                    days[day as usize - 2].reputation[group].to_bits()
                );
            }
            assert_close(reputation_equation.total(), reputation_equation.after);
            assert_eq!(
                reputation_equation.individual_departures.count, used.gave_up[group],
                "{group} on day {day}"
            );
            assert_eq!(reputation_equation.contribution, all.contributions[group]);
            for spill in &reputation_equation.spillovers {
                assert_eq!(all.spillover_between(spill.from, group), Some(*spill));
                assert_eq!(spill.counts, spill.change.abs() > reputation_equation.thresholds.spillover);
                number += u32::from(spill.counts);
                dropped += u32::from(!spill.counts);
            }
            gave_up += reputation_equation.individual_departures.count;
            lost += reputation_equation.enterprise_departures.count;
        }
    }
    assert!(gave_up > 50 && lost > 0 && number > 50 && dropped > 50, "{gave_up} {lost} {number} {dropped}");
}

#[test]
fn competitor_and_drift_state_match_the_world_and_next_move_occurs() {
    let place = tempfile::tempdir().expect("a folder");
    let (mut session, days) = run_and_days(place.path());
    let last = days.last().expect("a day").events.clone();
    assert!(last.len() > 1);
    for day in COMPARED_DAYS.into_iter().chain([58, 59, 64, 65, 72, 73]) {
        let used = &days[day as usize - 1];
        let rivals = session.inspect().competitor_state(Some(day)).expect("an inspection");
        assert_eq!((rivals.shared_bonus, rivals.shared_bank), used.shared);
        for (group, bonus, bank) in &rivals.group_banks {
            assert_eq!((*bonus, *bank), used.group_banks[*group]);
        }
        let moves: Vec<CompetitorEvent> = rivals.moves.iter().map(|(event, _)| *event).collect();
        assert_eq!(moves, used.events);
        let coming = last.iter().find(|event| event.day > day);
        assert_eq!(rivals.next_move.as_ref().and_then(|next| next.outcome), coming.copied());
        // The predicted next move equals the simulated move.
        let permit = InspectionPermit::start(&mut session, "streams", "rivals", None).expect("an inspection");
        let (params, streams) =
            (permit.hidden_state(&session).params(), permit.hidden_state(&session).streams());
        let last_event = used.events.last().map(|event| event.day);
        let decided = next_move(day, 119, last_event, params, streams);
        let decided_move = decided.map(|next| (next.day, next.sampled, next.u));
        assert_eq!(decided_move, coming.map(|event| (event.day, event.sampled, event.u)));
        let drift = session.inspect().drift_state(Some(day)).expect("an inspection");
        assert_eq!(drift.common_expectation, used.drift.global_quality);
        let group = |group: Group| drift.groups[group.index()];
        assert!(
            Group::all()
                .all(|market_group| group(market_group).expectation == used.drift.expectation(market_group))
        );
        let Some(next) = drift.next_day else { continue };
        // Budgets change only by drift.
        let [eve, after] = [next - 1, next].map(|day| &days[day as usize - 1].drift.c_max);
        assert_eq!(*eve, used.drift.c_max, "nothing drifts between days {day} and {next}");
        assert!(Group::all().all(
            |market_group| after[market_group] == eve[market_group] + group(market_group).next_step.c_max
        ));
    }
}

/// Creates a debug run in memory with subscribers and development.
fn run_in_memory(seed: u64) -> Session {
    let new = NewRun {
        seed: Some(seed),
        days: Some(200),
        cash: Some(1e8),
        mode: Mode::Debug,
        storage: Storage::Memory,
        projection: false,
        ..NewRun::default()
    };
    let mut session = Session::create(new, &Configuration::bundled()).expect("the run begins");
    for (tool, arguments) in [
        ("set_prices", json!({"A": 9, "B": 18, "C": 40})),
        ("set_usage_quotas", json!({"A": 500, "B": 2500, "C": 9000})),
        ("set_model_tiers", json!({"A": 2, "B": 3, "C": 4})),
        ("set_daily_spend", json!({"development": 4000, "operations": 100})),
        (
            "set_targeted_ad_spend",
            json!({"targeted_spend": {"social_media": {"S1": 400, "S2": 400, "S3": 400}}}),
        ),
    ] {
        session.call(tool, &arguments, Via::Script).expect(tool);
    }
    session
}

/// Returns the hidden state of a debug run.
fn hidden_state(session: &Session) -> HiddenState<'_> {
    session.debug_hidden_state().expect("a debug run")
}

const DRAWN_DAYS: u32 = 150;

#[test]
fn next_day_makes_the_predicted_draws() {
    // Find a world with a demand surge.
    let surges = |seed: &u64| {
        let streams = Streams::new(*seed);
        (1..=DRAWN_DAYS).any(|day| surge_on_day(day, &Params::bundled(), &streams).is_some())
    };
    let mut session = run_in_memory((5..).find(surges).expect("a seed"));
    let mut seen = BTreeMap::new();
    for _ in 0..DRAWN_DAYS {
        let next_draws =
            RandomPart::ALL.map(|part| session.inspect().next_draws(part, None).expect("an inspection"));
        let bonus = hidden_state(&session).world().product.shared_bonus;
        session.step(1, &mut |_| {}).expect("a day");
        for draws in next_draws {
            assert_draws_match_streams(&draws, hidden_state(&session).streams());
            assert_effects_match_day(&draws, &session, bonus, &mut seen);
        }
    }
    for what in ["leads", "failed payment", "outage", "no outage", "surge", "index", "move", "noise"] {
        assert!(seen.get(what).is_some_and(|count| *count > 0), "{what}: {seen:?}");
    }
}

fn assert_draws_match_streams(next_draws: &NextDraws, streams: &Streams) {
    for keyed_draws in &next_draws.streams {
        let part = [
            Part::LeadCount,
            Part::InvoluntaryMu,
            Part::Service,
            Part::QualityNoise,
            Part::Research,
            Part::MarketResearch,
            Part::Surge,
            Part::Macro,
            Part::CompetitorEvent,
        ][next_draws.part as usize];
        assert_eq!(keyed_draws.stream, part.name());
        let mut stream = match keyed_draws.key[..] {
            [(_, one)] => streams.open(part, [one]),
            [(_, one), (_, other)] => streams.open(part, [one, other]),
            _ => panic!("{keyed_draws:?}"),
        };
        assert!(keyed_draws.draws.iter().all(|draw| draw.uniform.to_bits() == stream.uniform().to_bits()));
    }
}

fn assert_effects_match_day(
    next_draws: &NextDraws,
    session: &Session,
    bonus: f64,
    seen: &mut BTreeMap<&'static str, u32>,
) {
    let mut saw = |what| *seen.entry(what).or_insert(0) += 1;
    let inside = hidden_state(session);
    let (world, params) = (inside.world(), inside.params());
    let (streams, facts) = (inside.streams(), inside.facts());
    assert_eq!(next_draws.day, world.day);
    for keyed_draws in &next_draws.streams {
        match &keyed_draws.effect {
            DrawEffect::Leads { expected, number } => {
                let group = keyed_draws.group.expect("a group");
                let key = [keyed_draws.key[0].1, keyed_draws.key[1].1];
                let arrivals = facts.arrivals.iter().filter(|arrival| arrival.group == group).count() as u64;
                let now = inside.lead_factors(group).expected();
                assert_eq!(streams.open(Part::LeadCount, key).poisson(now), arrivals);
                assert_eq!(streams.open(Part::LeadCount, key).poisson(*expected), u64::from(*number));
                saw("leads");
            }
            DrawEffect::FailedPayments { customers, .. } => {
                let numbers: BTreeSet<u32> = customers.iter().copied().collect();
                let failed = facts.endings.iter().filter(|ending| {
                    Some(ending.group) == keyed_draws.group && ending.cause == EndCause::Involuntary
                });
                assert_eq!(failed.map(|ending| ending.customer).collect::<BTreeSet<u32>>(), numbers);
                if !numbers.is_empty() {
                    saw("failed payment");
                }
            }
            DrawEffect::OutageAbove(above) => {
                let (law, service) = (&params.operations, facts.service.expect("a service"));
                let spend = world.settings.core.operations;
                assert_eq!(service.outage, *above < outage_probability(spend, service.overload, law));
                // If an outage occurs, its length is drawn before latency and errors.
                let at = 1 + usize::from(service.outage);
                assert_eq!(service.p95_ms, p95_latency(service.overload, keyed_draws.draws[at].normal, law));
                assert_eq!(
                    service.error_rate,
                    error_rate(service.overload, keyed_draws.draws[at + 1].normal, law)
                );
                saw(if service.outage { "outage" } else { "no outage" });
            }
            DrawEffect::Noise(noise) => {
                let gain = development_gain(world.settings.core.development, &params.development);
                assert_close(world.product.shared_bonus - bonus, gain + noise);
                saw("noise");
            }
            DrawEffect::Surge(surge) => {
                let drawn = world.market.surges.iter().find(|surge| surge.day == next_draws.day);
                assert_eq!(drawn, surge.as_ref());
                if surge.is_some() {
                    saw("surge");
                }
            }
            DrawEffect::Index { after, .. } => {
                assert_eq!(world.market.economy.pmi.to_bits(), after.to_bits());
                saw("index");
            }
            DrawEffect::CompetitorMove(made) => {
                let event = world.market.competitors.iter().find(|event| event.day == next_draws.day);
                assert_eq!(event.map(|event| (event.sampled, event.u)), *made);
                if made.is_some() {
                    saw("move");
                }
            }
            DrawEffect::Project { .. } | DrawEffect::Found(_) => {}
        }
    }
}

#[test]
fn purchases_make_the_predicted_draws() {
    let mut session = run_in_memory(5);
    let mut found = 0;
    for _ in 0..4 {
        for tier in [1, 2] {
            let next_draws = session.inspect().next_draws(RandomPart::Research, None).expect("an inspection");
            session.call("start_research_project", &json!({"tier": tier}), Via::Script).expect("a project");
            let started = hidden_state(&session).world().product.research.last().expect("a project");
            let days = started.due_day - started.started_day;
            let project = DrawEffect::Project { tier: started.tier, days, gain: started.boost };
            assert_eq!(next_draws.streams[tier - 1].effect, project);
        }
        for _ in 0..3 {
            let next_draws =
                session.inspect().next_draws(RandomPart::Discovery, None).expect("an inspection");
            let before: Vec<Group> = hidden_state(&session).world().market.undiscovered().collect();
            session.call("research_market", &json!({}), Via::Script).expect("an attempt");
            let market = &hidden_state(&session).world().market;
            let new = before.into_iter().find(|group| market.is_known(*group));
            assert_eq!(next_draws.streams[0].effect, DrawEffect::Found(new));
            found += u32::from(new.is_some());
        }
        // Wait until both projects are finished.
        for _ in 0..45 {
            session.step(1, &mut |_| {}).expect("a day");
        }
    }
    assert!(found > 0);
    let refused = session.inspect().next_draws(RandomPart::Leads, Some(0)).expect_err("none").to_string();
    assert_eq!(refused, "out_of_range (draws): choose a number of draws from 1 to 1000");
    assert_eq!(
        session.inspect().next_draws(RandomPart::Leads, Some(1001)).expect_err("many").code,
        "out_of_range"
    );
}
