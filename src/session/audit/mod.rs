//! The audit of a study: what an honest session does not leave behind, with its line and its moment.
//!
//! A person with a shell can do anything to the files on a machine. What they do is found where something else
//! remembers otherwise: the chain of hashes, the simulation, a witness on another machine, the machine's list of opened
//! worlds, the assignment, the clock that nobody sets.

mod archives;
mod clock;
mod facts;
mod finding;
mod machine;
mod rehearsal;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Serialize;

pub use facts::RunFacts;
pub use finding::{AuditFinding, AuditKind};

use crate::session::error::RunError;
use crate::session::folder::derived::departures_of_file;
use crate::session::folder::manifest::Manifest;
use crate::session::play::afterwards::lines_afterwards;
use crate::session::resume::integrity::Integrity;
use crate::session::resume::verify::verify_sealed;
use crate::session::study::definition::Study;
use crate::session::study::visit_log::{VisitSummary, visits_of};
use crate::session::trajectory::record::{Activity, PresenceEvent};
use crate::session::trajectory::{Line, Record, Trajectory};
use crate::session::witness::{Finding, FindingKind, Told, compare, read_witness};
use machine::{MachineRecord, RunRecord};

/// What an audit of a study says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Audit {
    /// The runs of the study, by participant and run.
    pub runs: Vec<RunFacts>,
    /// What was found, by run, line and kind.
    pub findings: Vec<AuditFinding>,
    /// Whether a witness was asked.
    pub witnessed: bool,
    /// How many came, and what became of them.
    pub visits: VisitSummary,
}

/// Audits the runs of a study in the folders of runs of its machines, or copies of them. The witness is that of the
/// protocol, unless another is named.
///
/// # Errors
/// The witness or the public key of the lab cannot be read.
pub fn audit(study: &Study, machines: &[PathBuf], witness: Option<&Path>) -> Result<Audit, RunError> {
    let records: Vec<MachineRecord> = machines.iter().map(|base| MachineRecord::read(base)).collect();
    let witness = witness.map(Path::to_owned).or_else(|| study.witness());
    let told = match &witness {
        Some(folder) if !folder.is_dir() => return Err(no_witness(folder)),
        folder => folder.as_deref().map(read_witness).transpose()?,
    };
    let told_of =
        |run: &str| told.as_ref().and_then(|record| record.runs.get(run)).map_or(&[][..], Vec::as_slice);
    let mut audit = Audit {
        runs: Vec::new(),
        findings: Vec::new(),
        witnessed: told.is_some(),
        visits: VisitSummary::default(),
    };
    for machine in &records {
        for run in machine.runs.iter().filter(|run| run.is_of(&study.digest)) {
            let own = Inspection { study, machine, run };
            audit.findings.extend(own.findings(told.is_some().then(|| told_of(&run.id))));
            audit.runs.extend(own.facts());
        }
    }
    audit.findings.extend(second_sessions(study, &records));
    audit.findings.extend(archives::not_signed(study, machines)?);
    if let Some(record) = &told {
        audit.findings.extend(gone(&records, &record.runs));
    }
    let with_runs = audit.runs.iter().filter_map(|run| run.participant.as_deref()).collect();
    audit.visits = VisitSummary::of(&visits_of(study, machines), &with_runs);
    audit.runs.sort_by(|one, other| (&one.participant, &one.run).cmp(&(&other.participant, &other.run)));
    audit.findings.sort_by(|one, other| {
        (&one.participant, &one.run, one.line, one.kind).cmp(&(
            &other.participant,
            &other.run,
            other.line,
            other.kind,
        ))
    });
    Ok(audit)
}

fn no_witness(folder: &Path) -> RunError {
    let problem = "the witness is not there: mount its share, or name a copy of its folder with --witness DIR. Nothing was audited";
    let error = std::io::Error::new(std::io::ErrorKind::NotFound, problem);
    RunError::Io { path: folder.to_owned(), error }
}

/// One run, on its machine.
struct Inspection<'a> {
    study: &'a Study,
    machine: &'a MachineRecord,
    run: &'a RunRecord,
}

impl Inspection<'_> {
    fn participant(&self) -> Option<String> {
        self.run.manifest.as_ref().and_then(|manifest| manifest.participant.clone())
    }

    fn finding(&self, kind: AuditKind, line: Option<u64>, at: &str, words: String) -> AuditFinding {
        let (run, participant) = (self.run.id.clone(), self.participant());
        AuditFinding { kind, run, participant, line, at: at.to_owned(), words }
    }

    fn facts(&self) -> Option<RunFacts> {
        let trajectory = self.run.trajectory.as_ref().ok()?;
        RunFacts::of(self.run.manifest.as_ref()?, trajectory)
    }

    fn findings(&self, told: Option<&[Told]>) -> Vec<AuditFinding> {
        let mut found = self.unsaved();
        match &self.run.trajectory {
            Err(RunError::Damaged { line, problem, .. }) => {
                found.push(self.finding(AuditKind::Damaged, Some(*line as u64), "", problem.clone()));
            }
            Err(problem) => {
                found.push(self.finding(AuditKind::Missing, None, "", problem.to_string()));
            }
            Ok(trajectory) => {
                let afterwards = lines_afterwards(&self.run.folder, trajectory);
                let damaged = |problem| self.finding(AuditKind::Damaged, None, "", problem);
                found.extend(afterwards.as_ref().err().map(|problem| damaged(problem.to_string())));
                let afterwards = afterwards.map_or(Vec::new(), |after| after.lines);
                let beside = |told| self.beside_witness(trajectory, &afterwards, told);
                found.extend(told.into_iter().flat_map(beside));
                found.extend(self.beside_database(trajectory));
                found.extend(self.simulated());
                found.extend(self.manifest());
                found.extend(self.assigned(trajectory));
                found.extend(self.clock(trajectory));
                found.extend(rehearsal::of(self, trajectory));
                found.extend(self.world_list(trajectory));
            }
        }
        found
    }

    /// Lines that were kept beside the trajectory, because it could not take them.
    fn unsaved(&self) -> Vec<AuditFinding> {
        let entries = std::fs::read_dir(&self.run.folder).into_iter().flatten().flatten();
        let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
        let unsaved = names.filter(|name| name.starts_with("trajectory-unsaved"));
        let words = |name: String| {
            format!("{name}: the trajectory was moved, removed or replaced while the run was played")
        };
        unsaved.map(|name| self.finding(AuditKind::Unsaved, None, "", words(name))).collect()
    }

    fn beside_witness(
        &self,
        trajectory: &Trajectory,
        afterwards: &[Line],
        told: &[Told],
    ) -> Vec<AuditFinding> {
        let kind = |kind: FindingKind| match kind {
            FindingKind::Changed => Some(AuditKind::Changed),
            FindingKind::Cut => Some(AuditKind::Cut),
            FindingKind::TwoHistories => Some(AuditKind::TwoHistories),
            FindingKind::Unseen => Some(AuditKind::Unseen),
            FindingKind::OtherMachine => Some(AuditKind::OtherMachine),
            // The lines themselves tell.
            FindingKind::ClockBack => None,
        };
        let of = |Finding { kind: own, line, at, words, .. }: Finding| {
            Some(self.finding(kind(own)?, Some(line), &at, words))
        };
        compare(trajectory, afterwards, told).into_iter().filter_map(of).collect()
    }

    /// Whether the lines lead to the states that they record.
    fn simulated(&self) -> Option<AuditFinding> {
        let problem = verify_sealed(&self.run.folder.join("trajectory.jsonl"), &self.study.seal_key).err()?;
        let line = match &problem {
            RunError::Damaged { line, .. } => Some(*line as u64),
            _ => None,
        };
        Some(self.finding(AuditKind::NotReached, line, "", problem.to_string()))
    }

    /// Whether the lines go as far as database and snapshot remember.
    fn beside_database(&self, trajectory: &Trajectory) -> Option<AuditFinding> {
        let manifest = self.run.manifest.as_ref()?;
        let path = self.run.folder.join("trajectory.jsonl");
        let integrity = Integrity::of(&self.run.folder, manifest, &self.study.seal_key);
        match integrity.check(&path, trajectory).err()? {
            RunError::Damaged { line, problem, .. } => {
                Some(self.finding(AuditKind::Cut, Some(line as u64), "", problem))
            }
            other => Some(self.finding(AuditKind::Cut, None, "", other.to_string())),
        }
    }

    /// What `run.toml` says beside the first line.
    fn manifest(&self) -> Vec<AuditFinding> {
        let told = self.run.manifest.iter();
        told.flat_map(|told| departures_of_file(&self.run.folder, told))
            .map(|words| self.finding(AuditKind::Manifest, Some(1), "", words))
            .collect()
    }

    /// Participant, seed, condition, rules and consent beside what the study lays down.
    fn assigned(&self, trajectory: &Trajectory) -> Vec<AuditFinding> {
        let (Some(manifest), Some(first)) = (&self.run.manifest, trajectory.lines.first()) else {
            return Vec::new();
        };
        let mut wrong = Vec::new();
        let label = manifest.participant.clone().unwrap_or_default();
        let folder = self
            .run
            .folder
            .parent()
            .and_then(Path::file_name)
            .map(|name| name.to_string_lossy().into_owned());
        if folder.as_deref() != Some(label.as_str()) {
            wrong.push(format!("the run of {label} lies in the folder {}", folder.unwrap_or_default()));
        }
        if manifest.recorded_rules() != self.study.rules() {
            wrong.push("it was played by other rules than those of the protocol".to_owned());
        }
        if self.study.consent.is_some() && manifest.consent.is_none() {
            wrong.push("nobody has agreed to the text of the study".to_owned());
        }
        let stamp = manifest.study.as_ref();
        match self.study.assignment.as_ref().map(|assignment| assignment.place(&label)) {
            Some(None) => wrong.push(format!("{label} is no label of the assignment")),
            Some(Some(place)) => {
                let practice = stamp.is_some_and(|stamp| stamp.practice);
                let seed = place.seed.filter(|seed| !practice && *seed != manifest.seed);
                wrong.extend(
                    seed.map(|seed| {
                        format!("{label} was assigned seed {seed}, but played {}", manifest.seed)
                    }),
                );
                if stamp.is_some_and(|stamp| stamp.condition != place.condition) {
                    wrong.push(format!("{label} was assigned another condition"));
                }
            }
            None => {}
        }
        wrong
            .into_iter()
            .map(|words| self.finding(AuditKind::Assignment, Some(1), &first.at, words))
            .collect()
    }

    fn clock(&self, trajectory: &Trajectory) -> Vec<AuditFinding> {
        let settings = clock::settings_of_clock(&trajectory.lines).into_iter();
        settings
            .map(|(line, words)| self.finding(AuditKind::Clock, Some(line.seq + 1), &line.at, words))
            .collect()
    }

    /// What sittings saw of the machine's list of opened worlds, beside the list.
    fn world_list(&self, trajectory: &Trajectory) -> Option<AuditFinding> {
        let log = &self.machine.worlds;
        let saw = trajectory.lines.iter().filter_map(|line| match &line.record {
            Record::Activity(Activity::Session(own)) if own.event == PresenceEvent::Opened => {
                own.worlds.as_ref().map(|seen| (line, seen))
            }
            _ => None,
        });
        let lost = saw.into_iter().find(|(_, seen)| !log.holds(seen));
        let words = |lines: u64| {
            format!(
                "the machine's list of opened worlds had {lines} lines at this line; it is not that list any more"
            )
        };
        let lost = lost.map(|(line, seen)| {
            self.finding(AuditKind::WorldList, Some(line.seq + 1), &line.at, words(seen.lines))
        });
        lost.or_else(|| {
            let words = format!(
                "line {} of the machine's list of opened worlds does not follow from the one before",
                log.broken_at?
            );
            Some(self.finding(AuditKind::WorldList, None, "", words))
        })
    }
}

/// Participants with more than one session, and runs that lie in two places.
fn second_sessions(study: &Study, machines: &[MachineRecord]) -> Vec<AuditFinding> {
    let mut sessions: BTreeMap<String, Vec<&RunRecord>> = BTreeMap::new();
    for run in machines.iter().flat_map(|machine| &machine.runs).filter(|run| run.is_of(&study.digest)) {
        let Some(manifest) = &run.manifest else { continue };
        if manifest.study.as_ref().is_some_and(|stamp| !stamp.practice) {
            let known = sessions.entry(manifest.participant.clone().unwrap_or_default()).or_default();
            // The same run in two folders is a copy.
            if !known.iter().any(|other| other.id == run.id && is_copy(other, run)) {
                known.push(run);
            }
        }
    }
    let several = sessions.into_iter().filter(|(_, runs)| runs.len() > 1);
    several
        .flat_map(|(label, runs)| {
            let names =
                runs.iter().map(|run| run.folder.display().to_string()).collect::<Vec<_>>().join(", ");
            let finding = move |run: &RunRecord| AuditFinding {
                kind: AuditKind::SecondSession,
                run: run.id.clone(),
                participant: Some(label.clone()),
                line: None,
                at: run
                    .manifest
                    .as_ref()
                    .map(|manifest: &Manifest| manifest.created.clone())
                    .unwrap_or_default(),
                words: format!("{label} has {names}"),
            };
            runs.last().map(|run| finding(run))
        })
        .collect()
}

fn is_copy(one: &RunRecord, other: &RunRecord) -> bool {
    let last = |run: &RunRecord| run.trajectory.as_ref().ok()?.lines.last().map(|line| line.hash.clone());
    last(one).is_some() && last(one) == last(other)
}

/// Runs that a witness was told of, and that are nowhere.
fn gone(machines: &[MachineRecord], told: &BTreeMap<String, Vec<Told>>) -> Vec<AuditFinding> {
    let is_there = |run: &str| machines.iter().any(|machine| machine.runs.iter().any(|own| own.id == run));
    let withdrawn = |run: &str| machines.iter().any(|machine| machine.withdrawn.iter().any(|own| own == run));
    // A stone is laid by anybody; the witness is told by the program alone.
    let is_told = |lines: &[Told]| lines.iter().any(Told::is_withdrawal);
    let missing = told.iter().filter(|(run, lines)| !(is_there(run) || withdrawn(run) && is_told(lines)));
    missing
        .map(|(run, lines)| {
            let last = lines.iter().filter(|told| !told.is_withdrawal()).max_by_key(|told| told.seq);
            let words = match (withdrawn(run), is_told(lines)) {
                (true, _) => "withdrawn.toml says that its participant has withdrawn, and the witness was told of no withdrawal",
                (false, true) => "the witness was told that its participant has withdrawn, and no withdrawn.toml says so",
                (false, false) => "the witness was told of this run, and it is in none of the folders",
            };
            AuditFinding {
                kind: AuditKind::Missing,
                run: run.clone(),
                participant: None,
                line: last.map(|told| told.seq + 1),
                at: last.map(|told| told.at.clone()).unwrap_or_default(),
                words: words.to_owned(),
            }
        })
        .collect()
}
