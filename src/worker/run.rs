//! The open run on the session thread: calls, weeks, notes and reports.

use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use serde_json::Value;

use super::BETWEEN_DAYS;
use super::queries::QueryThreads;
use crate::company::Company;
use crate::message::{DayTold, DaysRan, Message, News};
use novamind_database::Interrupt;
use novamind_insight::Inspect;
use novamind_record::trajectory::record::Via;
use novamind_report::xray::stop_in_words;
use novamind_report::{Story, as_html, as_markdown};
use novamind_session::{DayReport, Forecasts, RunDatabase, Session};
use novamind_tools::ToolId;

/// The open run, with where its messages are sent.
pub(super) struct OpenRun<'a> {
    pub(super) session: &'a mut Session,
    pub(super) shown: &'a mut Option<Arc<Company>>,
    pub(super) news: &'a Sender<Message>,
    pub(super) queries: &'a QueryThreads,
    pub(super) stop: &'a Mutex<Option<Interrupt>>,
}

impl OpenRun<'_> {
    pub(super) fn company(&mut self) -> Arc<Company> {
        let company = Arc::new(Company::in_lesson(self.session, self.shown.as_deref()));
        *self.shown = Some(company.clone());
        company
    }

    pub(super) fn call(&mut self, tool: ToolId, arguments: &Value) -> News {
        let hold = |own| *self.stop.lock().unwrap_or_else(PoisonError::into_inner) = own;
        hold(
            self.session
                .complete_database()
                .and_then(RunDatabase::interrupt)
                .ok()
                .filter(|_| tool.runs_code()),
        );
        let answer = self.session.call(tool, arguments, Via::Form).map(Box::new);
        hold(None);
        News::Called(tool, answer, self.company())
    }

    pub(super) fn undo(&mut self) -> News {
        let changes = self.session.undo(Via::Palette);
        News::Restored("undone", changes, self.company())
    }

    pub(super) fn redo(&mut self) -> News {
        let changes = self.session.redo(Via::Palette);
        News::Restored("redone", changes, self.company())
    }

    pub(super) fn advance(&mut self, rationale: &str, forecasts: &Forecasts) -> News {
        let mut tell = tell_days(self.news);
        let week = self.session.advance(rationale, forecasts, Via::Form, &mut tell);
        News::Advanced(week.map(Box::new), self.company())
    }

    pub(super) fn run_days(&mut self, days: u32) -> News {
        let mut tell = tell_days(self.news);
        let breakpoints = self.session.inspect().breakpoints().map_or(0, |set| set.len());
        let run = self.session.inspect().run_until_breakpoint(days, &mut tell);
        let ran = run.map(|run| DaysRan {
            lines: stop_in_words(&run, self.session.day(), breakpoints),
            is_over: run.week.ended.is_some(),
        });
        News::Ran(ran, self.company())
    }

    pub(super) fn set_memo(&mut self, text: &str) -> News {
        let kept = self.session.set_memo(text);
        News::MemoKept(kept, self.company())
    }

    pub(super) fn tell_story(&mut self) -> News {
        News::Told(Arc::new(Story::of(self.session)))
    }

    pub(super) fn write_report(&mut self) -> News {
        let story = Story::of(self.session);
        News::Reported(vec![("report.md", as_markdown(&story)), ("report.html", as_html(&story))])
    }
}

/// Returns a function that reports simulated days, with a minimum interval.
pub(super) fn tell_days(news: &Sender<Message>) -> impl FnMut(&DayReport<'_>) + use<> {
    let (news, mut told) = (news.clone(), Instant::now());
    move |report| {
        if told.elapsed() >= BETWEEN_DAYS {
            told = Instant::now();
            let figures = report.figures;
            let told = DayTold { cash: figures.cash, subscribers: figures.individual_subscribers };
            let _ = news.send(Message::News(News::Day(figures.day, Some(told))));
        }
    }
}
