//! The worker threads of the console: one owns the session, two query the database.
//!
//! The console sends jobs and never blocks. A result returns through the channel that also carries the input: as the
//! answer to the page that asked ([`asking`]), or as a response if it concerns more than one page. A query waits for
//! the session thread, so that it sees all confirmed actions. While a week runs it does not wait, and sees the state
//! before the week.

mod answering;
pub mod asking;
pub mod branches;
pub mod causes;
mod class;
pub mod company;
pub mod folder;
mod lesson;
pub mod look_inside;
pub mod message;
mod player;
pub mod posts;
pub mod preferences;
pub mod queries;
pub mod questions;
pub mod readings;
pub mod request;
mod run;
#[cfg(any(test, feature = "test-kit"))]
pub mod test_kit;
mod upkeep;
mod visit;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::company::Company;
use crate::message::{Message, News};
use crate::preferences::Preferences;
use crate::request::Request;
use answering::words_of;
use novamind_database::{Interrupt, Rows};
use novamind_insight::{Causes, LastRead, WhatIf};
use novamind_record::error::RunError;
use novamind_record::folder::configuration::Configuration;
use novamind_record::trajectory::record::{LeavingCause, QuerySource};
use novamind_session::{Goal, Interface, Playback, Session};
use novamind_tools::Refusal;
use queries::QueryThreads;
use run::OpenRun;
use visit::Desk;

pub use answering::answer_on_thread;

/// A job for the session thread.
pub enum Job {
    /// Execute a request of the user.
    Do(Request),
    /// Seek in the playback; the flag stops it.
    Go(Goal, Arc<AtomicBool>),
    /// Play the next week of the playback after a pause.
    GoOn(Duration),
    /// Cancel the scheduled next week.
    Hold,
    /// Answer a question of a page.
    Ask(Box<dyn FnOnce(&mut SessionThread) + Send>),
    /// Reconnect the query threads after a panic has ended a connection.
    Reconnect,
    /// Record a query of the user.
    NoteQuery(String, Result<Rows, Refusal>, Duration, QuerySource),
    /// Record that the user has opened the run.
    TakeUp(Interface),
    /// Record user activity; nothing is reported.
    Note(Box<dyn FnOnce(&mut Session) + Send>),
    /// Record that the clock was started.
    StartClock,
    /// Signal that all earlier jobs are done.
    Settle(Sender<()>),
    /// Save preferences for the next start.
    Remember(Preferences),
    /// Save and close the run.
    Close(LeavingCause),
    /// Save, close the run and end the thread.
    End,
}

/// The worker threads.
pub struct Workers {
    jobs: Sender<Job>,
    queries: QueryThreads,
    news: Sender<Message>,
    /// Stops the running script or query of hidden tables.
    running_stop: Arc<Mutex<Option<Interrupt>>>,
    session: Option<JoinHandle<()>>,
}

impl Workers {
    /// Starts the threads, which send their messages to `news`.
    pub fn start(
        news: Sender<Message>,
        configuration: Configuration,
        runs: PathBuf,
        lists_everybody: bool,
    ) -> Workers {
        let (jobs, todo) = channel();
        let queries = QueryThreads::start(&jobs);
        let (for_session, for_answers) = (queries.clone(), news.clone());
        let running_stop: Arc<Mutex<Option<Interrupt>>> = Arc::default();
        let stop = running_stop.clone();
        let session = std::thread::spawn(move || {
            let thread = SessionThread {
                open: None,
                company: None,
                due: None,
                looked: Instant::now(),
                mending: None,
                desk: None,
                lists_everybody,
                limits: None,
                minutes_left: Vec::new(),
                causes: Arc::default(),
                branches: Arc::default(),
                inside: None,
                inside_has_rows: false,
                running_stop: stop,
                news,
                first_runs: runs.clone(),
                runs,
                queries: for_session,
                configuration,
            };
            thread.run(&todo);
        });
        Workers { jobs, queries, news: for_answers, running_stop, session: Some(session) }
    }

    /// Sends a job.
    pub fn send(&self, job: Job) {
        let _ = self.jobs.send(job);
    }

    /// Stops the user's query, the running script and the query of hidden tables.
    pub fn stop_what_runs(&self) {
        self.queries.stop();
        let stop = self.running_stop.lock().unwrap_or_else(PoisonError::into_inner);
        stop.iter().for_each(Interrupt::stop);
    }

    /// Waits until all earlier jobs are done, up to a timeout.
    pub fn settle(&self, patience: Duration) {
        let (done, waits) = channel();
        self.send(Job::Settle(done));
        let _ = waits.recv_timeout(patience);
    }

    /// Waits until all earlier jobs are done and the run is closed.
    pub fn finish(mut self) {
        self.send(Job::End);
        self.queries.disconnect();
        if let Some(session) = self.session.take() {
            let _ = session.join();
        }
    }
}

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

/// The thread that owns the session.
pub struct SessionThread {
    open: Option<Open>,
    /// The runs folder; after opening a handout, that of its student.
    runs: PathBuf,
    first_runs: PathBuf,
    company: Option<Arc<Company>>,
    /// When the next week of the playback is due.
    due: Option<Instant>,
    /// When new lines of a followed run were last polled.
    looked: Instant,
    mending: Option<Instant>,
    desk: Option<Desk>,
    lists_everybody: bool,
    /// When time limits are checked next; `None` if there are none.
    limits: Option<Instant>,
    minutes_left: Vec<i64>,
    causes: Arc<Mutex<LastRead<Causes>>>,
    branches: Arc<Mutex<LastRead<WhatIf>>>,
    /// The session for inspections, if the open one is read-only and cannot record them.
    inside: Option<Box<Session>>,
    inside_has_rows: bool,
    /// Stops the running script or query of hidden tables.
    running_stop: Arc<Mutex<Option<Interrupt>>>,
    news: Sender<Message>,
    queries: QueryThreads,
    configuration: Configuration,
}

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
            Job::Do(request) => self.answer(request),
            Job::Go(goal, stop) => self.go(goal, &stop),
            Job::GoOn(after) => self.due = Some(Instant::now() + after),
            Job::Hold => self.due = None,
            Job::Remember(chosen) => {
                if let Err(error) = chosen.keep(&self.configuration) {
                    self.say(News::Written(Err(error.to_string())));
                }
            }
            Job::Close(cause) => self.close(cause),
            // A run that is still open was not left regularly: the terminal has failed.
            Job::End => self.close(LeavingCause::Hangup),
            Job::Ask(answer) => answer(self),
            Job::Reconnect => drop(self.with_run(|run| run.queries.connect(run.session))),
            Job::NoteQuery(sql, answer, took, via) => {
                self.with_run(|run| run.session.note_query(&sql, answer.as_ref(), took, via));
            }
            Job::TakeUp(interface) => self.take_up(interface),
            Job::Note(note) => self.with_session(note),
            Job::StartClock => {
                self.with_session(|session| drop(session.activity().start_clock()));
                // Questions may be due after a pause.
                self.tell_due();
            }
            Job::Settle(done) => drop(done.send(())),
        }
    }

    fn with_session(&mut self, work: impl FnOnce(&mut Session)) {
        if let Some(open) = &mut self.open {
            work(open.session());
        }
    }

    fn take_up(&mut self, interface: Interface) {
        self.with_session(|session| session.activity().take_up(interface));
        let Some(Open::Played(session)) = &self.open else { return };
        let (texts, held) = (session.drafts().kept(), session.log().is_held());
        self.minutes_left.clear();
        self.limits = (!session.log().time_left().is_empty()).then(Instant::now);
        if !texts.is_empty() {
            self.say(News::Unsent(Box::new(texts)));
        }
        if held {
            self.say(News::Held);
        }
        self.tell_due();
    }

    /// Records that the user leaves the run, and syncs it to disk.
    fn put_down(&mut self, cause: LeavingCause) -> Result<(), RunError> {
        match &mut self.open {
            Some(Open::Played(session)) => {
                session.activity().leave(cause);
                session.save()
            }
            Some(Open::Replayed(playback)) => playback.session_mut().save(),
            None => Ok(()),
        }
    }

    fn close(&mut self, cause: LeavingCause) {
        let problem = self.put_down(cause).err();
        (self.open, self.company, self.due, self.mending, self.limits) = (None, None, None, None, None);
        self.inside = None;
        self.say(News::Closed(problem.map(|error| error.to_string())));
    }

    fn answer(&mut self, request: Request) {
        match request {
            Request::ListRuns => self.list_runs(None),
            Request::EndRun(id) => self.end_run(&id),
            Request::DeleteRun(id) => self.delete_run(&id),
            Request::ReadClass(folder, shown) => self.read_class(&folder, shown),
            Request::OpenHandout(path) => self.open_handout(&path),
            Request::Create(new) => self.create(*new),
            Request::Open(id, access) => self.open_run(&id, access),
            Request::Rescue(id) => self.rescue(&id),
            Request::Replay { recorded, goal, follow } => self.replay(recorded, goal, follow),
            Request::TakeOver(mode) => self.take_over(mode),
            Request::AdoptBranch { week, edits } => self.adopt_branch(week, &edits),
            Request::Call { tool, arguments } => self.report(|run| run.call(tool, &arguments)),
            Request::Undo => self.report(|run| run.undo()),
            Request::Redo => self.report(|run| run.redo()),
            Request::Advance { rationale, forecasts } => {
                self.report(|run| run.advance(&rationale, &forecasts));
            }
            Request::RunDays(days) => self.report(|run| run.run_days(days)),
            Request::SetMemo(text) => self.report(|run| run.set_memo(&text)),
            Request::TellStory => self.report(|run| run.tell_story()),
            Request::WriteReport => self.report(|run| run.write_report()),
            Request::Lesson(asked) => self.in_lesson(asked),
            Request::Visit(request) => self.lead(request),
        }
    }

    /// Works on the open run, if there is one.
    fn with_run<T>(&mut self, work: impl FnOnce(&mut OpenRun<'_>) -> T) -> Option<T> {
        let SessionThread { open: Some(open), company: shown, news, queries, running_stop: stop, .. } = self
        else {
            return None;
        };
        let result = work(&mut OpenRun { session: open.session(), shown, news, queries, stop });
        let loss = self.open.as_mut().and_then(|open| open.session().log().loss().map(str::to_owned));
        if let Some(words) = loss {
            // Sent before the response to the work, because nothing else can follow.
            self.say(News::RecordLost(words));
        }
        self.tell_due();
        self.look_after_database();
        Some(result)
    }

    fn report(&mut self, work: impl FnOnce(&mut OpenRun<'_>) -> News) {
        if let Some(news) = self.with_run(work) {
            self.say(news);
        }
    }

    fn notice_losses(&mut self) {
        self.with_run(|_| ());
    }
}
