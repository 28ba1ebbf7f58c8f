//! The threads behind the screen: one that owns the session, two that ask the database.
//!
//! The screen sends jobs and never waits; what comes of them returns as news through the channel that also
//! carries the input. A query waits for the session's thread, so that it sees everything that was confirmed,
//! unless a week is running: then it sees the state before it.

mod answering;
mod branches;
mod causes;
mod class;
pub mod company;
mod curve;
mod desk;
mod folder;
mod inside;
mod kin;
mod lesson;
mod limits;
pub mod look_inside;
mod mending;
pub mod message;
mod opponents;
mod player;
pub mod posts;
pub mod preferences;
mod queries;
pub mod readings;
pub mod request;
pub mod resimulation;
mod run;
#[cfg(any(test, feature = "test-kit"))]
pub mod test_kit;
mod values;
mod visit;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::company::Company;
use crate::look_inside::LookQuestion;
use crate::message::{Message, News};
use crate::preferences::Preferences;
use crate::request::Request;
use crate::resimulation::{BranchesAsked, WhyAsked};
use answering::words_of;
use desk::Desk;
use novamind_insight::{Causes, LastRead, WhatIf};
use novamind_report::opponents::PlayOpponents;
use novamind_session::identifiers::Group;
use novamind_session::record::{LeavingCause, PresenceEvent};
use novamind_session::{
    Activity, Configuration, Goal, Interface, Interrupt, Playback, QuerySource, Refusal, Rows, RunError,
    Session, UnsentTexts,
};
use novamind_tools::ToolId;
use queries::QueryThreads;
use run::OpenRun;

pub use answering::answer_on_thread;
pub use queries::Question;

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
    /// What a call would do.
    Check(u64, ToolId, Value),
    /// Pass a question on once everything confirmed is in the database.
    Ask(Question),
    /// Ask the database and the tables of the x-ray; the number tells the answer from others.
    AskInside(u64, String),
    /// Find out why a figure changed.
    FindCauses(WhyAsked),
    /// Find out what would have been.
    FindBranches(BranchesAsked),
    /// Play the opponents of the run; the number tells the answer from others, the flag ends the work.
    PlayOpponents(u64, PlayOpponents, Arc<AtomicBool>),
    /// Draw the curve of a group; the number tells the answer from others.
    FindCurve(u64, Group),
    /// Read the tree of branches in which the run stands.
    ReadKin,
    /// Look at hidden state of the run.
    LookInside(u64, LookQuestion),
    /// Look at the true values of a day.
    ReadHiddenValues(u32),
    /// Give the query threads new connections: a defect has ended one.
    Reconnect,
    /// Record what the person asked.
    NoteQuery(String, Result<Rows, Refusal>, Duration, QuerySource),
    /// Record that the person takes up the run.
    TakeUp(Interface),
    /// Record what the person did besides acting.
    Note(Activity),
    /// Record that the person went away or came back, or that the window changed: milliseconds without a key, its size.
    NotePresence(PresenceEvent, Option<u64>, Option<(u16, u16)>),
    /// Record that the clock was stopped, and why.
    StopClock(Option<String>),
    /// Record that it was started again.
    StartClock,
    /// Keep texts that were typed and not sent.
    KeepDrafts(Box<UnsentTexts>),
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
        let queries = QueryThreads::start(&news, &jobs);
        let for_session = queries.clone();
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
        Workers { jobs, queries, running_stop, session: Some(session) }
    }

    /// Hands over a job.
    pub fn send(&self, job: Job) {
        let _ = self.jobs.send(job);
    }

    /// Asks at once, without waiting for the session's thread.
    pub fn ask_now(&self, question: Question) {
        self.queries.ask(question);
    }

    /// Stops the script that runs, and the question that the tables of the x-ray are asked.
    pub fn stop_what_runs(&self) {
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

struct SessionThread {
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
            Job::Check(number, tool, arguments) => {
                self.with_run(|run| Some(News::Checked(number, run.session.check(tool, &arguments))))
            }
            Job::Ask(question) => self.with_run(|run| {
                // A database that cannot be written answers with what it has; the screen says that it is behind.
                let _ = run.session.wait_for_database();
                run.queries.ask(question);
                None
            }),
            Job::Reconnect => {
                self.with_run(|run| run.queries.connect(run.session).map(News::Reconnected));
            }
            Job::NoteQuery(sql, answer, took, via) => self.with_run(|run| {
                run.session.note_query(&sql, answer.as_ref(), took, via);
                None
            }),
            Job::FindCauses(asked) => self.find_causes(asked),
            Job::FindBranches(asked) => self.find_branches(asked),
            Job::PlayOpponents(number, play, stop) => self.play_opponents(number, play, stop),
            Job::FindCurve(number, group) => self.find_curve(number, group),
            Job::ReadKin => self.read_kin(),
            Job::AskInside(number, sql) => self.ask_inside(number, &sql),
            Job::LookInside(number, question) => self.look_inside(number, &question),
            Job::ReadHiddenValues(day) => self.read_hidden_values(day),
            Job::TakeUp(interface) => self.take_up(interface),
            Job::Note(activity) => self.with_session(|session| session.activity().note(activity)),
            Job::NotePresence(event, idle_ms, window) => {
                self.with_session(|session| session.activity().note_presence(event, idle_ms, window));
            }
            // The screen is covered already; a disk that refuses the line is no reason to uncover it.
            Job::StopClock(reason) => {
                self.with_session(|session| drop(session.activity().stop_clock(reason.as_deref())));
            }
            Job::StartClock => {
                self.with_session(|session| drop(session.activity().start_clock()));
                // Questions may be due after a break.
                self.tell_due();
            }
            Job::KeepDrafts(texts) => self.with_session(|session| session.drafts().keep(&texts)),
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
            Request::ListRuns => self.list_runs(),
            Request::PreviewRun(id) => self.preview_run(id),
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
            Request::Call { tool, arguments } => self.with_run(|run| run.call(tool, &arguments)),
            Request::Undo => self.with_run(|run| run.undo()),
            Request::Redo => self.with_run(|run| run.redo()),
            Request::Advance { rationale, forecasts } => {
                self.with_run(|run| run.advance(&rationale, &forecasts));
            }
            Request::RunDays(days) => self.with_run(|run| run.run_days(days)),
            Request::SetMemo(text) => self.with_run(|run| run.set_memo(&text)),
            Request::TellStory => self.with_run(|run| run.tell_story()),
            Request::WriteReport => self.with_run(|run| run.write_report()),
            Request::Lesson(asked) => self.in_lesson(asked),
            Request::Visit(request) => self.lead(request),
        }
    }

    /// Works on the run that is open, if there is one, and reports what comes of it.
    fn with_run(&mut self, work: impl FnOnce(&mut OpenRun<'_>) -> Option<News>) {
        let SessionThread { open: Some(open), company: shown, news, queries, running_stop: stop, .. } = self
        else {
            return;
        };
        let news = work(&mut OpenRun { session: open.session(), shown, news, queries, stop });
        let loss = self.open.as_mut().and_then(|open| open.session().log().loss().map(str::to_owned));
        if let Some(words) = loss {
            // Before what came of the work: nothing goes on from here.
            self.say(News::RecordLost(words));
        }
        self.tell_due();
        news.into_iter().for_each(|news| self.say(news));
        self.look_after_database();
    }
}
