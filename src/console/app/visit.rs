//! Studies: the pages around a participant's runs, and the parts of the console that are closed to participants.

use super::{App, Closing, Layer, Order, Stage};
use crate::screens::menu::Menu;
use crate::visit::questions::QuestionPage;
use crate::visit::{VisitPage, VisitState};
use novamind_study::{NextStep, Study};
use novamind_worker::Job;
use novamind_worker::message::VisitNews;
use novamind_worker::request::{Request, VisitRequest};

const KEPT: &str = "not available in a study: only your own session is open";

impl App {
    pub(super) fn receive(&mut self, study: Box<Study>) {
        let visit = VisitState::of(&study);
        self.code_check = study.code_check();
        self.stage = Stage::Visit(Box::new(VisitPage::wait(&visit.title)));
        self.visit = Some(visit);
        self.ask_visit(VisitRequest::Receive(study));
    }

    fn ask_visit(&mut self, request: VisitRequest) {
        self.request(Request::Visit(request));
    }

    /// Rejects a request that participants must not send. Returns whether it did.
    pub(super) fn keeps_from_participant(&mut self, request: &Request) -> bool {
        let kept = self.visit.is_some() && request.is_kept_from_participants();
        if kept {
            self.complain(KEPT);
        }
        kept
    }

    /// Returns whether a participant uses the console and only their session is reachable.
    pub(super) fn leads_participant(&self) -> bool {
        self.visit.is_some()
    }

    pub(super) fn complain_of_visit(&mut self) {
        self.complain(KEPT);
    }

    /// Returns whether the participant must answer questions before anything else.
    pub(super) fn owes_answers(&self) -> bool {
        self.visit.as_ref().is_some_and(|visit| !visit.due.is_empty())
    }

    pub(super) fn note_request(&mut self, request: &Request) {
        let Some(visit) = &mut self.visit else { return };
        match request {
            Request::Visit(VisitRequest::Answer(answers)) => {
                visit.due.retain(|due| answers.iter().all(|answer| answer.due != *due));
            }
            Request::Visit(VisitRequest::Play) => self.tour_planned = visit.has_tour(),
            _ => {}
        }
    }

    fn turn_to(&mut self, page: impl FnOnce(&str) -> VisitPage) {
        self.close_layers();
        let Some(visit) = &self.visit else { return };
        self.stage = Stage::Visit(Box::new(page(&visit.title)));
    }

    pub(super) fn visited(&mut self, news: VisitNews) {
        let Some(visit) = &mut self.visit else { return };
        match news {
            VisitNews::Ready => self.turn_to(VisitPage::label),
            VisitNews::LabelRefused(problem) => {
                if let Stage::Visit(page) = &mut self.stage {
                    page.refuse_label(problem);
                }
            }
            VisitNews::Next(step) => {
                visit.due.clear();
                visit.practises = matches!(step, NextStep::Practice { .. });
                let opens = matches!(step, NextStep::Questions(_));
                self.turn_to(|title| VisitPage::next(title, step));
                if opens {
                    self.ask_visit(VisitRequest::Play);
                }
            }
            VisitNews::Declined => self.turn_to(VisitPage::declined),
            VisitNews::Due(due) | VisitNews::Answered(due) => visit.due = due,
            VisitNews::Code(Some(true)) => {
                self.visit = None;
                self.stage = Stage::Menu(Box::new(Menu::new(&self.configuration)));
                self.orders.push(Order::Job(Job::Do(Request::ListRuns)));
            }
            VisitNews::Code(right) => {
                let problem = match right {
                    None => "this study has no experimenter's code",
                    Some(_) => "this is not the experimenter's code",
                };
                self.complain_on_page(problem.to_owned());
            }
            VisitNews::Failed(problem) => {
                self.complain_on_page(problem);
            }
        }
    }

    /// Shows an error on the study page. Returns false if no study page is shown.
    pub(super) fn complain_on_page(&mut self, problem: String) -> bool {
        if let Stage::Visit(page) = &mut self.stage {
            page.complain(problem);
            return true;
        }
        false
    }

    pub(super) fn after_run(&mut self, problem: Option<String>) {
        let over = self.run().is_some_and(|run| !run.company.is_running());
        let answered = !self.owes_answers();
        let Some(visit) = &mut self.visit else { return };
        if std::mem::take(&mut visit.withdraws) {
            self.turn_to(VisitPage::withdraw);
        } else if over && answered {
            self.turn_to(VisitPage::wait);
            self.ask_visit(VisitRequest::GoOn);
        } else {
            self.turn_to(VisitPage::left);
        }
        if let Some(problem) = problem {
            self.complain(problem);
        }
    }

    pub(super) fn withdraw(&mut self) {
        let Some(visit) = &mut self.visit else { return self.complain("this run is not part of a study") };
        visit.withdraws = true;
        self.leave(Closing::ToMenu);
    }

    /// Shows due questions once no dialog covers the run; leaves the run after it has ended.
    pub(super) fn settle_visit(&mut self) {
        let Some(visit) = &self.visit else { return };
        let Stage::Run(run) = &self.stage else { return };
        if !self.layers.is_empty() || self.busy.is_some() || self.closing.is_some() || self.cover.is_some() {
            return;
        }
        let over = !run.company.is_running();
        match QuestionPage::first_of(&visit.due) {
            Some((page, shown)) => {
                // The status message refers to keys that do not work here.
                self.note = None;
                self.lay(Layer::Dialog(Box::new(page)));
                self.follow(vec![shown]);
            }
            None if over => self.leave(Closing::ToMenu),
            None => {}
        }
    }
}
