//! The thread that owns the session, and the handle by which doors ask it.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use serde_json::Value;
use tokio::sync::oneshot;

use super::answering::answer;
use super::request::{Answer, Request, Status};
use super::running::Running;
use novamind_record::error::RunError;
use novamind_record::trajectory::record::{LeavingCause, Via};
use novamind_session::{Access, Interface, ModelSettings, RunDatabase, Session};
use novamind_tools::Kept;

/// Hears of defects of ours.
pub type OnDefect = fn(&str);

/// How programs come to a session.
#[derive(Clone, Copy)]
pub struct Door {
    /// What the lines of their calls say.
    pub via: Via,
    /// What the lines of their sessions say.
    pub interface: &'static str,
    /// Hears of defects of ours.
    pub on_defect: OnDefect,
}

/// A request and where its answer goes.
struct Asked {
    number: u64,
    request: Request,
    reply: oneshot::Sender<Answer>,
}

/// The thread that owns a session. It ends when nobody can ask any more.
pub struct Owner {
    thread: JoinHandle<Result<(), RunError>>,
    running: Running,
    /// Number and folder of the run.
    run: String,
    folder: Option<PathBuf>,
}

impl Owner {
    /// Gives a session to a thread of its own; the handle asks it.
    pub fn start(session: Session, door: Door) -> (Owner, Handle) {
        let (sender, receiver) = channel();
        let advancing = Advancing::default();
        let running = Running::default();
        let handle =
            Handle { sender, advancing: advancing.clone(), asked: Arc::default(), running: running.clone() };
        let (folder, model) = (session.folder().map(PathBuf::from), session.model_settings().cloned());
        let run = session.manifest().id.clone();
        let owned =
            Owned { folder: folder.clone(), model, session: Some(session), door, running: running.clone() };
        let thread = std::thread::spawn(move || owned.work(&receiver, &advancing));
        (Owner { thread, running, run, folder }, handle)
    }

    /// Stops the script, the calculation or the statement that runs: a server that is to end does not wait for it.
    pub fn stop_code(&self) {
        self.running.stop();
    }

    /// Waits until every request is answered and the run is left. All handles must be gone.
    ///
    /// # Errors
    /// What the disk did not take; everything that was confirmed is on it. [`RunError::Defect`] if the thread panicked.
    pub fn finish(self) -> Result<(), RunError> {
        let Owner { thread, run, folder, .. } = self;
        thread.join().unwrap_or(Err(RunError::Defect { run, folder }))
    }
}

/// Asks the owner.
#[derive(Clone)]
pub struct Handle {
    sender: Sender<Asked>,
    advancing: Advancing,
    /// Requests so far.
    asked: Arc<AtomicU64>,
    running: Running,
}

impl Handle {
    /// Asks, and waits for the answer. A week is simulated to its end even if nobody waits any more; a script or a statement
    /// is stopped then.
    pub async fn ask(&self, request: Request) -> Answer {
        if let Request::NextWeek { request_id, .. } = &request
            && !self.advancing.begin(request_id)
        {
            return Answer::wrong(
                Status::Busy,
                "week_running",
                "a week is being simulated; ask for the next one when it has been answered",
            );
        }
        let (reply, answer) = oneshot::channel();
        let number = self.asked.fetch_add(1, Ordering::Relaxed);
        let watch = self.running.watch(number);
        if self.sender.send(Asked { number, request, reply }).is_err() {
            return gone();
        }
        let answer = answer.await.unwrap_or_else(|_| gone());
        watch.ends();
        answer
    }
}

fn gone() -> Answer {
    Answer::wrong(Status::Failed, "closing", "the server is closing the run; what was confirmed is kept")
}

/// The weeks that were asked for and not yet answered: one, and retries of it.
#[derive(Clone, Default)]
struct Advancing(Arc<Mutex<(usize, Value)>>);

impl Advancing {
    /// Takes a request for a week; whether it may wait for its answer. While a week is simulated, only a retry with the same
    /// id may: it returns the first answer.
    fn begin(&self, request_id: &Value) -> bool {
        let mut weeks = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (open, id) = &mut *weeks;
        if *open > 0 && (request_id.is_null() || *id != *request_id) {
            return false;
        }
        *open += 1;
        *id = request_id.clone();
        true
    }

    /// A request for a week was answered.
    fn end(&self) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).0 -= 1;
    }
}

/// The session and what is needed to open it again.
struct Owned {
    /// None between a defect of ours and opening the run again.
    session: Option<Session>,
    folder: Option<PathBuf>,
    /// The language model that speaks in it.
    model: Option<ModelSettings>,
    door: Door,
    running: Running,
}

impl Owned {
    fn work(mut self, asked: &Receiver<Asked>, advancing: &Advancing) -> Result<(), RunError> {
        let interface = Interface { name: self.door.interface, window: None };
        if let Some(session) = &mut self.session {
            session.activity().take_up(interface);
        }
        while let Ok(Asked { number, request, reply }) = asked.recv() {
            let is_week = matches!(request, Request::NextWeek { .. });
            if reply.is_closed() && request.runs_code() {
                // Whoever asked has gone before it began.
                continue;
            }
            if request.runs_code() || (is_week && self.has_calculations()) {
                let interrupt = self
                    .session
                    .as_mut()
                    .and_then(|session| session.complete_database().and_then(RunDatabase::interrupt).ok());
                self.running.begin(number, request.runs_code(), interrupt);
            }
            let answer = self.answer(request);
            self.running.end();
            if is_week {
                advancing.end();
            }
            // Whoever asked may have gone.
            let _ = reply.send(answer);
        }
        match self.session {
            Some(mut session) => {
                session.activity().leave(LeavingCause::Quit);
                session.save()
            }
            None => Ok(()),
        }
    }

    /// Whether code runs before a week.
    fn has_calculations(&self) -> bool {
        let kept = |session: &Session| !session.notebook().statements(Kept::Calculation).entries().is_empty();
        self.session.as_ref().is_some_and(kept)
    }

    fn answer(&mut self, request: Request) -> Answer {
        if let Err(error) = self.open_again() {
            return Answer::wrong(Status::Failed, "internal_error", error);
        }
        let Some(session) = &mut self.session else { return gone() };
        let Door { via, on_defect, .. } = self.door;
        catch_unwind(AssertUnwindSafe(|| answer(session, request, via))).unwrap_or_else(|_| {
            // What the session holds may be half done; the trajectory is not.
            self.session = None;
            internal_error(on_defect)
        })
    }

    /// Opens the run again after a defect of ours.
    fn open_again(&mut self) -> Result<(), String> {
        if self.session.is_some() {
            return Ok(());
        }
        let folder = self.folder.as_ref().ok_or("the run was not kept and cannot be opened again")?;
        let mut session = Session::open(folder, Access::Write, true).map_err(|error| error.to_string())?;
        session.join_model(self.model.as_ref());
        self.session = Some(session);
        Ok(())
    }
}

/// A defect of ours, with a number by which its report is found.
fn internal_error(on_defect: OnDefect) -> Answer {
    static DEFECTS: AtomicU64 = AtomicU64::new(1);
    let id =
        format!("{:012x}", (u64::from(std::process::id()) << 16) + DEFECTS.fetch_add(1, Ordering::Relaxed));
    on_defect(&format!(
        "defect {id}: a request met a defect of the program; the run is opened again from its record"
    ));
    let mut answer = Answer::wrong(
        Status::Failed,
        "internal_error",
        "the program has a defect; what was confirmed before is kept, and the run goes on",
    );
    answer.body["defect_id"] = id.into();
    answer
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finish_reports_a_panic_while_the_run_is_saved() {
        let panicked = |folder: Option<&str>| {
            let thread = std::thread::spawn(|| panic!("a defect while saving"));
            let (run, folder) = ("0123abcd".to_owned(), folder.map(PathBuf::from));
            let owner = Owner { thread, running: Running::default(), run, folder };
            owner.finish().expect_err("it panicked").to_string()
        };
        let words = panicked(Some("runs/0123abcd"));
        assert!(
            words.contains("0123abcd/trajectory.jsonl") && words.contains("play --run 0123abcd"),
            "{words}"
        );
        assert!(panicked(None).contains("only in memory"));
    }
}
