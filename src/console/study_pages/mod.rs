//! The pages of a participant's session: label, consent, practice, session, questions and thanks.
//!
//! While a page is shown, the participant cannot reach other parts of the console. The experimenter's code opens the
//! start menu.

mod answer;
mod draw;
pub mod questions;

use crossterm::event::{KeyCode, KeyEvent};

use super::action::{Action, Scope};
use super::consent::{ConsentText, UNREAD_ERROR};
use super::effect::Effect;
use novamind_study::{DueQuestion, NextStep, Study};
use novamind_tui::widgets::TextField;
use novamind_worker::request::{Request, StudyRequest};

/// State of the console in a study, on study pages and in runs.
pub struct StudyState {
    /// Title of the study that participants see.
    pub title: String,
    /// Label of the participant of a hosted session; `None` if participants enter their labels.
    pub label: Option<String>,
    /// Whether the study has time limits.
    has_limits: bool,
    /// Whether the practice includes the tour.
    has_practice_tour: bool,
    /// Due questions that have no answer yet.
    pub due_questions: Vec<DueQuestion>,
    /// Whether the current run is the practice.
    pub is_practice: bool,
    /// Whether the participant left the run to withdraw.
    pub is_withdrawing: bool,
    /// Whether the page at the end of the current run was shown.
    pub has_shown_end: bool,
}

impl StudyState {
    /// Returns the state of a study before the first participant starts.
    pub fn new(study: &Study, label: Option<String>) -> StudyState {
        StudyState {
            title: study.protocol.title.clone(),
            label,
            has_limits: {
                let limits = &study.protocol.limits;
                [limits.week_minutes, limits.session_minutes, limits.study_minutes]
                    .iter()
                    .any(Option::is_some)
            },
            has_practice_tour: study.protocol.session.tour,
            due_questions: Vec::new(),
            is_practice: false,
            is_withdrawing: false,
            has_shown_end: false,
        }
    }

    /// Returns whether the current run includes the tour.
    pub fn has_tour(&self) -> bool {
        self.has_practice_tour && self.is_practice
    }
}

/// A study page that is shown while no run is open.
pub struct StudyPage {
    title: String,
    kind: StudyPageKind,
    problem: Option<String>,
    /// Number of rejected labels on this page.
    rejected_labels: u32,
    /// Whether the participant has a hosted session, which ends with the participant's last page.
    is_hosted: bool,
    /// Whether the study has time limits.
    has_limits: bool,
}

enum StudyPageKind {
    /// Page on which the participant enters a label. The flag is true if the participant then withdraws.
    Label(TextField, bool),
    /// Page on which the experimenter enters the code.
    Code(TextField),
    /// Page that is shown until a response arrives.
    Loading,
    /// Page on which the participant agrees to the consent text or declines.
    Consent(ConsentText),
    /// Page that is shown before the practice starts or resumes.
    Practice { resumed: bool, may_pass: bool },
    /// Page that is shown before the session starts or resumes.
    Session { resumed: bool },
    /// Page after the participant left a run that has not ended.
    Left,
    /// Page on which the participant confirms a withdrawal, first with a key, then by typing a word.
    Withdraw(Option<TextField>),
    /// Page that is shown after the participant declined consent.
    Declined,
    /// Page after a withdrawal, with a description of the data that is kept.
    Withdrawn(String),
    /// Page after the participant finished the session.
    Thanks,
}

const WITHDRAW: &str = "withdraw";

impl StudyPage {
    fn new(title: &str, kind: StudyPageKind) -> StudyPage {
        StudyPage {
            title: title.to_owned(),
            kind,
            problem: None,
            rejected_labels: 0,
            is_hosted: false,
            has_limits: false,
        }
    }

    /// Returns the page with the properties of the study and of the session.
    pub fn in_study(self, study_state: &StudyState) -> StudyPage {
        StudyPage { is_hosted: study_state.label.is_some(), has_limits: study_state.has_limits, ..self }
    }

    /// Returns whether the participant can only leave this page, or withdraw.
    pub fn is_last_page(&self) -> bool {
        matches!(
            self.kind,
            StudyPageKind::Left
                | StudyPageKind::Declined
                | StudyPageKind::Withdrawn(_)
                | StudyPageKind::Thanks
        )
    }

    /// Returns the page that asks for a label.
    pub fn label_page(title: &str) -> StudyPage {
        StudyPage::new(title, StudyPageKind::Label(TextField::default(), false))
    }

    /// Returns the page that is shown until a response arrives.
    pub fn loading_page(title: &str) -> StudyPage {
        StudyPage::new(title, StudyPageKind::Loading)
    }

    /// Returns the page after the participant left a run before its end.
    pub fn left_page(title: &str) -> StudyPage {
        StudyPage::new(title, StudyPageKind::Left)
    }

    /// Returns the page on which the participant confirms a withdrawal.
    pub fn withdraw_page(title: &str) -> StudyPage {
        StudyPage::new(title, StudyPageKind::Withdraw(None))
    }

    /// Returns the page after a participant declined.
    pub fn declined_page(title: &str) -> StudyPage {
        StudyPage::new(title, StudyPageKind::Declined)
    }

    /// Returns the page of the participant's next step.
    pub fn from_step(title: &str, step: NextStep) -> StudyPage {
        let kind = match step {
            NextStep::Consent(text) => StudyPageKind::Consent(ConsentText::new(text.text)),
            NextStep::Practice { unfinished, may_skip: may_pass } => {
                StudyPageKind::Practice { resumed: unfinished.is_some(), may_pass }
            }
            NextStep::Session(unfinished) => StudyPageKind::Session { resumed: unfinished.is_some() },
            // The run opens automatically and shows the questions over the screen.
            NextStep::Questions(_) => StudyPageKind::Loading,
            NextStep::Thanks => StudyPageKind::Thanks,
            NextStep::Withdrawn(kept) => StudyPageKind::Withdrawn(kept),
        };
        StudyPage::new(title, kind)
    }

    /// Shows why a label was rejected, and counts the rejection.
    pub fn reject_label(&mut self, problem: String) {
        if self.is_hosted {
            return self.set_problem(problem);
        }
        self.rejected_labels += 1;
        let field = TextField::default();
        (self.kind, self.problem) =
            (StudyPageKind::Label(field, self.withdraws_after_label()), Some(problem));
    }

    /// Returns whether the participant chose to withdraw before entering the label.
    pub fn withdraws_after_label(&self) -> bool {
        matches!(self.kind, StudyPageKind::Label(_, true))
    }

    /// Shows an error message on the page.
    pub fn set_problem(&mut self, problem: String) {
        self.problem = Some(problem);
    }

    /// Returns the scopes of the current page.
    pub fn scopes(&self) -> Vec<Scope> {
        match self.kind {
            StudyPageKind::Label(..) | StudyPageKind::Code(_) | StudyPageKind::Withdraw(Some(_)) => {
                vec![Scope::Field, Scope::Study]
            }
            StudyPageKind::Consent(_) => vec![Scope::Study, Scope::List],
            StudyPageKind::Withdraw(None) => vec![Scope::Dialog],
            _ => vec![Scope::Study],
        }
    }

    /// Returns the actions to show in the footer, without the action of the experimenter.
    pub fn hints(&self) -> Vec<Action> {
        match &self.kind {
            StudyPageKind::Label(..) => vec![Action::Continue],
            StudyPageKind::Code(_) => vec![Action::Continue, Action::Discard],
            StudyPageKind::Loading => Vec::new(),
            StudyPageKind::Consent(text) if text.consent().is_none() => {
                vec![Action::Down, Action::Decline, Action::Withdraw]
            }
            StudyPageKind::Consent(_) => vec![Action::Agree, Action::Decline, Action::Withdraw],
            StudyPageKind::Practice { may_pass: true, .. } => {
                vec![Action::Continue, Action::SkipPractice, Action::Withdraw]
            }
            StudyPageKind::Practice { .. }
            | StudyPageKind::Session { .. }
            | StudyPageKind::Left
            | StudyPageKind::Thanks => {
                vec![Action::Continue, Action::Withdraw]
            }
            StudyPageKind::Withdraw(None) => vec![Action::Confirm, Action::Cancel],
            StudyPageKind::Withdraw(Some(_)) => vec![Action::Continue, Action::Discard],
            StudyPageKind::Declined | StudyPageKind::Withdrawn(_) => vec![Action::Continue],
        }
    }

    /// Handles an action on the current page.
    pub fn handle_action(&mut self, action: Action) -> Vec<Effect> {
        let withdraws = action == Action::Withdraw && self.hints().contains(&action);
        match (&mut self.kind, action) {
            (StudyPageKind::Consent(text), Action::Agree) => match text.consent() {
                Some(consent_given) => self.send_request(StudyRequest::Agree(consent_given)),
                None => vec![Effect::ShowError(UNREAD_ERROR.to_owned())],
            },
            (StudyPageKind::Consent(_), Action::Decline) => self.send_request(StudyRequest::Decline),
            _ if withdraws => self.show_page(StudyPageKind::Withdraw(None)),
            (StudyPageKind::Consent(text), _) => {
                text.handle_scroll(action);
                Vec::new()
            }
            (StudyPageKind::Practice { may_pass: true, .. }, Action::SkipPractice) => {
                self.send_request(StudyRequest::SkipPractice)
            }
            (StudyPageKind::Label(..), Action::Experimenter) => {
                self.show_page(StudyPageKind::Code(TextField::default()))
            }
            (StudyPageKind::Withdraw(None), Action::Confirm) => {
                self.show_page(StudyPageKind::Withdraw(Some(TextField::default())))
            }
            (StudyPageKind::Withdraw(None), Action::Cancel)
            | (StudyPageKind::Withdraw(Some(_)), Action::Discard) => {
                let kept = Effect::ShowStatus("you did not withdraw; nothing was erased".to_owned());
                self.send_request(StudyRequest::ShowNextStep).into_iter().chain([kept]).collect()
            }
            (StudyPageKind::Code(_), Action::Discard) => {
                self.show_page(StudyPageKind::Label(TextField::default(), false))
            }
            (_, Action::Continue | Action::Commit | Action::CommitNext) => self.continue_to_next(),
            _ => Vec::new(),
        }
    }

    fn show_page(&mut self, kind: StudyPageKind) -> Vec<Effect> {
        (self.kind, self.problem) = (kind, None);
        Vec::new()
    }

    fn continue_to_next(&mut self) -> Vec<Effect> {
        match &self.kind {
            StudyPageKind::Label(field, _) if field.text().trim() == WITHDRAW => {
                self.show_page(StudyPageKind::Label(TextField::default(), true))
            }
            StudyPageKind::Label(field, _) if !field.text().trim().is_empty() => {
                let (label, refused) = (field.text().trim().to_owned(), self.rejected_labels);
                vec![Effect::Request(Request::Study(StudyRequest::IdentifyParticipant {
                    label,
                    rejected_labels: refused,
                }))]
            }
            StudyPageKind::Code(field) => {
                let code = field.text().to_owned();
                vec![Effect::Request(Request::Study(StudyRequest::CheckCode(code)))]
            }
            StudyPageKind::Practice { .. } | StudyPageKind::Session { .. } => {
                vec![Effect::Request(Request::Study(StudyRequest::Play))]
            }
            StudyPageKind::Withdraw(Some(field)) if field.text().trim() == WITHDRAW => {
                self.send_request(StudyRequest::Withdraw)
            }
            StudyPageKind::Withdraw(Some(_)) => {
                self.problem = Some(format!("nothing was erased: type {WITHDRAW}, or press esc to continue"));
                Vec::new()
            }
            _ if self.is_last_page() && self.is_hosted => vec![Effect::LeaveNow],
            // The next participant can enter a label.
            _ if self.is_last_page() => {
                self.rejected_labels = 0;
                self.show_page(StudyPageKind::Label(TextField::default(), false))
            }
            _ => Vec::new(),
        }
    }

    /// Sends a request and shows the loading page.
    fn send_request(&mut self, request: StudyRequest) -> Vec<Effect> {
        self.show_page(StudyPageKind::Loading);
        vec![Effect::Request(Request::Study(request))]
    }

    fn field(&mut self) -> Option<&mut TextField> {
        match &mut self.kind {
            StudyPageKind::Label(field, _)
            | StudyPageKind::Code(field)
            | StudyPageKind::Withdraw(Some(field)) => Some(field),
            _ => None,
        }
    }

    /// Handles a typed key.
    pub fn handle_key(&mut self, key: &KeyEvent) -> Vec<Effect> {
        match self.field() {
            Some(field) => {
                field.handle_key(key);
                self.problem = None;
            }
            None if key.code == KeyCode::Char('q') => return vec![Effect::Execute(Action::Quit)],
            None => {}
        }
        Vec::new()
    }

    /// Handles text that is pasted into the field of the page.
    pub fn paste(&mut self, text: &str) {
        if let Some(field) = self.field() {
            field.insert(text.trim());
        }
    }
}
