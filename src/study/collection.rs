//! Finds the runs of all machines of a study in folders and archives, and returns each run once in its latest state.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::assignment::Assignment;
use crate::definition::shorten_digest;
use crate::visit_log::{VISITS_FILE, VisitEvent, VisitLine, read_visits};
use novamind_record::clock::parse_nanoseconds;
use novamind_record::error::RunError;
use novamind_record::folder::manifest::Manifest;
use novamind_record::trajectory::Trajectory;
use novamind_session::{LabPublicKey, import_run, is_archive_name, read_afterwards};

/// Maximum depth of the search for runs.
const MAX_FOLDER_DEPTH: usize = 12;

/// A note to the experimenter about a collection.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum CollectNote {
    /// A run or archive that cannot be read.
    Unreadable {
        /// Path of the run or archive.
        path: PathBuf,
        /// Reason why the run or archive cannot be read.
        problem: String,
    },
    /// An earlier state or a copy of a run, which is not used.
    Superseded {
        /// ID of the run.
        run: String,
        /// Path of the earlier state or copy.
        path: PathBuf,
        /// Path of the state that is used.
        by: PathBuf,
    },
    /// Two records of one run, neither of which continues the other. Both records are stored in a separate folder and
    /// excluded from the tables.
    Conflict {
        /// ID of the run.
        run: String,
        /// Paths of the records.
        paths: Vec<PathBuf>,
        /// Number of the first line in which the records differ, from 1.
        line: usize,
    },
    /// Several sessions of one study that have the same label: two participants used the label, or one
    /// participant played twice.
    SharedLabel {
        /// Label of the sessions.
        label: String,
        /// IDs of the runs.
        runs: Vec<String>,
    },
    /// A label of the assignment that has no session.
    Missing {
        /// Label of the participant.
        label: String,
        /// The last visit of the label on any machine.
        last_visit: Option<VisitEvent>,
    },
    /// A label that has sessions only with a different version of the protocol.
    OtherProtocol {
        /// Label of the participant.
        label: String,
        /// ID of the run.
        run: String,
        /// Digest of the run's protocol.
        digest: String,
    },
    /// A run whose label in the tables differs from its record.
    Relabelled {
        /// ID of the run.
        run: String,
        /// Label in the first line of the run.
        from: String,
        /// Label in the tables.
        to: String,
    },
    /// An archive that is not signed by the lab whose public key is in the folder of the study.
    NotSigned {
        /// Path of the archive.
        path: PathBuf,
        /// Fingerprint of the key that signed the archive; `None` if the archive is not signed.
        by: Option<String>,
    },
    /// A line of the mapping file whose run was not found.
    UnknownRun {
        /// ID of the run in the mapping file.
        run: String,
    },
    /// A run whose re-simulation does not match its record.
    Unverified {
        /// ID of the run.
        run: String,
        /// Reason why the run was not collected.
        problem: String,
    },
}

impl CollectNote {
    /// Returns whether the experimenter has to act on the note.
    pub fn needs_attention(&self) -> bool {
        !matches!(self, CollectNote::Superseded { .. } | CollectNote::Relabelled { .. })
    }
}

impl fmt::Display for CollectNote {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CollectNote::Unreadable { path, problem } => {
                write!(out, "not collected: {}: {problem}", path.display())
            }
            CollectNote::Superseded { run, path, by } => {
                write!(out, "run {run}: {} is an earlier state or a copy of {}", path.display(), by.display())
            }
            CollectNote::Conflict { run, paths, line } => {
                let paths: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
                write!(
                    out,
                    "conflict: run {run} has two records that differ from line {line}: {}; both are in the folder conflicts and not in the tables",
                    paths.join(" and ")
                )
            }
            CollectNote::NotSigned { path, by: None } => {
                write!(out, "not signed: {}", path.display())
            }
            CollectNote::NotSigned { path, by: Some(key) } => {
                write!(out, "not signed by the lab: {} is signed with the key {key}", path.display())
            }
            CollectNote::SharedLabel { label, runs } => {
                write!(out, "label {label} has {} sessions: runs {}", runs.len(), runs.join(", "))
            }
            CollectNote::Missing { label, last_visit: None } => write!(out, "label {label} has no session"),
            CollectNote::Missing { label, last_visit: Some(event) } => {
                let event = serde_json::to_value(event).unwrap_or_default();
                let word = event.as_str().map_or_else(|| event.to_string(), |word| word.replace('_', " "));
                write!(out, "label {label} has no session; last visit: {word}")
            }
            CollectNote::OtherProtocol { label, run, digest } => write!(
                out,
                "label {label} has no session under this protocol; run {run} of the label has the protocol digest {}",
                shorten_digest(digest)
            ),
            CollectNote::Relabelled { run, from, to } => {
                write!(out, "run {run}: label {from:?} becomes {to:?}")
            }
            CollectNote::UnknownRun { run } => {
                write!(out, "the mapping names run {run}, which was not found")
            }
            CollectNote::Unverified { run, problem } => write!(out, "run {run} is not collected: {problem}"),
        }
    }
}

/// A record of a run in one folder or archive.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundRun {
    /// Manifest of the run.
    pub manifest: Manifest,
    /// Folder that contains the files of the run.
    pub folder: PathBuf,
    /// Folder or archive in which the record was found.
    pub source: PathBuf,
    /// Hashes of all lines of the record, including the lines of `afterwards.jsonl`.
    hashes: Vec<String>,
}

impl FoundRun {
    fn read(folder: &Path, source: &Path) -> Result<FoundRun, RunError> {
        let manifest = Manifest::read(folder)?;
        let trajectory = Trajectory::read(&folder.join("trajectory.jsonl"))?;
        let after = read_afterwards(folder, &trajectory)?;
        let lines = trajectory.lines.iter().chain(&after.lines);
        let hashes = lines.map(|line| line.hash.clone()).collect();
        Ok(FoundRun { manifest, folder: folder.to_owned(), source: source.to_owned(), hashes })
    }

    /// Returns whether this record is an earlier state or a copy of `other`.
    fn is_prefix_of(&self, other: &FoundRun) -> bool {
        other.hashes.starts_with(&self.hashes)
    }
}

/// The result of a search for runs.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CollectedRuns {
    /// Runs in their latest state, sorted by creation time.
    pub runs: Vec<FoundRun>,
    /// Records that contradict each other, by run.
    pub conflicts: BTreeMap<String, Vec<FoundRun>>,
    /// Notes to the experimenter about the search.
    pub notes: Vec<CollectNote>,
    /// Visits on all machines, sorted by time. A line that occurs in several copies of a list is included once.
    pub visits: Vec<FoundVisit>,
}

/// A line of a list of visits, with the folder of runs that contains the list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FoundVisit {
    /// The line of the list of visits.
    pub line: VisitLine,
    /// The folder of runs that contains the list.
    pub folder: PathBuf,
}

/// Finds all runs and archives below the given paths. Archives are unpacked into `workshop`. The folder
/// `without` is not searched. If `lab` is given, the result has a note for each archive that the lab has not
/// signed.
pub fn collect_runs(
    sources: &[PathBuf],
    workshop: &Path,
    without: &Path,
    lab: Option<&LabPublicKey>,
) -> CollectedRuns {
    let mut gathered = CollectedRuns::default();
    let without = without.canonicalize().unwrap_or_else(|_| without.to_owned());
    let mut found_there = FoundPaths::default();
    for source in sources {
        let found = scan_folder(source, &without, MAX_FOLDER_DEPTH, &mut found_there);
        gathered.notes.extend(
            found
                .err()
                .map(|error| CollectNote::Unreadable { path: source.clone(), problem: error.to_string() }),
        );
    }
    let FoundPaths { folders, archives, visits } = found_there;
    gathered.visits = visits.into_iter().map(|(line, folder)| FoundVisit { line, folder }).collect();
    gathered.visits.sort_by_cached_key(|visit| parse_nanoseconds(&visit.line.at));
    let mut by_run: BTreeMap<String, Vec<FoundRun>> = BTreeMap::new();
    let mut take = |found: Result<FoundRun, RunError>, source: &Path| match found {
        Ok(found) => by_run.entry(found.manifest.id.clone()).or_default().push(found),
        Err(error) => gathered
            .notes
            .push(CollectNote::Unreadable { path: source.to_owned(), problem: error.to_string() }),
    };
    let mut unsigned = Vec::new();
    for folder in &folders {
        take(FoundRun::read(folder, folder), folder);
    }
    for (number, archive) in archives.iter().enumerate() {
        let unpacked = unpack_archive(archive, &workshop.join(number.to_string()));
        if let (Some(lab), Ok((_, signer))) = (lab, &unpacked)
            && signer.as_ref() != Some(lab)
        {
            let by = signer.as_ref().map(LabPublicKey::fingerprint);
            unsigned.push(CollectNote::NotSigned { path: archive.clone(), by });
        }
        take(unpacked.map(|(run, _)| run), archive);
    }
    gathered.notes.append(&mut unsigned);
    for (run, records) in by_run {
        merge_records(run, records, &mut gathered);
    }
    gathered.runs.sort_by(|one, other| {
        (&one.manifest.created, &one.manifest.id).cmp(&(&other.manifest.created, &other.manifest.id))
    });
    gathered.notes.extend(shared_labels(&gathered.runs));
    gathered
}

/// Returns a note for each label of an assignment that has no session. `labels` contains the labels that have
/// a session. `others` maps a label to its run with a different protocol and to the digest of that protocol.
pub fn missing_participants(
    assignment: &Assignment,
    labels: &BTreeSet<String>,
    others: &BTreeMap<String, (String, String)>,
    visits: &[FoundVisit],
) -> Vec<CollectNote> {
    let last_visits: BTreeMap<&String, VisitEvent> =
        visits.iter().map(|visit| (&visit.line.label, visit.line.event)).collect();
    let missing = assignment.rows.iter().filter(|place| !labels.contains(&place.label));
    let note = |label: &String| match others.get(label).cloned() {
        Some((run, digest)) => CollectNote::OtherProtocol { label: label.clone(), run, digest },
        None => CollectNote::Missing { label: label.clone(), last_visit: last_visits.get(label).copied() },
    };
    missing.map(|place| note(&place.label)).collect()
}

fn unpack_archive(archive: &Path, folder: &Path) -> Result<(FoundRun, Option<LabPublicKey>), RunError> {
    std::fs::create_dir_all(folder).map_err(RunError::io(folder))?;
    let (seal, signer, _) = import_run(folder, archive, None)?;
    Ok((FoundRun::read(&folder.join(&seal.run), archive)?, signer))
}

/// Runs, archives and visits that were found below the searched paths.
#[derive(Default)]
struct FoundPaths {
    /// Folders of the runs.
    folders: BTreeSet<PathBuf>,
    archives: BTreeSet<PathBuf>,
    /// Lines of lists of visits, each with the folder of the first list that contains the line.
    visits: BTreeMap<VisitLine, PathBuf>,
}

/// Searches a path for run folders, archives and lists of visits. Does not follow links.
fn scan_folder(path: &Path, without: &Path, depth: usize, found: &mut FoundPaths) -> std::io::Result<()> {
    let path = path.canonicalize()?;
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    if path.is_file() {
        if is_archive_name(&name) {
            found.archives.insert(path);
        } else if name == VISITS_FILE {
            let folder = path.parent().unwrap_or(&path).to_owned();
            for line in read_visits(&path) {
                found.visits.entry(line).or_insert_with(|| folder.clone());
            }
        }
        return Ok(());
    }
    if path.starts_with(without) || depth == 0 {
        return Ok(());
    }
    if path.join("trajectory.jsonl").is_file() || path.join("run.toml").is_file() {
        found.folders.insert(path);
        return Ok(());
    }
    for entry in std::fs::read_dir(&path)? {
        let entry = entry?;
        let name = entry.file_name();
        // `.local` is searched although it is hidden, because it contains the default folder of runs.
        let is_hidden = name.to_string_lossy().starts_with('.') && name != ".local";
        if !is_hidden && !entry.file_type()?.is_symlink() {
            scan_folder(&entry.path(), without, depth - 1, found)?;
        }
    }
    Ok(())
}

/// Keeps the latest record of a run if it continues all other records of the run. Otherwise adds all records
/// as a conflict.
fn merge_records(run: String, mut records: Vec<FoundRun>, gathered: &mut CollectedRuns) {
    records.sort_by(|one, other| (other.hashes.len(), &one.source).cmp(&(one.hashes.len(), &other.source)));
    let mut separate_records: Vec<FoundRun> = Vec::new();
    for record in records {
        match separate_records.iter().find(|later| record.is_prefix_of(later)) {
            Some(later) => gathered.notes.push(CollectNote::Superseded {
                run: run.clone(),
                path: record.source,
                by: later.source.clone(),
            }),
            None => separate_records.push(record),
        }
    }
    if separate_records.len() == 1 {
        gathered.runs.append(&mut separate_records);
        return;
    }
    let fork = separate_records[0]
        .hashes
        .iter()
        .zip(&separate_records[1].hashes)
        .take_while(|(one, other)| one == other)
        .count();
    let paths = separate_records.iter().map(|record| record.source.clone()).collect();
    gathered.notes.push(CollectNote::Conflict { run: run.clone(), paths, line: fork + 1 });
    gathered.conflicts.insert(run, separate_records);
}

/// Returns a note for each label that has several sessions of one study. Practice runs do not count.
fn shared_labels(runs: &[FoundRun]) -> Vec<CollectNote> {
    let mut by_label: BTreeMap<(&str, &str), Vec<String>> = BTreeMap::new();
    for run in runs {
        let (Some(label), stamp) = (&run.manifest.participant, &run.manifest.study) else { continue };
        if stamp.as_ref().is_some_and(|stamp| stamp.practice) {
            continue;
        }
        let study = stamp.as_ref().map_or("", |stamp| stamp.digest.as_str());
        by_label.entry((study, label)).or_default().push(run.manifest.id.clone());
    }
    let shared = by_label.into_iter().filter(|(_, runs)| runs.len() > 1);
    shared.map(|((_, label), runs)| CollectNote::SharedLabel { label: label.to_owned(), runs }).collect()
}
