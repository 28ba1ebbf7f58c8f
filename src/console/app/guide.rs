//! Explanations, the glossary and the tour.

use super::{App, Layer, Stage};
use crate::action::Action;
use crate::context::{ScreenContext, ScreenId};
use crate::dialogs::explanation::ExplainDialog;
use crate::dialogs::glossary::GlossaryDialog;
use crate::effect::Effect;
use crate::screens::ScreenState;
use crate::study_pages::StudyState;
use crate::tour::{self, TourFacts};
use novamind_glossary::Subject;
use novamind_session::Access;
use novamind_worker::request::Request;

impl App {
    /// Explains the selected figure, or the screen if no figure is selected.
    pub(super) fn open_explanation(&mut self) {
        let figure = self.with_screen(|screen, context| screen.figure(context)).flatten();
        let Stage::Run(run) = &mut self.stage else { return };
        let numbers = run.company.numbers.clone();
        let dialog = match figure {
            Some(figure) => ExplainDialog::for_figure(&figure, numbers),
            None => ExplainDialog::for_screen(run.screen, numbers),
        };
        self.push_layer(Layer::Dialog(Box::new(dialog)));
    }

    pub(super) fn open_subject(&mut self, subject: Subject) {
        let Stage::Run(run) = &mut self.stage else { return };
        let explain = ExplainDialog::for_subject(subject, run.company.numbers.clone());
        self.push_layer(Layer::Dialog(Box::new(explain)));
    }

    pub(super) fn open_glossary(&mut self) {
        let Stage::Run(run) = &self.stage else { return };
        let glossary = GlossaryDialog::new(run.company.numbers.clone());
        self.push_layer(Layer::Dialog(Box::new(glossary)));
    }

    pub(super) fn start_tour(&mut self) {
        self.starts_tour = true;
        let begun = match &self.stage {
            Stage::Menu(menu) => menu.practice_run().map(str::to_owned),
            Stage::Run(_) | Stage::Study(_) => None,
        };
        self.execute_effects(vec![Effect::Request(match begun {
            Some(id) => Request::Open(id, Access::Write),
            None => Request::Create(Box::new(tour::practice_run())),
        })]);
    }

    /// Shows the tour at its first unfinished step.
    pub(super) fn resume_tour(&mut self) {
        let of_practice = self.study.as_ref().is_some_and(StudyState::has_tour);
        if self.has_participant() && !of_practice {
            return self.show_error("this session has no tour");
        }
        let Stage::Run(run) = &mut self.stage else { return };
        if run.company.is_baseline() && !of_practice {
            return self
                .show_error("baseline runs have no tour; Tour in the start menu opens a practice run");
        }
        // The steps of the tour apply only to the practice run.
        if run.company.observation.scenario != tour::scenario() {
            return self.show_error("the tour has its own run; open that run with Tour in the start menu");
        }
        run.tour.get_or_insert_default();
    }

    pub(super) fn skip_tour_step(&mut self) {
        match self.running_tour() {
            Some(tour) => tour.skip_step(),
            None => self.show_error("no tour is shown"),
        }
    }

    pub(super) fn close_tour(&mut self) {
        let Stage::Run(run) = &mut self.stage else { return };
        if run.tour.take().is_none() {
            return self.show_error("no tour is shown");
        }
        let way = match self.keys.label(Action::Tour) {
            Some(key) => key,
            None => format!("{} tour", self.keys.label(Action::Palette).unwrap_or_default()),
        };
        self.show_status(format!("tour closed; {way} resumes the tour"));
    }

    fn running_tour(&mut self) -> Option<&mut tour::Tour> {
        match &mut self.stage {
            Stage::Run(run) => run.tour.as_mut(),
            Stage::Menu(_) | Stage::Study(_) => None,
        }
    }

    pub(super) fn advance_tour(&mut self) {
        let Stage::Run(run) = &mut self.stage else { return };
        let Some(tour) = &mut run.tour else { return };
        let filing = matches!(self.layers.top(), Some(Layer::NextWeek)).then(|| run.next_week.step_number());
        let context = ScreenContext { company: &run.company, keys: &self.keys, page_rows: self.page_rows };
        let group_open =
            run.screen == ScreenId::Customers && run.screens.customers.open_item_title(&context).is_some();
        let facts = TourFacts {
            company: &run.company,
            screen: run.screen,
            back_history: &run.back_history,
            next_week_step: filing,
            has_dialog: !self.layers.is_empty(),
            is_group_open: group_open,
        };
        if !tour.skip_finished_steps(&facts) {
            run.tour = None;
            let last = run.company.observation.last_day;
            self.show_status(format!("tour completed; you can play on until day {last}"));
        }
    }
}
