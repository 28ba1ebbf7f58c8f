//! The thread that owns the session, and the handle that interfaces use to send requests to this thread.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use serde_json::Value;
use tokio::sync::oneshot;

use super::committed::CommittedState;
use super::current_request::CurrentRequest;
use super::request::{ApiRequest, ApiResponse, ResponseStatus};
use super::request_handler::handle_request;
use novamind_record::error::RunError;
use novamind_record::trajectory::record::{DetachCause, Via};
use novamind_session::{Access, Interface, ModelSettings, RunDatabase, Session};
use novamind_tools::NotebookSection;

/// Function that receives reports of internal errors.
pub type OnDefect = fn(&str);

/// How an interface is recorded, and where it reports internal errors.
#[derive(Clone, Copy)]
pub struct InterfaceInfo {
    /// How the record names the interface in tool calls.
    pub via: Via,
    /// How the record names the interface when a session starts.
    pub interface: &'static str,
    /// Function that is called with reports of internal errors.
    pub on_defect: OnDefect,
}

/// A request, and the channel on which its response is sent.
struct QueuedRequest {
    number: u64,
    request: ApiRequest,
    reply: oneshot::Sender<ApiResponse>,
}

/// The thread that owns a session. The thread ends when all handles are dropped.
pub struct SessionWorker {
    thread: JoinHandle<Result<(), RunError>>,
    running: CurrentRequest,
    /// ID and folder of the run, for the error that reports a panic.
    run: String,
    folder: Option<PathBuf>,
}

impl SessionWorker {
    /// Moves a session to a new thread and returns a handle for requests.
    pub fn start(session: Session, interface: InterfaceInfo) -> (SessionWorker, SessionHandle) {
        let (sender, receiver) = channel();
        let advancing = PendingWeeks::default();
        let running = CurrentRequest::default();
        let committed = session.has_release_2_interface().then(|| CommittedState::new(&session));
        let handle = SessionHandle {
            sender,
            committed: committed.clone(),
            advancing: advancing.clone(),
            request_count: Arc::default(),
            running: running.clone(),
        };
        let (folder, model) = (session.folder().map(PathBuf::from), session.model_settings().cloned());
        let run = session.manifest().id.clone();
        let owned = WorkerState {
            folder: folder.clone(),
            model,
            session: Some(session),
            interface,
            running: running.clone(),
            committed,
        };
        let thread = std::thread::spawn(move || owned.run(&receiver, &advancing));
        (SessionWorker { thread, running, run, folder }, handle)
    }

    /// Stops the running script, calculation or statement, because a server that shuts down does not wait for it.
    pub fn stop_running_code(&self) {
        self.running.stop();
    }

    /// Waits until all responses are sent and the run is closed. All handles must have been dropped.
    ///
    /// # Errors
    /// The last line of the record cannot be written; all confirmed actions are saved. [`RunError::Defect`] if the
    /// thread panicked.
    pub fn finish(self) -> Result<(), RunError> {
        let SessionWorker { thread, run, folder, .. } = self;
        thread.join().unwrap_or(Err(RunError::Defect { run, folder }))
    }
}

/// A handle that sends requests to the session worker.
#[derive(Clone)]
pub struct SessionHandle {
    sender: Sender<QueuedRequest>,
    committed: Option<CommittedState>,
    advancing: PendingWeeks,
    /// Number of requests that were sent; the next request gets this number.
    request_count: Arc<AtomicU64>,
    running: CurrentRequest,
}

impl SessionHandle {
    /// Returns the state after the last executed request, if the run has the interface of release 2.
    pub fn committed(&self) -> Option<&CommittedState> {
        self.committed.as_ref()
    }

    /// Sends a request and waits for the response. If the caller stops waiting, a script or statement is stopped, but a
    /// week is simulated to its end.
    pub async fn send(&self, request: ApiRequest) -> ApiResponse {
        if let ApiRequest::NextWeek { request_id, .. } = &request
            && !self.advancing.try_begin(request_id)
        {
            return ApiResponse::invalid_request(
                ResponseStatus::Busy,
                "week_running",
                "a week is being simulated; request the next week after the response",
            );
        }
        let (reply, answer) = oneshot::channel();
        let number = self.request_count.fetch_add(1, Ordering::Relaxed);
        let watch = self.running.watch(number);
        if self.sender.send(QueuedRequest { number, request, reply }).is_err() {
            return worker_gone_response();
        }
        let answer = answer.await.unwrap_or_else(|_| worker_gone_response());
        watch.mark_answered();
        answer
    }
}

fn worker_gone_response() -> ApiResponse {
    ApiResponse::invalid_request(
        ResponseStatus::Failed,
        "closing",
        "the server is closing the run; all confirmed actions are saved",
    )
}

/// Number of pending requests for a week, and the request id that they share. All but the first are retries of the
/// first.
#[derive(Clone, Default)]
struct PendingWeeks(Arc<Mutex<(usize, Value)>>);

impl PendingWeeks {
    /// Adds a request for a week. Returns `false` if another week is being simulated and the request is not a
    /// retry with the same id. A retry waits and receives the first response.
    fn try_begin(&self, request_id: &Value) -> bool {
        let mut weeks = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (open, id) = &mut *weeks;
        if *open > 0 && (request_id.is_null() || *id != *request_id) {
            return false;
        }
        *open += 1;
        *id = request_id.clone();
        true
    }

    /// Removes a pending request for a week once its response is known.
    fn end(&self) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).0 -= 1;
    }
}

/// The session, and the data needed to reopen the run.
struct WorkerState {
    /// `None` between an internal error and reopening the run.
    session: Option<Session>,
    folder: Option<PathBuf>,
    /// Settings of the model voice.
    model: Option<ModelSettings>,
    interface: InterfaceInfo,
    running: CurrentRequest,
    /// State that the server reports during a request, if the run has the interface of release 2.
    committed: Option<CommittedState>,
}

impl WorkerState {
    fn run(mut self, receiver: &Receiver<QueuedRequest>, advancing: &PendingWeeks) -> Result<(), RunError> {
        let interface = Interface { name: self.interface.interface, window: None };
        if let Some(session) = &mut self.session {
            session.activity().attach(interface);
        }
        while let Ok(QueuedRequest { number, request, reply }) = receiver.recv() {
            let is_week = matches!(request, ApiRequest::NextWeek { .. });
            if reply.is_closed() && request.runs_code() {
                // The client disconnected before the request started.
                continue;
            }
            if request.runs_code() || (is_week && self.has_calculations()) {
                let interrupt = self.session.as_mut().and_then(|session| {
                    session.up_to_date_database().and_then(RunDatabase::interrupt_handle).ok()
                });
                self.running.begin(number, request.runs_code(), interrupt);
            }
            let answer = self.respond_and_commit(request);
            self.running.end();
            if is_week {
                advancing.end();
            }
            // The client may have disconnected.
            let _ = reply.send(answer);
        }
        match self.session {
            Some(mut session) => {
                session.activity().detach(DetachCause::Quit);
                session.save()
            }
            None => Ok(()),
        }
    }

    /// Returns whether the run has calculations. They run before each week.
    fn has_calculations(&self) -> bool {
        let kept = |session: &Session| {
            !session.notebook().statements(NotebookSection::Calculation).entries().is_empty()
        };
        self.session.as_ref().is_some_and(kept)
    }

    /// Executes a request. If the request can change the run, the committed state contains its id during the execution.
    fn respond_and_commit(&mut self, request: ApiRequest) -> ApiResponse {
        let committed = self.committed.clone().filter(|state| {
            let id = request.stored_id();
            id.inspect(|id| state.begin(id)).is_some()
        });
        let response = self.respond(request);
        if let Some(state) = committed {
            state.commit(self.session.as_ref());
        }
        response
    }

    fn respond(&mut self, request: ApiRequest) -> ApiResponse {
        if let Err(error) = self.reopen() {
            return ApiResponse::invalid_request(ResponseStatus::Failed, "internal_error", error);
        }
        let Some(session) = &mut self.session else { return worker_gone_response() };
        let InterfaceInfo { via, on_defect, .. } = self.interface;
        catch_unwind(AssertUnwindSafe(|| handle_request(session, request, via))).unwrap_or_else(|_| {
            // The session in memory may be inconsistent, but the trajectory is consistent.
            self.session = None;
            internal_error(on_defect)
        })
    }

    /// Reopens the run after an internal error.
    fn reopen(&mut self) -> Result<(), String> {
        if self.session.is_some() {
            return Ok(());
        }
        let folder = self.folder.as_ref().ok_or("the run was not saved and cannot be reopened")?;
        let mut session = Session::open(folder, Access::Write, true).map_err(|error| error.to_string())?;
        session.connect_model(self.model.as_ref());
        self.session = Some(session);
        Ok(())
    }
}

/// Reports an internal error to `on_defect`, and returns a response that contains the ID of the report.
fn internal_error(on_defect: OnDefect) -> ApiResponse {
    static DEFECTS: AtomicU64 = AtomicU64::new(1);
    let id =
        format!("{:012x}", (u64::from(std::process::id()) << 16) + DEFECTS.fetch_add(1, Ordering::Relaxed));
    on_defect(&format!("internal error {id}: a request failed; the run is reopened from its record"));
    let mut answer = ApiResponse::invalid_request(
        ResponseStatus::Failed,
        "internal_error",
        "an internal error occurred; all actions confirmed before it are saved, and the run continues",
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
            let owner = SessionWorker { thread, running: CurrentRequest::default(), run, folder };
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
