//! The steps of a participant at a machine, from entering the label to the final page.
//!
//! The next step is derived from the participant's runs and the list of visits. A participant can therefore leave
//! after any step and resume there.

use std::path::{Path, PathBuf};

use super::assignment::AssignmentRow;
use super::definition::{PracticeOffer, SeedPlan, Study};
use super::visit_log::{VisitEvent, VisitLog};
use super::withdrawal::WithdrawalRecord;
use novamind_record::consent::{ConsentAgreement, ConsentText};
use novamind_record::error::RunError;
use novamind_record::folder::configuration::Configuration;
use novamind_record::folder::manifest::Manifest;
use novamind_record::folder::manifest_check::ManifestCheck;
use novamind_record::folder::runs::{RunSummary, delete_run, list_runs, participant_folder};
use novamind_record::mode::Mode;
use novamind_record::stamp::StudyStamp;
use novamind_session::{Access, NewRun, Session, Storage, StudyOptions};

/// Message to a participant who declines consent.
pub const DECLINED_NOTICE: &str = "You did not agree. Kept: your label, the time of your visit, and that you did not agree. Nothing else \
                            was recorded.";

/// Message on the last page of a hosted session.
pub const CLOSE_WINDOW_NOTICE: &str = "Everything is saved. You can close this window.";

/// Message to a participant of a hosted session who can continue later.
pub const RETURN_LATER_NOTICE: &str =
    "To continue later, open your link again, or connect again in the same way.";

/// The visit of a participant who has entered a valid label.
#[derive(Debug, Clone)]
pub struct ParticipantSession {
    study: Study,
    label: String,
    assignment: Option<AssignmentRow>,
    /// Folder of the participant's runs.
    runs: PathBuf,
    log: VisitLog,
    refused_labels: u32,
}

/// A run of a study with its manifest and progress.
type ParticipantRun = (Manifest, RunSummary);

/// The next step of a participant in a study.
#[derive(Debug, Clone, PartialEq)]
pub enum NextStep {
    /// The participant reads the consent text and agrees or declines.
    Consent(ConsentText),
    /// The participant plays the practice run.
    Practice {
        /// Folder of the unfinished practice run; `None` to start a new run.
        unfinished: Option<PathBuf>,
        /// Whether the participant may skip the practice run.
        may_skip: bool,
    },
    /// The participant plays the session: the unfinished run in this folder, or a new run.
    Session(Option<PathBuf>),
    /// The participant answers the open questions after the end of the run in this folder.
    Questions(PathBuf),
    /// The participant has completed the study.
    Thanks,
    /// The participant has withdrawn. The text describes which data was erased and which data is kept.
    Withdrawn(String),
}

impl ParticipantSession {
    /// Starts the visit of a participant. `runs` is the machine's folder of runs. `refused` is the number of
    /// labels that were rejected before this label.
    ///
    /// # Errors
    /// Returns an error if the label is not in the assignment or cannot be the name of a folder. The
    /// rejection is recorded in the list of visits.
    pub fn start(
        study: Study,
        runs: &Path,
        label: &str,
        refused: u32,
    ) -> Result<ParticipantSession, RunError> {
        let log = VisitLog::new(runs, &study);
        let label = label.trim();
        let folder = participant_folder(runs, label);
        let place = study.assignment.as_ref().map(|assignment| assignment.row_for(label).cloned());
        let problem = match (&folder, &place) {
            (Err(problem), _) => Some(problem.clone()),
            (Ok(_), Some(None)) => Some(format!(
                "{label} is not a label of this study. Check the label, or ask the experimenter"
            )),
            _ => None,
        };
        if let Some(problem) = problem {
            log.append(label, VisitEvent::LabelRefused);
            return Err(RunError::InvalidRequest(problem));
        }
        let visit = ParticipantSession {
            runs: folder.unwrap_or_default(),
            assignment: place.flatten(),
            label: label.to_owned(),
            refused_labels: refused,
            study,
            log,
        };
        visit.check_protocol()?;
        visit.log.append(label, VisitEvent::Came);
        Ok(visit)
    }

    /// Returns the study of this visit.
    pub fn study(&self) -> &Study {
        &self.study
    }

    /// Returns the label of the participant.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// Returns the folder of the participant's runs.
    pub fn runs(&self) -> &Path {
        &self.runs
    }

    /// Returns the next step of the participant.
    ///
    /// # Errors
    /// Returns an error if the participant's runs cannot be read.
    pub fn next_step(&self) -> Result<NextStep, RunError> {
        if WithdrawalRecord::exists_in(&self.runs) {
            return Ok(NextStep::Withdrawn(self.withdrawal_summary()));
        }
        let study_runs = self.study_runs()?;
        match self.pending_consent(&study_runs) {
            Some(text) => Ok(NextStep::Consent(text)),
            None => self.next_step_with_runs(&study_runs),
        }
    }

    /// Returns the next step after consent. The consent is recorded in the participant's first run.
    ///
    /// # Errors
    /// Returns the errors of [`ParticipantSession::next_step`].
    pub fn next_step_after_consent(&self) -> Result<NextStep, RunError> {
        self.next_step_with_runs(&self.study_runs()?)
    }

    fn next_step_with_runs(&self, study_runs: &[ParticipantRun]) -> Result<NextStep, RunError> {
        let is = |manifest: &Manifest, practice| {
            manifest.study.as_ref().is_some_and(|study_stamp| study_stamp.practice == practice)
        };
        let find =
            |practice| study_runs.iter().find(|(manifest, _)| is(manifest, practice)).map(|(_, run)| run);
        let (practice, session) = (find(true), find(false));
        let has_practised = practice.is_some_and(|run| run.ended.is_some());
        if session.is_none() && !has_practised && self.study.protocol.practice.offer != PracticeOffer::None {
            let may_pass = self.study.protocol.practice.offer == PracticeOffer::Optional;
            let unfinished = practice.map(|run| self.runs.join(&run.id));
            if !(may_pass && self.log.contains(&self.label, VisitEvent::PassedPractice)) {
                return Ok(NextStep::Practice { unfinished, may_skip: may_pass });
            }
        }
        let Some(run) = session else { return Ok(NextStep::Session(None)) };
        let folder = self.runs.join(&run.id);
        if run.ended.is_none() {
            return Ok(NextStep::Session(Some(folder)));
        }
        let finished = Session::open_sealed(&folder, Access::Read, false, self.study.seal_key.clone())?;
        let open = !self.study.due_questions(&finished).is_empty();
        Ok(if open { NextStep::Questions(folder) } else { NextStep::Thanks })
    }

    /// Returns the definition of a new practice run or session run.
    pub fn new_run(&self, practice: bool, agreed: Option<ConsentAgreement>) -> NewRun {
        let protocol = &self.study.protocol;
        let stamp = StudyStamp {
            name: protocol.name.clone(),
            digest: self.study.digest.clone(),
            condition: self.assignment.as_ref().and_then(|place| place.condition.clone()),
            order: self.assignment.as_ref().map(|place| place.order),
            practice,
            refused_labels: self.refused_labels,
        };
        let assigned_seed = self.assignment.as_ref().and_then(|place| place.seed);
        let seed = match protocol.seeds.plan {
            SeedPlan::One => protocol.seeds.seed,
            SeedPlan::Blocks | SeedPlan::Assigned | SeedPlan::Secret => assigned_seed.or(protocol.seeds.seed),
        };
        let (seed, scenario, days, cash) = match practice {
            true => (Some(protocol.practice.seed), &protocol.practice.scenario, protocol.practice.days, None),
            false => (seed, &protocol.world.scenario, protocol.world.days, protocol.world.cash),
        };
        NewRun {
            seed,
            days,
            cash,
            scenario: scenario.clone(),
            mode: Mode::Baseline,
            participant: Some(self.label.clone()),
            agreed,
            study: Some(StudyOptions {
                stamp,
                rules: self.study.session_rules(),
                consent: self.consent_text(),
                voice: protocol.voice.clone(),
            }),
            storage: Storage::Runs(self.runs.clone()),
            seal_key: self.study.seal_key.clone(),
            ..NewRun::default()
        }
    }

    /// Creates a new run for the practice or the session.
    ///
    /// # Errors
    /// Returns the errors of [`Session::create`].
    pub fn create_run(
        &self,
        practice: bool,
        agreed: Option<ConsentAgreement>,
        configuration: &Configuration,
    ) -> Result<Session, RunError> {
        Session::create(self.new_run(practice, agreed), configuration)
    }

    /// Opens an unfinished run of the participant.
    ///
    /// # Errors
    /// Returns the errors of [`Session::open`].
    pub fn open_run(&self, folder: &Path) -> Result<Session, RunError> {
        let mut session = Session::open_sealed(folder, Access::Write, true, self.study.seal_key.clone())?;
        session.connect_model(self.study.protocol.voice.as_ref());
        Ok(session)
    }

    /// Records that the participant skipped the practice run.
    pub fn skip_practice(&self) {
        self.log.append(&self.label, VisitEvent::PassedPractice);
    }

    /// Records that the participant declined consent.
    pub fn record_declined(&self) {
        self.log.append(&self.label, VisitEvent::ConsentDeclined);
    }

    /// Records that the participant completed the study.
    pub fn record_finished(&self) {
        self.log.append(&self.label, VisitEvent::Finished);
    }

    /// Erases the participant's runs of this study permanently and records the withdrawal.
    ///
    /// # Errors
    /// Returns an error if a run is in use or cannot be removed.
    pub fn withdraw(&self) -> Result<(), RunError> {
        let texts: Vec<String> = self.study_runs()?.into_iter().map(|(_, run)| run.id).collect();
        texts.iter().try_for_each(|run| delete_run(&self.runs, run))?;
        WithdrawalRecord::new(&texts, &self.study.digest).write(&self.runs)?;
        self.log.append(&self.label, VisitEvent::Withdrew);
        Ok(())
    }

    fn withdrawal_summary(&self) -> String {
        "Erased: your runs with all your actions, texts and answers. Kept: your label, the times of your visits, \
         your withdrawal, the names of the erased runs, and remarks or copies that the experimenter made before."
            .to_owned()
    }

    fn consent_text(&self) -> Option<ConsentText> {
        let file = self
            .study
            .folder
            .join(novamind_record::folder::configuration::CONSENT_FILE)
            .display()
            .to_string();
        self.study.consent.clone().map(|text| ConsentText { file, text })
    }

    /// Returns the consent text if the participant has not agreed yet.
    fn pending_consent(&self, study_runs: &[ParticipantRun]) -> Option<ConsentText> {
        let text = self.consent_text()?;
        let digest = text.digest();
        let agreed = |(manifest, _): &ParticipantRun| {
            manifest.consent.as_ref().is_some_and(|consent| consent.digest == digest)
        };
        (!study_runs.iter().any(agreed)).then_some(text)
    }

    /// Returns the participant's runs of this study, most recently played first.
    fn study_runs(&self) -> Result<Vec<ParticipantRun>, RunError> {
        let is_own = |stamp: &StudyStamp| stamp.digest == self.study.digest;
        let all = self.runs_of_all_studies()?.into_iter();
        Ok(all.filter(|(manifest, _)| manifest.study.as_ref().is_some_and(is_own)).collect())
    }

    /// Returns the participant's runs of all studies, most recently played first.
    fn runs_of_all_studies(&self) -> Result<Vec<ParticipantRun>, RunError> {
        let with_manifest = |run: RunSummary| {
            let manifest = ManifestCheck::read(&self.runs.join(&run.id)).ok()?.manifest;
            manifest.study.is_some().then_some((manifest, run))
        };
        Ok(list_runs(&self.runs)?.into_iter().filter_map(with_manifest).collect())
    }

    /// Returns an error if the participant has a run with a different version of the protocol.
    fn check_protocol(&self) -> Result<(), RunError> {
        let other = self.runs_of_all_studies()?.into_iter().find_map(|(manifest, run)| {
            let stamp = manifest.study?;
            (stamp.name == self.study.protocol.name && stamp.digest != self.study.digest).then_some(run.id)
        });
        match other {
            None => Ok(()),
            Some(run) => Err(RunError::InvalidRequest(format!(
                "the study was changed after {} started (run {run}). Ask the experimenter; nothing was recorded",
                self.label
            ))),
        }
    }
}
