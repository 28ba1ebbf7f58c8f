//! The audit of a study: finds contradictions within and between its records, each with line and time.
//!
//! A participant who controls a machine can change every file on the machine. The audit therefore compares the records with
//! each other: the chain of hashes, the simulation, the database and the snapshot, the assignment, and two clocks. The
//! audit cannot find a run that was continued in a copy of its folder, or lines that were rewritten with correct hashes.

mod archives;
mod clock;
mod facts;
mod finding;
mod hidden_state;
mod run_record;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Serialize;

pub use facts::RunFacts;
pub use finding::{AuditFinding, FindingKind};

use crate::definition::{Study, shorten_digest};
use crate::visit_log::{
    VISITS_FILE, VisitLine, VisitSummary, finished_visits_without_run, read_study_visits,
};
use novamind_record::clock::parse_seconds;
use novamind_record::error::RunError;
use novamind_record::folder::manifest::Manifest;
use novamind_record::folder::manifest_check::manifest_differences;
use novamind_record::rules::SessionRules;
use novamind_record::trajectory::{Line, Trajectory};
use novamind_session::{Integrity, read_afterwards, verify_sealed};
use run_record::{RunRecord, read_runs};

/// The result of the audit of a study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AuditReport {
    /// Facts about the runs of the study, sorted by participant and run.
    pub runs: Vec<RunFacts>,
    /// Findings, sorted by run, line and kind.
    pub findings: Vec<AuditFinding>,
    /// Number of runs that belong to a study with a different name and were not examined.
    pub runs_of_other_studies: usize,
    /// Number of participants by outcome.
    pub visits: VisitSummary,
}

/// Audits the runs of a study. `machines` contains the folders of runs of the study's machines, or copies of
/// these folders.
///
/// # Errors
/// Returns an error if the public key of the lab cannot be read.
pub fn audit_study(study: &Study, machines: &[PathBuf]) -> Result<AuditReport, RunError> {
    let records: Vec<Vec<RunRecord>> = machines.iter().map(|base| read_runs(base)).collect();
    let mut audit = AuditReport {
        runs: Vec::new(),
        findings: Vec::new(),
        runs_of_other_studies: 0,
        visits: VisitSummary::default(),
    };
    for machine in &records {
        for run in machine.iter().filter(|run| run.belongs_to_study(&study.digest)) {
            let run_audit = RunAudit { study, machine, run };
            audit.findings.extend(run_audit.findings());
            audit.runs.extend(run_audit.facts());
        }
    }
    let all: Vec<&RunRecord> = records.iter().flatten().collect();
    audit.findings.extend(nothing_examined_finding(study, &all, machines));
    audit.findings.extend(all.iter().filter_map(|run| unexaminable_run_finding(study, run)));
    audit.runs_of_other_studies = all.iter().filter(|run| run.belongs_to_different_study(study)).count();
    audit.findings.extend(hidden_state::hidden_view_findings(study, &all));
    audit.findings.extend(duplicate_sessions(study, &all));
    audit.findings.extend(archives::unsigned_archives(study, machines)?);
    let with_runs = audit.runs.iter().filter_map(|run| run.participant.as_deref()).collect();
    let visits = read_study_visits(study, machines);
    audit.visits = VisitSummary::from_lines(&visits, &with_runs);
    let gone = finished_visits_without_run(&visits, &with_runs).into_iter().map(missing_run_finding);
    audit.findings.extend(gone);
    audit.runs.sort_by(|one, other| (&one.participant, &one.run).cmp(&(&other.participant, &other.run)));
    audit.findings.sort_by(|one, other| {
        (&one.participant, &one.run, one.line, one.kind).cmp(&(
            &other.participant,
            &other.run,
            other.line,
            other.kind,
        ))
    });
    // One folder may be a copy of another folder, which results in duplicate findings.
    audit.findings.dedup();
    Ok(audit)
}

fn missing_run_finding(visit: &VisitLine) -> AuditFinding {
    AuditFinding {
        kind: FindingKind::Missing,
        run: String::new(),
        participant: Some(visit.label.clone()),
        line: None,
        at: visit.at.clone(),
        words: format!(
            "{VISITS_FILE} records that this participant finished, but the participant has no run"
        ),
    }
}

fn nothing_examined_finding(
    study: &Study,
    runs: &[&RunRecord],
    machines: &[PathBuf],
) -> Option<AuditFinding> {
    if runs.iter().any(|run| run.belongs_to_study(&study.digest)) {
        return None;
    }
    let folders: Vec<String> = machines.iter().map(|folder| folder.display().to_string()).collect();
    let words = format!(
        "no run with the protocol digest {} is in {}. Check the folders and the protocol. The audit checks only the signatures of archives",
        study.short_digest(),
        folders.join(", ")
    );
    Some(AuditFinding {
        kind: FindingKind::NothingExamined,
        run: String::new(),
        participant: None,
        line: None,
        at: String::new(),
        words,
    })
}

/// Returns a finding on a run that could not be examined although it may belong to the study.
fn unexaminable_run_finding(study: &Study, run: &RunRecord) -> Option<AuditFinding> {
    let (kind, at, words) = match (&run.manifest, run.stamp()) {
        (None, _) => {
            let words =
                "the study of this run is unknown, because neither its first line nor run.toml can be read"
                    .to_owned();
            (FindingKind::Damaged, String::new(), words)
        }
        (Some(manifest), Some(stamp))
            if stamp.name == study.protocol.name && stamp.digest != study.digest =>
        {
            let words = format!(
                "the run has the protocol digest {}, not {}, and was not examined. Audit the run with the study folder that has the digest of the run",
                shorten_digest(&stamp.digest),
                study.short_digest()
            );
            (FindingKind::OtherProtocol, manifest.created.clone(), words)
        }
        _ => return None,
    };
    let participant = run.manifest.as_ref().and_then(|manifest| manifest.participant.clone());
    Some(AuditFinding { kind, run: run.id.clone(), participant, line: None, at, words })
}

/// A run of the study, with all runs of the same machine.
struct RunAudit<'a> {
    study: &'a Study,
    machine: &'a [RunRecord],
    run: &'a RunRecord,
}

impl RunAudit<'_> {
    fn participant(&self) -> Option<String> {
        self.run.manifest.as_ref().and_then(|manifest| manifest.participant.clone())
    }

    fn new_finding(&self, kind: FindingKind, line: Option<u64>, at: &str, words: String) -> AuditFinding {
        let (run, participant) = (self.run.id.clone(), self.participant());
        AuditFinding { kind, run, participant, line, at: at.to_owned(), words }
    }

    fn facts(&self) -> Option<RunFacts> {
        let trajectory = self.run.trajectory.as_ref().ok()?;
        RunFacts::from_trajectory(self.run.manifest.as_ref()?, trajectory)
    }

    fn findings(&self) -> Vec<AuditFinding> {
        let mut found = self.check_unsaved_lines();
        match &self.run.trajectory {
            Err(RunError::Damaged { line, problem, .. }) => {
                found.push(self.new_finding(FindingKind::Damaged, Some(*line as u64), "", problem.clone()));
            }
            Err(problem) => {
                found.push(self.new_finding(FindingKind::Missing, None, "", problem.to_string()));
            }
            Ok(trajectory) => {
                let afterwards = read_afterwards(&self.run.folder, trajectory);
                let damaged = |problem| self.new_finding(FindingKind::Damaged, None, "", problem);
                found.extend(afterwards.as_ref().err().map(|problem| damaged(problem.to_string())));
                let afterwards = afterwards.map_or(Vec::new(), |after| after.lines);
                found.extend(self.check_against_database(trajectory));
                found.extend(self.check_simulation());
                found.extend(self.check_manifest());
                found.extend(self.check_assignment(trajectory));
                found.extend(self.check_clock(trajectory, &afterwards));
                found.extend(self.check_earlier_runs());
            }
        }
        found
    }

    /// Returns findings on files that contain lines that could not be appended to the trajectory.
    fn check_unsaved_lines(&self) -> Vec<AuditFinding> {
        let entries = std::fs::read_dir(&self.run.folder).into_iter().flatten().flatten();
        let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
        let unsaved = names.filter(|name| name.starts_with("trajectory-unsaved"));
        let words = |name: String| {
            format!("{name}: the trajectory was moved, removed or replaced while the run was played")
        };
        unsaved.map(|name| self.new_finding(FindingKind::Unsaved, None, "", words(name))).collect()
    }

    /// Returns a finding if the re-simulation of the run does not reproduce the recorded states.
    fn check_simulation(&self) -> Option<AuditFinding> {
        let problem = verify_sealed(&self.run.folder.join("trajectory.jsonl"), &self.study.seal_key).err()?;
        let line = match &problem {
            RunError::Damaged { line, .. } => Some(*line as u64),
            _ => None,
        };
        Some(self.new_finding(FindingKind::NotReached, line, "", problem.to_string()))
    }

    /// Returns a finding if the database or the snapshot contains lines that are missing from the trajectory.
    fn check_against_database(&self, trajectory: &Trajectory) -> Option<AuditFinding> {
        let manifest = self.run.manifest.as_ref()?;
        let path = self.run.folder.join("trajectory.jsonl");
        let integrity = Integrity::read(&self.run.folder, manifest, &self.study.seal_key);
        match integrity.check(&path, trajectory).err()? {
            RunError::Damaged { line, problem, .. } => {
                Some(self.new_finding(FindingKind::Cut, Some(line as u64), "", problem))
            }
            other => Some(self.new_finding(FindingKind::Cut, None, "", other.to_string())),
        }
    }

    /// Returns findings on contradictions between `run.toml` and the first line of the trajectory.
    fn check_manifest(&self) -> Vec<AuditFinding> {
        let manifests = self.run.manifest.iter();
        manifests
            .flat_map(|manifest| manifest_differences(&self.run.folder, manifest))
            .map(|words| self.new_finding(FindingKind::Manifest, Some(1), "", words))
            .collect()
    }

    /// Returns findings if the participant, seed, condition, rules or consent of the run differ from the study.
    fn check_assignment(&self, trajectory: &Trajectory) -> Vec<AuditFinding> {
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
            wrong.push(format!("the run of {label} is in the folder {}", folder.unwrap_or_default()));
        }
        // Earlier builds recorded `code_words`, which does not affect a run.
        let rules = SessionRules { code_words: None, ..manifest.recorded_rules() };
        if rules != self.study.session_rules() {
            wrong.push("the rules of the run differ from the rules of the protocol".to_owned());
        }
        if self.study.consent.is_some() && manifest.consent.is_none() {
            wrong.push("the run records no consent to the text of the study".to_owned());
        }
        let stamp = manifest.study.as_ref();
        match self.study.assignment.as_ref().map(|assignment| assignment.row_for(&label)) {
            Some(None) => wrong.push(format!("{label} is not in the assignment")),
            Some(Some(place)) => {
                let practice = stamp.is_some_and(|stamp| stamp.practice);
                let seed = place.seed.filter(|seed| !practice && *seed != manifest.seed);
                wrong.extend(
                    seed.map(|seed| {
                        format!("{label} was assigned seed {seed}, but played {}", manifest.seed)
                    }),
                );
                if stamp.is_some_and(|stamp| stamp.condition != place.condition) {
                    wrong.push(format!("{label} was assigned a different condition"));
                }
            }
            None => {}
        }
        wrong
            .into_iter()
            .map(|words| self.new_finding(FindingKind::Assignment, Some(1), &first.at, words))
            .collect()
    }

    fn check_clock(&self, trajectory: &Trajectory, afterwards: &[Line]) -> Vec<AuditFinding> {
        // Lines after the end of the run are included, because they contain the line that closes the run.
        let changes = clock::clock_changes(trajectory.lines.iter().chain(afterwards)).into_iter();
        changes
            .map(|(line, words)| self.new_finding(FindingKind::Clock, Some(line.seq + 1), &line.at, words))
            .collect()
    }

    /// Returns findings on older runs of the participant that the first line of the run does not list.
    fn check_earlier_runs(&self) -> Vec<AuditFinding> {
        let Some(manifest) = &self.run.manifest else { return Vec::new() };
        let began = parse_seconds(&manifest.created);
        let unlisted = self.machine.iter().filter_map(|run| run.manifest.as_ref()).filter(|other| {
            other.participant == manifest.participant
                && other.id != manifest.id
                && other.parent.is_none()
                && parse_seconds(&other.created) < began
                && !manifest.earlier.iter().any(|known| known.run == other.id)
        });
        unlisted
            .map(|other| {
                let words = format!(
                    "run {} of this participant is older, and the first line does not list it",
                    other.id
                );
                self.new_finding(FindingKind::EarlierRuns, Some(1), &manifest.created, words)
            })
            .collect()
    }
}

/// Returns a finding for each participant with more than one session.
fn duplicate_sessions(study: &Study, runs: &[&RunRecord]) -> Vec<AuditFinding> {
    let mut sessions: BTreeMap<String, Vec<&RunRecord>> = BTreeMap::new();
    for run in runs.iter().filter(|run| run.belongs_to_study(&study.digest)) {
        let Some(manifest) = &run.manifest else { continue };
        if manifest.study.as_ref().is_some_and(|stamp| !stamp.practice) {
            let known = sessions.entry(manifest.participant.clone().unwrap_or_default()).or_default();
            // A run that is found in two folders is a copy and not a second session.
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
                kind: FindingKind::SecondSession,
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
