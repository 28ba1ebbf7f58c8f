//! The experimenter's page: a table of sessions, and the actions that the audit log records.

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use axum::extract::{Form, Path, State};
use axum::http::header::{RETRY_AFTER, SET_COOKIE};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Redirect, Response};
use axum::routing::{get, post};
use axum::{Extension, Router};
use serde::Deserialize;

use super::WebHost;
use super::admin_page;
use super::attempt_limit::AttemptLimit;
use super::pages::message_page;
use super::request_guard::{ADMIN_COOKIE, CheckedRequest, cookie, set_cookie};
use crate::access::random_text;
use crate::audit::AuditEvent;
use novamind_record::error::RunError;
use novamind_study::session_statuses;

/// Time without a request after which the experimenter has to enter the code again.
const SIGNED_IN_FOR: Duration = Duration::from_secs(12 * 60 * 60);
/// Number of wrong codes of an address without a waiting time.
const FREE_WRONG_CODES: u32 = 2;
/// Number of browsers that can be signed in at the same time.
const MAX_SIGNED_IN: usize = 32;
/// Maximum length of a message or a reason in characters.
pub(super) const MAX_TEXT_CHARACTERS: usize = 500;

/// Browsers in which the code was entered.
#[derive(Debug)]
pub(super) struct AdminAccess {
    wrong_codes: AttemptLimit,
    signed_in: Mutex<BTreeMap<String, SignedIn>>,
}

/// A browser in which the code was entered.
#[derive(Debug, Clone)]
struct SignedIn {
    /// Text that every form contains, so that pages of other sites cannot send a form.
    form_token: String,
    last_request: Instant,
}

impl AdminAccess {
    pub fn new() -> AdminAccess {
        AdminAccess { wrong_codes: AttemptLimit::new(FREE_WRONG_CODES), signed_in: Mutex::default() }
    }

    /// Returns the token of forms if the request comes from a browser in which the code was entered.
    fn form_token(&self, head: &HeaderMap) -> Option<String> {
        let mut browsers = self.lock();
        browsers.retain(|_, browser| browser.last_request.elapsed() < SIGNED_IN_FOR);
        let browser = browsers.get_mut(&cookie_digest(cookie(head, ADMIN_COOKIE)?))?;
        browser.last_request = Instant::now();
        Some(browser.form_token.clone())
    }

    /// Signs a browser in. Returns the value of its cookie.
    fn sign_in(&self) -> Result<String, RunError> {
        let (value, form_token) = (random_text::<16>()?, random_text::<16>()?);
        let mut browsers = self.lock();
        if browsers.len() >= MAX_SIGNED_IN {
            let oldest = browsers.iter().min_by_key(|(_, browser)| browser.last_request);
            if let Some(oldest) = oldest.map(|(digest, _)| digest.clone()) {
                browsers.remove(&oldest);
            }
        }
        browsers.insert(cookie_digest(&value), SignedIn { form_token, last_request: Instant::now() });
        Ok(value)
    }

    fn sign_out(&self, head: &HeaderMap) {
        if let Some(value) = cookie(head, ADMIN_COOKIE) {
            self.lock().remove(&cookie_digest(value));
        }
    }

    fn lock(&self) -> MutexGuard<'_, BTreeMap<String, SignedIn>> {
        self.signed_in.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Digests are looked up, because the time of a lookup does not depend on how much of the value is right.
fn cookie_digest(value: &str) -> String {
    blake3::hash(value.as_bytes()).to_hex().to_string()
}

/// Returns the routes below `/admin`.
pub(super) fn routes() -> Router<WebHost> {
    Router::new()
        .route("/admin", get(overview))
        .route("/admin/sign-in", post(sign_in))
        .route("/admin/sign-out", post(sign_out))
        .route("/admin/session/{label}", get(session_page).post(act))
}

async fn overview(State(host): State<WebHost>, head: HeaderMap) -> Response {
    let Some(form_token) = host.admin().form_token(&head) else {
        return sign_in_page(&host, None);
    };
    let rows = session_rows(&host, None).await;
    admin_page::overview(&host.sessions().folder().study().protocol.name, &rows, &form_token).into_response()
}

fn sign_in_page(host: &WebHost, problem: Option<String>) -> Response {
    if host.sessions().folder().admin_code().is_none() {
        let text =
            "This host has no code for this page. Set one with `novamind host code`, then reload this page.";
        return (StatusCode::NOT_FOUND, message_page("No code", text)).into_response();
    }
    let status = if problem.is_some() { StatusCode::FORBIDDEN } else { StatusCode::OK };
    (status, admin_page::sign_in(problem.as_deref())).into_response()
}

#[derive(Deserialize)]
struct SignInForm {
    code: String,
}

async fn sign_in(
    State(host): State<WebHost>,
    Extension(request): Extension<CheckedRequest>,
    Form(form): Form<SignInForm>,
) -> Response {
    let address = request.client;
    let attempts = &host.admin().wrong_codes;
    // The right code has to wait as well; otherwise the waiting time would not slow down guesses.
    if let Some(delay) = attempts.delay(address, Instant::now()) {
        return must_wait(delay);
    }
    // The attempt counts as a failure while the code is checked, so that parallel guesses have to wait.
    attempts.record_failure(address, Instant::now());
    let checking = host.clone();
    let code = form.code.trim().to_owned();
    let check = move || checking.sessions().folder().admin_code().is_some_and(|digest| digest.matches(&code));
    // The digest of a code takes time to compute.
    let is_right = tokio::task::spawn_blocking(check).await.unwrap_or(false);
    if !is_right {
        host.sessions().record(&AuditEvent::WrongAdminCode { address: address.to_string() });
        return sign_in_page(
            &host,
            Some("The code is wrong. Each further attempt has to wait longer.".to_owned()),
        );
    }
    attempts.record_success(address);
    host.sessions().record(&AuditEvent::AdminSignedIn { address: address.to_string() });
    let Ok(value) = host.admin().sign_in() else { return StatusCode::INTERNAL_SERVER_ERROR.into_response() };
    let cookie = set_cookie(ADMIN_COOKIE, &value, "/admin", request.is_secure);
    ([(SET_COOKIE, cookie)], Redirect::to("/admin")).into_response()
}

fn must_wait(delay: Duration) -> Response {
    let seconds = delay.as_secs() + 1;
    let problem = format!("Too many wrong codes. Wait {seconds} s, then enter the code.");
    let page = admin_page::sign_in(Some(&problem));
    (StatusCode::TOO_MANY_REQUESTS, [(RETRY_AFTER, seconds.to_string())], page).into_response()
}

#[derive(Deserialize)]
struct SignOutForm {
    form_token: String,
}

async fn sign_out(State(host): State<WebHost>, head: HeaderMap, Form(form): Form<SignOutForm>) -> Response {
    if let Some(refused) = form_rejection(&host, &head, &form.form_token) {
        return refused;
    }
    host.admin().sign_out(&head);
    Redirect::to("/admin").into_response()
}

/// Returns a rejection if a form was not sent from a page of a browser in which the code was entered.
fn form_rejection(host: &WebHost, head: &HeaderMap, form_token: &str) -> Option<Response> {
    let Some(expected) = host.admin().form_token(head) else {
        return Some(Redirect::to("/admin").into_response());
    };
    if cookie_digest(&expected) == cookie_digest(form_token) {
        return None;
    }
    let text = "The form is out of date, and nothing was changed. Open the page again.";
    Some((StatusCode::FORBIDDEN, message_page("Not changed", text)).into_response())
}

async fn session_page(State(host): State<WebHost>, head: HeaderMap, Path(label): Path<String>) -> Response {
    let Some(form_token) = host.admin().form_token(&head) else {
        return Redirect::to("/admin").into_response();
    };
    show_session(&host, &label, &form_token, None).await
}

async fn show_session(
    host: &WebHost,
    label: &str,
    form_token: &str,
    outcome: Option<Result<&str, String>>,
) -> Response {
    let Some(row) = session_rows(host, Some(label)).await.pop() else {
        let page = message_page("Unknown label", "This label is not in the study.");
        return (StatusCode::NOT_FOUND, page).into_response();
    };
    let status = match outcome {
        Some(Err(_)) => StatusCode::CONFLICT,
        _ => StatusCode::OK,
    };
    (status, admin_page::session(&row, form_token, outcome)).into_response()
}

#[derive(Deserialize)]
struct ActionForm {
    form_token: String,
    action: Action,
    #[serde(default)]
    text: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Action {
    Message,
    Pause,
    Resume,
    End,
}

async fn act(
    State(host): State<WebHost>,
    Extension(request): Extension<CheckedRequest>,
    head: HeaderMap,
    Path(label): Path<String>,
    Form(form): Form<ActionForm>,
) -> Response {
    if let Some(refused) = form_rejection(&host, &head, &form.form_token) {
        return refused;
    }
    let text = form.text.trim();
    let problem = match form.action {
        _ if text.chars().count() > MAX_TEXT_CHARACTERS => {
            Some(format!("The text has more than {MAX_TEXT_CHARACTERS} characters. Shorten it."))
        }
        Action::Message if text.is_empty() => Some("Enter the text of the message.".to_owned()),
        Action::End if text.is_empty() => Some("Enter the reason for ending the session.".to_owned()),
        _ => None,
    };
    let outcome = match problem {
        Some(problem) => Err(problem),
        None => apply(&host, &label, form.action, text, request.client).await,
    };
    show_session(&host, &label, &form.form_token, Some(outcome)).await
}

/// Applies an action, after it was recorded. Returns the text that the experimenter is shown.
async fn apply(
    host: &WebHost,
    label: &str,
    action: Action,
    text: &str,
    address: IpAddr,
) -> Result<&'static str, String> {
    let (name, done) = match action {
        Action::Message => ("message", "The message was sent."),
        Action::Pause => ("pause", "The session is paused. Its program has saved and closed."),
        Action::Resume => ("resume", "The participant can continue."),
        Action::End => ("end", "The session is ended. Its program has saved and closed."),
    };
    let sessions = host.sessions();
    let event = AuditEvent::Act {
        label: label.to_owned(),
        action: name,
        text: text.to_owned(),
        address: address.to_string(),
    };
    let refused = |error| format!("Nothing was changed, because the audit log cannot be written: {error}");
    sessions.audit().append(&event).map_err(refused)?;
    let applied = match action {
        Action::Message => sessions.message(label, text),
        Action::Pause => sessions.pause(label).await,
        Action::Resume => sessions.resume(label).await,
        Action::End => sessions.end(label, text).await,
    };
    applied.map(|()| done).map_err(|error| error.to_string())
}

/// The state of a session, as a row of the table shows it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SessionRow {
    pub label: String,
    /// The connected client, or `None`.
    pub client: Option<String>,
    pub state: crate::SessionState,
    pub connected_for: Option<Duration>,
    /// Time since the last key since the host started.
    pub idle_for: Option<Duration>,
    /// The latest run of the participant.
    pub run: Option<RunProgress>,
}

/// The progress of a run, from its record.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RunProgress {
    pub is_practice: bool,
    pub week: u32,
    pub weeks: u32,
    pub state: novamind_study::SessionState,
    /// Time since the last recorded action.
    pub last_action: Duration,
    /// Time since the run was created.
    pub elapsed: Duration,
    pub problems: Vec<String>,
}

/// Returns the rows of the table, or only the row of one label. Reads the last lines of the records.
async fn session_rows(host: &WebHost, label: Option<&str>) -> Vec<SessionRow> {
    let (sessions, label) = (host.sessions().clone(), label.map(str::to_owned));
    let read = move || {
        let folder = sessions.folder();
        let mut statuses = sessions.statuses();
        statuses.retain(|status| label.as_ref().is_none_or(|label| *label == status.label));
        let rows = statuses.into_iter().map(|status| SessionRow {
            run: latest_run(folder.study(), &folder.runs_folder(&status.label)),
            label: status.label,
            client: status.client.map(|client| client.to_string()),
            state: status.state,
            connected_for: status.connected_for,
            idle_for: status.idle_for,
        });
        rows.collect()
    };
    tokio::task::spawn_blocking(read).await.unwrap_or_default()
}

fn latest_run(study: &novamind_study::Study, runs: &std::path::Path) -> Option<RunProgress> {
    let status = session_statuses(study, runs).into_iter().min_by(|one, other| {
        (one.practice, one.quiet_seconds)
            .partial_cmp(&(other.practice, other.quiet_seconds))
            .unwrap_or(std::cmp::Ordering::Equal)
    })?;
    let seconds = |seconds: f64| Duration::try_from_secs_f64(seconds).unwrap_or_default();
    Some(RunProgress {
        is_practice: status.practice,
        week: status.day.div_ceil(7),
        weeks: status.days.div_ceil(7),
        state: status.state,
        last_action: seconds(status.quiet_seconds),
        elapsed: seconds(status.elapsed_seconds),
        problems: status.problems,
    })
}
