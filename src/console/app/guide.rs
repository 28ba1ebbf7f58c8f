//! Explanations, the glossary and the tour.

use super::{App, Layer, Stage};
use crate::action::{Action, Scope};
use crate::context::ScreenId;
use crate::dialogs::DialogView;
use crate::dialogs::explanation::ExplainDialog;
use crate::dialogs::glossary::GlossaryDialog;
use crate::effect::Effect;
use crate::study_pages::StudyState;
use crate::tour::{self, NextWeekFacts, TourFacts};
use novamind_glossary::Subject;
use novamind_session::Access;
use novamind_worker::request::Request;

/// Name of the query for cancelled subscribers.
const CANCELLATIONS_QUERY: &str = "issues-of-leavers";

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
        let started = match &self.stage {
            Stage::Menu(menu) => menu.tour_run().map(str::to_owned),
            Stage::Run(_) | Stage::Study(_) => None,
        };
        self.execute_effects(vec![Effect::Request(match started {
            Some(id) => Request::Open(id, Access::Write),
            None => Request::Create(Box::new(tour::tour_run())),
        })]);
    }

    /// Shows the tour at its first unfinished step.
    pub(super) fn resume_tour(&mut self) {
        let is_practice_with_tour = self.study.as_ref().is_some_and(StudyState::has_tour);
        if self.has_participant() && !is_practice_with_tour {
            return self.show_error("this session has no tour");
        }
        let Stage::Run(run) = &mut self.stage else { return };
        if run.company.is_baseline() && !is_practice_with_tour {
            return self
                .show_error("baseline runs have no tour; Tour in the start menu opens a run for the tour");
        }
        // The settings that the tour proposes suit the tour's own run and a practice run.
        let seen = &run.company.observation;
        if !is_practice_with_tour
            && !tour::is_tour_run(&seen.scenario, seen.seed.unwrap_or_default(), seen.last_day)
        {
            return self.show_error("the tour has its own run; open that run with Tour in the start menu");
        }
        run.tour.get_or_insert_default();
    }

    pub(super) fn continue_tour(&mut self) {
        let Stage::Run(run) = &mut self.stage else { return };
        match &mut run.tour {
            Some(tour) if tour.is_step_done(&run.company) => tour.continue_to_next_step(),
            Some(tour) => {
                let close = self.keys.label(Action::TourClose).unwrap_or_default();
                // The key that continues is among the keys after →, so the message names the first key.
                let task = match tour.key_groups().first() {
                    Some(group) if group.presses.is_empty() => group.effect.clone(),
                    Some(group) => format!("press {} first", group.label()),
                    None => "press the keys after →".to_owned(),
                };
                self.show_error(format!("this step is not done: {task}; {close} closes the tour"));
            }
            None => self.show_error("no tour is shown"),
        }
    }

    pub(super) fn return_to_previous_tour_step(&mut self) {
        let Stage::Run(run) = &mut self.stage else { return };
        match run.tour.as_mut().map(|tour| tour.go_back(&run.company)) {
            Some(true) => {}
            Some(false) => self.show_error("this is the first step of the tour"),
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

    pub(super) fn advance_tour(&mut self) {
        let Some(facts) = self.tour_facts() else { return };
        let (scopes, layer) = facts;
        let Stage::Run(run) = &mut self.stage else { return };
        let Some(tour) = &mut run.tour else { return };
        let is_on = |screen| run.screen == screen && !layer.is_open;
        let facts = TourFacts {
            company: &run.company,
            screen: run.screen,
            is_typing: scopes.first().is_some_and(|scope| scope.is_text()),
            scopes,
            has_dialog: layer.is_open,
            dialog: layer.view,
            next_week: NextWeekFacts {
                open_step: layer.is_next_week.then(|| run.next_week.step_number()),
                has_rationale: !run.next_week.draft().0.trim().is_empty(),
            },
            customers: run.screens.customers.tour_facts(&run.company),
            form: is_on(ScreenId::Tools).then(|| run.screens.tools.tour_facts()).flatten(),
            shows_cancellations: run.screens.sql.shows_rows_of(CANCELLATIONS_QUERY),
        };
        if !tour.update(&facts, &self.keys) {
            run.tour = None;
            let last = run.company.observation.last_day;
            self.show_status(format!("tour completed; you can play on until day {last}"));
        }
    }

    /// Returns the key scopes and the top layer, while a tour is shown.
    fn tour_facts(&self) -> Option<(Vec<Scope>, TopLayer)> {
        self.run()?.tour.as_ref()?;
        let top = self.layers.top();
        let layer = TopLayer {
            is_open: top.is_some(),
            is_next_week: matches!(top, Some(Layer::NextWeek)),
            view: match top {
                Some(Layer::Dialog(dialog)) => dialog.tour_view(),
                Some(Layer::NextWeek) | None => None,
            },
        };
        Some((self.scopes(), layer))
    }
}

/// The top dialog, as far as the tour depends on it.
struct TopLayer {
    is_open: bool,
    is_next_week: bool,
    view: Option<DialogView>,
}
