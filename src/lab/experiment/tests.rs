use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use super::*;
use novamind_record::folder::configuration::Configuration;

fn arm(name: &str, policy: &str) -> Arm {
    let policy = Policy::find(policy, &Configuration::shipped()).expect("a bundled policy");
    let mut own = Arm::new(name, policy);
    own.spec.days = Some(14);
    own
}

fn experiment() -> Experiment {
    Experiment::of(vec![arm("idle", "P0"), arm("routine", "P1b")], 1..=3)
}

/// Conducts an experiment with results in a file; returns the results and the number of played runs. Stops after `most` runs.
fn conduct(
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
    let configuration = Configuration::shipped();
    let with = Conduct {
        configuration: &configuration,
        store: Some(&store),
        pool: &pool,
        stop: &stop,
        on_run: &on_run,
    };
    let prepared = experiment.prepare(&configuration, Some(&store), fresh).expect("arms");
    let results = prepared.conduct(&with);
    (results, played.into_inner())
}

#[test]
fn what_is_known_is_not_played_again_and_is_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("deeper/results.jsonl");
    let (first, played) = conduct(&experiment(), &path, false, 99);
    let first = first.expect("results");
    assert_eq!(played, 6);
    assert_eq!(first.by_arm.iter().map(Vec::len).collect::<Vec<_>>(), [3, 3]);
    assert!(first.by_arm[1].iter().all(|run| run.weeks.len() == 2 && run.day == 14));
    assert_ne!(first.of(0, |run| run.cash), first.of(1, |run| run.cash));
    let (second, played) = conduct(&experiment(), &path, false, 99);
    assert_eq!((second.expect("results"), played), (first.clone(), 0));
    let (afresh, played) = conduct(&experiment(), &path, true, 99);
    assert_eq!((afresh.expect("results"), played), (first.clone(), 6));
    // A new name keeps the key; a new day, parameter or figure changes it.
    let mut renamed = experiment();
    renamed.arms[0].name = "nothing".to_owned();
    assert_eq!(conduct(&renamed, &path, false, 99).1, 0);
    renamed.arms[0].spec.days = Some(21);
    assert_eq!(conduct(&renamed, &path, false, 99).1, 3);
    let surges = |share: &str| vec![("demand_surge.probability".to_owned(), share.to_owned())];
    renamed.arms[0].spec.overrides = surges("0.0");
    assert_eq!(conduct(&renamed, &path, false, 99).1, 0, "the policy has no surges either");
    renamed.arms[0].spec.overrides = surges("0.25");
    assert_eq!(conduct(&renamed, &path, false, 99).1, 3, "explicit overrides take precedence");
    renamed.wanted.daily = true;
    let (daily, played) = conduct(&renamed, &path, false, 99);
    assert_eq!(played, 6);
    assert_eq!(daily.expect("results").by_arm[0][0].daily.len(), 21);
}

#[test]
fn a_command_that_was_stopped_goes_on_and_shows_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let whole = conduct(&experiment(), &folder.path().join("whole.jsonl"), false, 99).0.expect("results");
    let path = folder.path().join("parts.jsonl");
    let (stopped, played) = conduct(&experiment(), &path, false, 2);
    match stopped {
        Err(ExperimentError::Stopped { kept, of }) => assert_eq!((kept, of), (played, 6)),
        other => panic!("{other:?}"),
    }
    let (rest, again) = conduct(&experiment(), &path, false, 99);
    assert_eq!((rest.expect("results"), played + again), (whole, 6));
}

#[test]
fn a_file_that_was_cut_off_anywhere_loses_one_run_at_most() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("results.jsonl");
    let whole = conduct(&experiment(), &path, false, 99).0.expect("results");
    let bytes = std::fs::read(&path).expect("results");
    let lines = bytes.iter().filter(|byte| **byte == b'\n').count();
    assert_eq!(lines, 6);
    for cut in [bytes.len() - 1, bytes.len() - 40, bytes.len() / 2, 3] {
        std::fs::write(&path, &bytes[..cut]).expect("a cut file");
        let left = bytes[..cut].iter().filter(|byte| **byte == b'\n').count();
        let (results, played) = conduct(&experiment(), &path, false, 99);
        assert_eq!(results.expect("results"), whole, "cut at {cut}");
        // A line that lacks only its line end is complete.
        assert!(played == 6 - left || (cut + 1 == bytes.len() && played == 0), "cut at {cut}: {played}");
        let (again, played) = conduct(&experiment(), &path, false, 99);
        assert_eq!((again.expect("results"), played), (whole.clone(), 0), "cut at {cut}");
    }
}

#[test]
fn a_result_that_was_changed_is_played_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("results.jsonl");
    let whole = conduct(&experiment(), &path, false, 99).0.expect("results");
    let text = std::fs::read_to_string(&path).expect("results");
    for (from, to) in [
        ("\"cash\":", "\"cash\":1"),
        ("\"subscribers\":", "\"subscribers\":7"),
        ("\"key\":\"", "\"key\":\"0"),
    ] {
        let changed = text.replacen(from, to, 1);
        assert_ne!(changed, text);
        std::fs::write(&path, changed).expect("written");
        let (again, played) = conduct(&experiment(), &path, false, 99);
        assert_eq!((again.expect("results"), played), (whole.clone(), 1), "{from}");
    }
}

#[test]
fn figures_of_days_are_kept_where_they_are_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut own = experiment();
    own.wanted.figures_on = vec![7];
    let (results, _) = conduct(&own, &folder.path().join("results.jsonl"), false, 99);
    let results = results.expect("results");
    let run = &results.by_arm[1][0];
    assert_eq!(run.figure(7, "cash", ""), Some(run.weeks[0].cash));
    assert_eq!(run.figure(14, "cash", ""), None);
    let again = conduct(&own, &folder.path().join("results.jsonl"), false, 99);
    assert_eq!((again.0.expect("results"), again.1), (results, 0), "numbers survive the file");
}

#[test]
fn a_wrong_arm_is_named() {
    let mut own = experiment();
    own.arms[1].spec.scenario = Some("nowhere".to_owned());
    let error = own.prepare(&Configuration::shipped(), None, false).map(|_| ()).expect_err("no scenario");
    assert!(error.to_string().starts_with("routine: "), "{error}");
}
