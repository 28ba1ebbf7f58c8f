//! The pages of a participant's session: label, consent, practice, session, questions, thanks.
//!
//! No other part of the console is reachable meanwhile; the experimenter's code opens the rest.

mod answer;
mod draw;
pub mod questions;

use crossterm::event::{KeyCode, KeyEvent};

use super::action::{Action, Scope};
use super::agreement::{Agreement, READ_FIRST};
use super::effect::Effect;
use novamind_study::{DueQuestion, NextStep, Study};
use novamind_tui::widgets::Field;
use novamind_worker::request::{Request, VisitRequest};

/// Study state of the console, on pages and in runs.
pub struct VisitState {
    /// Title of the study for participants.
    pub title: String,
    /// Whether the practice includes the tour.
    tour: bool,
    /// Due questions without an answer.
    pub due: Vec<DueQuestion>,
    /// Whether the current run is the practice.
    pub practises: bool,
    /// Whether the participant left the run to withdraw.
    pub withdraws: bool,
}

impl VisitState {
    /// Returns the state before the first participant.
    pub fn of(study: &Study) -> VisitState {
        VisitState {
            title: study.protocol.title.clone(),
            tour: study.protocol.session.tour,
            due: Vec::new(),
            practises: false,
            withdraws: false,
        }
    }

    /// Returns whether the current run includes the tour.
    pub fn has_tour(&self) -> bool {
        self.tour && self.practises
    }
}

/// A page outside of a run.
pub struct VisitPage {
    title: String,
    kind: PageKind,
    problem: Option<String>,
    /// Number of rejected labels on this page.
    refused: u32,
}

enum PageKind {
    /// The participant enters their label.
    Label(Field),
    /// The experimenter enters the code.
    Code(Field),
    /// Waiting for a response.
    Wait,
    /// The participant agrees or declines.
    Consent(Agreement),
    /// The practice comes next.
    Practice { resumed: bool, may_pass: bool },
    /// The session comes next.
    Session { resumed: bool },
    /// The participant has left a run that has not ended.
    Left,
    /// The participant withdraws: confirmed once, then by typing a word.
    Withdraw(Option<Field>),
    /// The participant declined.
    Declined,
    /// The participant has withdrawn; describes what is kept.
    Withdrawn(String),
    /// The participant has finished.
    Thanks,
}

const WITHDRAW: &str = "withdraw";

impl VisitPage {
    fn new(title: &str, kind: PageKind) -> VisitPage {
        VisitPage { title: title.to_owned(), kind, problem: None, refused: 0 }
    }

    /// Returns the page that asks for a label.
    pub fn label(title: &str) -> VisitPage {
        VisitPage::new(title, PageKind::Label(Field::default()))
    }

    /// Returns the page shown while waiting.
    pub fn wait(title: &str) -> VisitPage {
        VisitPage::new(title, PageKind::Wait)
    }

    /// Returns the page after a run was left before its end.
    pub fn left(title: &str) -> VisitPage {
        VisitPage::new(title, PageKind::Left)
    }

    /// Returns the withdrawal page.
    pub fn withdraw(title: &str) -> VisitPage {
        VisitPage::new(title, PageKind::Withdraw(None))
    }

    /// Returns the page after a participant declined.
    pub fn declined(title: &str) -> VisitPage {
        VisitPage::new(title, PageKind::Declined)
    }

    /// Returns the page of the next step.
    pub fn next(title: &str, step: NextStep) -> VisitPage {
        let kind = match step {
            NextStep::Consent(text) => PageKind::Consent(Agreement::new(text.text)),
            NextStep::Practice { unfinished, may_pass } => {
                PageKind::Practice { resumed: unfinished.is_some(), may_pass }
            }
            NextStep::Session(unfinished) => PageKind::Session { resumed: unfinished.is_some() },
            // The run opens automatically, with the questions over it.
            NextStep::Questions(_) => PageKind::Wait,
            NextStep::Thanks => PageKind::Thanks,
            NextStep::Withdrawn(kept) => PageKind::Withdrawn(kept),
        };
        VisitPage::new(title, kind)
    }

    /// Shows why a label was rejected, and counts it.
    pub fn refuse_label(&mut self, problem: String) {
        self.refused += 1;
        let field = Field::default();
        (self.kind, self.problem) = (PageKind::Label(field), Some(problem));
    }

    /// Shows an error.
    pub fn complain(&mut self, problem: String) {
        self.problem = Some(problem);
    }

    /// Returns the scopes of the page.
    pub fn scopes(&self) -> Vec<Scope> {
        match self.kind {
            PageKind::Label(_) | PageKind::Code(_) | PageKind::Withdraw(Some(_)) => {
                vec![Scope::Field, Scope::Visit]
            }
            PageKind::Consent(_) => vec![Scope::Visit, Scope::List],
            PageKind::Withdraw(None) => vec![Scope::Dialog],
            _ => vec![Scope::Visit],
        }
    }

    /// Returns the actions for the footer, without the experimenter's action.
    pub fn hints(&self) -> Vec<Action> {
        match &self.kind {
            PageKind::Label(_) => vec![Action::GoOn],
            PageKind::Code(_) => vec![Action::GoOn, Action::Discard],
            PageKind::Wait => Vec::new(),
            PageKind::Consent(text) if text.given().is_none() => vec![Action::Down, Action::Decline],
            PageKind::Consent(_) => vec![Action::Agree, Action::Decline],
            PageKind::Practice { may_pass: true, .. } => {
                vec![Action::GoOn, Action::PassPractice, Action::Withdraw]
            }
            PageKind::Practice { .. } | PageKind::Session { .. } | PageKind::Left | PageKind::Thanks => {
                vec![Action::GoOn, Action::Withdraw]
            }
            PageKind::Withdraw(None) => vec![Action::Confirm, Action::Cancel],
            PageKind::Withdraw(Some(_)) => vec![Action::GoOn, Action::Discard],
            PageKind::Declined | PageKind::Withdrawn(_) => vec![Action::GoOn],
        }
    }

    /// Handles an action.
    pub fn act(&mut self, action: Action) -> Vec<Effect> {
        let withdraws = action == Action::Withdraw && self.hints().contains(&action);
        match (&mut self.kind, action) {
            (PageKind::Consent(text), Action::Agree) => match text.given() {
                Some(given) => self.ask(VisitRequest::Agree(given)),
                None => vec![Effect::Complain(READ_FIRST.to_owned())],
            },
            (PageKind::Consent(_), Action::Decline) => self.ask(VisitRequest::Decline),
            (PageKind::Consent(text), _) => {
                text.scroll(action);
                Vec::new()
            }
            (PageKind::Practice { may_pass: true, .. }, Action::PassPractice) => {
                self.ask(VisitRequest::PassPractice)
            }
            (PageKind::Label(_), Action::Experimenter) => self.turn_to(PageKind::Code(Field::default())),
            (PageKind::Withdraw(None), Action::Confirm) => {
                self.turn_to(PageKind::Withdraw(Some(Field::default())))
            }
            (PageKind::Withdraw(None), Action::Cancel) => self.ask(VisitRequest::GoOn),
            (PageKind::Withdraw(Some(_)), Action::Discard) => self.ask(VisitRequest::GoOn),
            (PageKind::Code(_), Action::Discard) => self.turn_to(PageKind::Label(Field::default())),
            _ if withdraws => self.turn_to(PageKind::Withdraw(None)),
            (_, Action::GoOn | Action::Commit | Action::CommitNext) => self.go_on(),
            _ => Vec::new(),
        }
    }

    fn turn_to(&mut self, kind: PageKind) -> Vec<Effect> {
        (self.kind, self.problem) = (kind, None);
        Vec::new()
    }

    fn go_on(&mut self) -> Vec<Effect> {
        match &self.kind {
            PageKind::Label(field) if !field.text().trim().is_empty() => {
                let (label, refused) = (field.text().trim().to_owned(), self.refused);
                vec![Effect::Request(Request::Visit(VisitRequest::Begin { label, refused }))]
            }
            PageKind::Code(field) => {
                let code = field.text().to_owned();
                vec![Effect::Request(Request::Visit(VisitRequest::TryCode(code)))]
            }
            PageKind::Practice { .. } | PageKind::Session { .. } => {
                vec![Effect::Request(Request::Visit(VisitRequest::Play))]
            }
            PageKind::Withdraw(Some(field)) if field.text().trim() == WITHDRAW => {
                self.ask(VisitRequest::Withdraw)
            }
            PageKind::Withdraw(Some(_)) => {
                self.problem = Some(format!("nothing was erased: type {WITHDRAW}, or press esc to continue"));
                Vec::new()
            }
            // The next participant.
            PageKind::Left | PageKind::Declined | PageKind::Withdrawn(_) | PageKind::Thanks => {
                self.refused = 0;
                self.turn_to(PageKind::Label(Field::default()))
            }
            _ => Vec::new(),
        }
    }

    /// Sends a request and shows the waiting page.
    fn ask(&mut self, request: VisitRequest) -> Vec<Effect> {
        self.turn_to(PageKind::Wait);
        vec![Effect::Request(Request::Visit(request))]
    }

    fn field(&mut self) -> Option<&mut Field> {
        match &mut self.kind {
            PageKind::Label(field) | PageKind::Code(field) | PageKind::Withdraw(Some(field)) => Some(field),
            _ => None,
        }
    }

    /// Handles a typed key.
    pub fn key(&mut self, key: &KeyEvent) -> Vec<Effect> {
        match self.field() {
            Some(field) => {
                field.key(key);
                self.problem = None;
            }
            None if key.code == KeyCode::Char('q') => return vec![Effect::Do(Action::Quit)],
            None => {}
        }
        Vec::new()
    }

    /// Handles pasted text.
    pub fn paste(&mut self, text: &str) {
        if let Some(field) = self.field() {
            field.insert(text.trim());
        }
    }
}
