//! The threads behind the screen: one that owns the session, two that ask the database.
//!
//! The screen sends jobs and never waits. The result returns through the channel that also carries the input: as the answer to
//! the page that asked ([`asking`]), or as news if it concerns more than one page. A query waits for the session's thread, so
//! that it sees everything that was confirmed, unless a week is running: then it sees the state before it.

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

/// Work for the session's thread.
pub enum Job {
    /// What a person asked for.
    Do(Request),
    /// Go somewhere in the replay, unless it is stopped on the way.
    Go(Goal, Arc<AtomicBool>),
    /// Go a week on in the replay after a while.
    GoOn(Duration),
    /// Do not go on.
    Hold,
    /// Answer a question of a page.
    Ask(Box<dyn FnOnce(&mut SessionThread) + Send>),
    /// Give the query threads new connections: a defect has ended one.
    Reconnect,
    /// Record what the person asked.
    NoteQuery(String, Result<Rows, Refusal>, Duration, QuerySource),
    /// Record that the person takes up the run.
    TakeUp(Interface),
    /// Record something about the user; nothing is reported.
    Note(Box<dyn FnOnce(&mut Session) + Send>),
    /// Record that the clock was started again.
    StartClock,
    /// Say that everything handed over before is done.
    Settle(Sender<()>),
    /// Start with this look the next time, too. One after the other: what was chosen last counts.
    Remember(Preferences),
    /// Save and close the run, which is left for a reason.
    Close(LeavingCause),
    /// Save, close the run and end the thread.
    End,
}

/// The threads behind the screen.
pub struct Workers {
    jobs: Sender<Job>,
    queries: QueryThreads,
    news: Sender<Message>,
    /// Stops the script that the session's thread runs, or its question to the tables of the x-ray, while it does.
    running_stop: Arc<Mutex<Option<Interrupt>>>,
    session: Option<JoinHandle<()>>,
}

impl Workers {
    /// Starts the threads; what they report goes into the channel.
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

    /// Hands over a job.
    pub fn send(&self, job: Job) {
        let _ = self.jobs.send(job);
    }

    /// Stops the query of the user, the script that runs, and the question that the tables of the x-ray are asked.
    pub fn stop_what_runs(&self) {
        self.queries.stop();
        let stop = self.running_stop.lock().unwrap_or_else(PoisonError::into_inner);
        stop.iter().for_each(Interrupt::stop);
    }

    /// Waits until everything handed over is done, but not for a week that is simulated.
    pub fn settle(&self, patience: Duration) {
        let (done, waits) = channel();
        self.send(Job::Settle(done));
        let _ = waits.recv_timeout(patience);
    }

    /// Waits until everything handed over is done and the run is closed.
    pub fn finish(mut self) {
        self.send(Job::End);
        self.queries.disconnect();
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

/// The thread that owns the session.
pub struct SessionThread {
    open: Option<Open>,
    /// The folder of runs: after a hand-out was opened that of its student.
    runs: PathBuf,
    /// The folder of runs with which the program began.
    first_runs: PathBuf,
    /// The company as it was shown last.
    company: Option<Arc<Company>>,
    /// When the replay goes on by itself.
    due: Option<Instant>,
    /// When somebody else's lines were looked for.
    looked: Instant,
    /// The database could not be written: when it is tried again.
    mending: Option<Instant>,
    /// The study whose participants are led.
    desk: Option<Desk>,
    /// The experimenter's code was given: the list holds the runs of all participants.
    lists_everybody: bool,
    /// When time limits are looked at next; none where the rules have none.
    limits: Option<Instant>,
    /// Minutes that are left to each limit, as they were told last.
    minutes_left: Vec<i64>,
    /// What was simulated to answer the last question why.
    causes: Arc<Mutex<LastRead<Causes>>>,
    /// What was simulated to answer the last question what would have been.
    branches: Arc<Mutex<LastRead<WhatIf>>>,
    /// The run that is looked into where the one that is open keeps no lines.
    inside: Option<Box<Session>>,
    /// It has a database.
    inside_has_rows: bool,
    /// Stops the script that runs, and what is asked of the tables of the x-ray.
    running_stop: Arc<Mutex<Option<Interrupt>>>,
    news: Sender<Message>,
    queries: QueryThreads,
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
            // A run that is still open was not left in good order: the terminal has failed.
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
                // Questions may be due after a break.
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

    /// Records that the run is left, and puts everything on the disk.
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

    /// Does what a person asked for.
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

    /// Works on the run that is open, if there is one.
    fn with_run<T>(&mut self, work: impl FnOnce(&mut OpenRun<'_>) -> T) -> Option<T> {
        let SessionThread { open: Some(open), company: shown, news, queries, running_stop: stop, .. } = self
        else {
            return None;
        };
        let result = work(&mut OpenRun { session: open.session(), shown, news, queries, stop });
        let loss = self.open.as_mut().and_then(|open| open.session().log().loss().map(str::to_owned));
        if let Some(words) = loss {
            // Before what came of the work: nothing goes on from here.
            self.say(News::RecordLost(words));
        }
        self.tell_due();
        self.look_after_database();
        Some(result)
    }

    /// The same, and reports what came of it.
    fn report(&mut self, work: impl FnOnce(&mut OpenRun<'_>) -> News) {
        if let Some(news) = self.with_run(work) {
            self.say(news);
        }
    }

    /// Notices a line that the disk has refused, as after any other work.
    fn notice_losses(&mut self) {
        self.with_run(|_| ());
    }
}
