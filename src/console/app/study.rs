//! Studies: the pages around a participant's runs, and the functions of the console that are closed to participants.

use super::{App, ExitTarget, Layer, Order, Stage};
use crate::screens::menu::StartMenu;
use crate::study_pages::questions::QuestionPage;
use crate::study_pages::{StudyPage, StudyState};
use novamind_study::{CodeOutcome, NextStep, Study};
use novamind_worker::Job;
use novamind_worker::message::StudyResponse;
use novamind_worker::request::{Request, StudyRequest};

const PARTICIPANT_REJECTION: &str = "not available in a study: only your own session is open";

impl App {
    /// Starts a study. Without a label, participants enter their labels.
    pub(super) fn start_study(&mut self, study: Box<Study>, label: Option<String>) {
        let study_state = StudyState::new(&study, label);
        self.has_code = study.protocol.access.code.is_some();
        let page = StudyPage::loading_page(&study_state.title).in_study(&study_state);
        self.stage = Stage::Study(Box::new(page));
        self.study = Some(study_state);
        self.send_study_request(StudyRequest::StartStudy(study));
    }

    fn send_study_request(&mut self, request: StudyRequest) {
        self.send_request(Request::Study(request));
    }

    /// Rejects a request that participants must not send. Returns whether the request was rejected.
    pub(super) fn reject_for_participant(&mut self, request: &Request) -> bool {
        let is_rejected = self.study.is_some() && request.is_forbidden_for_participants();
        if is_rejected {
            self.show_error(PARTICIPANT_REJECTION);
        }
        is_rejected
    }

    /// Returns whether a participant uses the console. Participants can open only their own session.
    pub(super) fn has_participant(&self) -> bool {
        self.study.is_some()
    }

    pub(super) fn show_participant_error(&mut self) {
        self.show_error(PARTICIPANT_REJECTION);
    }

    /// Returns whether the participant must answer questions before anything else.
    pub(super) fn has_due_questions(&self) -> bool {
        self.study.as_ref().is_some_and(|study_state| !study_state.due_questions.is_empty())
    }

    pub(super) fn update_study_for_request(&mut self, request: &Request) {
        let Some(study_state) = &mut self.study else { return };
        match request {
            Request::Study(StudyRequest::SubmitAnswers(answers)) => {
                study_state.due_questions.retain(|due| answers.iter().all(|answer| answer.due != *due));
            }
            Request::Study(StudyRequest::Play) => {
                study_state.has_shown_end = false;
                self.starts_tour = study_state.has_tour();
            }
            _ => {}
        }
    }

    fn show_study_page(&mut self, page: impl FnOnce(&str) -> StudyPage) {
        self.close_layers();
        let Some(study_state) = &self.study else { return };
        self.stage = Stage::Study(Box::new(page(&study_state.title).in_study(study_state)));
    }

    pub(super) fn handle_study_response(&mut self, news: StudyResponse) {
        let Some(study_state) = &mut self.study else { return };
        match news {
            StudyResponse::Ready => match study_state.label.clone() {
                Some(label) => {
                    let rejected_labels = 0;
                    self.send_study_request(StudyRequest::IdentifyParticipant { label, rejected_labels });
                }
                None => self.show_study_page(StudyPage::label_page),
            },
            StudyResponse::LabelRejected(problem) => {
                if let Stage::Study(page) = &mut self.stage {
                    page.reject_label(problem);
                }
            }
            StudyResponse::Next(step)
                if !matches!(step, NextStep::Withdrawn(_))
                    && matches!(&self.stage, Stage::Study(page) if page.withdraws_after_label()) =>
            {
                self.show_study_page(StudyPage::withdraw_page);
            }
            StudyResponse::Next(step) => {
                study_state.due_questions.clear();
                study_state.is_practice = matches!(step, NextStep::Practice { .. });
                // A participant who returns to a hosted session continues at the same place.
                let resumes = matches!(
                    step,
                    NextStep::Session(Some(_)) | NextStep::Practice { unfinished: Some(_), .. }
                );
                let opens = matches!(step, NextStep::Questions(_)) || study_state.label.is_some() && resumes;
                self.show_study_page(|title| match opens {
                    true => StudyPage::loading_page(title),
                    false => StudyPage::from_step(title, step),
                });
                if opens {
                    self.send_study_request(StudyRequest::Play);
                }
            }
            StudyResponse::ConsentDeclined => self.show_study_page(StudyPage::declined_page),
            StudyResponse::QuestionsDue(due) | StudyResponse::AnswersRecorded(due) => {
                study_state.due_questions = due
            }
            StudyResponse::CodeChecked(CodeOutcome::Right) => {
                self.study = None;
                self.stage = Stage::Menu(Box::new(StartMenu::new(&self.configuration)));
                self.orders.push(Order::Job(Job::Execute(Request::ListRuns)));
            }
            StudyResponse::CodeChecked(outcome) => drop(self.show_page_error(outcome.describe())),
            StudyResponse::LimitCodeChecked(outcome) => self.handle_limit_code(outcome),
            StudyResponse::Failed(problem) => {
                self.show_page_error(problem);
            }
        }
    }

    /// Shows an error on the study page. Returns false if no study page is shown.
    pub(super) fn show_page_error(&mut self, problem: String) -> bool {
        if let Stage::Study(page) = &mut self.stage {
            page.set_problem(problem);
            return true;
        }
        false
    }

    pub(super) fn continue_after_run(&mut self, problem: Option<String>) {
        let over = self.run().is_some_and(|run| !run.company.is_running());
        let answered = !self.has_due_questions();
        let Some(study_state) = &mut self.study else { return };
        if std::mem::take(&mut study_state.is_withdrawing) {
            self.show_study_page(StudyPage::withdraw_page);
        } else if over && answered {
            self.show_study_page(StudyPage::loading_page);
            self.send_study_request(StudyRequest::ShowNextStep);
        } else {
            self.show_study_page(StudyPage::left_page);
        }
        if let Some(problem) = problem {
            self.show_error(problem);
        }
    }

    pub(super) fn leave_to_withdraw(&mut self) {
        let Some(study_state) = &mut self.study else {
            return self.show_error("this run is not part of a study");
        };
        study_state.is_withdrawing = true;
        self.exit_run(ExitTarget::Menu);
    }

    /// Shows due questions once no dialog covers the run. Closes the run after the run has ended.
    pub(super) fn show_due_questions(&mut self) {
        let Some(study_state) = &self.study else { return };
        let Stage::Run(run) = &self.stage else { return };
        if !self.layers.is_empty()
            || self.busy.is_some()
            || self.exit_target.is_some()
            || self.pause_screen.is_some()
        {
            return;
        }
        let over = !run.company.is_running();
        match QuestionPage::for_due_questions(&study_state.due_questions) {
            Some((page, effect)) => {
                // The status message may name keys that do not work on study pages.
                self.status = None;
                self.push_layer(Layer::Dialog(Box::new(page)));
                self.execute_effects(vec![effect]);
            }
            // The results follow the last questions.
            None if over && !study_state.has_shown_end => self.show_final_page(),
            None if over => self.exit_run(ExitTarget::Menu),
            None => {}
        }
    }
}
