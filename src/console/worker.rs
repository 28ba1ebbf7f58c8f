//! The threads behind the screen: one that owns the session, two that ask the database.
//!
//! The screen sends jobs and never waits; what comes of them returns as news through the channel that also
//! carries the input. A query waits for the session's thread, so that it sees everything that was confirmed,
//! unless a week is running: then it sees the state before it.

mod mending;
mod player;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use serde_json::Value;

use super::company::Company;
use super::message::{Instead, Message, News};
use super::preferences::Preferences;
use super::readings::Reading;
use crate::database::query::Limits;
use crate::report::{Story, as_html, as_markdown};
use crate::session::{
    Access, Configuration, Forecasts, Goal, Interrupt, Mode, NewRun, Playback, QueryConnection, Refusal,
    Rows, RunError, Session, Ticket, Via, delete_run, end_run, find_run, find_run_to_read, list_runs,
    run_history,
};
use crate::tools::ToolId;

/// Work for the session's thread.
pub enum Job {
    /// List the runs of a folder.
    List(PathBuf),
    /// How a run of a folder went.
    Course(PathBuf, String),
    /// Give up a run of a folder.
    EndRun(PathBuf, String),
    /// Delete a run of a folder.
    DeleteRun(PathBuf, String),
    /// Start a run.
    Create(Box<NewRun>),
    /// Open a run of a folder by its id, to go on with it or to look at it.
    Open(PathBuf, String, Access),
    /// Play a run of a folder again, or a file: where it begins, and whether new lines are awaited.
    Replay(PathBuf, Recorded, Goal, bool),
    /// Go somewhere in the replay, unless it is stopped on the way.
    Go(Goal, Arc<AtomicBool>),
    /// Go a week on in the replay after a while.
    GoOn(Duration),
    /// Do not go on.
    Hold,
    /// Go on from this moment of the replay in a run of one's own.
    TakeOver(Mode),
    /// Open the good beginning of a damaged run of a folder as a branch.
    Rescue(PathBuf, String),
    /// What a call would do.
    Check(u64, ToolId, Value),
    /// Call a tool.
    Call(ToolId, Value),
    /// Take back the last setting.
    Undo,
    /// Set again what the last undo took back.
    Redo,
    /// Let the week pass.
    Advance(String, Forecasts),
    /// Pass a question on once everything confirmed is in the database.
    Ask(Question),
    /// Record what the person asked.
    NoteQuery(String, Result<Rows, Refusal>, Duration),
    /// Record what the person looked at: screen, screen before, milliseconds.
    NoteView(&'static str, &'static str, u64),
    /// Keep the notes.
    SetMemo(String),
    /// Tell the story of the run.
    Tell,
    /// Put the report of the run into words.
    Report,
    /// Start with this look the next time, too. One after the other: what was chosen last counts.
    Remember(Preferences),
    /// Save and close the run.
    Close,
    /// Save, close the run and end the thread.
    End,
}

/// A run that was recorded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Recorded {
    /// One of the folder of runs, by its id.
    Run(String),
    /// A folder of a run or a trajectory file anywhere.
    File(PathBuf),
}

/// A question for the database.
pub struct Question {
    sql: String,
    asker: Asker,
}

enum Asker {
    Person(u64, Option<Ticket>),
    Screen(Reading, u64),
}

impl Question {
    /// A question of the person, with its number and with the ticket by which it can be stopped.
    pub fn of_person(sql: String, number: u64, ticket: Option<Ticket>) -> Question {
        Question { sql, asker: Asker::Person(number, ticket) }
    }

    /// A question of a screen, with the number of changes of the run before it.
    pub fn of_screen(reading: Reading, changes: u64) -> Question {
        Question { sql: reading.sql().to_owned(), asker: Asker::Screen(reading, changes) }
    }
}

/// The desks' side of a channel: the person's questions and those of screens do not wait for each other.
#[derive(Clone)]
struct Desks {
    person: Sender<DeskJob>,
    screens: Sender<DeskJob>,
}

enum DeskJob {
    Take(Box<QueryConnection>, Limits),
    Ask(Question),
    Leave,
}

impl Desks {
    fn ask(&self, question: Question) {
        let desk = match question.asker {
            Asker::Person(..) => &self.person,
            Asker::Screen(..) => &self.screens,
        };
        // The threads end with the program.
        let _ = desk.send(DeskJob::Ask(question));
    }
}

/// The threads behind the screen.
pub struct Workers {
    jobs: Sender<Job>,
    desks: Desks,
    session: Option<JoinHandle<()>>,
}

impl Workers {
    /// Starts the threads; what they report goes into the channel.
    pub fn start(news: Sender<Message>, configuration: Configuration) -> Workers {
        let (jobs, todo) = channel();
        let desks = Desks {
            person: start_desk(news.clone(), jobs.clone()),
            screens: start_desk(news.clone(), jobs.clone()),
        };
        let for_session = desks.clone();
        let session = std::thread::spawn(move || {
            let thread = SessionThread {
                open: None,
                company: None,
                due: None,
                looked: Instant::now(),
                mending: None,
                news,
                desks: for_session,
                configuration,
            };
            thread.run(&todo);
        });
        Workers { jobs, desks, session: Some(session) }
    }

    /// Hands over a job.
    pub fn send(&self, job: Job) {
        let _ = self.jobs.send(job);
    }

    /// Asks at once, without waiting for the session's thread.
    pub fn ask_now(&self, question: Question) {
        self.desks.ask(question);
    }

    /// Waits until everything handed over is done and the run is closed.
    pub fn finish(mut self) {
        self.send(Job::End);
        for desk in [&self.desks.person, &self.desks.screens] {
            let _ = desk.send(DeskJob::Leave);
        }
        if let Some(session) = self.session.take() {
            let _ = session.join();
        }
    }
}

/// The run that is open.
enum Open {
    Played(Box<Session>),
    Replayed(Box<Playback>),
}

impl Open {
    fn session(&mut self) -> &mut Session {
        match self {
            Open::Played(session) => session,
            Open::Replayed(playback) => playback.session_mut(),
        }
    }
}

struct SessionThread {
    open: Option<Open>,
    /// The company as it was shown last.
    company: Option<Arc<Company>>,
    /// When the replay goes on by itself.
    due: Option<Instant>,
    /// When somebody else's lines were looked for.
    looked: Instant,
    /// The database could not be written: when it is tried again.
    mending: Option<Instant>,
    news: Sender<Message>,
    desks: Desks,
    configuration: Configuration,
}

/// Days are reported at most this often: the screen needs no more.
const BETWEEN_DAYS: Duration = Duration::from_millis(40);

impl SessionThread {
    fn run(mut self, todo: &Receiver<Job>) {
        loop {
            let job = match self.patience().map(|patience| todo.recv_timeout(patience)) {
                None => todo.recv().ok(),
                Some(Ok(job)) => Some(job),
                Some(Err(RecvTimeoutError::Disconnected)) => None,
                Some(Err(RecvTimeoutError::Timeout)) => {
                    if let Err(panic) = catch_unwind(AssertUnwindSafe(|| self.go_on())) {
                        return self.say(News::Crashed(words_of(&*panic)));
                    }
                    continue;
                }
            };
            let Some(job) = job else { return };
            let ending = matches!(job, Job::End);
            let done = catch_unwind(AssertUnwindSafe(|| self.work(job)));
            if let Err(panic) = done {
                self.say(News::Crashed(words_of(&*panic)));
                return;
            }
            if ending {
                return;
            }
        }
    }

    fn say(&self, news: News) {
        let _ = self.news.send(Message::News(news));
    }

    fn work(&mut self, job: Job) {
        match job {
            Job::List(runs) => {
                let list = list_runs(&runs).map_err(|error| error.to_string());
                self.say(News::Runs(list));
            }
            Job::Course(runs, id) => {
                let course = run_history(&runs, &id).map_err(|error| error.to_string());
                self.say(News::Course(id, course));
            }
            Job::EndRun(runs, id) => {
                let done = end_run(&runs, &id).map_err(|error| error.to_string());
                self.say_kept(&runs, done.map(|()| format!("run {id} is given up; you can still open it")));
            }
            Job::DeleteRun(runs, id) => {
                let done = delete_run(&runs, &id).map_err(|error| error.to_string());
                self.say_kept(&runs, done.map(|()| format!("run {id} is deleted")));
            }
            Job::Create(new) => match Session::create((*new).clone(), &self.configuration) {
                Err(RunError::ConsentNeeded(text)) => {
                    self.say(News::NotOpened(text.text, Some(Instead::Agree(new, 0))));
                }
                made => self.take(made, "", None),
            },
            Job::Open(runs, id, access) => {
                let found = match access {
                    Access::Write => find_run(&runs, &id),
                    Access::Read => find_run_to_read(&runs, &id),
                };
                let found = found.and_then(|folder| Session::open(&folder, access, true));
                self.take(found, &id, None);
            }
            Job::Replay(runs, recorded, goal, follow) => self.replay(&runs, recorded, goal, follow),
            Job::Go(goal, stop) => self.go(goal, &stop),
            Job::GoOn(after) => self.due = Some(Instant::now() + after),
            Job::Hold => self.due = None,
            Job::TakeOver(mode) => self.take_over(mode),
            Job::Rescue(runs, id) => self.rescue(&runs, &id),
            Job::Remember(chosen) => {
                if let Err(error) = chosen.keep(&self.configuration) {
                    self.say(News::Written(Err(error.to_string())));
                }
            }
            Job::Close | Job::End => {
                let problem = self.open.as_mut().and_then(|open| open.session().save().err());
                (self.open, self.company, self.due, self.mending) = (None, None, None, None);
                self.say(News::Closed(problem.map(|error| error.to_string())));
            }
            other => {
                if let Some(open) = &mut self.open {
                    let news =
                        Self::with_run(open.session(), &mut self.company, other, &self.news, &self.desks);
                    if let Some(news) = news {
                        self.say(news);
                    }
                    self.look_after_database();
                }
            }
        }
    }

    /// What became of a run of the folder, and the runs that are there now.
    fn say_kept(&self, runs: &std::path::Path, done: Result<String, String>) {
        let list = list_runs(runs).map_err(|error| error.to_string());
        self.say(News::Kept(done, list));
    }

    /// Shows a run that was opened, with a remark; if it does not open, what can be done instead.
    fn take(&mut self, opened: Result<Session, RunError>, id: &str, remark: Option<String>) {
        let session = match opened {
            Ok(session) => session,
            Err(problem) => {
                let instead = match &problem {
                    RunError::InUse { id, .. } | RunError::NotWritable { id, .. } => {
                        Some(Instead::Watch(id.clone()))
                    }
                    RunError::Damaged { .. } if !id.is_empty() => Some(Instead::Rescue(id.to_owned())),
                    _ => None,
                };
                return self.say(News::NotOpened(problem.to_string(), instead));
            }
        };
        let interrupt = self.hand_desks(&session);
        self.mending = None;
        let mut company = Company::of(&session);
        company.remarks.extend(remark);
        let company = Arc::new(company);
        self.company = Some(company.clone());
        (self.open, self.due) = (Some(Open::Played(Box::new(session))), None);
        self.say(News::Opened(company, interrupt));
    }

    /// Gives the threads that ask the database a desk each; returns what stops the person's.
    fn hand_desks(&self, session: &Session) -> Option<Interrupt> {
        let mut interrupt: Option<Interrupt> = None;
        for (desk, of_person) in [(&self.desks.person, true), (&self.desks.screens, false)] {
            if let Ok(own) = session.open_desk() {
                if of_person {
                    interrupt = Some(own.interrupt());
                }
                let _ = desk.send(DeskJob::Take(Box::new(own), session.query_limits()));
            }
        }
        interrupt
    }

    fn with_run(
        session: &mut Session,
        shown: &mut Option<Arc<Company>>,
        job: Job,
        news: &Sender<Message>,
        desks: &Desks,
    ) -> Option<News> {
        let mut company = |session: &Session| {
            let company = Arc::new(Company::after(session, shown.as_deref()));
            *shown = Some(company.clone());
            company
        };
        match job {
            Job::Check(number, tool, arguments) => {
                Some(News::Checked(number, session.check(tool, &arguments)))
            }
            Job::Call(tool, arguments) => {
                let answer = session.call(tool, &arguments, Via::Form).map(Box::new);
                Some(News::Called(tool, answer, company(session)))
            }
            Job::Undo => {
                let back = session.undo(Via::Palette);
                Some(News::Undone(back, company(session)))
            }
            Job::Redo => {
                let again = session.redo(Via::Palette);
                Some(News::Redone(again, company(session)))
            }
            Job::Advance(rationale, forecasts) => {
                let mut told = Instant::now();
                let week = session.advance(&rationale, &forecasts, Via::Form, &mut |report| {
                    if told.elapsed() >= BETWEEN_DAYS {
                        told = Instant::now();
                        let _ = news.send(Message::News(News::Day(report.figures.day, report.week_end)));
                    }
                });
                Some(News::Advanced(week.map(Box::new), company(session)))
            }
            Job::Ask(question) => {
                // A database that cannot be written answers with what it has; the screen says that it is behind.
                let _ = session.wait_for_database();
                desks.ask(question);
                None
            }
            Job::NoteQuery(sql, answer, took) => {
                session.note_query(&sql, answer.as_ref(), took);
                None
            }
            Job::NoteView(screen, from, for_ms) => {
                session.note_view(screen, from, for_ms);
                None
            }
            Job::SetMemo(text) => {
                let kept = session.set_memo(&text);
                Some(News::MemoKept(kept, company(session)))
            }
            Job::Tell => Some(News::Told(Arc::new(Story::of(session)))),
            Job::Report => {
                let story = Story::of(session);
                let files = vec![("report.md", as_markdown(&story)), ("report.html", as_html(&story))];
                Some(News::Reported(files))
            }
            Job::List(_)
            | Job::Course(..)
            | Job::EndRun(..)
            | Job::DeleteRun(..)
            | Job::Create(_)
            | Job::Open(..)
            | Job::Replay(..)
            | Job::Go(..)
            | Job::GoOn(_)
            | Job::Hold
            | Job::TakeOver(_)
            | Job::Rescue(..)
            | Job::Remember(_)
            | Job::Close
            | Job::End => None,
        }
    }
}

fn start_desk(news: Sender<Message>, jobs: Sender<Job>) -> Sender<DeskJob> {
    let (asked, questions) = channel();
    std::thread::spawn(move || {
        let mut desk: Option<(Box<QueryConnection>, Limits)> = None;
        while let Ok(job) = questions.recv() {
            match job {
                DeskJob::Take(own, limits) => desk = Some((own, limits)),
                DeskJob::Leave => desk = None,
                DeskJob::Ask(question) => answer(question, desk.as_ref(), &news, &jobs),
            }
        }
    });
    asked
}

fn answer(
    question: Question,
    desk: Option<&(Box<QueryConnection>, Limits)>,
    news: &Sender<Message>,
    jobs: &Sender<Job>,
) {
    let started = Instant::now();
    let rows = match (desk, &question.asker) {
        (Some((desk, limits)), Asker::Person(_, Some(ticket))) => {
            desk.ask_as(*ticket, &question.sql, *limits).map_err(Refusal::from)
        }
        (Some((desk, limits)), _) => desk.ask(&question.sql, *limits).map_err(Refusal::from),
        (None, _) => Err(Refusal::new("sql_error", "no run is open")),
    };
    let took = started.elapsed();
    let report = match question.asker {
        Asker::Person(number, _) => {
            let noted = rows.clone();
            let _ = jobs.send(Job::NoteQuery(question.sql, noted, took));
            News::Answered(number, rows, took)
        }
        Asker::Screen(reading, changes) => News::Read(reading, changes, rows),
    };
    let _ = news.send(Message::News(report));
}

/// What a panic said.
pub fn words_of(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("an unknown reason").to_owned()
}
