//! Studies on the session thread: the steps, runs and answers of a participant.

use super::{ActiveRun, SessionThread};
use crate::message::{Response, StudyResponse};
use crate::request::{GivenAnswer, StudyRequest};
use novamind_record::consent::ConsentAgreement;
use novamind_record::error::RunError;
use novamind_study::{CodeOutcome, DueQuestion, NextStep, ParticipantSession, Study};

pub(super) struct ActiveStudy {
    pub(super) study: Study,
    pub(super) participant: Option<ParticipantSession>,
    /// The participant's consent until a run records it.
    pub(super) consent: Option<ConsentAgreement>,
    /// The due questions that were last reported to the console.
    pub(super) due_questions: Vec<DueQuestion>,
}

impl ActiveStudy {
    pub(super) fn new(study: Study) -> ActiveStudy {
        ActiveStudy { study, participant: None, consent: None, due_questions: Vec::new() }
    }

    /// Returns the next step of the participant, or `None` if no participant has started.
    pub(super) fn next_step(&self) -> Result<Option<NextStep>, RunError> {
        let Some(visit) = &self.participant else { return Ok(None) };
        let step = match visit.next_step()? {
            // The first run will record the consent.
            NextStep::Consent(_) if self.consent.is_some() => visit.next_step_after_consent()?,
            step => step,
        };
        if step == NextStep::Thanks {
            visit.record_finished();
        }
        Ok(Some(step))
    }
}

impl SessionThread {
    pub(super) fn handle_study_request(&mut self, request: StudyRequest) {
        match request {
            StudyRequest::StartStudy(study) => {
                self.study = Some(ActiveStudy::new(*study));
                self.send_response(Response::Study(StudyResponse::Ready));
            }
            StudyRequest::IdentifyParticipant { label, rejected_labels: refused } => {
                self.start_participant(&label, refused)
            }
            StudyRequest::Agree(consent_given) => {
                self.with_study(|active_study| active_study.consent = Some(consent_given.agree_now()));
                self.send_next_step();
            }
            StudyRequest::Decline => {
                self.with_study(|state| {
                    state.participant.iter().for_each(ParticipantSession::record_declined)
                });
                self.send_response(Response::Study(StudyResponse::ConsentDeclined));
            }
            StudyRequest::SkipPractice => {
                self.with_study(|state| state.participant.iter().for_each(ParticipantSession::skip_practice));
                self.send_next_step();
            }
            StudyRequest::Play => self.open_participant_run(),
            StudyRequest::ShowNextStep => self.send_next_step(),
            StudyRequest::RecordShownQuestion(due) => {
                if let Some(ActiveRun::Live(session)) = &mut self.active_run {
                    due.record_shown(session);
                }
            }
            StudyRequest::SubmitAnswers(answers) => self.record_answers(&answers),
            StudyRequest::Withdraw => self.erase_participant(),
            StudyRequest::CheckCode(code) => {
                let outcome = self.check_code(&code);
                if outcome == CodeOutcome::Right {
                    (self.study, self.lists_all_participants) = (None, true);
                }
                self.send_response(Response::Study(StudyResponse::CodeChecked(outcome)));
            }
            StudyRequest::LiftLimit(code) => {
                let outcome = self.check_code(&code);
                self.send_response(Response::Study(StudyResponse::LimitCodeChecked(outcome)));
            }
        }
    }

    fn check_code(&self, code: &str) -> CodeOutcome {
        let study = self.study.as_ref();
        study.map_or(CodeOutcome::NoCode, |state| state.study.check_code(&self.runs_folder, code))
    }

    fn with_study(&mut self, work: impl FnOnce(&mut ActiveStudy)) {
        if let Some(study) = &mut self.study {
            work(study);
        }
    }

    fn start_participant(&mut self, label: &str, refused: u32) {
        let Some(study) = &mut self.study else { return };
        (study.participant, study.consent, study.due_questions) = (None, None, Vec::new());
        match ParticipantSession::start(study.study.clone(), &self.runs_folder, label, refused) {
            Ok(visit) => {
                study.participant = Some(visit);
                self.send_next_step();
            }
            Err(problem) => {
                self.send_response(Response::Study(StudyResponse::LabelRejected(problem.to_string())))
            }
        }
    }

    fn send_next_step(&self) {
        let news = match self.study.as_ref().map_or(Ok(None), ActiveStudy::next_step) {
            Ok(Some(step)) => StudyResponse::Next(step),
            Ok(None) => StudyResponse::Ready,
            Err(problem) => StudyResponse::Failed(problem.to_string()),
        };
        self.send_response(Response::Study(news));
    }

    fn open_participant_run(&mut self) {
        let Some(study) = &self.study else { return };
        let Some(visit) = &study.participant else { return };
        let begin = |practice: bool| visit.create_run(practice, study.consent.clone(), &self.configuration);
        let opened = study.next_step().and_then(|step| match step {
            Some(NextStep::Practice { unfinished: None, .. }) => begin(true),
            Some(NextStep::Session(None)) => begin(false),
            Some(
                NextStep::Practice { unfinished: Some(folder), .. }
                | NextStep::Session(Some(folder))
                | NextStep::Questions(folder),
            ) => visit.open_run(&folder),
            _ => {
                Err(RunError::InvalidRequest("there is no run to play in this step of the study".to_owned()))
            }
        });
        self.show_opened_run(opened, "", None);
    }

    fn record_answers(&mut self, answers: &[GivenAnswer]) {
        let (Some(active_study), Some(ActiveRun::Live(session))) = (&mut self.study, &mut self.active_run)
        else {
            return;
        };
        for GivenAnswer { due, value, shown_ms: for_ms, changes } in answers {
            due.record_answer(session, value, *for_ms, *changes);
        }
        active_study.due_questions = active_study.study.due_questions(session);
        let due = active_study.due_questions.clone();
        self.send_response(Response::Study(StudyResponse::AnswersRecorded(due)));
    }

    pub(super) fn report_due_questions(&mut self) {
        let (Some(active_study), Some(ActiveRun::Live(session))) = (&mut self.study, &self.active_run) else {
            return;
        };
        let due = active_study.study.due_questions(session);
        if due != active_study.due_questions {
            active_study.due_questions.clone_from(&due);
            self.send_response(Response::Study(StudyResponse::QuestionsDue(due)));
        }
    }

    /// Erases the data of the participant. The caller must have closed the participant's run.
    fn erase_participant(&mut self) {
        self.queries.disconnect();
        let erased = self
            .study
            .as_ref()
            .and_then(|study| study.participant.as_ref())
            .map(ParticipantSession::withdraw);
        match erased {
            Some(Err(problem)) => {
                self.send_response(Response::Study(StudyResponse::Failed(problem.to_string())))
            }
            Some(Ok(())) | None => self.send_next_step(),
        }
    }
}
