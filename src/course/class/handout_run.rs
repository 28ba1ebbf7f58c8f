//! A run that is handed out. Every student receives a branch from the end of the run's last week, with its own label
//! and name.

use std::path::Path;

use super::handout::HandoutRunFiles;
use novamind_record::clock::now;
use novamind_record::error::RunError;
use novamind_record::folder::manifest::{FORMAT, Manifest};
use novamind_record::folder::manifest_check::ManifestCheck;
use novamind_record::mode::Mode;
use novamind_record::rules::SessionRules;
use novamind_record::stamp::HandoutStamp;
use novamind_record::trajectory::record::Parent;
use novamind_record::trajectory::{Line, Record, Trajectory};
use novamind_session::{TemporaryFolder, create_branch_files, verify};

/// A run that can be handed out.
pub(super) struct HandoutRun {
    manifest: Manifest,
    lines: Vec<Line>,
    pub(super) day: u32,
}

impl HandoutRun {
    /// Reads and verifies a run to hand out.
    ///
    /// # Errors
    /// Returns an error if the run is damaged, is an unfinished baseline run, belongs to a study or a lesson, has no
    /// day left, or has a language model as judge.
    pub(super) fn from_folder(folder: &Path) -> Result<HandoutRun, RunError> {
        let manifest = ManifestCheck::read(folder)?.manifest;
        let trajectory = Trajectory::read(&folder.join("trajectory.jsonl"))?;
        let refused = |why: &str| {
            Err(RunError::InvalidRequest(format!("run {} cannot be handed out: {why}", manifest.id)))
        };
        if manifest.lesson.is_some() {
            return refused("the run belongs to a lesson. Hand out the lesson itself");
        }
        if manifest.study.is_some() || (manifest.mode == Mode::Baseline && trajectory.end_line().is_none()) {
            return refused(
                "an unfinished baseline run and a run of a study cannot be branched. End the run first, or choose another run",
            );
        }
        if manifest.voice.as_ref().is_some_and(|model| model.judge) {
            return refused(
                "a language model judged the posts of the run, and judgments of students' posts could not be verified",
            );
        }
        let day = verify(folder)?.day;
        if day >= manifest.days {
            return refused(
                "the run has no day left. Branch the run at an earlier week and hand out the branch",
            );
        }
        let closing = trajectory.lines.iter().rposition(Line::closes_days).map_or(1, |at| at + 1);
        let lines = trajectory.lines.into_iter().take(closing).collect();
        Ok(HandoutRun { manifest, lines, day })
    }

    pub(super) fn run_id(&self) -> &str {
        &self.manifest.id
    }

    /// Returns the files of a branch for one student. Builds them in a temporary folder inside `parent_folder`.
    ///
    /// # Errors
    /// Returns an error if `parent_folder` cannot be written.
    pub(super) fn branch_files_for_student(
        &self,
        label: &str,
        stamp: &HandoutStamp,
        parent_folder: &Path,
    ) -> Result<HandoutRunFiles, RunError> {
        let was_changed = self.lines.iter().any(|line| matches!(line.record, Record::Override(_)));
        let mode = if was_changed || self.manifest.fault.is_some() { Mode::Debug } else { Mode::Sandbox };
        let manifest = Manifest {
            id: stamp.run.clone(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            created: now(),
            format: FORMAT,
            mode,
            participant: Some(label.to_owned()),
            handout: Some(stamp.clone()),
            rules: Some(SessionRules::for_mode(mode)),
            // The earlier runs and the consent belong to the instructor, so the student's copy omits them.
            earlier: Vec::new(),
            earlier_runs: 0,
            consent: None,
            parent: Some(Parent {
                run: self.manifest.id.clone(),
                seq: self.lines.last().map_or(0, |line| line.seq),
            }),
            ..self.manifest.clone()
        };
        let temporary_folder = TemporaryFolder::create_in(parent_folder)?;
        let folder = temporary_folder.path().join(&stamp.run);
        create_branch_files(&folder, &manifest, &self.lines)?;
        let text = |file: &str| {
            let path = folder.join(file);
            std::fs::read_to_string(&path).map_err(RunError::io(&path))
        };
        Ok(HandoutRunFiles { manifest: text("run.toml")?, trajectory: text("trajectory.jsonl")? })
    }
}
