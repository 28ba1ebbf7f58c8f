use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use super::*;
use novamind_record::folder::configuration::Configuration;

fn test_arm(name: &str, policy: &str) -> Arm {
    let policy = Policy::find(policy, &Configuration::bundled()).expect("a bundled policy");
    let mut arm = Arm::new(name, policy);
    arm.spec.days = Some(14);
    arm
}

fn test_experiment() -> Experiment {
    Experiment::new(vec![test_arm("idle", "P0"), test_arm("routine", "P1b")], 1..=3)
}

/// Runs an experiment with a results file. Returns the results and the number of played runs. Stops after `most` runs.
fn run_experiment(
    experiment: &Experiment,
    path: &Path,
    fresh: bool,
    most: usize,
) -> (Result<ExperimentResults, ExperimentError>, usize) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
    let (stop, played) = (AtomicBool::new(false), AtomicUsize::new(0));
    let on_run = || {
        let count = played.fetch_add(1, Ordering::Relaxed) + 1;
        stop.store(count >= most, Ordering::Relaxed);
    };
    let store = ResultStore::open(path).expect("a file");
    let configuration = Configuration::bundled();
    let with = ExperimentContext {
        configuration: &configuration,
        store: Some(&store),
        pool: &pool,
        stop: &stop,
        on_run: &on_run,
    };
    let prepared = experiment.prepare(&configuration, Some(&store), fresh).expect("arms");
    let results = prepared.run(&with);
    (results, played.into_inner())
}

#[test]
fn stored_results_are_reused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("deeper/results.jsonl");
    let (first, played) = run_experiment(&test_experiment(), &path, false, 99);
    let first = first.expect("results");
    assert_eq!(played, 6);
    assert_eq!(first.by_arm.iter().map(Vec::len).collect::<Vec<_>>(), [3, 3]);
    assert!(first.by_arm[1].iter().all(|run| run.weeks.len() == 2 && run.day == 14));
    assert_ne!(first.figures_of_arm(0, |run| run.cash), first.figures_of_arm(1, |run| run.cash));
    let (second, played) = run_experiment(&test_experiment(), &path, false, 99);
    assert_eq!((second.expect("results"), played), (first.clone(), 0));
    let (afresh, played) = run_experiment(&test_experiment(), &path, true, 99);
    assert_eq!((afresh.expect("results"), played), (first.clone(), 6));
    // A new name of an arm does not change its keys. Other days, parameters or recorded figures change the keys.
    let mut renamed = test_experiment();
    renamed.arms[0].name = "nothing".to_owned();
    assert_eq!(run_experiment(&renamed, &path, false, 99).1, 0);
    renamed.arms[0].spec.days = Some(21);
    assert_eq!(run_experiment(&renamed, &path, false, 99).1, 3);
    let surges = |share: &str| vec![("demand_surge.probability".to_owned(), share.to_owned())];
    renamed.arms[0].spec.overrides = surges("0.0");
    assert_eq!(run_experiment(&renamed, &path, false, 99).1, 0, "the policy has no surges either");
    renamed.arms[0].spec.overrides = surges("0.25");
    assert_eq!(run_experiment(&renamed, &path, false, 99).1, 3, "explicit overrides take precedence");
    renamed.recorded.daily = true;
    let (daily, played) = run_experiment(&renamed, &path, false, 99);
    assert_eq!(played, 6);
    assert_eq!(daily.expect("results").by_arm[0][0].daily.len(), 21);
}

#[test]
fn stopped_experiment_resumes_with_equal_results() {
    let folder = tempfile::tempdir().expect("a folder");
    let experiment_results =
        run_experiment(&test_experiment(), &folder.path().join("whole.jsonl"), false, 99).0.expect("results");
    let path = folder.path().join("parts.jsonl");
    let (stopped, played) = run_experiment(&test_experiment(), &path, false, 2);
    match stopped {
        Err(ExperimentError::Stopped { kept, of }) => assert_eq!((kept, of), (played, 6)),
        other => panic!("{other:?}"),
    }
    let (rest, again) = run_experiment(&test_experiment(), &path, false, 99);
    assert_eq!((rest.expect("results"), played + again), (experiment_results, 6));
}

#[test]
fn truncated_file_loses_at_most_one_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("results.jsonl");
    let experiment_results = run_experiment(&test_experiment(), &path, false, 99).0.expect("results");
    let bytes = std::fs::read(&path).expect("results");
    let lines = bytes.iter().filter(|byte| **byte == b'\n').count();
    assert_eq!(lines, 6);
    for cut in [bytes.len() - 1, bytes.len() - 40, bytes.len() / 2, 3] {
        std::fs::write(&path, &bytes[..cut]).expect("a cut file");
        let left = bytes[..cut].iter().filter(|byte| **byte == b'\n').count();
        let (results, played) = run_experiment(&test_experiment(), &path, false, 99);
        assert_eq!(results.expect("results"), experiment_results, "cut at {cut}");
        // The last line is complete even if its line terminator is missing.
        assert!(played == 6 - left || (cut + 1 == bytes.len() && played == 0), "cut at {cut}: {played}");
        let (again, played) = run_experiment(&test_experiment(), &path, false, 99);
        assert_eq!((again.expect("results"), played), (experiment_results.clone(), 0), "cut at {cut}");
    }
}

#[test]
fn altered_result_is_replayed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("results.jsonl");
    let experiment_results = run_experiment(&test_experiment(), &path, false, 99).0.expect("results");
    let text = std::fs::read_to_string(&path).expect("results");
    for (from, to) in [
        ("\"cash\":", "\"cash\":1"),
        ("\"subscribers\":", "\"subscribers\":7"),
        ("\"key\":\"", "\"key\":\"0"),
    ] {
        let changed = text.replacen(from, to, 1);
        assert_ne!(changed, text);
        std::fs::write(&path, changed).expect("written");
        let (again, played) = run_experiment(&test_experiment(), &path, false, 99);
        assert_eq!((again.expect("results"), played), (experiment_results.clone(), 1), "{from}");
    }
}

#[test]
fn requested_day_figures_are_stored() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut experiment = test_experiment();
    experiment.recorded.figures_on = vec![7];
    let (results, _) = run_experiment(&experiment, &folder.path().join("results.jsonl"), false, 99);
    let results = results.expect("results");
    let run = &results.by_arm[1][0];
    assert_eq!(run.figure(7, "cash", ""), Some(run.weeks[0].cash));
    assert_eq!(run.figure(14, "cash", ""), None);
    let again = run_experiment(&experiment, &folder.path().join("results.jsonl"), false, 99);
    assert_eq!((again.0.expect("results"), again.1), (results, 0), "numbers survive the file");
}

#[test]
fn invalid_arm_is_named() {
    let mut experiment = test_experiment();
    experiment.arms[1].spec.scenario = Some("nowhere".to_owned());
    let error =
        experiment.prepare(&Configuration::bundled(), None, false).map(|_| ()).expect_err("no scenario");
    assert!(error.to_string().starts_with("routine: "), "{error}");
}
