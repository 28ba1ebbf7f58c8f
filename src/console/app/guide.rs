//! Explanations, the glossary and the tour.

use super::{App, Layer, Stage};
use crate::action::Action;
use crate::context::{Look, ScreenId};
use crate::dialogs::explain::Explain;
use crate::dialogs::glossary::Glossary;
use crate::effect::Effect;
use crate::screens::ScreenState;
use crate::tour::{self, TourFacts};
use crate::visit::VisitState;
use novamind_glossary::Subject;
use novamind_session::Access;
use novamind_worker::request::Request;

impl App {
    /// Explains the selected figure, or the screen if no figure is selected.
    pub(super) fn explain(&mut self) {
        let figure = self.with_screen(|screen, look| screen.figure(look)).flatten();
        let Stage::Run(run) = &mut self.stage else { return };
        let numbers = run.company.numbers.clone();
        let dialog = match figure {
            Some(figure) => Explain::figure(&figure, numbers),
            None => Explain::screen(run.here, numbers),
        };
        self.lay(Layer::Dialog(Box::new(dialog)));
    }

    pub(super) fn explain_subject(&mut self, subject: Subject) {
        let Stage::Run(run) = &mut self.stage else { return };
        let explain = Explain::subject(subject, run.company.numbers.clone());
        self.lay(Layer::Dialog(Box::new(explain)));
    }

    pub(super) fn show_glossary(&mut self) {
        let Stage::Run(run) = &self.stage else { return };
        let glossary = Glossary::new(run.company.numbers.clone());
        self.lay(Layer::Dialog(Box::new(glossary)));
    }

    pub(super) fn start_tour(&mut self) {
        self.tour_planned = true;
        let begun = match &self.stage {
            Stage::Menu(menu) => menu.practice().map(str::to_owned),
            Stage::Run(_) | Stage::Visit(_) => None,
        };
        self.follow(vec![Effect::Request(match begun {
            Some(id) => Request::Open(id, Access::Write),
            None => Request::Create(Box::new(tour::practice_run())),
        })]);
    }

    /// Shows the tour, starting with the first step that is not done.
    pub(super) fn show_tour(&mut self) {
        let of_practice = self.visit.as_ref().is_some_and(VisitState::has_tour);
        if self.leads_participant() && !of_practice {
            return self.complain("this session has no tour");
        }
        let Stage::Run(run) = &mut self.stage else { return };
        if run.company.is_baseline() && !of_practice {
            return self.complain("baseline runs have no tour; Tour in the start menu opens a practice run");
        }
        // The steps are written for the practice run.
        if run.company.seen.scenario != tour::scenario() {
            return self.complain("the tour has its own run; open it with Tour in the start menu");
        }
        run.tour.get_or_insert_default();
    }

    pub(super) fn skip_step(&mut self) {
        match self.tour() {
            Some(tour) => tour.skip(),
            None => self.complain("no tour is shown"),
        }
    }

    pub(super) fn close_tour(&mut self) {
        let Stage::Run(run) = &mut self.stage else { return };
        if run.tour.take().is_none() {
            return self.complain("no tour is shown");
        }
        let way = match self.keys.label(Action::Tour) {
            Some(key) => key,
            None => format!("{} tour", self.keys.label(Action::Palette).unwrap_or_default()),
        };
        self.say(format!("tour closed; {way} resumes it"));
    }

    fn tour(&mut self) -> Option<&mut tour::Tour> {
        match &mut self.stage {
            Stage::Run(run) => run.tour.as_mut(),
            Stage::Menu(_) | Stage::Visit(_) => None,
        }
    }

    pub(super) fn settle_tour(&mut self) {
        let Stage::Run(run) = &mut self.stage else { return };
        let Some(tour) = &mut run.tour else { return };
        let filing = matches!(self.layers.last(), Some(Layer::Filing)).then(|| run.filing.step_number());
        let look = Look { company: &run.company, keys: &self.keys, page: self.page };
        let group_open = run.here == ScreenId::Customers && run.screens.customers.open_here(&look).is_some();
        let facts = TourFacts {
            company: &run.company,
            here: run.here,
            before: &run.before,
            filing,
            dialog: !self.layers.is_empty(),
            group_open,
        };
        if !tour.settle(&facts) {
            run.tour = None;
            let last = run.company.seen.last_day;
            self.say(format!("tour completed; you can play on until day {last}"));
        }
    }
}
