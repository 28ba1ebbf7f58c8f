//! Tests that a world with replayed series reproduces the figures that were measured in the released simulator.

use super::*;
use crate::day::step_day;
use crate::events::Facts;
use crate::events::Reading;
use crate::market::Market;
use crate::market::competitors::sampled_boost;
use crate::market::economy::Dimension;
use crate::market::surges::surge_factor;
use crate::params::{ParameterSource, SurgeStart, bundled_sources};
use crate::random::Streams;
use crate::retention::renewal::group_involuntary_rate;
use crate::state::World;

fn replay_params() -> Params {
    let scenario = include_str!("../../../configs/scenarios/reference-seed42.toml");
    let table: toml::Table = scenario.parse().expect("a scenario");
    let world = table.get("world").and_then(toml::Value::as_table).expect("overrides");
    let text = toml::to_string(world).expect("a table");
    Params::load(&bundled_sources(), &[ParameterSource { name: "scenario".to_owned(), text }])
        .expect("parameters")
}

/// Returns the rows of a file with measured figures.
macro_rules! measured {
    ($file:literal) => {
        include_str!(concat!("../../../tests/data/seed42/", $file, ".csv"))
            .lines()
            .skip(1)
            .map(|line| line.split(',').collect::<Vec<&str>>())
    };
}

fn number(text: &str) -> f64 {
    text.parse().expect("a number")
}

fn day(text: &str) -> u32 {
    text.parse().expect("a day")
}

fn group(id: &str) -> Group {
    Group::parse(id).expect("a group")
}

/// Simulates a company whose player takes no action, and calls `each` with the world and the facts of every day.
fn run_company_without_actions(seed: u64, mut each: impl FnMut(&World, &Facts)) {
    let (params, streams, mut facts) = (replay_params(), Streams::new(seed), Facts::default());
    let mut world = World::new(500, 1_000_000.0, &params, &mut facts);
    for _ in 0..500 {
        step_day(&mut world, &params, &streams, &mut facts);
        each(&world, &facts);
    }
}

#[test]
fn economy_matches_the_record_daily() {
    let pmi: Vec<f64> = measured!("pmi_daily").map(|row| number(row[1])).collect();
    let mut published: Vec<(u32, Reading)> = Vec::new();
    // Use a different seed, because the seed of the run has no effect on replayed series.
    run_company_without_actions(7, |world, facts| {
        assert_eq!(world.market.economy.pmi.to_bits(), pmi[world.day as usize - 1].to_bits());
        published.extend(facts.readings.iter().map(|reading| (world.day, *reading)));
    });
    let rows: Vec<Vec<&str>> = measured!("pmi_publications").filter(|row| day(row[1]) <= 500).collect();
    assert_eq!(published.len(), rows.len());
    for ((published_day, reading), row) in published.iter().zip(rows) {
        assert_eq!((reading.measured_day, *published_day), (day(row[0]), day(row[1])));
        assert_eq!((reading.value, reading.change), (number(row[2]), number(row[3])));
        assert_eq!((reading.trend.id(), reading.phase.id()), (row[4], row[5]));
    }
}

#[test]
fn macro_multipliers_match_the_record() {
    let params = replay_params();
    run_company_without_actions(42, |world, _| {
        for row in measured!("macro_multipliers").filter(|row| day(row[0]) == world.day) {
            let economy = &world.market.economy;
            let multiplier = |dimension| economy.multiplier(group(row[1]), dimension, &params);
            for (dimension, text) in [
                (Dimension::LeadGeneration, row[2]),
                (Dimension::WillingnessToPay, row[3]),
                (Dimension::SeatCount, row[4]),
            ] {
                // The file has no value for groups without this sensitivity.
                if !text.is_empty() {
                    assert!((multiplier(dimension) - number(text)).abs() < 1e-12, "{row:?}");
                }
            }
        }
    });
}

#[test]
fn competitor_events_and_expectations_match_the_record() {
    let mut seen: Vec<(u32, f64)> = Vec::new();
    run_company_without_actions(42, |world, _| {
        seen = world.market.competitors.iter().map(|event| (event.day, event.sampled)).collect();
        for row in measured!("drift_untouched").filter(|row| day(row[0]) == world.day) {
            let drift = &world.market.drift;
            let row_group = group(row[1]);
            for (value, text) in [
                (drift.quality[row_group], row[2]),
                (drift.c_max[row_group], row[3]),
                (drift.global_quality, row[4]),
            ] {
                assert!((value - number(text)).abs() < 1e-12, "{row:?}: {value}");
            }
        }
    });
    let recorded: Vec<(u32, f64)> =
        measured!("competitor_events_dev_groups_0").map(|row| (day(row[0]), number(row[3]))).collect();
    assert_eq!(seen, recorded);
    let params = replay_params();
    for row in measured!("competitor_events_dev_groups_0") {
        let recorded_event = SEED_42.competitor_event(day(row[0])).flatten().expect("an event");
        assert_eq!(recorded_event.u, number(row[4]));
        assert_eq!(sampled_boost(recorded_event.size, day(row[0]), 500, &params.competitor), number(row[3]));
    }
}

#[test]
fn surges_match_the_record() {
    let mut seen = Vec::new();
    run_company_without_actions(42, |world, _| {
        if world.day == 402 {
            // The surge of day 405 starts on the first day of its week.
            let factor = surge_factor(402, &world.market.surges, SurgeStart::Week);
            assert_eq!(factor, 6.745419511721691);
        }
        seen = world.market.surges.iter().map(|surge| (surge.day, surge.multiplier, surge.end_day)).collect();
    });
    let recorded: Vec<(u32, f64, u32)> =
        measured!("demand_surges").map(|row| (day(row[0]), number(row[2]), day(row[3]))).collect();
    assert_eq!(seen, recorded);
}

#[test]
fn market_research_matches_the_record() {
    let (params, streams) = (replay_params(), Streams::new(3));
    let mut market = Market::initial(&params);
    for row in measured!("market_research") {
        let attempt = market.next_attempt(&params, &streams);
        market.record_attempt(&attempt, 10, &params);
        assert_eq!(attempt.found.map_or("", Group::id), row[2]);
        assert_eq!(market.undiscovered().count().to_string(), row[3]);
    }
    assert_eq!(market.next_attempt(&params, &streams).found, None);
}

#[test]
fn involuntary_churn_matches_the_record() {
    let (params, streams) = (replay_params(), Streams::new(3));
    for row in measured!("involuntary_churn") {
        for tested_day in [day(row[2]), day(row[3])] {
            let rate = group_involuntary_rate(group(row[0]), tested_day, &params, &streams);
            assert_eq!(rate.to_bits(), number(row[4]).to_bits(), "{row:?}");
        }
    }
}

#[test]
fn channel_yields_match_the_record() {
    let channel = |id: &str| Channel::parse(id).expect("a channel");
    run_company_without_actions(3, |world, _| {
        let month = world.day - world.day % 30;
        if [0, 29].contains(&(world.day % 30)) {
            for row in measured!("channel_drift").filter(|row| day(row[0]) == month) {
                let value = world.market.yields[channel(row[1])][group(row[2])];
                assert_eq!(value.to_bits(), number(row[3]).to_bits(), "{row:?}");
            }
        }
    });
}

#[test]
fn draws_resume_after_the_end_of_the_record() {
    assert_eq!((SEED_42.pmi(0), SEED_42.pmi(505)), (None, None));
    assert_eq!((SEED_42.competitor_event(505), SEED_42.demand_surge(505)), (None, None));
    assert_eq!(SEED_42.involuntary_rate(group("S1"), 17), None);
    assert_eq!(SEED_42.channel_yield(Channel::Linkedin, group("S1"), 17), None);
    let (params, streams, mut facts) = (replay_params(), Streams::new(3), Facts::default());
    let mut world = World::new(600, 1_000_000.0, &params, &mut facts);
    for _ in 0..600 {
        step_day(&mut world, &params, &streams, &mut facts);
    }
    assert!(world.market.competitors.iter().any(|event| event.day > 505));
}
