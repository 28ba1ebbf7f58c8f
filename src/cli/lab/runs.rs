//! Reads the runs that are named on the command line.

use std::collections::BTreeMap;

use crate::cli::run::progress_bar;
use crate::cli::{Context, Failure};
use crate::record::folder::manifest::Manifest;
use crate::record::folder::runs::find_run_to_read;
use crate::record::trajectory::Trajectory;
use crate::session::Session;

/// Applies `of` to each named run, and returns the results. Each run records that it was read.
///
/// # Errors
/// A run is missing, damaged, not accessible, or named twice.
pub fn map_runs<T>(
    names: &[String],
    command: &str,
    context: &Context,
    of: impl Fn(&Session, &Trajectory) -> T,
) -> Result<Vec<T>, Failure> {
    let folder = context.runs_folder()?;
    let progress = progress_bar(names.len() as u64, "runs");
    let mut read = Vec::new();
    let mut known = BTreeMap::new();
    for name in names {
        let path = find_run_to_read(&folder, name)?;
        // A copy of a run folder has the same run id.
        if let Some(before) = known.insert(Manifest::read(&path)?.id, name) {
            let message = format!("{before} and {name} are the same run; name each run once");
            return Err(Failure::usage(message));
        }
        context.authorize_view(&path, command, &names.join(" "))?;
        let session = Session::open_to_read(&path, true)?;
        read.push(of(&session, &Trajectory::read(&path.join("trajectory.jsonl"))?));
        progress.inc(1);
    }
    progress.finish_and_clear();
    Ok(read)
}
