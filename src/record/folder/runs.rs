//! Listing, finding and deleting runs in runs folders.

use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::lock::{is_served, lock_run};
use super::manifest::Manifest;
use super::manifest_check::ManifestCheck;
use crate::error::RunError;
use crate::files::{open_regular_file, read_regular_file};
use crate::mode::Mode;
use crate::stamp::EarlierRun;
use crate::trajectory::find_policy;
use crate::trajectory::record::RunEndReason;
use crate::trajectory::{Line, Record};
use novamind_world::params::{HorizonRule, Interface};

/// Summary of a run for run lists.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunSummary {
    /// ID of the run.
    pub id: String,
    /// Time of creation, RFC 3339.
    pub created: String,
    /// Time at which the last line was recorded, RFC 3339.
    pub played: String,
    /// Mode of the run; `None` if the run cannot be read.
    pub mode: Option<Mode>,
    /// Seed of all random draws.
    pub seed: u64,
    /// Name of the scenario.
    pub scenario: String,
    /// Whether parameters differ from the bundled scenario of the same name.
    pub has_own_parameters: bool,
    /// Whether a language model scores the posts of the player.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub judged_by_model: bool,
    /// Whether the run is a branch of another run.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub is_branch: bool,
    /// Name of the policy that decided all weeks in the last lines, if any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub policy: Option<String>,
    /// Label of the participant.
    pub participant: Option<String>,
    /// Last simulated day.
    pub day: u32,
    /// Last day of the run.
    pub days: u32,
    /// Rule that derived the last day.
    pub horizon_rule: HorizonRule,
    /// Generation of the released simulator that defines the rules of the run.
    pub generation: Interface,
    /// Cash on day 0, dollars.
    pub starting_cash: f64,
    /// Cash after the last week, dollars.
    pub cash: f64,
    /// Reason for the end of the run; `None` if the run is unfinished.
    pub ended: Option<RunEndReason>,
    /// Whether a server has the run open.
    pub is_served: bool,
    /// ID of the recorded run, if the folder is a copy under another name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub copy_of: Option<String>,
    /// Why the run cannot be read; `None` if the run is readable.
    pub problem: Option<String>,
}

/// Returns the run folder for a run id.
pub fn run_folder(runs: &Path, id: &str) -> PathBuf {
    runs.join(id)
}

/// Subfolder of the common runs folder that contains one folder per participant.
pub const PARTICIPANTS_FOLDER: &str = "participants";

/// Returns the folder of a participant's runs. Each participant on a machine has a separate folder.
///
/// # Errors
/// The label is not a valid folder name.
pub fn participant_folder(runs: &Path, label: &str) -> Result<PathBuf, String> {
    let fits = |letter: char| letter.is_ascii_alphanumeric() || "-_.".contains(letter);
    if label.is_empty() || label.len() > 40 || label.starts_with('.') || !label.chars().all(fits) {
        return Err(format!(
            "{label:?} is not a participant label: use up to 40 letters, digits, hyphens, underscores and \
             dots, not beginning with a dot"
        ));
    }
    Ok(runs.join(PARTICIPANTS_FOLDER).join(label))
}

/// Name prefix of staging folders, which contain incomplete branches.
pub const STAGING_PREFIX: &str = ".branch-";

/// Returns whether a folder is a staging folder, which is not listed as a run.
pub fn is_staging_folder(folder: &Path) -> bool {
    folder.file_name().is_some_and(|name| name.to_string_lossy().starts_with(STAGING_PREFIX))
}

/// Returns the label of the participant whose runs are in a folder, or `None` for the common runs folder.
pub fn participant_of_folder(runs: &Path) -> Option<String> {
    let is_participant = runs.parent()?.file_name()? == PARTICIPANTS_FOLDER;
    runs.file_name().filter(|_| is_participant).map(|label| label.to_string_lossy().into_owned())
}

/// Returns the common runs folder for any runs folder, and the participant's label if `runs` is a participant's folder.
pub fn common_runs_folder(runs: &Path) -> (&Path, Option<String>) {
    let label = participant_of_folder(runs);
    let base = label.as_ref().and_then(|_| runs.parent()?.parent());
    (base.unwrap_or(runs), label)
}

/// Returns all related runs folders: the common folder, then the participants' folders, sorted by label.
pub fn all_run_folders(runs: &Path) -> Vec<PathBuf> {
    let (base, _) = common_runs_folder(runs);
    let entries = std::fs::read_dir(base.join(PARTICIPANTS_FOLDER)).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
    paths.sort_unstable();
    paths.insert(0, base.to_owned());
    paths
}

/// Returns all runs in a folder, most recently played first.
///
/// # Errors
/// The folder exists but cannot be read.
pub fn list_runs(runs: &Path) -> Result<Vec<RunSummary>, RunError> {
    let entries = match std::fs::read_dir(runs) {
        Ok(entries) => entries,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(RunError::Io { path: runs.to_owned(), error }),
    };
    let mut list: Vec<RunSummary> = entries
        .flatten()
        .map(|entry| entry.path())
        .filter(|folder| !is_staging_folder(folder))
        .filter(|folder| folder.join("run.toml").exists() || folder.join("trajectory.jsonl").exists())
        .map(|folder| summarize_run(&folder))
        .collect();
    list.sort_by(|left, right| right.played.cmp(&left.played).then_with(|| left.id.cmp(&right.id)));
    Ok(list)
}

fn summarize_run(folder: &Path) -> RunSummary {
    let id = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let manifest = match ManifestCheck::read(folder) {
        Ok(ManifestCheck { manifest, .. }) => manifest,
        Err(error) => return unreadable_summary(id, error.to_string()),
    };
    let (last, problem) = match read_last_lines(&folder.join("trajectory.jsonl")) {
        Ok(lines) => (lines, None),
        Err(problem) => (Vec::new(), Some(problem)),
    };
    // Day and cash after the last simulated days, and the reason for the end of the run.
    let closed = last.iter().rev().find_map(|line| match &line.record {
        Record::Week(closing) | Record::Step(closing) => Some((line.day, closing.cash)),
        Record::End(end) => Some((line.day, end.cash)),
        _ => None,
    });
    let ended = last.iter().rev().find_map(|line| match &line.record {
        Record::End(end) => Some(end.reason),
        _ => None,
    });
    RunSummary {
        copy_of: (manifest.id != id).then(|| manifest.id.clone()),
        id,
        horizon_rule: manifest.horizon_rule(),
        generation: manifest.generation(),
        has_own_parameters: manifest.has_changed_parameters()
            || (may_set_parameters(&manifest) && has_override_lines(&folder.join("trajectory.jsonl"))),
        judged_by_model: manifest.voice.as_ref().is_some_and(|model| model.judge),
        is_branch: manifest.parent.is_some(),
        policy: find_policy(&last).map(str::to_owned),
        created: manifest.created.clone(),
        played: last.last().map_or(manifest.created, |line| line.at.clone()),
        mode: Some(manifest.mode),
        seed: manifest.seed,
        scenario: manifest.scenario,
        participant: manifest.participant,
        day: closed.map_or(0, |(day, _)| day),
        days: manifest.days,
        starting_cash: manifest.cash,
        cash: match closed {
            Some((_, cash)) => cash,
            // The cash of an unreadable run is unknown.
            None if problem.is_some() => 0.0,
            None => manifest.cash,
        },
        ended,
        is_served: is_served(folder),
        problem,
    }
}

/// Returns whether parameters may have been set during the run, which is possible in debug runs, lessons and branches.
fn may_set_parameters(manifest: &Manifest) -> bool {
    manifest.mode == Mode::Debug || manifest.lesson.is_some() || manifest.parent.is_some()
}

fn has_override_lines(trajectory: &Path) -> bool {
    let Ok(bytes) = read_regular_file(trajectory) else { return false };
    let kind = br#""kind":"override""#;
    bytes.windows(kind.len()).any(|window| window == kind)
}

fn unreadable_summary(id: String, problem: String) -> RunSummary {
    RunSummary {
        id,
        created: String::new(),
        played: String::new(),
        mode: None,
        seed: 0,
        scenario: String::new(),
        has_own_parameters: false,
        judged_by_model: false,
        is_branch: false,
        policy: None,
        participant: None,
        day: 0,
        days: 0,
        horizon_rule: HorizonRule::Exact,
        generation: Interface::Release1,
        starting_cash: 0.0,
        cash: 0.0,
        ended: None,
        is_served: false,
        copy_of: None,
        problem: Some(problem),
    }
}

/// Returns the last lines of a trajectory, including its last week. Reads backwards from the end, because runs can be
/// long.
///
/// # Errors
/// The file cannot be read, or contains no readable line.
pub fn read_last_lines(path: &Path) -> Result<Vec<Line>, String> {
    let mut window: u64 = 64 << 10;
    loop {
        let (text, whole) =
            read_tail(path, window).map_err(|error| format!("{}: {error}", path.display()))?;
        let lines: Vec<Line> =
            text.lines().filter_map(|line| Line::parse_unchecked(line.as_bytes())).collect();
        let has_week = lines.iter().any(Line::closes_days);
        let begins = || lines.iter().any(|line| matches!(line.record, Record::Start(_)));
        match (has_week, whole) {
            (true, _) => return Ok(lines),
            (false, true) if begins() => return Ok(lines),
            (false, true) => return Err(format!("{}: no line of this file can be read", path.display())),
            (false, false) => window *= 8,
        }
    }
}

fn read_tail(path: &Path, window: u64) -> std::io::Result<(String, bool)> {
    let mut file = open_regular_file(path)?;
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(window)))?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)?;
    Ok((String::from_utf8_lossy(&bytes).into_owned(), window >= length))
}

/// Finds a run to play and returns its folder. `id` is a run id, a unique prefix of a run id, or `latest` for the
/// newest unfinished run.
///
/// # Errors
/// No run matches, or several runs match.
pub fn find_run(runs: &Path, id: &str) -> Result<PathBuf, RunError> {
    find_matching_run(runs, id, |run| run.ended.is_none())
}

/// Finds a run to read and returns its folder. `id` is a run id, a unique prefix of a run id, or `latest` for the
/// newest run.
///
/// # Errors
/// No run matches, or several runs match.
pub fn find_run_to_read(runs: &Path, id: &str) -> Result<PathBuf, RunError> {
    find_matching_run(runs, id, |_| true)
}

/// Finds a run by id, by unique prefix, or as the `latest` run that `is_wanted` accepts. In the common folder, also
/// searches the runs of all participants.
fn find_matching_run(
    runs: &Path,
    id: &str,
    is_wanted: impl Fn(&RunSummary) -> bool,
) -> Result<PathBuf, RunError> {
    let missing = || RunError::NotFound { id: id.to_owned(), folder: runs.to_owned() };
    let folders =
        if participant_of_folder(runs).is_some() { vec![runs.to_owned()] } else { all_run_folders(runs) };
    let mut list: Vec<(PathBuf, RunSummary)> = Vec::new();
    for folder in folders {
        list.extend(list_runs(&folder)?.into_iter().map(|run| (folder.join(&run.id), run)));
    }
    // The sort is stable: for equal times, the run in the common folder comes first.
    list.sort_by(|(_, one), (_, other)| other.played.cmp(&one.played));
    if id == "latest" {
        if list.is_empty() {
            return Err(RunError::NoRuns { folder: runs.to_owned() });
        }
        if list.iter().all(|(_, run)| run.ended.is_some() && !is_wanted(run)) {
            return Err(RunError::AllRunsEnded { folder: runs.to_owned() });
        }
        let newest = list.into_iter().find(|(_, run)| run.problem.is_none() && is_wanted(run));
        return newest.map(|(folder, _)| folder).ok_or_else(missing);
    }
    if let Some((folder, _)) = list.iter().find(|(_, run)| !id.is_empty() && run.id == id) {
        return Ok(folder.clone());
    }
    let mut fitting = list.iter().filter(|(_, run)| id.len() >= 2 && run.id.starts_with(id));
    match (fitting.next(), fitting.next()) {
        (Some((folder, _)), None) => Ok(folder.clone()),
        (Some(_), Some(_)) => Err(RunError::InvalidRequest(format!(
            "several run ids begin with {id}; enter more characters of the id"
        ))),
        _ => Err(missing()),
    }
}

/// Deletes a run folder.
///
/// # Errors
/// The run is in use, or the folder cannot be removed.
pub fn delete_run(runs: &Path, id: &str) -> Result<(), RunError> {
    let folder = find_run(runs, id)?;
    let lock = lock_run(&folder, id)?;
    drop(lock);
    std::fs::remove_dir_all(&folder).map_err(RunError::io(&folder))
}

/// Returns the earlier runs of a participant in all related folders. If there is no label, returns the unlabeled runs
/// in this folder.
pub fn earlier_runs(runs: &Path, participant: Option<&str>) -> Vec<EarlierRun> {
    let folders = if participant.is_some() { all_run_folders(runs) } else { vec![runs.to_owned()] };
    let entries = folders.iter().flat_map(|folder| std::fs::read_dir(folder).into_iter().flatten().flatten());
    let whole = entries.map(|entry| entry.path()).filter(|folder| !is_staging_folder(folder));
    let manifests = whole.filter_map(|folder| ManifestCheck::read(&folder).ok());
    let manifests = manifests.map(|derived| derived.manifest);
    let participant_manifests = manifests.filter(|manifest| manifest.participant.as_deref() == participant);
    let mut earlier: Vec<EarlierRun> = participant_manifests
        .map(|manifest| EarlierRun {
            run: manifest.id,
            mode: manifest.mode,
            seed: manifest.seed,
            scenario: manifest.scenario,
            created: manifest.created,
        })
        .collect();
    earlier.sort_by(|one, other| one.created.cmp(&other.created).then_with(|| one.run.cmp(&other.run)));
    earlier
}
