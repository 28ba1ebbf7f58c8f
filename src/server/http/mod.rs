//! The HTTP door: 127.0.0.1 only, one run, bounded in every direction.

mod body;
mod guard;
mod routes;
mod shutdown;

use std::io;
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
use super::owner::{Door, OnDefect, Owner};
use super::request::{Answer, Status};
use guard::Guard;
use novamind_record::error::RunError;
use novamind_record::trajectory::record::Via;
use novamind_session::Session;
use routes::Served;
use shutdown::Shutdown;

/// Connections that are open at once. Further ones are refused with status 503.
const MAX_CONNECTIONS: usize = 64;
/// A refused connection is closed after this time at the latest.
const REFUSAL_DEADLINE: Duration = Duration::from_secs(2);
/// A head of a request that takes longer closes its connection.
const HEAD_DEADLINE: Duration = Duration::from_secs(10);
/// Requests in hand when the server is asked to stop have this long to arrive and be answered.
const LAST_REQUESTS: Duration = Duration::from_secs(60);
/// Between two looks for code that keeps a server from ending.
const BETWEEN_STOPS: Duration = Duration::from_millis(100);

/// How a run is served.
#[derive(Debug, Clone, Default)]
pub struct HttpOptions {
    /// Requests must carry the token in this file.
    pub token: Option<PathBuf>,
}

/// A port that is held before there is a run to serve on it: a run that cannot be served is not begun.
#[derive(Debug)]
pub struct HeldPort(std::net::TcpListener);

impl HeldPort {
    /// Takes a port of 127.0.0.1; any free one if none is named.
    ///
    /// # Errors
    /// It is taken.
    pub fn take(port: Option<u16>) -> Result<HeldPort, RunError> {
        let address = (Ipv4Addr::LOCALHOST, port.unwrap_or(0));
        let bound = std::net::TcpListener::bind(address).and_then(|listener| {
            listener.set_nonblocking(true)?;
            Ok(listener)
        });
        match bound {
            Ok(listener) => Ok(HeldPort(listener)),
            Err(error) => Err(RunError::NotPossible(format!(
                "port {} of 127.0.0.1 cannot be used ({error}); name another one, or none for any free one",
                address.1
            ))),
        }
    }
}

/// Serves a run on a port until a signal asks to stop. `ready` is told where, once requests are taken; `on_defect` hears of defects of ours.
///
/// # Errors
/// The file of the token cannot be read; the disk did not take the end of the record.
pub fn serve_http(
    session: Session,
    held: HeldPort,
    options: &HttpOptions,
    ready: impl FnOnce(&Announcement),
    on_defect: OnDefect,
) -> Result<(), RunError> {
    let token = options.token.as_deref().map(token_of).transpose()?;
    let run = session.manifest().id.clone();
    let folder = session.folder().map(PathBuf::from);
    let numbers = session.numbers();
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(RunError::io(Path::new("the network")))?;
    let (owner, handle) = Owner::start(session, Door { via: Via::Http, interface: "http", on_defect });
    let served = runtime.block_on(async {
        let failed = || RunError::io(Path::new("the port"));
        let listener = TcpListener::from_std(held.0).map_err(failed())?;
        let port = listener.local_addr().map_err(failed())?.port();
        let file = options.token.as_deref().map(|file| std::path::absolute(file).unwrap_or(file.to_owned()));
        let announcement =
            Announcement { run: run.clone(), port: Some(port), pid: std::process::id(), token: file };
        let shutdown = Shutdown::listen().map_err(failed())?;
        if let Some(folder) = &folder {
            announcement.put_up(folder)?;
        }
        ready(&announcement);
        let router =
            routes::router(handle, Guard { token }, numbers, Served { run, stop: shutdown.asking() });
        take_connections(&listener, router, shutdown, &owner).await;
        Ok(())
    });
    // Requests that were cut off hold handles of the owner.
    drop(runtime);
    // While the run is still held: nobody else can have put up another one.
    if let Some(folder) = &folder {
        Announcement::take_down(folder);
    }
    owner.finish()?;
    served
}

/// The token of a file, made with it if there is none.
fn token_of(path: &Path) -> Result<String, RunError> {
    let failed = RunError::io(path);
    match std::fs::read_to_string(path) {
        Ok(text) if !text.trim().is_empty() => Ok(text.trim().to_owned()),
        Ok(_) => Err(failed(io::Error::new(io::ErrorKind::InvalidData, "the file of the token is empty"))),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            let token = guard::new_token()?;
            guard::write_private(path, &token).map_err(failed)?;
            Ok(token)
        }
        Err(error) => Err(failed(error)),
    }
}

async fn take_connections(
    listener: &TcpListener,
    router: axum::Router,
    mut shutdown: Shutdown,
    owner: &Owner,
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
                // Too many open files, a connection that is gone already: the next one may do.
                Err(_) => {
                    tokio::time::sleep(Duration::from_millis(20)).await;
                    continue;
                }
            },
            () = shutdown.asked() => break,
        };
        let Ok(place) = places.clone().try_acquire_owned() else {
            if let Ok(place) = refusals.clone().try_acquire_owned() {
                tokio::spawn(async move {
                    let _ = tokio::time::timeout(REFUSAL_DEADLINE, refuse(stream)).await;
                    drop(place);
                });
            }
            continue;
        };
        let connection =
            http.serve_connection(TokioIo::new(stream), TowerToHyperService::new(router.clone()));
        let watched = open.watch(connection);
        tokio::spawn(async move {
            // A client that goes away in the middle is no concern of the run.
            let _ = watched.await;
            drop(place);
        });
    }
    // Again and again: a week has several calculations, and a request that waits may hold a script.
    let stop_code = async {
        loop {
            owner.stop_code();
            tokio::time::sleep(BETWEEN_STOPS).await;
        }
    };
    tokio::select! {
        () = open.shutdown() => {}
        () = stop_code => {}
        () = tokio::time::sleep(LAST_REQUESTS) => {}
        () = shutdown.asked() => {}
    }
}

/// Answers a connection for which there is no room, and reads what it sends until it closes: a connection that is closed with
/// unread data can lose the answer.
async fn refuse(mut stream: TcpStream) {
    let message =
        format!("the server has {MAX_CONNECTIONS} open connections; send the request again in a second");
    let body = Answer::wrong(Status::Failed, "too_many_connections", message).body.to_string();
    let head = format!(
        "HTTP/1.1 503 Service Unavailable\r\ncontent-type: application/json\r\ncontent-length: {}\r\nretry-after: 1\r\n\
         connection: close\r\n\r\n",
        body.len()
    );
    // Clients take an answer that comes before they have asked for a fault of the connection.
    let mut unread = [0; 4096];
    let _ = tokio::time::timeout(REFUSAL_DEADLINE / 2, stream.read(&mut unread)).await;
    let answered = stream.write_all(format!("{head}{body}").as_bytes()).await;
    if answered.is_ok() && stream.shutdown().await.is_ok() {
        while matches!(stream.read(&mut unread).await, Ok(1..)) {}
    }
}
