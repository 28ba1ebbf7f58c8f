//! Companies that policies have led, on the disk.

use std::path::Path;

use novamind::lab::{Collector, Policy, RunSpec, play};
use novamind::session::Configuration;

/// Lets a policy of `tests/data/policies` lead a company until a day.
pub fn led(policy: &str, seed: u64, until: u32, runs: &Path) {
    let configuration = Configuration::shipped();
    let file = format!("{}/tests/data/policies/{policy}", env!("CARGO_MANIFEST_DIR"));
    let policy = Policy::find(&file, &configuration).expect("a policy");
    let spec = RunSpec {
        until: Some(until),
        save: Some(runs.to_owned()),
        projection: true,
        ..RunSpec::of_seed(seed)
    };
    play(&policy, &spec, &configuration, &mut Collector::idle()).expect("a run");
}
