//! A study collected: the runs of all machines in one folder, each once and verified by simulation, with their tables.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::Logbook;
use super::tables::StudyTables;
use novamind_record::error::RunError;
use novamind_session::archive::Workshop;
use novamind_session::{Export, LabKey, LabPublicKey, Seal, SealKey};
use novamind_study::{
    CollectNote, FoundRun, FoundVisit, Gathered, Study, VisitSummary, gather, missing_places,
};

/// What is collected, and how.
#[derive(Clone, Copy)]
pub struct Collecting<'a> {
    /// Folders of machines, and archives.
    pub sources: &'a [PathBuf],
    /// Where everything goes.
    pub out: &'a Path,
    /// The study whose assignment says who should be there.
    pub study: Option<&'a Study>,
    /// New labels by run.
    pub labels: &'a BTreeMap<String, String>,
    /// The keys of the lab.
    pub keys: LabKeys<'a>,
}

/// The keys of the lab that collects.
#[derive(Clone, Copy, Default)]
pub struct LabKeys<'a> {
    /// What signs the archives that are written.
    pub own: Option<&'a LabKey>,
    /// Who should have signed the archives that are read.
    pub public: Option<&'a LabPublicKey>,
    /// What seals the snapshots of the runs besides the runs.
    pub seal: Option<&'a SealKey>,
}

impl LabKeys<'_> {
    fn seal_key(&self) -> SealKey {
        self.seal.cloned().unwrap_or_default()
    }
}

/// What came of it.
#[derive(Debug, Clone)]
pub struct Collected {
    /// The tables of all runs that were taken.
    pub tables: StudyTables,
    /// Runs that were taken: label, seal, where the archive lies.
    pub runs: Vec<(Option<String>, Seal, PathBuf)>,
    /// What should be known.
    pub notes: Vec<CollectNote>,
    /// How many came, and what became of them.
    pub visits: VisitSummary,
}

/// Collects a study. Every run is simulated again and sealed into an archive; `progress` is told how many of how many are
/// done. Archives that are there from before make room: trajectories only grow.
///
/// # Errors
/// The folder cannot be written.
pub fn collect(what: Collecting<'_>, progress: &mut dyn FnMut(usize, usize)) -> Result<Collected, RunError> {
    let Collecting { sources, out, study, labels, keys } = what;
    std::fs::create_dir_all(out).map_err(|error| RunError::Io { path: out.to_owned(), error })?;
    // What archives are unpacked into stays hidden, and is gone afterwards.
    let workshop = Workshop::within(out)?;
    let Gathered { runs, conflicts, mut notes, visits } = gather(sources, workshop.path(), out, keys.public);
    let mut collected = Collected {
        tables: StudyTables::default(),
        runs: Vec::new(),
        notes: Vec::new(),
        visits: VisitSummary::default(),
    };
    let labels_recorded: BTreeSet<&str> =
        runs.iter().filter_map(|run| run.manifest.participant.as_deref()).collect();
    let of_study = |visit: &&FoundVisit| study.is_none_or(|study| visit.line.study == study.digest);
    let own_visits = visits.iter().filter(of_study).map(|visit| &visit.line);
    collected.visits = VisitSummary::of(own_visits, &labels_recorded);
    collected.tables.add_visits(&visits);
    let mut present: BTreeSet<String> = BTreeSet::new();
    let mut others: BTreeMap<String, (String, String)> = BTreeMap::new();
    for (done, run) in runs.iter().enumerate() {
        progress(done, runs.len());
        let id = &run.manifest.id;
        let label = labels.get(id).or(run.manifest.participant.as_ref()).cloned();
        if let Some(to) = labels.get(id) {
            let from = run.manifest.participant.clone().unwrap_or_default();
            notes.push(CollectNote::Relabelled { run: id.clone(), from, to: to.clone() });
        }
        let other =
            run.manifest.study.as_ref().filter(|stamp| study.is_some_and(|own| own.digest != stamp.digest));
        if let (Some(stamp), Some(label)) = (other, &label) {
            others.insert(label.clone(), (id.clone(), stamp.digest.clone()));
        }
        match take(run, out, label.clone(), keys, &mut collected.tables) {
            Ok((seal, archive)) => {
                let is_session = run.manifest.study.as_ref().is_none_or(|stamp| !stamp.practice);
                present.extend(label.clone().filter(|_| is_session && other.is_none()));
                collected.runs.push((label, seal, archive));
            }
            Err(error) => {
                let problem = error.to_string();
                collected.tables.add_unread(id, &problem);
                notes.push(CollectNote::Unverified { run: id.clone(), problem });
            }
        }
    }
    keep_apart(&conflicts, out, keys, &mut notes)?;
    for id in conflicts.keys() {
        collected.tables.add_unread(id, "two records contradict each other; both are kept in conflicts");
    }
    let known: BTreeSet<&String> = runs.iter().map(|run| &run.manifest.id).chain(conflicts.keys()).collect();
    let unknown = labels.keys().filter(|run| !known.contains(run));
    notes.extend(unknown.map(|run| CollectNote::UnknownRun { run: run.clone() }));
    if let Some(assignment) = study.and_then(|study| study.assignment.as_ref()) {
        notes.extend(missing_places(assignment, &present, &others, &visits));
    }
    collected.notes = notes;
    Ok(collected)
}

/// Simulates a run again, seals it, and adds it to the tables.
fn take(
    run: &FoundRun,
    out: &Path,
    label: Option<String>,
    keys: LabKeys<'_>,
    tables: &mut StudyTables,
) -> Result<(Seal, PathBuf), RunError> {
    let export = Export::prepare(&run.folder, out, &keys.seal_key())?;
    let archive = out.join(format!("{}.tar.gz", run.manifest.id));
    let seal = export.write(&archive, true, keys.own)?;
    let mut book = Logbook::of(export.session(), &export.trajectory().lines, export.afterwards());
    book.participant = label;
    tables.add(&book, &export.trajectory().lines, export.afterwards());
    Ok((seal, archive))
}

/// Seals records that contradict each other, each for itself.
fn keep_apart(
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
            let kept = Export::prepare(&record.folder, &folder, &keys.seal_key())
                .and_then(|own| own.write(&archive, true, keys.own));
            notes.extend(kept.err().map(|error| CollectNote::Unreadable {
                path: record.source.clone(),
                problem: error.to_string(),
            }));
        }
    }
    Ok(())
}
