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

/// The id of the served run, and the notification that stops the server.
#[derive(Clone)]
pub struct ServedRun {
    /// Id of the served run.
    pub run: String,
    /// Notification that a request to stop the server has arrived.
    pub stop: Arc<Notify>,
}

impl RouteState {
    fn has_release_2(&self) -> bool {
        self.handle.committed().is_some()
    }

    /// Converts a response to the form of the run's interface.
    fn converted(&self, response: ApiResponse) -> ApiResponse {
        if self.has_release_2() { release_2::convert(response) } else { response }
    }
}

/// Returns a router with all routes, which the guard protects.
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
    let door = RouteState { handle, guard: Arc::new(guard), numbers, served };
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
        .layer(from_fn_with_state(door.clone(), check_access))
        .with_state(door)
}

/// Returns the routes that release 2 does not have, or answers differently.
fn release_1_router() -> Router<RouteState> {
    Router::new()
        .route("/vars", get(|door: State<RouteState>| handle_read(door, ApiRequest::CurrentDay)))
        .route("/dashboard", get(|door: State<RouteState>| handle_read(door, ApiRequest::Dashboard)))
        .route("/game-status", get(|door: State<RouteState>| handle_read(door, ApiRequest::GameStatus)))
        .route(
            "/daily-scripts",
            get(|door: State<RouteState>| handle_read(door, ApiRequest::DailyScripts))
                .post(save_script)
                .delete(delete_script),
        )
}

async fn check_access(State(door): State<RouteState>, request: HttpRequest, next: Next) -> Response {
    match door.guard.rejection_for(request.headers()) {
        None => next.run(request).await,
        Some(answer) => to_http_response(&answer),
    }
}

async fn health(State(door): State<RouteState>) -> Response {
    let mut body = json!({ "status": "ok", "run": door.served.run });
    if door.has_release_2() {
        body["interface"] = "release_2".into();
    }
    json_response(StatusCode::OK, &body)
}

async fn shut_down(State(door): State<RouteState>) -> Response {
    door.served.stop.notify_one();
    json_response(StatusCode::OK, &json!({ "success": true, "run": door.served.run }))
}

async fn not_found(request: HttpRequest) -> Response {
    let error = format!("there is no route {} {}", request.method(), request.uri().path());
    json_response(StatusCode::NOT_FOUND, &json!({ "error": error }))
}

async fn tools(State(door): State<RouteState>) -> Response {
    let all: Vec<ToolDocument> =
        CATALOGUE.iter().map(|tool| document_tool(tool.spec(), &door.numbers)).collect();
    json_response(StatusCode::OK, &json!(all))
}

async fn table_documents(State(door): State<RouteState>) -> Response {
    json_response(StatusCode::OK, &json!(tables(door.numbers.interface())))
}

async fn openapi_document(State(door): State<RouteState>) -> Response {
    json_response(StatusCode::OK, &openapi::document(&door.numbers, door.has_release_2()))
}

async fn handle_read(State(door): State<RouteState>, request: ApiRequest) -> Response {
    to_http_response(&door.handle.send(request).await)
}

async fn handle_with_body(
    door: &RouteState,
    tool: ToolId,
    body: Body,
    request: impl FnOnce(BodyFields) -> ApiRequest,
) -> Response {
    match read_object(body).await {
        Ok(mut fields) => {
            if tool == ToolId::NextWeek && door.has_release_2() {
                let refusal =
                    release_2::rejection(tool.name(), fields.get(REQUEST_ID), fields.rejection.as_ref());
                fields.rejection = refusal;
            }
            let request = match fields.rejection.take() {
                Some(refusal) => ApiRequest::RejectedCall {
                    tool: tool.name().to_owned(),
                    args: fields.into_remaining(),
                    refusal,
                },
                None => request(fields),
            };
            to_http_response(&door.converted(door.handle.send(request).await))
        }
        Err(wrong) => close_connection(to_http_response(&door.converted(wrong))),
    }
}

async fn call(State(door): State<RouteState>, body: Body) -> Response {
    let mut fields = match read_object(body).await {
        Ok(fields) => fields,
        Err(wrong) => return close_connection(to_http_response(&door.converted(wrong))),
    };
    // Convert a name of another type to text, so that the tool is rejected as unknown.
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
    let mut refusal = fields.rejection.take();
    if door.has_release_2() {
        let sent = if request_id.is_null() { &args[REQUEST_ID] } else { &request_id };
        refusal = release_2::rejection(&tool, sent, refusal.as_ref()).or(refusal);
    }
    let request = match refusal {
        Some(refusal) => ApiRequest::RejectedCall { tool, args, refusal },
        None => ApiRequest::from_tool_call(&tool, args, request_id),
    };
    to_http_response(&door.converted(door.handle.send(request).await.into_tool_response()))
}

async fn next_week(State(door): State<RouteState>, body: Body) -> Response {
    handle_with_body(&door, ToolId::NextWeek, body, |fields| {
        ApiRequest::from_tool_call(ToolId::NextWeek.name(), fields.into_remaining(), Value::Null)
    })
    .await
}

async fn query(State(door): State<RouteState>, body: Body) -> Response {
    handle_with_body(&door, ToolId::Query, body, |fields| {
        ApiRequest::from_tool_call(ToolId::Query.name(), fields.into_remaining(), Value::Null)
    })
    .await
}

async fn save_script(State(door): State<RouteState>, body: Body) -> Response {
    handle_with_body(&door, ToolId::RegisterScript, body, |mut fields| ApiRequest::SaveDailyScript {
        name: fields.take("name"),
        content: fields.take("content"),
        request_id: fields.take("request_id"),
    })
    .await
}

async fn delete_script(State(door): State<RouteState>, body: Body) -> Response {
    handle_with_body(&door, ToolId::DeleteScript, body, |mut fields| ApiRequest::DeleteDailyScript {
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

/// Closes the connection after the response. Otherwise, the server would read the unread rest of the body as the next request.
fn close_connection(mut response: Response) -> Response {
    response.headers_mut().insert(header::CONNECTION, header::HeaderValue::from_static("close"));
    response
}

pub(super) fn json_response(status: StatusCode, body: &Value) -> Response {
    (status, [(header::CONTENT_TYPE, "application/json")], body.to_string()).into_response()
}
