//! Run folders of companies that policies have played.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock, Mutex, OnceLock};

use novamind::lab::{MetricsCollector, Policy, RunSpec, play_policy};
use novamind::record::folder::configuration::Configuration;

/// Relative path and contents of the files in a folder of runs.
type FolderContents = Vec<(PathBuf, Vec<u8>)>;

/// Policy, seed and last day of a played company.
type PlayedRunKey = (String, u64, u32);

/// Companies that policies have played for the tests of this process.
static PLAYED_RUNS: LazyLock<Mutex<HashMap<PlayedRunKey, Arc<OnceLock<FolderContents>>>>> =
    LazyLock::new(Mutex::default);

/// Copies a company that a policy of `tests/data/policies` has played until a day. Tests that use the same company
/// share the played files.
pub fn copy_played_run(policy: &str, seed: u64, until: u32, runs: &Path) {
    let shared = Arc::clone(
        PLAYED_RUNS.lock().expect("companies").entry((policy.to_owned(), seed, until)).or_default(),
    );
    for (path, bytes) in shared.get_or_init(|| played_run_files(policy, seed, until)) {
        let path = runs.join(path);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, bytes).expect("a file");
    }
}

fn played_run_files(policy: &str, seed: u64, until: u32) -> FolderContents {
    let runs = tempfile::tempdir().expect("a folder");
    let configuration = Configuration::bundled();
    let file = format!("{}/tests/data/policies/{policy}", env!("CARGO_MANIFEST_DIR"));
    let policy = Policy::find(&file, &configuration).expect("a policy");
    let spec = RunSpec {
        stop_after_day: Some(until),
        save_folder: Some(runs.path().to_owned()),
        saves_database: true,
        ..RunSpec::for_seed(seed)
    };
    play_policy(&policy, &spec, &configuration, &mut MetricsCollector::disabled()).expect("a run");
    let mut files = Vec::new();
    read_files(runs.path(), runs.path(), &mut files);
    files
}

fn read_files(folder: &Path, base: &Path, files: &mut FolderContents) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            read_files(&path, base, files);
        } else {
            let below = path.strip_prefix(base).expect("below the folder").to_owned();
            files.push((below, fs::read(path).expect("a file")));
        }
    }
}
