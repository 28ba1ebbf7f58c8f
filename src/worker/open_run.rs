//! The open run on the session thread: calls, weeks, notes and reports.

use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use serde_json::Value;

use super::DAY_REPORT_INTERVAL;
use super::queries::QueryThreads;
use crate::company::DisplayedCompany;
use crate::message::{DebugRunResult, Message, Response, SimulatedDay};
use novamind_database::Interrupt;
use novamind_insight::Inspect;
use novamind_record::trajectory::record::Via;
use novamind_report::inspection::describe_stop;
use novamind_report::{RunReport, report_to_html, report_to_markdown};
use novamind_session::{DayReport, Forecasts, RunDatabase, Session};
use novamind_tools::ToolId;

/// The open run, with the channels and handles that its operations use.
pub(super) struct OpenRun<'a> {
    pub(super) session: &'a mut Session,
    pub(super) last_company: &'a mut Option<Arc<DisplayedCompany>>,
    pub(super) messages: &'a Sender<Message>,
    pub(super) queries: &'a QueryThreads,
    pub(super) interrupt: &'a Mutex<Option<Interrupt>>,
}

impl OpenRun<'_> {
    pub(super) fn company(&mut self) -> Arc<DisplayedCompany> {
        let company =
            Arc::new(DisplayedCompany::from_session_with_lesson(self.session, self.last_company.as_deref()));
        *self.last_company = Some(company.clone());
        company
    }

    pub(super) fn call_tool(&mut self, tool: ToolId, arguments: &Value) -> Response {
        let hold = |interrupt| *self.interrupt.lock().unwrap_or_else(PoisonError::into_inner) = interrupt;
        hold(
            self.session
                .up_to_date_database()
                .and_then(RunDatabase::interrupt_handle)
                .ok()
                .filter(|_| tool.executes_code()),
        );
        let answer = self.session.call(tool, arguments, Via::Form).map(Box::new);
        hold(None);
        Response::ToolCalled(tool, answer, self.company())
    }

    pub(super) fn undo(&mut self) -> Response {
        let changes = self.session.undo(Via::Palette);
        Response::SettingRestored("undone", changes, self.company())
    }

    pub(super) fn redo(&mut self) -> Response {
        let changes = self.session.redo(Via::Palette);
        Response::SettingRestored("redone", changes, self.company())
    }

    pub(super) fn advance(&mut self, rationale: &str, forecasts: &Forecasts) -> Response {
        let mut report_day = day_reporter(self.messages);
        let week = self.session.advance(rationale, forecasts, Via::Form, &mut report_day);
        Response::WeekAdvanced(week.map(Box::new), self.company())
    }

    pub(super) fn run_days(&mut self, days: u32) -> Response {
        let mut report_day = day_reporter(self.messages);
        let breakpoints = self.session.inspect().breakpoints().map_or(0, |set| set.len());
        let run = self.session.inspect().run_until_breakpoint(days, &mut report_day);
        let ran = run.map(|run| DebugRunResult {
            lines: describe_stop(&run, self.session.day(), breakpoints),
            has_ended: run.week.ended.is_some(),
        });
        Response::DebugDaysSimulated(ran, self.company())
    }

    pub(super) fn set_notes(&mut self, text: &str) -> Response {
        let kept = self.session.set_notes(text);
        Response::NotesSaved(kept, self.company())
    }

    pub(super) fn build_run_report(&mut self) -> Response {
        Response::RunReportReady(Arc::new(RunReport::from_session(self.session)))
    }

    pub(super) fn render_report_files(&mut self) -> Response {
        let run_report = RunReport::from_session(self.session);
        Response::ReportFilesReady(vec![
            ("report.md", report_to_markdown(&run_report)),
            ("report.html", report_to_html(&run_report)),
        ])
    }
}

/// Returns a function that reports a simulated day to the console, at most once per [`DAY_REPORT_INTERVAL`].
pub(super) fn day_reporter(news: &Sender<Message>) -> impl FnMut(&DayReport<'_>) + use<> {
    let (news, mut instant) = (news.clone(), Instant::now());
    move |report| {
        if instant.elapsed() >= DAY_REPORT_INTERVAL {
            instant = Instant::now();
            let figures = report.figures;
            let simulated_day =
                SimulatedDay { cash: figures.cash, subscribers: figures.individual_subscribers };
            let _ = news.send(Message::Response(Response::DaySimulated(figures.day, Some(simulated_day))));
        }
    }
}
