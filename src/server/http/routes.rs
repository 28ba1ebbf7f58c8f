//! The routes of the HTTP server: they convert request bodies to requests, and responses to HTTP status codes.

use std::sync::Arc;

use axum::Router;
use axum::body::Body;
use axum::extract::{Request as HttpRequest, State};
use axum::http::{StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use serde_json::{Value, json};
use tokio::sync::Notify;

use super::body::{BodyFields, read_object};
use super::guard::RequestGuard;
use super::release_2;
use crate::openapi;
use crate::request::{ApiRequest, ApiResponse, ResponseStatus};
use crate::schema::REQUEST_ID;
use crate::worker::SessionHandle;
use novamind_database::tables;
use novamind_tools::describe::{ToolDocument, document_tool};
use novamind_tools::{CATALOGUE, ParameterNumbers, ToolId};

/// State that all routes share.
#[derive(Clone)]
pub(super) struct RouteState {
    pub(super) handle: SessionHandle,
    guard: Arc<RequestGuard>,
    numbers: Arc<ParameterNumbers>,
    served: ServedRun,
}

/// The served run, and how to stop its server.
#[derive(Clone)]
pub struct ServedRun {
    /// ID of the served run.
    pub run: String,
    /// Notified when a request to stop the server arrives.
    pub stop: Arc<Notify>,
}

impl RouteState {
    fn has_release_2(&self) -> bool {
        self.handle.committed().is_some()
    }

    /// Converts a response to the form of the run's interface.
    fn convert(&self, response: ApiResponse) -> ApiResponse {
        if self.has_release_2() { release_2::convert(response) } else { response }
    }
}

/// Returns a router with all routes. The guard checks every request.
pub fn router(
    handle: SessionHandle,
    guard: RequestGuard,
    numbers: Arc<ParameterNumbers>,
    served: ServedRun,
) -> Router {
    let generation = match handle.committed() {
        Some(committed) => release_2::router(committed),
        None => release_1_router(),
    };
    let state = RouteState { handle, guard: Arc::new(guard), numbers, served };
    Router::new()
        .merge(generation)
        .route("/health", get(health))
        .route("/call", post(call))
        .route("/next-week", post(next_week))
        .route("/query", post(query))
        .route("/tools", get(tools))
        .route("/tables", get(table_documents))
        .route("/openapi.json", get(openapi_document))
        .route("/shutdown", post(shut_down))
        .fallback(not_found)
        .method_not_allowed_fallback(not_found)
        .layer(from_fn_with_state(state.clone(), check_access))
        .with_state(state)
}

/// Returns the routes that do not exist in release 2, or whose responses differ in release 2.
fn release_1_router() -> Router<RouteState> {
    Router::new()
        .route("/vars", get(|state: State<RouteState>| handle_read(state, ApiRequest::CurrentDay)))
        .route("/dashboard", get(|state: State<RouteState>| handle_read(state, ApiRequest::Dashboard)))
        .route("/game-status", get(|state: State<RouteState>| handle_read(state, ApiRequest::GameStatus)))
        .route(
            "/daily-scripts",
            get(|state: State<RouteState>| handle_read(state, ApiRequest::DailyScripts))
                .post(save_script)
                .delete(delete_script),
        )
}

async fn check_access(State(state): State<RouteState>, request: HttpRequest, next: Next) -> Response {
    match state.guard.rejection_for(request.headers()) {
        None => next.run(request).await,
        Some(answer) => to_http_response(&answer),
    }
}

async fn health(State(state): State<RouteState>) -> Response {
    let mut body = json!({ "status": "ok", "run": state.served.run });
    if state.has_release_2() {
        body["interface"] = "release_2".into();
    }
    json_response(StatusCode::OK, &body)
}

async fn shut_down(State(state): State<RouteState>) -> Response {
    state.served.stop.notify_one();
    json_response(StatusCode::OK, &json!({ "success": true, "run": state.served.run }))
}

async fn not_found(request: HttpRequest) -> Response {
    let error = format!("there is no route {} {}", request.method(), request.uri().path());
    json_response(StatusCode::NOT_FOUND, &json!({ "error": error }))
}

async fn tools(State(state): State<RouteState>) -> Response {
    let all: Vec<ToolDocument> =
        CATALOGUE.iter().map(|tool| document_tool(tool.spec(), &state.numbers)).collect();
    json_response(StatusCode::OK, &json!(all))
}

async fn table_documents(State(state): State<RouteState>) -> Response {
    json_response(StatusCode::OK, &json!(tables(state.numbers.interface())))
}

async fn openapi_document(State(state): State<RouteState>) -> Response {
    json_response(StatusCode::OK, &openapi::document(&state.numbers, state.has_release_2()))
}

async fn handle_read(State(state): State<RouteState>, request: ApiRequest) -> Response {
    to_http_response(&state.handle.send(request).await)
}

async fn handle_with_body(
    state: &RouteState,
    tool: ToolId,
    body: Body,
    request: impl FnOnce(BodyFields) -> ApiRequest,
) -> Response {
    match read_object(body).await {
        Ok(mut fields) => {
            if tool == ToolId::NextWeek && state.has_release_2() {
                let rejection =
                    release_2::rejection(tool.name(), fields.get(REQUEST_ID), fields.rejection.as_ref());
                fields.rejection = rejection;
            }
            let request = match fields.rejection.take() {
                Some(rejection) => ApiRequest::RejectedCall {
                    tool: tool.name().to_owned(),
                    args: fields.into_remaining(),
                    rejection,
                },
                None => request(fields),
            };
            to_http_response(&state.convert(state.handle.send(request).await))
        }
        Err(wrong) => close_connection(to_http_response(&state.convert(wrong))),
    }
}

async fn call(State(state): State<RouteState>, body: Body) -> Response {
    let mut fields = match read_object(body).await {
        Ok(fields) => fields,
        Err(wrong) => return close_connection(to_http_response(&state.convert(wrong))),
    };
    // A name that is not a string is converted to text, so that it is rejected as an unknown tool.
    let tool = match fields.take("tool") {
        Value::String(name) => name,
        Value::Null => String::new(),
        other => other.to_string(),
    };
    let mut args = match fields.take("args") {
        Value::Null => json!({}),
        given => given,
    };
    // Clients may send `request_id` and `expected_day` next to the arguments or among the arguments.
    if let (Value::Object(args), day @ Value::Number(_)) = (&mut args, fields.take("expected_day")) {
        args.entry("expected_day").or_insert(day);
    }
    let request_id = fields.take(REQUEST_ID);
    let mut rejection = fields.rejection.take();
    if state.has_release_2() {
        let sent = if request_id.is_null() { &args[REQUEST_ID] } else { &request_id };
        rejection = release_2::rejection(&tool, sent, rejection.as_ref()).or(rejection);
    }
    let request = match rejection {
        Some(rejection) => ApiRequest::RejectedCall { tool, args, rejection },
        None => ApiRequest::from_tool_call(&tool, args, request_id),
    };
    to_http_response(&state.convert(state.handle.send(request).await.into_tool_response()))
}

async fn next_week(State(state): State<RouteState>, body: Body) -> Response {
    handle_with_body(&state, ToolId::NextWeek, body, |fields| {
        ApiRequest::from_tool_call(ToolId::NextWeek.name(), fields.into_remaining(), Value::Null)
    })
    .await
}

async fn query(State(state): State<RouteState>, body: Body) -> Response {
    handle_with_body(&state, ToolId::Query, body, |fields| {
        ApiRequest::from_tool_call(ToolId::Query.name(), fields.into_remaining(), Value::Null)
    })
    .await
}

async fn save_script(State(state): State<RouteState>, body: Body) -> Response {
    handle_with_body(&state, ToolId::RegisterScript, body, |mut fields| ApiRequest::SaveDailyScript {
        name: fields.take("name"),
        content: fields.take("content"),
        request_id: fields.take("request_id"),
    })
    .await
}

async fn delete_script(State(state): State<RouteState>, body: Body) -> Response {
    handle_with_body(&state, ToolId::DeleteScript, body, |mut fields| ApiRequest::DeleteDailyScript {
        name: fields.take("name"),
        request_id: fields.take("request_id"),
    })
    .await
}

fn status_code(status: ResponseStatus) -> StatusCode {
    match status {
        ResponseStatus::Done => StatusCode::OK,
        ResponseStatus::BadRequest => StatusCode::BAD_REQUEST,
        ResponseStatus::Unauthorized => StatusCode::UNAUTHORIZED,
        ResponseStatus::Forbidden => StatusCode::FORBIDDEN,
        ResponseStatus::NotFound => StatusCode::NOT_FOUND,
        ResponseStatus::Busy => StatusCode::CONFLICT,
        ResponseStatus::Failed => StatusCode::INTERNAL_SERVER_ERROR,
        ResponseStatus::TimedOut => StatusCode::GATEWAY_TIMEOUT,
        ResponseStatus::TooSlow => StatusCode::REQUEST_TIMEOUT,
        ResponseStatus::TooLarge => StatusCode::PAYLOAD_TOO_LARGE,
    }
}

pub(super) fn to_http_response(answer: &ApiResponse) -> Response {
    let mut response = json_response(status_code(answer.status), &answer.body);
    if answer.status == ResponseStatus::Busy {
        response.headers_mut().insert(header::RETRY_AFTER, header::HeaderValue::from_static("1"));
    }
    response
}

/// Closes the connection after the response. Otherwise, the server would read the unread rest of the body as the next
/// request.
fn close_connection(mut response: Response) -> Response {
    response.headers_mut().insert(header::CONNECTION, header::HeaderValue::from_static("close"));
    response
}

pub(super) fn json_response(status: StatusCode, body: &Value) -> Response {
    (status, [(header::CONTENT_TYPE, "application/json")], body.to_string()).into_response()
}
