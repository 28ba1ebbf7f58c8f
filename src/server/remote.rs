//! A client for a run that is played by a server on this machine.

use std::net::Ipv4Addr;
use std::path::Path;
use std::time::Duration;

use axum::body::{Body, to_bytes};
use axum::http::{Method, Request, header};
use hyper_util::rt::TokioIo;
use serde_json::{Value, json};
use tokio::net::TcpStream;

use super::announcement::Announcement;
use super::http::new_token;
use super::request_id::needs_request_id;
use novamind_record::error::RunError;
use novamind_record::folder::lock::is_locked;

/// Time limit for the health check. A working server responds immediately, even during a week.
const HEALTH_DEADLINE: Duration = Duration::from_secs(10);
/// Time limit for all requests except the health check. A week of a large company takes seconds, and a script can take
/// minutes.
const REQUEST_DEADLINE: Duration = Duration::from_secs(1800);
/// Maximum size of a response in bytes.
const MAX_RESPONSE_BYTES: usize = 256 * 1024 * 1024;

/// A running server that plays a run.
#[derive(Debug, Clone)]
pub struct RemoteServer {
    /// Announcement of the server.
    pub announcement: Announcement,
    /// Port of the server on 127.0.0.1.
    pub port: u16,
    /// Token for requests, if the server requires a token.
    pub token: Option<String>,
    /// Whether the run has the interface of release 2.
    has_release_2: bool,
}

/// A response of a server.
#[derive(Debug, Clone, PartialEq)]
pub struct ServerResponse {
    /// HTTP status code of the response.
    pub status: u16,
    /// JSON body of the response.
    pub body: Value,
}

impl RemoteServer {
    /// Finds the server that plays the run in a folder. Returns `None` if no server responds for this run
    /// over HTTP.
    ///
    /// The announcement of a killed server is detected without a request, because no process has locked the run.
    pub fn find(folder: &Path, run: &str) -> Option<RemoteServer> {
        let announcement = Announcement::read(folder).filter(|announcement| announcement.run == run)?;
        if !is_locked(folder) {
            return None;
        }
        let token = match &announcement.token {
            Some(file) => Some(std::fs::read_to_string(file).ok()?.trim().to_owned()),
            None => None,
        };
        let mut remote = RemoteServer { port: announcement.port?, announcement, token, has_release_2: false };
        let health = remote.send(Method::GET, "/health", None, HEALTH_DEADLINE).ok()?;
        // A server with too many connections rejects the health check with a response that does not name the run. The
        // server will also reject the actual request.
        let is_full = health.status == 503 && health.body["code"] == "too_many_connections";
        remote.has_release_2 = health.body["interface"] == "release_2";
        (is_full || health.status == 200 && health.body["run"] == run).then_some(remote)
    }

    /// Returns a new request id if calls of the tool need one.
    ///
    /// # Errors
    /// The system cannot generate random numbers.
    pub fn new_request_id(&self, tool: &str) -> Result<Option<String>, RunError> {
        (self.has_release_2 && needs_request_id(tool)).then(new_token).transpose()
    }

    /// Sends a GET request.
    ///
    /// # Errors
    /// The server does not respond, or the response is not valid JSON. The error describes the problem.
    pub fn get(&self, path: &str) -> Result<ServerResponse, String> {
        self.send(Method::GET, path, None, REQUEST_DEADLINE)
    }

    /// Sends a POST request with a JSON object as its body.
    ///
    /// # Errors
    /// Same as [`RemoteServer::get`]. The server may have executed the request despite the error.
    pub fn post(&self, path: &str, body: &Value) -> Result<ServerResponse, String> {
        self.send(Method::POST, path, Some(body), REQUEST_DEADLINE)
    }

    /// Asks the server to finish pending requests and close the run.
    ///
    /// # Errors
    /// Same as [`RemoteServer::get`].
    pub fn shut_down(&self) -> Result<ServerResponse, String> {
        self.post("/shutdown", &json!({}))
    }

    fn send(
        &self,
        method: Method,
        path: &str,
        body: Option<&Value>,
        deadline: Duration,
    ) -> Result<ServerResponse, String> {
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
            let asked = tokio::time::timeout(deadline, exchange(self.port, request));
            asked.await.map_err(|_| format!("no response within {} s", deadline.as_secs()))?
        })
    }
}

async fn exchange(port: u16, request: Request<Body>) -> Result<ServerResponse, String> {
    let in_words = |error: &dyn std::error::Error| error.to_string();
    let stream = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).await.map_err(|error| in_words(&error))?;
    let (mut sender, connection) = hyper::client::conn::http1::handshake(TokioIo::new(stream))
        .await
        .map_err(|error| in_words(&error))?;
    tokio::spawn(async move {
        // Errors of the connection are ignored here, because the pending request reports them.
        let _ = connection.await;
    });
    let response = sender.send_request(request).await.map_err(|error| in_words(&error))?;
    let status = response.status().as_u16();
    let bytes = to_bytes(Body::new(response.into_body()), MAX_RESPONSE_BYTES)
        .await
        .map_err(|error| in_words(&error))?;
    let body =
        serde_json::from_slice(&bytes).map_err(|error| format!("the response is not valid JSON: {error}"))?;
    Ok(ServerResponse { status, body })
}
