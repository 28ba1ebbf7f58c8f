//! Converts effects into orders.

use super::{App, Busy, Closing, DaysRun, Layer, Order, Stage};
use crate::context::ScreenId;
use crate::dialogs::confirm::Confirm;
use crate::dialogs::reader::Reader;
use crate::effect::Effect;
use novamind_record::trajectory::record::DraftOutcome;
use novamind_session::Goal;
use novamind_worker::Job;
use novamind_worker::company::Company;
use novamind_worker::request::Request;

/// Days per week, in which lessons count the weeks before their start.
const DAYS_PER_WEEK: u32 = 7;

/// Returns the days that a lesson simulates before it starts.
fn days_of_start(request: &Request) -> Option<DaysRun> {
    let Request::Create(new) = request else { return None };
    let entry = new.lesson.as_ref()?;
    let weeks = entry.lesson.plan.parts.get(entry.part)?.start_weeks;
    (weeks > 0).then(|| DaysRun::between(0, weeks * DAYS_PER_WEEK))
}

/// Returns the last day that a request simulates unless it stops earlier.
fn last_day_of(request: &Request, company: &Company) -> u32 {
    match request {
        Request::RunDays(days) => company.seen.day.saturating_add(*days).min(company.seen.last_day),
        _ => company.next_decision_day,
    }
}

impl App {
    pub(super) fn follow(&mut self, effects: Vec<Effect>) {
        for effect in effects {
            self.follow_one(effect);
        }
    }

    fn follow_one(&mut self, effect: Effect) {
        if effect.changes_run() && self.is_replay() {
            return self.complain_of_replay();
        }
        match effect {
            Effect::Request(request) => {
                self.is_projected &= !matches!(request, Request::Replay { .. });
                self.request(request);
            }
            Effect::Project(recorded) => {
                self.is_projected = true;
                self.request(Request::Replay { recorded, goal: Goal::Last, follow: true });
            }
            Effect::ReplayInside(recorded, goal) => {
                self.opens_on = Some(ScreenId::Xray);
                self.request(Request::Replay { recorded, goal, follow: false });
            }
            Effect::Go(goal) => self.go(goal),
            Effect::Ask(ask) => self.orders.push(Order::Ask(ask, self.busy.is_some())),
            Effect::SentText(place) => self.end_text(place, DraftOutcome::Sent),
            Effect::ShowCurve(group) => self.show_curve(group),
            Effect::ShowOpponents => self.show_opponents(),
            Effect::OpenRun(id) => self.open_other(id),
            Effect::ConfirmWords(words) => {
                let text = format!(
                    "{words}: the change is recorded, and the run will not be ranked. Set the parameter?"
                );
                self.lay(Layer::Dialog(Box::new(Confirm::new("set", text, vec![Effect::SendWords(words)]))));
            }
            Effect::SendWords(_) if self.busy.is_some() => {
                self.complain("days are running; nothing was set, try again when they are done");
            }
            Effect::SendWords(words) => {
                if let Stage::Run(run) = &mut self.stage {
                    let effects = run.screens.xray.send_words(&words);
                    self.follow(effects);
                }
            }
            Effect::CancelQuery => self.orders.push(Order::CancelQuery),
            Effect::Read(reading) => {
                if let Stage::Run(run) = &mut self.stage {
                    run.asked.remove(&reading);
                }
                self.load();
            }
            Effect::Copy(text) => {
                self.say(format!("copied: {}", novamind_tui::canvas::fit(&text, 60)));
                self.orders.push(Order::Copy(text));
            }
            Effect::ShowText(title, text) => {
                self.lay(Layer::Dialog(Box::new(Reader::new(title, text))));
            }
            Effect::Write(name, contents) => self.write(vec![(name.as_str(), contents)]),
            Effect::Say(text) => self.say(text),
            Effect::AskWhy(figure) => self.ask_why(figure),
            Effect::ShowRows(figure) => self.show_rows_of(figure),
            Effect::CloseDialogs => self.close_layers(),
            Effect::Complain(text) => self.complain(text),
            Effect::BeginPath => {
                if let Stage::Run(run) = &mut self.stage {
                    run.forget_trail();
                }
            }
            Effect::Show(screen) => self.lead_to(screen, |_| {}),
            Effect::ShowTool(tool) => self.lead_to(ScreenId::Tools, |run| {
                let company = run.company.clone();
                run.screens.tools.show(tool, &company);
            }),
            Effect::ShowCell(tool, of) => self.lead_to(ScreenId::Tools, |run| {
                let company = run.company.clone();
                run.screens.tools.show_cell(tool, &of, &company);
            }),
            Effect::Prefill { tool, arguments } => {
                let mut effects = Vec::new();
                self.lead_to(ScreenId::Tools, |run| {
                    let company = run.company.clone();
                    effects = run.screens.tools.prefill(tool, &arguments, &company);
                });
                // The screen that shows the call requests its preview.
                self.follow(effects);
            }
            Effect::ShowThread(number) => self.lead_to(ScreenId::Inbox, |run| {
                let company = run.company.clone();
                run.screens.inbox.show(number, &company);
            }),
            Effect::ShowGroup(screen, group) => self.lead_to(screen, |run| match screen {
                ScreenId::Market => run.screens.market.show(group),
                _ => run.screens.customers.show(group, &run.company),
            }),
            Effect::EditSql(sql) => self.lead_to(ScreenId::Sql, |run| run.screens.sql.edit(&sql)),
            Effect::RunSql(sql) => {
                let mut effects = Vec::new();
                self.lead_to(ScreenId::Sql, |run| effects = run.screens.sql.edit_and_run(&sql));
                self.follow(effects);
            }
            Effect::SaveQuery { name, title, sql } => self.save_query([name, title, sql]),
            Effect::ConfirmCall { tool, arguments, text } => {
                let confirm = Confirm::new(tool.name(), text, vec![Effect::call(tool, arguments)]);
                self.lay(Layer::Dialog(Box::new(confirm)));
            }
            Effect::ConfirmCalls { calls, text } => {
                let calls = calls.into_iter().map(|(tool, arguments)| Effect::call(tool, arguments));
                let confirm = Confirm::new("send by rules", text, calls.collect());
                self.lay(Layer::Dialog(Box::new(confirm)));
            }
            Effect::Explain(subject) => self.explain_subject(subject),
            Effect::TryStepAgain(step) => self.ask_to_try_again(step),
            Effect::ShowDebrief => self.show_debrief(),
            Effect::StartTour => self.start_tour(),
            Effect::Receive(study) => self.receive(study),
            Effect::SettleOffer(restore) => self.settle_offer(restore),
            Effect::StopClock(reason) => self.stop_clock(reason, false),
            Effect::LeaveNow => self.leave(Closing::ToShell),
            Effect::Do(action) => self.act(action),
        }
    }

    /// Sends a request to the session thread, unless it is rejected while a week runs.
    pub(super) fn request(&mut self, request: Request) {
        if self.keeps_from_participant(&request) {
            return;
        }
        self.note_request(&request);
        if request.waits_for_week()
            && let Some(busy) = &self.busy
        {
            let what = if busy.is_script() { "a script is running" } else { "a week is running" };
            return self.complain(format!("{what}; nothing was sent, try again when it is done"));
        }
        let leaves_run = matches!(request, Request::Open(..)) && matches!(self.stage, Stage::Run(_));
        if leaves_run || matches!(request, Request::Replay { .. }) {
            self.put_down();
        }
        if let Some(what) = request.busy_with() {
            let is_advance = request.lets_time_pass();
            if self.busy.is_some() {
                return if is_advance {
                    self.complain("days are running already")
                };
            }
            if is_advance {
                // The drafts and the view belong to the week that ends.
                self.send_texts(&request);
                self.close_view();
                if let Stage::Run(run) = &mut self.stage {
                    run.stop_looking();
                }
            }
            let days = self
                .run()
                .filter(|_| is_advance)
                .map(|run| DaysRun::between(run.company.seen.day, last_day_of(&request, &run.company)))
                .or_else(|| days_of_start(&request));
            self.busy = Some(Busy { days, ..Busy::with(what) });
        }
        self.send_texts(&request);
        if matches!(request, Request::WriteReport) {
            self.say("writing the report …");
        }
        self.orders.push(Order::Job(Job::Do(request)));
    }

    fn save_query(&mut self, query: [String; 3]) {
        if self.leads_participant() {
            // The query would be visible to the next participant.
            return self.complain_of_visit();
        }
        match self.configuration.folder {
            Some(_) => self.orders.push(Order::SaveQuery(self.configuration.clone(), query)),
            None => self.complain("cannot save the query: there is no configuration folder"),
        }
    }

    pub(super) fn write(&mut self, files: Vec<(&str, Vec<u8>)>) {
        let folder = self.run().and_then(|run| run.company.folder.clone());
        match folder {
            Some(folder) => {
                let files = files.into_iter().map(|(name, contents)| (folder.join(name), contents));
                self.orders.push(Order::Write(files.collect()));
            }
            None => self.complain("cannot write files: this run is in memory and has no folder"),
        }
    }
}
