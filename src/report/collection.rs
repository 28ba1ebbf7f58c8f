//! Collects a study: verifies the runs of all machines, stores each run once in a folder, and returns the tables of all
//! runs.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::Logbook;
use super::tables::StudyTables;
use novamind_record::error::RunError;
use novamind_session::archive::TemporaryFolder;
use novamind_session::{Export, LabKey, LabPublicKey, Seal, SealKey};
use novamind_study::{
    CollectNote, CollectedRuns, FoundRun, FoundVisit, Study, VisitSummary, collect_runs, missing_participants,
};

/// Inputs and options of a collection.
#[derive(Clone, Copy)]
pub struct CollectOptions<'a> {
    /// Archives, and folders of runs copied from the machines.
    pub sources: &'a [PathBuf],
    /// Folder to which the archives of the collected runs are written.
    pub output_folder: &'a Path,
    /// Study to collect; `None` to collect runs without a study definition.
    pub study: Option<&'a Study>,
    /// Labels that replace the labels in the records, by run ID.
    pub labels: &'a BTreeMap<String, String>,
    /// Keys of the lab that collects the study.
    pub keys: LabKeys<'a>,
}

/// Keys of the lab that collects a study.
#[derive(Clone, Copy, Default)]
pub struct LabKeys<'a> {
    /// Key that signs the written archives.
    pub signing_key: Option<&'a LabKey>,
    /// Key that verifies the signatures of the source archives.
    pub verification_key: Option<&'a LabPublicKey>,
    /// Key that seals the snapshots of the runs.
    pub sealing_key: Option<&'a SealKey>,
}

impl LabKeys<'_> {
    fn sealing_key_or_default(&self) -> SealKey {
        self.sealing_key.cloned().unwrap_or_default()
    }
}

/// The result of a collection.
#[derive(Debug, Clone)]
pub struct CollectionResult {
    /// Tables of all collected runs.
    pub tables: StudyTables,
    /// Participant's label, seal and path of the archive, for each collected run.
    pub runs: Vec<(Option<String>, Seal, PathBuf)>,
    /// Problems for the experimenter to check, such as unreadable files.
    pub notes: Vec<CollectNote>,
    /// Number of participants who visited the study, for each outcome.
    pub visits: VisitSummary,
}

/// Collects a study: replays every run, verifies it, and seals it in an archive. `progress` is called with the number
/// of finished runs and the total number of runs. Replaces archives of earlier collections. No data is lost, because
/// trajectories only grow.
///
/// # Errors
/// Returns an error if the output folder cannot be written.
pub fn collect(
    what: CollectOptions<'_>,
    progress: &mut dyn FnMut(usize, usize),
) -> Result<CollectionResult, RunError> {
    let CollectOptions { sources, output_folder: out, study, labels, keys } = what;
    std::fs::create_dir_all(out).map_err(|error| RunError::Io { path: out.to_owned(), error })?;
    // Unpack archives into a hidden folder that is deleted at the end.
    let temporary_folder = TemporaryFolder::create_in(out)?;
    let CollectedRuns { runs, conflicts, mut notes, mut visits } =
        collect_runs(sources, temporary_folder.path(), out, keys.verification_key);
    relabel_visits(&mut visits, &runs, labels);
    let mut collected = CollectionResult {
        tables: StudyTables::default(),
        runs: Vec::new(),
        notes: Vec::new(),
        visits: VisitSummary::default(),
    };
    let labels_recorded: BTreeSet<&str> =
        runs.iter().filter_map(|run| label_of(run, labels)).map(String::as_str).collect();
    let of_study = |visit: &&FoundVisit| study.is_none_or(|study| visit.line.study == study.digest);
    let study_visits = visits.iter().filter(of_study).map(|visit| &visit.line);
    collected.visits = VisitSummary::from_lines(study_visits, &labels_recorded);
    collected.tables.add_visits(&visits);
    let mut present: BTreeSet<String> = BTreeSet::new();
    let mut others: BTreeMap<String, (String, String)> = BTreeMap::new();
    for (done, run) in runs.iter().enumerate() {
        progress(done, runs.len());
        let id = &run.manifest.id;
        let label = label_of(run, labels).cloned();
        if let Some(to) = labels.get(id) {
            let from = run.manifest.participant.clone().unwrap_or_default();
            notes.push(CollectNote::Relabelled { run: id.clone(), from, to: to.clone() });
        }
        let other = run
            .manifest
            .study
            .as_ref()
            .filter(|stamp| study.is_some_and(|study| study.digest != stamp.digest));
        if let (Some(stamp), Some(label)) = (other, &label) {
            others.insert(label.clone(), (id.clone(), stamp.digest.clone()));
        }
        match archive_run(run, out, label.clone(), keys, &mut collected.tables) {
            Ok((seal, archive)) => {
                let is_session = run.manifest.study.as_ref().is_none_or(|stamp| !stamp.practice);
                present.extend(label.clone().filter(|_| is_session && other.is_none()));
                collected.runs.push((label, seal, archive));
            }
            Err(error) => {
                let problem = error.to_string();
                collected.tables.add_unreadable_run(id, &problem);
                notes.push(CollectNote::Unverified { run: id.clone(), problem });
            }
        }
    }
    archive_conflicts(&conflicts, out, keys, &mut notes)?;
    for id in conflicts.keys() {
        collected.tables.add_unreadable_run(
            id,
            "two records contradict each other; both are stored in the folder conflicts",
        );
    }
    let known: BTreeSet<&String> = runs.iter().map(|run| &run.manifest.id).chain(conflicts.keys()).collect();
    let unknown = labels.keys().filter(|run| !known.contains(run));
    notes.extend(unknown.map(|run| CollectNote::UnknownRun { run: run.clone() }));
    if let Some(assignment) = study.and_then(|study| study.assignment.as_ref()) {
        notes.extend(missing_participants(assignment, &present, &others, &visits));
    }
    collected.notes = notes;
    Ok(collected)
}

/// Returns the label of a run: the new label, or the recorded one.
fn label_of<'a>(run: &'a FoundRun, labels: &'a BTreeMap<String, String>) -> Option<&'a String> {
    labels.get(&run.manifest.id).or(run.manifest.participant.as_ref())
}

/// Gives the visits of a label the new label of its runs, so that the tables of visits and of runs agree. If only some
/// runs of the label have a new label, its visits keep the typed label, because the visits do not name runs.
fn relabel_visits(visits: &mut [FoundVisit], runs: &[FoundRun], labels: &BTreeMap<String, String>) {
    let mut new_labels: BTreeMap<&String, BTreeSet<&String>> = BTreeMap::new();
    for run in runs {
        if let (Some(old), Some(new)) = (&run.manifest.participant, label_of(run, labels)) {
            new_labels.entry(old).or_default().insert(new);
        }
    }
    for visit in visits {
        let new = new_labels.get(&visit.line.label).filter(|new| new.len() == 1);
        if let Some(new) = new.and_then(BTreeSet::first) {
            visit.line.label.clone_from(new);
        }
    }
}

fn archive_run(
    run: &FoundRun,
    out: &Path,
    label: Option<String>,
    keys: LabKeys<'_>,
    tables: &mut StudyTables,
) -> Result<(Seal, PathBuf), RunError> {
    let export = Export::prepare(&run.folder, out, &keys.sealing_key_or_default())?;
    let archive = out.join(format!("{}.tar.gz", run.manifest.id));
    let seal = export.write(&archive, true, keys.signing_key)?;
    let mut book = Logbook::new(export.session(), &export.trajectory().lines, export.afterwards_lines());
    book.participant = label;
    tables.add(&book, &export.trajectory().lines, export.afterwards_lines());
    Ok((seal, archive))
}

fn archive_conflicts(
    conflicts: &BTreeMap<String, Vec<FoundRun>>,
    out: &Path,
    keys: LabKeys<'_>,
    notes: &mut Vec<CollectNote>,
) -> Result<(), RunError> {
    if conflicts.is_empty() {
        return Ok(());
    }
    let folder = out.join("conflicts");
    std::fs::create_dir_all(&folder).map_err(|error| RunError::Io { path: folder.clone(), error })?;
    for (run, records) in conflicts {
        for (number, record) in records.iter().enumerate() {
            let archive = folder.join(format!("{run}-{}.tar.gz", number + 1));
            let kept = Export::prepare(&record.folder, &folder, &keys.sealing_key_or_default())
                .and_then(|export| export.write(&archive, true, keys.signing_key));
            notes.extend(kept.err().map(|error| CollectNote::Unreadable {
                path: record.source.clone(),
                problem: error.to_string(),
            }));
        }
    }
    Ok(())
}
