//! Experiments for tests, with two threads and without stored results.

use std::sync::atomic::AtomicBool;

use super::{Arm, Experiment, ExperimentContext, ExperimentResults};
use novamind_record::folder::configuration::Configuration;

pub fn play_arms(arms: Vec<Arm>, seeds: impl IntoIterator<Item = u64>) -> ExperimentResults {
    let experiment = Experiment::new(arms, seeds);
    let configuration = Configuration::bundled();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
    let with = ExperimentContext {
        configuration: &configuration,
        store: None,
        pool: &pool,
        stop: &AtomicBool::new(false),
        on_run: &|| {},
    };
    let prepared = experiment.prepare(&configuration, None, true).expect("an experiment");
    prepared.run(&with).expect("results")
}
