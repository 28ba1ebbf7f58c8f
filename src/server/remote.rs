//! A run that a server on this machine plays, asked from another process.

use std::net::Ipv4Addr;
use std::path::Path;
use std::time::Duration;

use axum::body::{Body, to_bytes};
use axum::http::{Method, Request, header};
use hyper_util::rt::TokioIo;
use serde_json::{Value, json};
use tokio::net::TcpStream;

use super::announcement::Announcement;
use novamind_record::folder::lock::is_being_played;

/// A server that is well answers this at once, also while a week is simulated.
const HEALTH_DEADLINE: Duration = Duration::from_secs(10);
/// A week of a large company takes seconds; a script may take minutes.
const DEADLINE: Duration = Duration::from_secs(1800);
/// Bytes of an answer.
const MOST_BYTES: usize = 256 * 1024 * 1024;

/// A server that was found to play a run.
#[derive(Debug, Clone)]
pub struct Remote {
    /// What it says of itself.
    pub announcement: Announcement,
    /// Port on 127.0.0.1.
    pub port: u16,
    /// What requests carry, if they must carry something.
    pub token: Option<String>,
}

/// What a server said.
#[derive(Debug, Clone, PartialEq)]
pub struct Reply {
    /// Status of HTTP.
    pub status: u16,
    /// The object.
    pub body: Value,
}

impl Remote {
    /// The server that plays the run in a folder; none if there is none that answers for this run over HTTP.
    ///
    /// What a server that was killed left behind is recognised before anything is sent: nobody holds the run then.
    pub fn find(folder: &Path, run: &str) -> Option<Remote> {
        let announcement = Announcement::read(folder).filter(|own| own.run == run)?;
        if !is_being_played(folder) {
            return None;
        }
        let token = match &announcement.token {
            Some(file) => Some(std::fs::read_to_string(file).ok()?.trim().to_owned()),
            None => None,
        };
        let remote = Remote { port: announcement.port?, announcement, token };
        let health = remote.send(Method::GET, "/health", None, HEALTH_DEADLINE).ok()?;
        // A server that has no room for another connection names no run, and says so again to the request itself.
        let is_full = health.status == 503 && health.body["code"] == "too_many_connections";
        (is_full || health.status == 200 && health.body["run"] == run).then_some(remote)
    }

    /// Reads something.
    ///
    /// # Errors
    /// The server does not answer, or not in JSON: why, in words.
    pub fn get(&self, path: &str) -> Result<Reply, String> {
        self.send(Method::GET, path, None, DEADLINE)
    }

    /// Sends an object.
    ///
    /// # Errors
    /// As [`Remote::get`]. What was sent may have been done.
    pub fn post(&self, path: &str, body: &Value) -> Result<Reply, String> {
        self.send(Method::POST, path, Some(body), DEADLINE)
    }

    /// Asks the server to finish what it has in hand and to leave the run.
    ///
    /// # Errors
    /// As [`Remote::get`].
    pub fn shut_down(&self) -> Result<Reply, String> {
        self.post("/shutdown", &json!({}))
    }

    fn send(
        &self,
        method: Method,
        path: &str,
        body: Option<&Value>,
        deadline: Duration,
    ) -> Result<Reply, String> {
        let mut request = Request::builder()
            .method(method)
            .uri(path)
            .header(header::HOST, "127.0.0.1")
            .header(header::CONNECTION, "close")
            .header(header::CONTENT_TYPE, "application/json");
        if let Some(token) = &self.token {
            request = request.header(header::AUTHORIZATION, format!("Bearer {token}"));
        }
        let body = body.map_or_else(Body::empty, |body| Body::from(body.to_string()));
        let request = request.body(body).map_err(|error| error.to_string())?;
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
        let runtime = runtime.map_err(|error| error.to_string())?;
        runtime.block_on(async {
            let asked = tokio::time::timeout(deadline, ask(self.port, request));
            asked.await.map_err(|_| format!("it did not answer within {} s", deadline.as_secs()))?
        })
    }
}

async fn ask(port: u16, request: Request<Body>) -> Result<Reply, String> {
    let in_words = |error: &dyn std::error::Error| error.to_string();
    let stream = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).await.map_err(|error| in_words(&error))?;
    let (mut sender, connection) = hyper::client::conn::http1::handshake(TokioIo::new(stream))
        .await
        .map_err(|error| in_words(&error))?;
    tokio::spawn(async move {
        // What goes wrong on the way is told to whoever waits for the answer.
        let _ = connection.await;
    });
    let response = sender.send_request(request).await.map_err(|error| in_words(&error))?;
    let status = response.status().as_u16();
    let bytes =
        to_bytes(Body::new(response.into_body()), MOST_BYTES).await.map_err(|error| in_words(&error))?;
    let body = serde_json::from_slice(&bytes).map_err(|error| format!("it answered no JSON: {error}"))?;
    Ok(Reply { status, body })
}
