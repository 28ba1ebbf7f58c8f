//! Tests extreme values of every parameter: either a day can be simulated, or a size limit is reported.

use std::panic::{AssertUnwindSafe, catch_unwind};

use rayon::prelude::*;
use toml::{Table, Value};

use super::limits::{ExceededLimit, exceeded_limit_on_next_day};
use super::step_interaction_tests::busy_settings;
use super::*;
use crate::params::keys;

/// Values that every parameter is set to. Parameters reject values out of their range.
const TESTED_VALUES: [f64; 5] = [0.0, -1.0, 1_000.0, 4e9, 1e300];

fn company(params: &Params, streams: &Streams) -> World {
    let mut facts = Facts::default();
    let mut world = World::new(500, 1e8, params, &mut facts);
    busy_settings(&mut world);
    for _ in 0..27 {
        step_day(&mut world, params, streams, &mut facts);
    }
    world
}

/// Returns whether a key is skipped because the same key of another group, tier or level is tested.
fn is_redundant_key(key: &str) -> bool {
    let is_other_group =
        |part: &str| Group::parse(part).is_some_and(|group| !["S1", "E1"].contains(&group.id()));
    let is_higher_number = |part: &str| part.parse::<u32>().is_ok_and(|number| number > 1);
    key.split('.').any(|part| is_other_group(part) || is_higher_number(part)) || key.starts_with("personas.")
}

#[test]
fn extreme_parameters_simulate_or_exceed_limits() {
    let (bundled, streams) = (Params::bundled(), Streams::new(3));
    let opening = company(&bundled, &streams);
    assert!(opening.customers.active_by_group().iter().sum::<u32>() > 20);
    let changed_parameters = |key: &String| -> Vec<(String, Params)> {
        let bundled_value = if is_redundant_key(key) { None } else { bundled.value(key).ok() };
        let value = |number: f64| match bundled_value {
            Some(Value::Float(_)) => Some(Value::Float(number)),
            Some(Value::Integer(_)) => Some(Value::Integer(number as i64)),
            _ => None,
        };
        let with = |number: f64| Some((format!("{key} = {number}"), bundled.with(key, value(number)?).ok()?));
        TESTED_VALUES.into_iter().filter_map(with).collect()
    };
    let tried: Vec<(String, Params)> =
        keys(&Table::try_from(&bundled).expect("tables")).iter().flat_map(changed_parameters).collect();
    assert!(tried.len() > 400, "{}", tried.len());
    let passes = |params: &Params| {
        let (mut world, mut facts) = (opening.clone(), Facts::default());
        for _ in 0..2 {
            if world.is_over(params) || exceeded_limit_on_next_day(&world, params, &streams).is_some() {
                break;
            }
            step_day(&mut world, params, &streams, &mut facts);
        }
    };
    let failed: Vec<&String> = tried
        .par_iter()
        .filter(|(_, params)| catch_unwind(AssertUnwindSafe(|| passes(params))).is_err())
        .map(|(name, _)| name)
        .collect();
    assert_eq!(failed, Vec::<&String>::new());
}

#[test]
fn next_day_limit_rejects_millions_of_leads() {
    let (bundled, streams) = (Params::bundled(), Streams::new(3));
    let world = company(&bundled, &streams);
    assert_eq!(exceeded_limit_on_next_day(&world, &bundled, &streams), None);
    let crowded =
        bundled.with("calendar.weekly", Value::Array(vec![Value::Float(1e6); 7])).expect("in range");
    assert_eq!(exceeded_limit_on_next_day(&world, &crowded, &streams), Some(ExceededLimit::Leads));
    let mut full = world.clone();
    full.customers.next_customer = u32::MAX - 1;
    assert_eq!(exceeded_limit_on_next_day(&full, &bundled, &streams), Some(ExceededLimit::Numbers));
}
