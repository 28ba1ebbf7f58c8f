//! The worker threads of the console: one owns the session, two query the database.
//!
//! The console sends jobs and never blocks. Results arrive through the same channel as input. A result is either an
//! answer to the page that asked ([`question`]) or, if it affects more than one page, a response. A query waits for the
//! session thread, so that its result includes all confirmed actions. While a week is simulated, a query does not wait
//! and reads the state before the week.

mod background;
pub mod branches;
pub mod causes;
mod class;
pub mod company;
pub mod inspection;
mod lesson;
mod maintenance;
pub mod message;
mod open_run;
pub mod page_questions;
mod playback;
pub mod posts;
pub mod preferences;
pub mod queries;
pub mod question;
pub mod request;
pub mod run_folders;
pub mod screen_queries;
mod study;
#[cfg(any(test, feature = "test-kit"))]
pub mod test_kit;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::company::DisplayedCompany;
use crate::message::{Message, Response};
use crate::preferences::Preferences;
use crate::request::Request;
use background::panic_message;
use novamind_database::{Interrupt, QueryResult};
use novamind_insight::{AnalysisCache, CauseAnalysis, WhatIf};
use novamind_record::error::RunError;
use novamind_record::folder::configuration::Configuration;
use novamind_record::trajectory::record::{DetachCause, QuerySource};
use novamind_session::{Interface, Playback, SeekTarget, Session};
use novamind_tools::Rejection;
use open_run::OpenRun;
use queries::QueryThreads;
use study::ActiveStudy;

pub use background::answer_on_thread;

/// Work for the session thread. Jobs are done in the order in which they are sent.
pub enum Job {
    /// Execute a request of the user, and send a response.
    Execute(Request),
    /// Seek to this position of the playback. Setting the flag stops the seek.
    Seek(SeekTarget, Arc<AtomicBool>),
    /// Show the next week of the playback after this pause.
    ScheduleNextWeek(Duration),
    /// Cancel showing the next week of the playback.
    CancelNextWeek,
    /// Answer a question of a page.
    AnswerQuestion(Box<dyn FnOnce(&mut SessionThread) + Send>),
    /// Reconnect the query threads after a query has panicked and lost its connection.
    Reconnect,
    /// Record a query of the user.
    RecordQuery(String, Result<QueryResult, Rejection>, Duration, QuerySource),
    /// Record that the user has opened the run.
    Attach(Interface),
    /// Record user activity without sending a response.
    RecordActivity(Box<dyn FnOnce(&mut Session) + Send>),
    /// Record that the user started the clock.
    StartClock,
    /// Send a confirmation after all earlier jobs are done.
    Acknowledge(Sender<()>),
    /// Save preferences, so that the next start loads them.
    SavePreferences(Preferences),
    /// Save and close the run.
    Close(DetachCause),
    /// Save, close the run and end the thread.
    ShutDown,
}

/// Handle to the worker threads. The console uses it to send jobs and questions.
pub struct Workers {
    jobs: Sender<Job>,
    queries: QueryThreads,
    messages: Sender<Message>,
    /// Handle that stops the running script or query of hidden tables.
    interrupt: Arc<Mutex<Option<Interrupt>>>,
    session: Option<JoinHandle<()>>,
}

impl Workers {
    /// Starts the worker threads, which send their messages to `news`.
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
                active_run: None,
                last_company: None,
                next_week_at: None,
                last_poll: Instant::now(),
                repair_at: None,
                study: None,
                lists_all_participants: lists_everybody,
                next_limit_check: None,
                minutes_left: Vec::new(),
                causes_cache: Arc::default(),
                what_if_cache: Arc::default(),
                inspection_run: None,
                inspection_run_has_database: false,
                interrupt: stop,
                messages: news,
                initial_runs_folder: runs.clone(),
                runs_folder: runs,
                queries: for_session,
                configuration,
            };
            thread.run(&todo);
        });
        Workers { jobs, queries, messages: for_answers, interrupt: running_stop, session: Some(session) }
    }

    /// Sends a job to the session thread.
    pub fn send(&self, job: Job) {
        let _ = self.jobs.send(job);
    }

    /// Stops the user's query, the running script and the query of hidden tables.
    pub fn stop_running_work(&self) {
        self.queries.stop();
        let stop = self.interrupt.lock().unwrap_or_else(PoisonError::into_inner);
        stop.iter().for_each(Interrupt::stop);
    }

    /// Waits until all earlier jobs are done, up to a timeout.
    pub fn wait_for_jobs(&self, patience: Duration) {
        let (done, waits) = channel();
        self.send(Job::Acknowledge(done));
        let _ = waits.recv_timeout(patience);
    }

    /// Waits until all earlier jobs are done and the run is closed.
    pub fn shut_down(mut self) {
        self.send(Job::ShutDown);
        self.queries.disconnect();
        if let Some(session) = self.session.take() {
            let _ = session.join();
        }
    }
}

enum ActiveRun {
    Live(Box<Session>),
    Playback(Box<Playback>),
}

impl ActiveRun {
    fn session(&mut self) -> &mut Session {
        match self {
            ActiveRun::Live(session) => session,
            ActiveRun::Playback(playback) => playback.session_mut(),
        }
    }
}

/// The state of the thread that owns the session.
pub struct SessionThread {
    active_run: Option<ActiveRun>,
    /// Current runs folder. After a handout is opened, this is the runs folder of its student.
    runs_folder: PathBuf,
    initial_runs_folder: PathBuf,
    last_company: Option<Arc<DisplayedCompany>>,
    /// Time at which the playback shows the next week.
    next_week_at: Option<Instant>,
    /// Time at which a followed run was last polled for new lines.
    last_poll: Instant,
    repair_at: Option<Instant>,
    study: Option<ActiveStudy>,
    lists_all_participants: bool,
    /// Time of the next check of the time limits; `None` if the run has no time limits.
    next_limit_check: Option<Instant>,
    minutes_left: Vec<i64>,
    causes_cache: Arc<Mutex<AnalysisCache<CauseAnalysis>>>,
    what_if_cache: Arc<Mutex<AnalysisCache<WhatIf>>>,
    /// Second session for inspections, if the open session is read-only and cannot record inspections.
    inspection_run: Option<Box<Session>>,
    inspection_run_has_database: bool,
    /// Handle that stops the running script or query of hidden tables.
    interrupt: Arc<Mutex<Option<Interrupt>>>,
    messages: Sender<Message>,
    queries: QueryThreads,
    configuration: Configuration,
}

const DAY_REPORT_INTERVAL: Duration = Duration::from_millis(40);

impl SessionThread {
    fn run(mut self, todo: &Receiver<Job>) {
        loop {
            let job = match self.time_until_next_task().map(|patience| todo.recv_timeout(patience)) {
                None => todo.recv().ok(),
                Some(Ok(job)) => Some(job),
                Some(Err(RecvTimeoutError::Disconnected)) => None,
                Some(Err(RecvTimeoutError::Timeout)) => {
                    if let Err(panic) = catch_unwind(AssertUnwindSafe(|| self.run_due_tasks())) {
                        return self.send_response(Response::Crashed(panic_message(&*panic)));
                    }
                    continue;
                }
            };
            let Some(job) = job else { return };
            let ending = matches!(job, Job::ShutDown);
            let done = catch_unwind(AssertUnwindSafe(|| self.handle_job(job)));
            if let Err(panic) = done {
                self.send_response(Response::Crashed(panic_message(&*panic)));
                return;
            }
            if ending {
                return;
            }
        }
    }

    fn send_response(&self, news: Response) {
        let _ = self.messages.send(Message::Response(news));
    }

    fn handle_job(&mut self, job: Job) {
        match job {
            Job::Execute(request) => self.handle_request(request),
            Job::Seek(goal, stop) => self.seek(goal, &stop),
            Job::ScheduleNextWeek(after) => self.next_week_at = Some(Instant::now() + after),
            Job::CancelNextWeek => self.next_week_at = None,
            Job::SavePreferences(chosen) => {
                if let Err(error) = chosen.save(&self.configuration) {
                    self.send_response(Response::FilesWritten(Err(error.to_string())));
                }
            }
            Job::Close(cause) => self.close_run(cause),
            // A run that is still open was not closed by the user: the terminal was closed.
            Job::ShutDown => self.close_run(DetachCause::Hangup),
            Job::AnswerQuestion(answer) => answer(self),
            Job::Reconnect => drop(self.with_run(|run| run.queries.connect(run.session))),
            Job::RecordQuery(sql, answer, took, via) => {
                self.with_run(|run| run.session.record_query(&sql, answer.as_ref(), took, via));
            }
            Job::Attach(interface) => self.attach(interface),
            Job::RecordActivity(note) => self.with_session(note),
            Job::StartClock => {
                self.with_session(|session| drop(session.activity().start_clock()));
                // Study questions may be due after a pause.
                self.report_due_questions();
            }
            Job::Acknowledge(done) => drop(done.send(())),
        }
    }

    fn with_session(&mut self, work: impl FnOnce(&mut Session)) {
        if let Some(open) = &mut self.active_run {
            work(open.session());
        }
    }

    fn attach(&mut self, interface: Interface) {
        self.with_session(|session| session.activity().attach(interface));
        let Some(ActiveRun::Live(session)) = &self.active_run else { return };
        let (texts, held) = (session.draft_file().load(), session.log().is_stopped_by_limit());
        self.minutes_left.clear();
        self.next_limit_check = (!session.log().time_left().is_empty()).then(Instant::now);
        if !texts.is_empty() {
            self.send_response(Response::Drafts(Box::new(texts)));
        }
        if held {
            self.send_response(Response::ClockStopped);
        }
        self.report_due_questions();
    }

    /// Records that the program detaches from the run, and saves the run.
    fn detach(&mut self, cause: DetachCause) -> Result<(), RunError> {
        match &mut self.active_run {
            Some(ActiveRun::Live(session)) => {
                session.activity().detach(cause);
                session.save()
            }
            Some(ActiveRun::Playback(playback)) => playback.session_mut().save(),
            None => Ok(()),
        }
    }

    fn close_run(&mut self, cause: DetachCause) {
        let problem = self.detach(cause).err();
        (self.active_run, self.last_company, self.next_week_at, self.repair_at, self.next_limit_check) =
            (None, None, None, None, None);
        self.inspection_run = None;
        self.send_response(Response::Closed(problem.map(|error| error.to_string())));
    }

    fn handle_request(&mut self, request: Request) {
        match request {
            Request::ListRuns => self.list_runs(None),
            Request::EndRun(id) => self.end_run(&id),
            Request::DeleteRun(id) => self.delete_run(&id),
            Request::ReadClass(folder, display_options) => self.read_class(&folder, display_options),
            Request::OpenHandout(path) => self.open_handout(&path),
            Request::Create(new) => self.create_run(*new),
            Request::Open(id, access) => self.open_run(&id, access),
            Request::Recover(id) => self.recover_run(&id),
            Request::Replay { recorded, goal, follow } => self.replay_run(recorded, goal, follow),
            Request::TakeOver(mode) => self.take_over(mode),
            Request::AdoptBranch { week, edits } => self.adopt_branch(week, &edits),
            Request::Call { tool, arguments } => self.respond_with(|run| run.call_tool(tool, &arguments)),
            Request::Undo => self.respond_with(|run| run.undo()),
            Request::Redo => self.respond_with(|run| run.redo()),
            Request::Advance { rationale, forecasts } => {
                self.respond_with(|run| run.advance(&rationale, &forecasts));
            }
            Request::RunDays(days) => self.respond_with(|run| run.run_days(days)),
            Request::SetNotes(text) => self.respond_with(|run| run.set_notes(&text)),
            Request::BuildRunReport => self.respond_with(|run| run.build_run_report()),
            Request::RenderReportFiles => self.respond_with(|run| run.render_report_files()),
            Request::Lesson(lesson_request) => self.handle_lesson_request(lesson_request),
            Request::Study(request) => self.handle_study_request(request),
        }
    }

    /// Calls `work` with the open run, if a run is open.
    fn with_run<T>(&mut self, work: impl FnOnce(&mut OpenRun<'_>) -> T) -> Option<T> {
        let SessionThread {
            active_run: Some(open),
            last_company: displayed_company,
            messages: news,
            queries,
            interrupt: stop,
            ..
        } = self
        else {
            return None;
        };
        let result = work(&mut OpenRun {
            session: open.session(),
            last_company: displayed_company,
            messages: news,
            queries,
            interrupt: stop,
        });
        let loss =
            self.active_run.as_mut().and_then(|open| open.session().log().loss_reason().map(str::to_owned));
        if let Some(words) = loss {
            // Send this message before the response that reports the result of `work`, because the console ends when
            // it receives the message.
            self.send_response(Response::RecordLost(words));
        }
        self.report_due_questions();
        self.check_database();
        Some(result)
    }

    fn respond_with(&mut self, work: impl FnOnce(&mut OpenRun<'_>) -> Response) {
        if let Some(news) = self.with_run(work) {
            self.send_response(news);
        }
    }

    fn report_record_loss(&mut self) {
        self.with_run(|_| ());
    }
}
