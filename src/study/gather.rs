//! The runs of all machines of a study: found in folders and archives, each once, in its latest state.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::assignment::Assignment;
use crate::definition::shortened;
use crate::visit_log::{VISITS, VisitEvent, VisitLine, visits};
use novamind_record::clock::nanoseconds;
use novamind_record::error::RunError;
use novamind_record::folder::manifest::Manifest;
use novamind_record::trajectory::Trajectory;
use novamind_session::{LabPublicKey, import_run, is_archive_name, lines_afterwards};

/// How deep folders are searched.
const DEEPEST: usize = 12;

/// Something that whoever collects a study should know.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum CollectNote {
    /// A run or archive that cannot be read.
    Unreadable {
        /// Where it lies.
        path: PathBuf,
        /// Why.
        problem: String,
    },
    /// An earlier state of a run, or the same once more: the latest is taken.
    Superseded {
        /// Run.
        run: String,
        /// Where the earlier state lies.
        path: PathBuf,
        /// Where the later one lies.
        by: PathBuf,
    },
    /// Two records of one name of which neither goes on from the other: both are kept apart, neither is in the tables.
    Conflict {
        /// Run.
        run: String,
        /// Where they lie.
        paths: Vec<PathBuf>,
        /// First line in which they differ, from 1.
        line: usize,
    },
    /// Sessions of one study under one label: two people, or one who played twice.
    SharedLabel {
        /// Label.
        label: String,
        /// Runs.
        runs: Vec<String>,
    },
    /// A place of the assignment without a session.
    Missing {
        /// Label.
        label: String,
        /// What the machines say of the label last.
        last_visit: Option<VisitEvent>,
    },
    /// A session of the label exists, under another version of the protocol.
    OtherProtocol {
        /// Label.
        label: String,
        /// Run.
        run: String,
        /// Digest of the protocol of the run.
        digest: String,
    },
    /// A run was given another label.
    Relabelled {
        /// Run.
        run: String,
        /// Label in its first line.
        from: String,
        /// Label in the tables.
        to: String,
    },
    /// An archive that the lab whose public key lies in the folder of the study has not signed.
    NotSigned {
        /// Where it lies.
        path: PathBuf,
        /// Fingerprint of the key that signed it; none where none did.
        by: Option<String>,
    },
    /// A line of the mapping file that names no run.
    UnknownRun {
        /// Run.
        run: String,
    },
    /// A run that could not be simulated again as its lines say.
    Unverified {
        /// Run.
        run: String,
        /// Why.
        problem: String,
    },
}

impl CollectNote {
    /// Whether somebody has to look into it.
    pub fn needs_attention(&self) -> bool {
        !matches!(self, CollectNote::Superseded { .. } | CollectNote::Relabelled { .. })
    }
}

impl fmt::Display for CollectNote {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CollectNote::Unreadable { path, problem } => {
                write!(out, "not taken: {}: {problem}", path.display())
            }
            CollectNote::Superseded { run, path, by } => {
                write!(
                    out,
                    "run {run}: {} is an earlier state of {}, or the same",
                    path.display(),
                    by.display()
                )
            }
            CollectNote::Conflict { run, paths, line } => {
                let paths: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
                write!(
                    out,
                    "conflict: run {run} has two records that differ from line {line} on: {}; both are kept in conflicts, \
                     neither is in the tables",
                    paths.join(" and ")
                )
            }
            CollectNote::NotSigned { path, by: None } => {
                write!(out, "not signed: {}", path.display())
            }
            CollectNote::NotSigned { path, by: Some(key) } => {
                write!(
                    out,
                    "not signed by the lab: {} carries the signature of the key {key}",
                    path.display()
                )
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
                "label {label} has no session under this protocol; its run {run} has the protocol digest {}",
                shortened(digest)
            ),
            CollectNote::Relabelled { run, from, to } => {
                write!(out, "run {run}: label {from:?} becomes {to:?}")
            }
            CollectNote::UnknownRun { run } => {
                write!(out, "the mapping names run {run}, which was not found")
            }
            CollectNote::Unverified { run, problem } => write!(out, "run {run} is not taken: {problem}"),
        }
    }
}

/// A record of a run in one place.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundRun {
    /// What it is.
    pub manifest: Manifest,
    /// Folder of its files.
    pub folder: PathBuf,
    /// Where it was found: that folder, or an archive.
    pub source: PathBuf,
    /// Hashes of its lines, those of what was done after its end with them.
    hashes: Vec<String>,
}

impl FoundRun {
    fn read(folder: &Path, source: &Path) -> Result<FoundRun, RunError> {
        let manifest = Manifest::read(folder)?;
        let trajectory = Trajectory::read(&folder.join("trajectory.jsonl"))?;
        let after = lines_afterwards(folder, &trajectory)?;
        let lines = trajectory.lines.iter().chain(&after.lines);
        let hashes = lines.map(|line| line.hash.clone()).collect();
        Ok(FoundRun { manifest, folder: folder.to_owned(), source: source.to_owned(), hashes })
    }

    /// Whether it is this record or an earlier state of it.
    fn is_beginning_of(&self, other: &FoundRun) -> bool {
        other.hashes.starts_with(&self.hashes)
    }
}

/// What was found.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Gathered {
    /// Runs in their latest state, by creation.
    pub runs: Vec<FoundRun>,
    /// Records that contradict each other, by run.
    pub conflicts: BTreeMap<String, Vec<FoundRun>>,
    /// What should be known.
    pub notes: Vec<CollectNote>,
    /// What machines say of who came, by moment; a line that stands in several copies of a list once.
    pub visits: Vec<FoundVisit>,
}

/// A line of a list of visits, and the folder of runs in which the list lies.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FoundVisit {
    /// The line.
    pub line: VisitLine,
    /// The folder of runs.
    pub folder: PathBuf,
}

/// Finds all runs below some folders and in archives there. Archives are unpacked into `workshop`; `without` is not searched.
/// Where there is a key of a lab, archives that it has not signed are told.
pub fn gather(sources: &[PathBuf], workshop: &Path, without: &Path, lab: Option<&LabPublicKey>) -> Gathered {
    let mut gathered = Gathered::default();
    let without = without.canonicalize().unwrap_or_else(|_| without.to_owned());
    let mut found_there = Found::default();
    for source in sources {
        let found = look(source, &without, DEEPEST, &mut found_there);
        gathered.notes.extend(
            found
                .err()
                .map(|error| CollectNote::Unreadable { path: source.clone(), problem: error.to_string() }),
        );
    }
    let Found { folders, archives, visits } = found_there;
    gathered.visits = visits.into_iter().map(|(line, folder)| FoundVisit { line, folder }).collect();
    gathered.visits.sort_by_cached_key(|visit| nanoseconds(&visit.line.at));
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
        let unpacked = unpacked(archive, &workshop.join(number.to_string()));
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
        settle(run, records, &mut gathered);
    }
    gathered.runs.sort_by(|one, other| {
        (&one.manifest.created, &one.manifest.id).cmp(&(&other.manifest.created, &other.manifest.id))
    });
    gathered.notes.extend(shared_labels(&gathered.runs));
    gathered
}

/// Returns a note for each place of an assignment without a session. `labels` are those with a session, `others` the run
/// and its digest by label of runs under another protocol.
pub fn missing_places(
    assignment: &Assignment,
    labels: &BTreeSet<String>,
    others: &BTreeMap<String, (String, String)>,
    visits: &[FoundVisit],
) -> Vec<CollectNote> {
    let last_visits: BTreeMap<&String, VisitEvent> =
        visits.iter().map(|visit| (&visit.line.label, visit.line.event)).collect();
    let missing = assignment.places.iter().filter(|place| !labels.contains(&place.label));
    let note = |label: &String| match others.get(label).cloned() {
        Some((run, digest)) => CollectNote::OtherProtocol { label: label.clone(), run, digest },
        None => CollectNote::Missing { label: label.clone(), last_visit: last_visits.get(label).copied() },
    };
    missing.map(|place| note(&place.label)).collect()
}

fn unpacked(archive: &Path, folder: &Path) -> Result<(FoundRun, Option<LabPublicKey>), RunError> {
    std::fs::create_dir_all(folder).map_err(RunError::io(folder))?;
    let (seal, signer, _) = import_run(folder, archive, None)?;
    Ok((FoundRun::read(&folder.join(&seal.run), archive)?, signer))
}

/// What lies below some paths.
#[derive(Default)]
struct Found {
    /// Folders of runs.
    folders: BTreeSet<PathBuf>,
    archives: BTreeSet<PathBuf>,
    /// Lines of lists of visits, with the folder of the first list that has them.
    visits: BTreeMap<VisitLine, PathBuf>,
}

/// Folders of runs, archives and lists of visits below a path. Links are not followed.
fn look(path: &Path, without: &Path, depth: usize, found: &mut Found) -> std::io::Result<()> {
    let path = path.canonicalize()?;
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    if path.is_file() {
        if is_archive_name(&name) {
            found.archives.insert(path);
        } else if name == VISITS {
            let folder = path.parent().unwrap_or(&path).to_owned();
            for line in visits(&path) {
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
        // What the program keeps for a person lies below `.local` where nothing else is said.
        let is_hidden = name.to_string_lossy().starts_with('.') && name != ".local";
        if !is_hidden && !entry.file_type()?.is_symlink() {
            look(&entry.path(), without, depth - 1, found)?;
        }
    }
    Ok(())
}

/// Of several records of one run the latest, if all others are beginnings of it.
fn settle(run: String, mut records: Vec<FoundRun>, gathered: &mut Gathered) {
    records.sort_by(|one, other| (other.hashes.len(), &one.source).cmp(&(one.hashes.len(), &other.source)));
    let mut apart: Vec<FoundRun> = Vec::new();
    for record in records {
        match apart.iter().find(|later| record.is_beginning_of(later)) {
            Some(later) => gathered.notes.push(CollectNote::Superseded {
                run: run.clone(),
                path: record.source,
                by: later.source.clone(),
            }),
            None => apart.push(record),
        }
    }
    if apart.len() == 1 {
        gathered.runs.append(&mut apart);
        return;
    }
    let fork = apart[0].hashes.iter().zip(&apart[1].hashes).take_while(|(one, other)| one == other).count();
    let paths = apart.iter().map(|record| record.source.clone()).collect();
    gathered.notes.push(CollectNote::Conflict { run: run.clone(), paths, line: fork + 1 });
    gathered.conflicts.insert(run, apart);
}

/// Labels with several sessions of one study; practice is none.
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
