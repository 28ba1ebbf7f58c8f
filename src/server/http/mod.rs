//! The HTTP server for one run, on 127.0.0.1 only, with limits on connections, sizes and times.

mod body;
mod guard;
mod release_2;
mod routes;
mod shutdown;

use std::io::{self, Write};
use std::net::Ipv4Addr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::GracefulShutdown;
use hyper_util::service::TowerToHyperService;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Semaphore;

use super::announcement::Announcement;
use super::request::{ApiResponse, ResponseStatus};
use super::worker::{InterfaceInfo, OnDefect, SessionWorker};
pub(super) use guard::new_token;

use guard::RequestGuard;
use novamind_record::error::RunError;
use novamind_record::files::create_private_file;
use novamind_record::trajectory::record::Via;
use novamind_session::Session;
use routes::ServedRun;
use shutdown::Shutdown;

/// Maximum number of open connections. Additional connections are rejected with status 503.
const MAX_CONNECTIONS: usize = 64;
/// Time limit for the response to a rejected connection and for closing it.
const REJECTED_CONNECTION_DEADLINE: Duration = Duration::from_secs(2);
/// Time limit for the arrival of a request's headers.
const HEAD_DEADLINE: Duration = Duration::from_secs(10);
/// Time limit for finishing pending requests while the server shuts down.
const SHUTDOWN_DEADLINE: Duration = Duration::from_secs(60);
/// Interval between attempts to stop running code while the server shuts down.
const STOP_INTERVAL: Duration = Duration::from_millis(100);

/// Options of the HTTP server.
#[derive(Debug, Clone, Default)]
pub struct HttpOptions {
    /// File with the token that requests must include.
    pub token: Option<PathBuf>,
}

/// A bound port on 127.0.0.1. The port is bound before the run is created, so that every created run can be served.
#[derive(Debug)]
pub struct BoundPort(std::net::TcpListener);

impl BoundPort {
    /// Binds a port of 127.0.0.1, or any free port if `port` is `None`.
    ///
    /// # Errors
    /// The port is in use.
    pub fn bind(port: Option<u16>) -> Result<BoundPort, RunError> {
        let address = (Ipv4Addr::LOCALHOST, port.unwrap_or(0));
        let bound = std::net::TcpListener::bind(address).and_then(|listener| {
            listener.set_nonblocking(true)?;
            Ok(listener)
        });
        match bound {
            Ok(listener) => Ok(BoundPort(listener)),
            Err(error) => Err(RunError::InvalidRequest(format!(
                "cannot use port {} of 127.0.0.1 ({error}); give another port, or none to use any free port",
                address.1
            ))),
        }
    }
}

/// Serves a run until a signal or a request stops the server. Calls `ready` with the address once the server accepts
/// requests, and `on_defect` with reports of internal errors.
///
/// # Errors
/// The token file cannot be read, or the last line of the record cannot be written.
pub fn serve_http(
    session: Session,
    bound_port: BoundPort,
    options: &HttpOptions,
    ready: impl FnOnce(&Announcement),
    on_defect: OnDefect,
) -> Result<(), RunError> {
    let token = options.token.as_deref().map(read_or_create_token).transpose()?;
    let run = session.manifest().id.clone();
    let folder = session.folder().map(PathBuf::from);
    let numbers = session.numbers();
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(RunError::io(Path::new("the network")))?;
    let (owner, handle) =
        SessionWorker::start(session, InterfaceInfo { via: Via::Http, interface: "http", on_defect });
    let served = runtime.block_on(async {
        let failed = || RunError::io(Path::new("the port"));
        let listener = TcpListener::from_std(bound_port.0).map_err(failed())?;
        let port = listener.local_addr().map_err(failed())?.port();
        let file = options.token.as_deref().map(|file| std::path::absolute(file).unwrap_or(file.to_owned()));
        let announcement =
            Announcement { run: run.clone(), port: Some(port), pid: std::process::id(), token: file };
        let shutdown = Shutdown::listen().map_err(failed())?;
        if let Some(folder) = &folder {
            announcement.write(folder)?;
        }
        ready(&announcement);
        let router = routes::router(
            handle,
            RequestGuard { token },
            numbers,
            ServedRun { run, stop: shutdown.stop_notifier() },
        );
        accept_connections(&listener, router, shutdown, &owner).await;
        Ok(())
    });
    // Drop aborted requests, because they still own handles to the session worker.
    drop(runtime);
    // The run is still locked, so no other server can have written an announcement.
    if let Some(folder) = &folder {
        Announcement::remove(folder);
    }
    owner.finish()?;
    served
}

/// Reads the token from a file, or creates the file with a new token.
fn read_or_create_token(path: &Path) -> Result<String, RunError> {
    let failed = RunError::io(path);
    match std::fs::read_to_string(path) {
        Ok(text) if !text.trim().is_empty() => Ok(text.trim().to_owned()),
        Ok(_) => Err(failed(io::Error::new(io::ErrorKind::InvalidData, "the token file is empty"))),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            let token = guard::new_token()?;
            create_private_file(path).and_then(|mut file| writeln!(file, "{token}")).map_err(failed)?;
            Ok(token)
        }
        Err(error) => Err(failed(error)),
    }
}

async fn accept_connections(
    listener: &TcpListener,
    router: axum::Router,
    mut shutdown: Shutdown,
    owner: &SessionWorker,
) {
    let (places, refusals) =
        (Arc::new(Semaphore::new(MAX_CONNECTIONS)), Arc::new(Semaphore::new(MAX_CONNECTIONS)));
    let open = GracefulShutdown::new();
    let mut http = hyper::server::conn::http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(HEAD_DEADLINE);
    loop {
        let stream = tokio::select! {
            accepted = listener.accept() => match accepted {
                Ok((stream, _)) => stream,
                // Too many files are open, or the client closed the connection. The next attempt may succeed.
                Err(_) => {
                    tokio::time::sleep(Duration::from_millis(20)).await;
                    continue;
                }
            },
            () = shutdown.wait() => break,
        };
        let Ok(place) = places.clone().try_acquire_owned() else {
            if let Ok(place) = refusals.clone().try_acquire_owned() {
                tokio::spawn(async move {
                    let _ =
                        tokio::time::timeout(REJECTED_CONNECTION_DEADLINE, reject_connection(stream)).await;
                    drop(place);
                });
            }
            continue;
        };
        let connection =
            http.serve_connection(TokioIo::new(stream), TowerToHyperService::new(router.clone()));
        let watched = open.watch(connection);
        tokio::spawn(async move {
            // Ignore errors, because a client that disconnects does not affect the run.
            let _ = watched.await;
            drop(place);
        });
    }
    // Stop repeatedly, because a week can have several calculations and a queued request may start a script.
    let stop_code = async {
        loop {
            owner.stop_running_code();
            tokio::time::sleep(STOP_INTERVAL).await;
        }
    };
    tokio::select! {
        () = open.shutdown() => {}
        () = stop_code => {}
        () = tokio::time::sleep(SHUTDOWN_DEADLINE) => {}
        () = shutdown.wait() => {}
    }
}

/// Rejects a connection, and reads its input until the client closes the connection. If the server closed a connection
/// with unread data, the client could lose the response.
async fn reject_connection(mut stream: TcpStream) {
    let message =
        format!("the server has {MAX_CONNECTIONS} open connections; send the request again in a second");
    let body = ApiResponse::invalid_request(ResponseStatus::Failed, "too_many_connections", message)
        .body
        .to_string();
    let head = format!(
        "HTTP/1.1 503 Service Unavailable\r\ncontent-type: application/json\r\ncontent-length: {}\r\nretry-after: 1\r\n\
         connection: close\r\n\r\n",
        body.len()
    );
    // Some clients report a connection error if the response arrives before they have sent their request.
    let mut unread = [0; 4096];
    let _ = tokio::time::timeout(REJECTED_CONNECTION_DEADLINE / 2, stream.read(&mut unread)).await;
    let answered = stream.write_all(format!("{head}{body}").as_bytes()).await;
    if answered.is_ok() && stream.shutdown().await.is_ok() {
        while matches!(stream.read(&mut unread).await, Ok(1..)) {}
    }
}
