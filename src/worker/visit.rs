//! Studies on the session thread: the steps, runs and answers of a participant.

use super::{Open, SessionThread};
use crate::message::{News, VisitNews};
use crate::request::{GivenAnswer, VisitRequest};
use novamind_record::consent::Agreed;
use novamind_record::error::RunError;
use novamind_study::{DueQuestion, NextStep, Study, Visit, record_refused_code};

pub(super) struct Desk {
    pub(super) study: Study,
    pub(super) visit: Option<Visit>,
    /// The participant's consent, until a run records it.
    pub(super) agreed: Option<Agreed>,
    /// The due questions as last reported.
    pub(super) due: Vec<DueQuestion>,
}

impl Desk {
    pub(super) fn of(study: Study) -> Desk {
        Desk { study, visit: None, agreed: None, due: Vec::new() }
    }

    /// Returns the next step of the participant, or `None` before one has come.
    pub(super) fn next(&self) -> Result<Option<NextStep>, RunError> {
        let Some(visit) = &self.visit else { return Ok(None) };
        let step = match visit.next()? {
            // The first run will record the consent.
            NextStep::Consent(_) if self.agreed.is_some() => visit.after_consent()?,
            step => step,
        };
        if step == NextStep::Thanks {
            visit.finish();
        }
        Ok(Some(step))
    }
}

impl SessionThread {
    pub(super) fn lead(&mut self, request: VisitRequest) {
        match request {
            VisitRequest::Receive(study) => {
                self.desk = Some(Desk::of(*study));
                self.say(News::Visit(VisitNews::Ready));
            }
            VisitRequest::Begin { label, refused } => self.begin_visit(&label, refused),
            VisitRequest::Agree(given) => {
                self.at_desk(|desk| desk.agreed = Some(given.now()));
                self.say_next();
            }
            VisitRequest::Decline => {
                self.at_desk(|desk| desk.visit.iter().for_each(Visit::decline));
                self.say(News::Visit(VisitNews::Declined));
            }
            VisitRequest::PassPractice => {
                self.at_desk(|desk| desk.visit.iter().for_each(Visit::pass_practice));
                self.say_next();
            }
            VisitRequest::Play => self.play_next(),
            VisitRequest::GoOn => self.say_next(),
            VisitRequest::Ask(due) => {
                if let Some(Open::Played(session)) = &mut self.open {
                    due.note_shown(session);
                }
            }
            VisitRequest::Answer(answers) => self.take_answers(&answers),
            VisitRequest::Withdraw => self.withdraw(),
            VisitRequest::TryCode(code) => {
                let right = self.desk.as_ref().and_then(|desk| {
                    let protocol = &desk.study.protocol;
                    protocol.access.code.is_some().then(|| protocol.opens_with(Some(&code)))
                });
                if right != Some(true) {
                    self.desk.iter().for_each(|desk| record_refused_code(&desk.study, &self.runs));
                }
                if right == Some(true) {
                    (self.desk, self.lists_everybody) = (None, true);
                }
                self.say(News::Visit(VisitNews::Code(right)));
            }
        }
    }

    fn at_desk(&mut self, work: impl FnOnce(&mut Desk)) {
        if let Some(desk) = &mut self.desk {
            work(desk);
        }
    }

    fn begin_visit(&mut self, label: &str, refused: u32) {
        let Some(desk) = &mut self.desk else { return };
        (desk.visit, desk.agreed, desk.due) = (None, None, Vec::new());
        match Visit::begin(desk.study.clone(), &self.runs, label, refused) {
            Ok(visit) => {
                desk.visit = Some(visit);
                self.say_next();
            }
            Err(problem) => self.say(News::Visit(VisitNews::LabelRefused(problem.to_string()))),
        }
    }

    fn say_next(&self) {
        let news = match self.desk.as_ref().map_or(Ok(None), Desk::next) {
            Ok(Some(step)) => VisitNews::Next(step),
            Ok(None) => VisitNews::Ready,
            Err(problem) => VisitNews::Failed(problem.to_string()),
        };
        self.say(News::Visit(news));
    }

    fn play_next(&mut self) {
        let Some(desk) = &self.desk else { return };
        let Some(visit) = &desk.visit else { return };
        let begin = |practice: bool| visit.begin_run(practice, desk.agreed.clone(), &self.configuration);
        let opened = desk.next().and_then(|step| match step {
            Some(NextStep::Practice { unfinished: None, .. }) => begin(true),
            Some(NextStep::Session(None)) => begin(false),
            Some(
                NextStep::Practice { unfinished: Some(folder), .. }
                | NextStep::Session(Some(folder))
                | NextStep::Questions(folder),
            ) => visit.open(&folder),
            _ => Err(RunError::NotPossible("there is nothing to play".to_owned())),
        });
        self.take(opened, "", None);
    }

    fn take_answers(&mut self, answers: &[GivenAnswer]) {
        let (Some(desk), Some(Open::Played(session))) = (&mut self.desk, &mut self.open) else { return };
        for GivenAnswer { due, value, for_ms, changes } in answers {
            due.note_answer(session, value, *for_ms, *changes);
        }
        desk.due = desk.study.due(session);
        let due = desk.due.clone();
        self.say(News::Visit(VisitNews::Answered(due)));
    }

    pub(super) fn tell_due(&mut self) {
        let (Some(desk), Some(Open::Played(session))) = (&mut self.desk, &self.open) else { return };
        let due = desk.study.due(session);
        if due != desk.due {
            desk.due.clone_from(&due);
            self.say(News::Visit(VisitNews::Due(due)));
        }
    }

    /// Erases the participant's data; none of their runs is open.
    fn withdraw(&mut self) {
        self.queries.disconnect();
        let erased = self.desk.as_ref().and_then(|desk| desk.visit.as_ref()).map(Visit::withdraw);
        match erased {
            Some(Err(problem)) => self.say(News::Visit(VisitNews::Failed(problem.to_string()))),
            Some(Ok(())) | None => self.say_next(),
        }
    }
}
