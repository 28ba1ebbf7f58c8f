//! Converts effects into orders.

use super::{App, BusyState, ExitTarget, Layer, Order, SimulationProgress, Stage};
use crate::context::ScreenId;
use crate::dialogs::confirm::ConfirmDialog;
use crate::dialogs::text_dialog::TextDialog;
use crate::effect::Effect;
use crate::hosted;
use novamind_record::trajectory::record::TextEditOutcome;
use novamind_session::SeekTarget;
use novamind_worker::Job;
use novamind_worker::company::DisplayedCompany;
use novamind_worker::request::Request;

/// Days per week, for the weeks that a lesson simulates before its start.
const DAYS_PER_WEEK: u32 = 7;

/// Returns the days that a lesson simulates before it starts.
fn lesson_start_progress(request: &Request) -> Option<SimulationProgress> {
    let Request::Create(new) = request else { return None };
    let entry = new.lesson.as_ref()?;
    let weeks = entry.lesson.plan.parts.get(entry.part)?.start_weeks;
    (weeks > 0).then(|| SimulationProgress::new(0, weeks * DAYS_PER_WEEK))
}

/// Returns the last day that a request simulates, unless the simulation stops earlier.
fn last_simulated_day(request: &Request, company: &DisplayedCompany) -> u32 {
    match request {
        Request::RunDays(days) => {
            company.observation.day.saturating_add(*days).min(company.observation.last_day)
        }
        _ => company.next_decision_day,
    }
}

impl App {
    pub(super) fn execute_effects(&mut self, effects: Vec<Effect>) {
        for effect in effects {
            self.execute_effect(effect);
        }
    }

    fn execute_effect(&mut self, effect: Effect) {
        if effect.changes_run() && self.is_playback() {
            return self.show_playback_error();
        }
        match effect {
            Effect::Request(request) => {
                self.is_projected &= !matches!(request, Request::Replay { .. });
                self.send_request(request);
            }
            Effect::OpenProjector(recorded) => {
                self.is_projected = true;
                self.send_request(Request::Replay { recorded, goal: SeekTarget::Last, follow: true });
            }
            Effect::ReplayWithXray(recorded, goal) => {
                self.initial_screen = Some(ScreenId::Xray);
                self.send_request(Request::Replay { recorded, goal, follow: false });
            }
            Effect::Seek(goal) => self.seek(goal),
            Effect::Ask(ask) => self.orders.push(Order::Ask(ask, self.busy.is_some())),
            Effect::SentText(place) => self.end_draft(place, TextEditOutcome::Sent),
            Effect::ShowCurve(group) => self.show_curve(group),
            Effect::ShowOpponents => self.show_opponents(),
            Effect::OpenRun(id) => self.open_other_run(id),
            Effect::ConfirmCommand(words) => {
                let text = format!(
                    "{words}: the change is recorded, and the run will not be ranked. Set the parameter?"
                );
                self.push_layer(Layer::Dialog(Box::new(ConfirmDialog::new(
                    "set",
                    text,
                    vec![Effect::SendCommand(words)],
                ))));
            }
            Effect::SendCommand(_) if self.busy.is_some() => {
                self.show_error("days are being simulated; no parameter was set. Try again afterwards");
            }
            Effect::SendCommand(words) => {
                if let Stage::Run(run) = &mut self.stage {
                    let effects = run.screens.xray.send_confirmed_command(&words);
                    self.execute_effects(effects);
                }
            }
            Effect::CancelQuery => self.orders.push(Order::CancelQuery),
            Effect::Read(reading) => {
                if let Stage::Run(run) = &mut self.stage {
                    run.requested_queries.remove(&reading);
                }
                self.request_screen_data();
            }
            Effect::Copy(text) => {
                self.show_status(format!("copied: {}", novamind_tui::canvas::truncate_to_width(&text, 60)));
                self.orders.push(Order::Copy(text));
            }
            Effect::ShowText(title, text) => {
                self.push_layer(Layer::Dialog(Box::new(TextDialog::new(title, text))));
            }
            Effect::Write(name, contents) => self.write(vec![(name.as_str(), contents)]),
            Effect::ShowStatus(text) => self.show_status(text),
            Effect::ShowCauses(figure) => self.show_causes(figure),
            Effect::ShowRows(figure) => self.show_source_rows(figure),
            Effect::CloseDialogs => self.close_layers(),
            Effect::ShowError(text) => self.show_error(text),
            Effect::ArrangeColumns(layout) => self.arrange_columns(layout),
            Effect::ClearBreadcrumbs => {
                if let Stage::Run(run) = &mut self.stage {
                    run.clear_breadcrumbs();
                }
            }
            Effect::Show(screen) => self.open_linked_screen(screen, |_| {}),
            Effect::ShowTool(tool) => self.open_linked_screen(ScreenId::Tools, |run| {
                let company = run.company.clone();
                run.screens.tools.show_tool(tool, &company);
            }),
            Effect::ShowCell(tool, of) => self.open_linked_screen(ScreenId::Tools, |run| {
                let company = run.company.clone();
                run.screens.tools.show_cell(tool, &of, &company);
            }),
            Effect::Prefill { tool, arguments } => {
                let mut effects = Vec::new();
                self.open_linked_screen(ScreenId::Tools, |run| {
                    let company = run.company.clone();
                    effects = run.screens.tools.prefill(tool, &arguments, &company);
                });
                // The Tools screen requests a preview of the filled-in call.
                self.execute_effects(effects);
            }
            Effect::ShowThread(number) => self.open_linked_screen(ScreenId::Inbox, |run| {
                let company = run.company.clone();
                run.screens.inbox.show_thread(number, &company);
            }),
            Effect::ShowGroup(screen, group) => self.open_linked_screen(screen, |run| match screen {
                ScreenId::Market => run.screens.market.show_group(group),
                _ => run.screens.customers.show_group(group, &run.company),
            }),
            Effect::EditSql(sql) => {
                self.open_linked_screen(ScreenId::Sql, |run| run.screens.sql.set_statement(&sql))
            }
            Effect::RunSql(sql) => {
                let mut effects = Vec::new();
                self.open_linked_screen(ScreenId::Sql, |run| effects = run.screens.sql.edit_and_run(&sql));
                self.execute_effects(effects);
            }
            Effect::SaveQuery { name, title, sql } => self.save_query([name, title, sql]),
            Effect::ConfirmCall { tool, arguments, text } => {
                let confirm = ConfirmDialog::new(tool.name(), text, vec![Effect::call(tool, arguments)]);
                self.push_layer(Layer::Dialog(Box::new(confirm)));
            }
            Effect::ConfirmCalls { calls, text } => {
                let calls = calls.into_iter().map(|(tool, arguments)| Effect::call(tool, arguments));
                let confirm = ConfirmDialog::new("send by rules", text, calls.collect());
                self.push_layer(Layer::Dialog(Box::new(confirm)));
            }
            Effect::RunOwnCommand(at) => self.run_own_command(at),
            Effect::RunLines(at) => self.run_lines(at),
            Effect::Explain(subject) => self.open_subject(subject),
            Effect::TryStepAgain(step) => self.confirm_retry(step),
            Effect::ShowDebrief => self.open_debrief(),
            Effect::StartTour => self.start_tour(),
            Effect::StartStudy(study) => self.start_study(study, None),
            Effect::StartHostedSession(study, label) => self.start_study(study, Some(label)),
            Effect::ResolveDraftOffer(restore) => self.resolve_draft_offer(restore),
            Effect::StopClock(reason) => self.stop_clock(reason, false),
            Effect::LeaveNow => self.exit_run(ExitTarget::Shell),
            Effect::Execute(action) => self.handle_action(action),
        }
    }

    /// Sends a request to the session thread. Some requests are rejected while a week or a script runs.
    pub(super) fn send_request(&mut self, request: Request) {
        if self.reject_for_participant(&request) {
            return;
        }
        self.update_study_for_request(&request);
        if request.is_rejected_during_week()
            && let Some(busy) = &self.busy
        {
            let what = if busy.is_script() { "a script is running" } else { "a week is running" };
            return self.show_error(format!("{what}; no request was sent. Try again afterwards"));
        }
        let leaves_run = matches!(request, Request::Open(..)) && matches!(self.stage, Stage::Run(_));
        if leaves_run || matches!(request, Request::Replay { .. }) {
            self.detach_from_run();
        }
        if let Some(what) = request.busy_label() {
            let is_advance = request.simulates_days();
            if self.busy.is_some() {
                return if is_advance {
                    self.show_error("days are already being simulated")
                };
            }
            if is_advance {
                // The drafts and the view of the screen are recorded in the week that ends.
                self.record_sent_drafts(&request);
                self.record_view();
                if let Stage::Run(run) = &mut self.stage {
                    run.pause_view_timer();
                }
            }
            let days = self
                .run()
                .filter(|_| is_advance)
                .map(|run| {
                    SimulationProgress::new(
                        run.company.observation.day,
                        last_simulated_day(&request, &run.company),
                    )
                })
                .or_else(|| lesson_start_progress(&request));
            self.busy = Some(BusyState { progress: days, ..BusyState::new(what) });
        }
        self.record_sent_drafts(&request);
        if matches!(request, Request::RenderReportFiles) {
            self.show_status("writing the report …");
        }
        self.orders.push(Order::Job(Job::Execute(request)));
    }

    fn save_query(&mut self, query: [String; 3]) {
        if self.has_participant() {
            // A saved query would be visible to the next participant.
            return self.show_participant_error();
        }
        match self.configuration.folder {
            Some(_) => self.orders.push(Order::SaveQuery(self.configuration.clone(), query)),
            None => self.show_error("cannot save the query: there is no configuration folder"),
        }
    }

    pub(super) fn write(&mut self, files: Vec<(&str, Vec<u8>)>) {
        if self.is_hosted {
            return self.show_error(format!("files: {}", hosted::NOT_AVAILABLE));
        }
        let folder = self.run().and_then(|run| run.company.folder.clone());
        match folder {
            Some(folder) => {
                let files = files.into_iter().map(|(name, contents)| (folder.join(name), contents));
                self.orders.push(Order::Write(files.collect()));
            }
            None => self.show_error("cannot write files: this run is in memory and has no folder"),
        }
    }
}
