//! Handlers for the responses of the worker.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::lesson::LessonState;
use super::{App, Layer, Order, Run, Stage};
use crate::action::Action;
use crate::context::{ScreenContext, ScreenId};
use crate::dialogs::final_page::FinalPage;
use crate::dialogs::next_week::NextWeekDialog;
use crate::dialogs::week_report::WeekReportDialog;
use crate::effect::Effect;
use crate::playback::PlaybackViewer;
use crate::screens::Screens;
use crate::tour::Tour;
use novamind_base::formatting::{dollars, signed_dollars};
use novamind_course::CollectedClass;
use novamind_report::RunReport;
use novamind_report::class::ClassDisplayOptions;
use novamind_session::{SettingChange, WeekResult};
use novamind_study::RETURN_LATER_NOTICE;
use novamind_tools::Rejection;
use novamind_tui::text::format_number;
use novamind_worker::company::DisplayedCompany;
use novamind_worker::message::{DebugRunResult, OpenFallback, Response};
use novamind_worker::question::Pending;
use novamind_worker::request::Request;

impl App {
    pub(super) fn handle_response(&mut self, news: Response) {
        match news {
            Response::Runs(done, list) => {
                match done {
                    Some(Ok(text)) => self.show_status(text),
                    Some(Err(problem)) => self.show_error(problem),
                    None => {}
                }
                if let Stage::Menu(menu) = &mut self.stage {
                    let effects = menu.set_runs(list);
                    self.execute_effects(effects);
                }
            }
            Response::ClassRead(read) => self.handle_class_read(*read),
            Response::HandoutOpened(label) => {
                self.resume_command = command_with_student_label(&self.resume_command, &label)
            }
            Response::Opened(company) => self.show_opened_run(company, None),
            Response::PlaybackOpened(company, place) => {
                self.show_opened_run(company, Some(PlaybackViewer::new(*place)))
            }
            Response::RunChanged(company) => self.update_company(company),
            Response::SeekResult(arrival) => self.handle_playback_update(*arrival, true),
            Response::PlaybackAdvanced(arrival) => self.handle_playback_update(*arrival, false),
            Response::NotOpened(problem, instead) => {
                (self.busy, self.initial_screen) = (None, None);
                self.starts_tour = false;
                let asked = matches!(instead, Some(OpenFallback::AskConsent(..)));
                if let Stage::Menu(menu) = &mut self.stage {
                    menu.show_open_error(problem.clone(), instead);
                }
                if !asked && !self.show_page_error(problem.clone()) {
                    self.show_error(problem);
                }
            }
            Response::DaySimulated(day, simulated_day) => {
                if let Some(days) = self.busy.as_mut().and_then(|busy| busy.progress.as_mut()) {
                    (days.current, days.figures) = (day, simulated_day);
                }
            }
            Response::WeekAdvanced(week, company) => self.handle_week_result(week, company),
            Response::DebugDaysSimulated(ran, company) => self.handle_debug_run(ran, company),
            Response::Closed(problem) => self.on_run_closed(problem),
            Response::Crashed(words) => {
                if self.is_hosted {
                    let text =
                        format!("Internal error. All confirmed actions are saved. {RETURN_LATER_NOTICE}");
                    return self.orders.push(Order::Exit(1, Some(text)));
                }
                let saved = self.run().map_or(String::new(), |run| match &run.company.folder {
                    Some(folder) => format!(" All confirmed actions are saved in {}.", folder.display()),
                    None => String::new(),
                });
                let text = format!("internal error: {words}.{saved} Resume with `{}`.", self.resume_command);
                self.orders.push(Order::Exit(1, Some(text)));
            }
            Response::RecordLost(_) if self.is_hosted => {
                let text = "The record of your session cannot be written. Please tell the experimenter.";
                self.orders.push(Order::Exit(3, Some(text.to_owned())));
            }
            Response::RecordLost(words) => self.orders.push(Order::Exit(3, Some(words))),
            Response::QuerySaved(Ok((text, library))) => {
                if let Stage::Run(run) = &mut self.stage {
                    run.screens.sql.set_library(library.clone());
                }
                self.library = library;
                self.show_status(text);
            }
            Response::TimeLeft(left) => {
                if let Stage::Run(run) = &mut self.stage {
                    run.time_left = left;
                }
            }
            Response::Limit(limit) => self.handle_limit(&limit),
            Response::ClockStopped => self.pause_for_limit(),
            Response::Drafts(texts) => self.offer_drafts(*texts),
            Response::QuerySaved(Err(problem)) => self.show_error(problem),
            Response::DatabaseBehind(problem) => {
                if let Stage::Run(run) = &mut self.stage {
                    run.database_error = Some(problem);
                }
            }
            Response::DatabaseCurrent => self.handle_database_complete(),
            Response::NotesSaved(kept, company) => {
                match kept {
                    Ok(()) => self.show_status("notes saved"),
                    Err(rejection) => self.show_error(rejection.to_string()),
                }
                self.update_company(company);
            }
            Response::RunReportReady(report) => self.set_run_report(&report),
            Response::ReportFilesReady(files) => {
                self.write(files.into_iter().map(|(name, text)| (name, text.into_bytes())).collect());
            }
            Response::LessonUpdated(refused, company) => self.handle_lesson_response(refused, company),
            Response::DebriefReady(found) => self.set_debrief(found),
            Response::ProgramEnded(end) => self.show_program_end(end),
            Response::FilesWritten(Ok(text)) => self.show_status(text),
            Response::FilesWritten(Err(problem)) => self.show_error(problem),
            Response::Study(news) => self.handle_study_response(news),
            other => self.handle_run_response(other),
        }
    }

    fn handle_run_response(&mut self, news: Response) {
        if !matches!(self.stage, Stage::Run(_)) {
            return;
        }
        let screen = match &news {
            Response::ToolCalled(tool, answer, company) => {
                // Only the label of a script is removed. If the user has left the run, the label for saving remains.
                self.busy = self.busy.take().filter(|busy| !busy.is_script());
                self.update_company(company.clone());
                match answer {
                    Ok(_) => self.show_status(format!("{tool}: done")),
                    Err(rejection) => self.show_error(format!("{tool}: {rejection}")),
                }
                self.continue_lines(*tool, answer.is_ok());
                ScreenId::Tools
            }
            Response::SettingRestored(what, changes, company) => {
                self.update_company(company.clone());
                match changes {
                    Ok(changes) => self.show_status(format!("{what}: {}", describe_setting_changes(changes))),
                    Err(rejection) => self.show_error(rejection.message.clone()),
                }
                ScreenId::Tools
            }
            _ => return,
        };
        self.update_screens(|screens, here, context| {
            let mut effects = screens.get_mut(screen).handle_response(&news, context);
            if matches!(news, Response::ToolCalled(..)) && here != screen {
                effects.extend(screens.get_mut(here).handle_response(&news, context));
            }
            effects
        });
    }

    /// Updates screens and executes the effects that they return.
    fn update_screens(
        &mut self,
        update: impl FnOnce(&mut Screens, ScreenId, &ScreenContext<'_>) -> Vec<Effect>,
    ) {
        let Stage::Run(run) = &mut self.stage else { return };
        let company = run.company.clone();
        let context = ScreenContext { company: &company, keys: &self.keys, page_rows: self.page_rows };
        let focus = run.screens.get(run.screen).focused_index();
        let effects = update(&mut run.screens, run.screen, &context);
        // A zoomed pane keeps the focus, because the zoomed pane shows the answer.
        if run.zoomed && run.screens.get(run.screen).focused_index() != focus {
            run.screens.get_mut(run.screen).set_focus(focus);
        }
        self.execute_effects(effects);
    }

    pub(super) fn take_answers(&mut self) {
        if let Stage::Menu(menu) = &mut self.stage {
            menu.take_answers();
        }
        self.update_screens(|screens, _, context| {
            let take = |id| screens.get_mut(id).take_answers(context);
            ScreenId::ALL.into_iter().flat_map(take).collect()
        });
        for layer in self.layers.iter_mut() {
            if let Layer::Dialog(dialog) = layer {
                dialog.take_answers();
            }
        }
        self.record_dialog_step();
        self.apply_query_results();
        self.set_hidden_values();
    }

    /// Passes query results to the screens. Playback may request its next week when a screen has all its data.
    fn apply_query_results(&mut self) {
        let Stage::Run(run) = &mut self.stage else { return };
        let answers: Vec<_> = run.requested_queries.values_mut().filter_map(Pending::try_take).collect();
        for (reading, answer) in answers {
            match answer {
                Ok(rows) => self.update_screens(|screens, _, context| {
                    for id in ScreenId::ALL {
                        let screen = screens.get_mut(id);
                        if screen.screen_queries().contains(&reading) {
                            screen.apply_rows(reading, &rows, context);
                        }
                    }
                    Vec::new()
                }),
                Err(rejection) => self.show_error(rejection.to_string()),
            }
            self.request_next_week();
        }
    }

    fn show_opened_run(&mut self, company: Arc<DisplayedCompany>, viewer: Option<PlaybackViewer>) {
        self.busy = None;
        // After taking over a playback, the user stays on the current screen.
        let here =
            self.run().filter(|run| run.playback.is_some()).map_or(ScreenId::Overview, |run| run.screen);
        let here =
            self.initial_screen.take().filter(|screen| screen.is_available_in(&company)).unwrap_or(here);
        self.close_layers();
        let over = !company.is_running() && viewer.is_none();
        let tour = std::mem::take(&mut self.starts_tour).then(Tour::default);
        match company.remarks.last() {
            _ if viewer.is_some() => {
                let help = self.keys.label(Action::Help).unwrap_or_default();
                self.show_status(format!("replay, read-only; {help} shows the keys"));
            }
            Some(remark) => self.show_status(remark.clone()),
            None if company.lesson.is_some() => {
                let key = |action| self.keys.label(action).unwrap_or_default();
                let (task, week) = (key(Action::LessonPage), key(Action::NextWeek));
                self.show_status(format!("{task} shows the task, {week} runs a week"));
            }
            None if company.observation.day == 0 => {
                self.show_status("a new company: 8 shows the tools, n runs a week, ? explains the keys")
            }
            None => self.show_status(format!("day {}: welcome back", company.observation.day)),
        }
        if company.remarks.is_empty()
            && !self.has_participant()
            && let Some(problem) = self.own_commands.problem_summary()
        {
            self.show_error(problem);
        }
        self.stage = Stage::Run(Box::new(Run {
            company: company.clone(),
            screen: here,
            back_history: Vec::new(),
            breadcrumbs: Vec::new(),
            forward_history: Vec::new(),
            zoomed: false,
            shown_since: Some(self.stopwatch.elapsed()),
            previous_screen: None,
            selected: None,
            screens: Screens::default(),
            next_week: NextWeekDialog::default(),
            run_report: None,
            requested_queries: BTreeMap::new(),
            tour,
            playback: viewer,
            lesson: LessonState::default(),
            overlay: Default::default(),
            time_left: Vec::new(),
            database_error: None,
        }));
        if let Stage::Run(run) = &mut self.stage {
            run.screens.sql.set_library(self.library.clone());
        }
        self.reset_drafts();
        self.time_limit = super::time_limits::TimeLimitState::default();
        self.attach_to_run();
        self.refresh_queries();
        // In a study, the participant answers the final questions first.
        if over && !self.has_participant() {
            self.show_final_page();
        }
        self.open_initial_lesson_page();
    }

    /// Shows the final page. Figures from the ledger are added when the ledger has been read.
    pub(super) fn show_final_page(&mut self) {
        if self.show_lesson_end() {
            return;
        }
        let Stage::Run(run) = &self.stage else { return };
        let report = run.run_report.clone();
        if report.is_none() {
            self.execute_effects(vec![Effect::Request(Request::BuildRunReport)]);
        }
        if let Some(study_state) = &mut self.study {
            study_state.has_shown_end = true;
        }
        let page = FinalPage::new(report);
        let page = if self.has_participant() { page.for_participant() } else { page };
        self.push_layer(Layer::Dialog(Box::new(page)));
    }

    fn set_run_report(&mut self, report: &Arc<RunReport>) {
        if let Stage::Run(run) = &mut self.stage {
            run.run_report = Some(report.clone());
        }
        for layer in self.layers.iter_mut() {
            if let Layer::Dialog(dialog) = layer {
                dialog.set_run_report(report);
            }
        }
    }

    pub(super) fn update_company(&mut self, company: Arc<DisplayedCompany>) {
        if let Stage::Run(run) = &mut self.stage {
            run.set_company(company);
            run.requested_queries.clear();
        }
        self.refresh_queries();
    }

    fn handle_database_complete(&mut self) {
        if let Stage::Run(run) = &mut self.stage {
            run.database_error = None;
            run.requested_queries.clear();
        }
        self.show_status("the database is up to date again");
        self.request_screen_data();
    }

    pub(super) fn refresh_queries(&mut self) {
        if let Stage::Run(run) = &mut self.stage {
            let company = run.company.clone();
            let context = ScreenContext { company: &company, keys: &self.keys, page_rows: self.page_rows };
            for id in ScreenId::ALL {
                run.screens.get_mut(id).on_company_change(&context);
            }
        }
        self.request_screen_data();
    }

    fn handle_week_result(
        &mut self,
        week: Result<Box<WeekResult>, Rejection>,
        company: Arc<DisplayedCompany>,
    ) {
        self.busy = None;
        let now = self.stopwatch.elapsed();
        let before = self.run().and_then(|run| run.company.lesson.clone());
        if let Stage::Run(run) = &mut self.stage {
            run.resume_view_timer(now);
        }
        self.update_company(company);
        let week = match week {
            Ok(week) => week,
            Err(rejection) => {
                let text = rejection.to_string();
                if let Stage::Run(run) = &mut self.stage {
                    run.next_week.show_rejection(text.clone());
                    self.push_layer(Layer::NextWeek);
                }
                return self.show_error(text);
            }
        };
        let figures = &week.figures;
        let text = format!(
            "day {}: cash {} ({})",
            figures.day,
            dollars(figures.cash),
            signed_dollars(figures.cash_change)
        );
        if let Stage::Run(run) = &mut self.stage {
            run.next_week = NextWeekDialog::default();
        }
        let ended = week.ended;
        let unfiled = self.take_week_draft_notice();
        let remark = [unfiled, week.remark].into_iter().flatten().collect::<Vec<_>>().join(" ");
        let hides_result = self.run().is_some_and(|run| run.company.rules.hides_result(ended.is_some()));
        self.show_status(if hides_result { "the run has ended".to_owned() } else { text });
        match ended {
            Some(_) if self.has_due_questions() => self.show_status("the run has ended"),
            Some(_) => self.show_final_page(),
            None if self.show_lesson_week(before.as_ref()) => {}
            None => {
                let remark = (!remark.is_empty()).then_some(remark);
                self.push_layer(Layer::Dialog(Box::new(WeekReportDialog::new(remark))));
            }
        }
    }
}

impl App {
    fn handle_debug_run(&mut self, ran: Result<DebugRunResult, Rejection>, company: Arc<DisplayedCompany>) {
        self.busy = None;
        let now = self.stopwatch.elapsed();
        if let Stage::Run(run) = &mut self.stage {
            run.resume_view_timer(now);
            if let Ok(ran) = &ran {
                run.screens.xray.show_run_result(ran);
            }
        }
        self.update_company(company);
        match ran {
            Ok(ran) => {
                self.show_status(ran.lines.first().cloned().unwrap_or_default());
                if ran.has_ended {
                    self.show_final_page();
                }
            }
            Err(rejection) => self.show_error(rejection.to_string()),
        }
    }
}

impl App {
    fn handle_class_read(&mut self, read: Result<(CollectedClass, ClassDisplayOptions), String>) {
        self.busy = None;
        let Stage::Menu(menu) = &mut self.stage else { return };
        match read {
            Ok((class, display_options)) => menu.show_class(class, display_options),
            Err(problem) => {
                menu.show_open_error(problem.clone(), None);
                self.show_error(problem);
            }
        }
    }
}

fn command_with_student_label(again: &str, label: &str) -> String {
    let head = again.strip_suffix("--run latest").unwrap_or(again);
    let head = head.rsplit_once("--as ").map_or(head, |(before, _)| before);
    format!("{head}--as {label} --run latest")
}

fn describe_setting_changes(changes: &[SettingChange]) -> String {
    let one = |change: &SettingChange| {
        format!("{} {} → {}", change.setting, format_number(change.old), format_number(change.new))
    };
    match changes {
        [first, second, rest @ ..] if !rest.is_empty() => {
            format!("{}, {} and {} more", one(first), one(second), rest.len())
        }
        _ => changes.iter().map(one).collect::<Vec<_>>().join(", "),
    }
}
