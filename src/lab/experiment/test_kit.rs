//! Experiments for tests: two threads, results not stored.

use std::sync::atomic::AtomicBool;

use super::{Arm, Conduct, Experiment, ExperimentResults};
use novamind_record::folder::configuration::Configuration;

pub fn played(arms: Vec<Arm>, seeds: impl IntoIterator<Item = u64>) -> ExperimentResults {
    let experiment = Experiment::of(arms, seeds);
    let configuration = Configuration::shipped();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
    let with = Conduct {
        configuration: &configuration,
        store: None,
        pool: &pool,
        stop: &AtomicBool::new(false),
        on_run: &|| {},
    };
    let prepared = experiment.prepare(&configuration, None, true).expect("an experiment");
    prepared.conduct(&with).expect("results")
}
