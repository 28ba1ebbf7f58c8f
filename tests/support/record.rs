//! Helpers that read the record of a run.

use std::path::{Path, PathBuf};

use novamind::record::trajectory::record::Activity;
use novamind::record::trajectory::{Record, Trajectory};

/// Reads the lines of the run in a folder.
#[track_caller]
pub fn read_trajectory(folder: &Path) -> Trajectory {
    Trajectory::read(&folder.join("trajectory.jsonl")).expect("lines")
}

/// Returns the run folder with the alphabetically last name, which is the only run in most tests.
#[track_caller]
pub fn run_folder(runs: &Path) -> PathBuf {
    let folders = std::fs::read_dir(runs).expect("a folder").flatten().map(|entry| entry.path());
    folders.filter(|path| path.is_dir()).max().expect("a run")
}

/// Returns the recorded x-ray views with object and day, in the order of the lines.
pub fn inspections(lines: &Trajectory) -> Vec<String> {
    let inspection_text = |record: &Record| match record {
        Record::Activity(Activity::Inspection(inspection)) => {
            Some(format!("{} {} {}", inspection.what, inspection.which, inspection.shown_day))
        }
        _ => None,
    };
    lines.lines.iter().filter_map(|line| inspection_text(&line.record)).collect()
}
