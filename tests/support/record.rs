//! What a run has recorded.

use std::path::{Path, PathBuf};

use novamind::record::trajectory::record::Activity;
use novamind::record::trajectory::{Record, Trajectory};

/// The lines of the run in a folder.
#[track_caller]
pub fn recorded(folder: &Path) -> Trajectory {
    Trajectory::read(&folder.join("trajectory.jsonl")).expect("lines")
}

/// The folder of the only run, or of the one whose name comes last.
#[track_caller]
pub fn folder_of(runs: &Path) -> PathBuf {
    let folders = std::fs::read_dir(runs).expect("a folder").flatten().map(|entry| entry.path());
    folders.filter(|path| path.is_dir()).max().expect("a run")
}

/// What was looked at with the x-ray, of which and on which day, in the order of the lines.
pub fn looks(lines: &Trajectory) -> Vec<String> {
    let look = |record: &Record| match record {
        Record::Activity(Activity::Xray(look)) => {
            Some(format!("{} {} {}", look.what, look.which, look.shown_day))
        }
        _ => None,
    };
    lines.lines.iter().filter_map(|line| look(&line.record)).collect()
}
