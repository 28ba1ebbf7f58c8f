//! The routes: how each reads its body, and the status of its response.

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

use super::body::{Fields, read_object};
use super::guard::Guard;
use crate::openapi;
use crate::owner::Handle;
use crate::request::{Answer, Request, Status};
use novamind_database::tables;
use novamind_tools::describe::{ToolDocument, document};
use novamind_tools::{CATALOGUE, Numbers, ToolId};

/// State of the routes.
#[derive(Clone)]
struct Routed {
    handle: Handle,
    guard: Arc<Guard>,
    numbers: Arc<Numbers>,
    served: Served,
}

/// The run of the server and its stop notification.
#[derive(Clone)]
pub struct Served {
    /// Run id.
    pub run: String,
    /// Notified when a request asks to stop.
    pub stop: Arc<Notify>,
}

/// Returns all routes, protected by the guard.
pub fn router(handle: Handle, guard: Guard, numbers: Arc<Numbers>, served: Served) -> Router {
    let door = Routed { handle, guard: Arc::new(guard), numbers, served };
    Router::new()
        .route("/health", get(health))
        .route("/vars", get(|door: State<Routed>| ask(door, Request::Vars)))
        .route("/dashboard", get(|door: State<Routed>| ask(door, Request::Dashboard)))
        .route("/game-status", get(|door: State<Routed>| ask(door, Request::GameStatus)))
        .route("/call", post(call))
        .route("/next-week", post(next_week))
        .route("/query", post(query))
        .route(
            "/daily-scripts",
            get(|door: State<Routed>| ask(door, Request::DailyScripts))
                .post(keep_script)
                .delete(forget_script),
        )
        .route("/tools", get(tools))
        .route("/tables", get(async || json_response(StatusCode::OK, &json!(tables()))))
        .route("/openapi.json", get(describe))
        .route("/shutdown", post(shut_down))
        .fallback(unknown)
        .method_not_allowed_fallback(unknown)
        .layer(from_fn_with_state(door.clone(), guarded))
        .with_state(door)
}

async fn guarded(State(door): State<Routed>, request: HttpRequest, next: Next) -> Response {
    match door.guard.bar(request.headers()) {
        None => next.run(request).await,
        Some(answer) => response(&answer),
    }
}

async fn health(State(door): State<Routed>) -> Response {
    json_response(StatusCode::OK, &json!({ "status": "ok", "run": door.served.run }))
}

async fn shut_down(State(door): State<Routed>) -> Response {
    door.served.stop.notify_one();
    json_response(StatusCode::OK, &json!({ "success": true, "run": door.served.run }))
}

async fn unknown(request: HttpRequest) -> Response {
    let error = format!("there is no route {} {}", request.method(), request.uri().path());
    json_response(StatusCode::NOT_FOUND, &json!({ "error": error }))
}

async fn tools(State(door): State<Routed>) -> Response {
    let all: Vec<ToolDocument> = CATALOGUE.iter().map(|tool| document(tool.spec(), &door.numbers)).collect();
    json_response(StatusCode::OK, &json!(all))
}

async fn describe(State(door): State<Routed>) -> Response {
    json_response(StatusCode::OK, &openapi::document(&door.numbers))
}

async fn ask(State(door): State<Routed>, request: Request) -> Response {
    response(&door.handle.ask(request).await)
}

async fn ask_with(
    door: &Routed,
    tool: ToolId,
    body: Body,
    request: impl FnOnce(Fields) -> Request,
) -> Response {
    match read_object(body).await {
        Ok(mut fields) => {
            let request = match fields.refusal.take() {
                Some(refusal) => {
                    Request::Refused { tool: tool.name().to_owned(), args: fields.rest(), refusal }
                }
                None => request(fields),
            };
            response(&door.handle.ask(request).await)
        }
        Err(wrong) => closing(response(&wrong)),
    }
}

async fn call(State(door): State<Routed>, body: Body) -> Response {
    let mut fields = match read_object(body).await {
        Ok(fields) => fields,
        Err(wrong) => return closing(response(&wrong)),
    };
    // A name that is not a text cannot be a tool.
    let tool = match fields.take("tool") {
        Value::String(name) => name,
        Value::Null => String::new(),
        other => other.to_string(),
    };
    let mut args = match fields.take("args") {
        Value::Null => json!({}),
        given => given,
    };
    // The request id may be next to the arguments or among them.
    if let (Value::Object(args), day @ Value::Number(_)) = (&mut args, fields.take("expected_day")) {
        args.entry("expected_day").or_insert(day);
    }
    let request = match fields.refusal.take() {
        Some(refusal) => Request::Refused { tool, args, refusal },
        None => Request::of_tool(&tool, args, fields.take("request_id")),
    };
    response(&door.handle.ask(request).await.told_as_call())
}

async fn next_week(State(door): State<Routed>, body: Body) -> Response {
    ask_with(&door, ToolId::NextWeek, body, |fields| {
        Request::of_tool(ToolId::NextWeek.name(), fields.rest(), Value::Null)
    })
    .await
}

async fn query(State(door): State<Routed>, body: Body) -> Response {
    ask_with(&door, ToolId::Query, body, |fields| {
        Request::of_tool(ToolId::Query.name(), fields.rest(), Value::Null)
    })
    .await
}

async fn keep_script(State(door): State<Routed>, body: Body) -> Response {
    ask_with(&door, ToolId::RegisterScript, body, |mut fields| Request::KeepDailyScript {
        name: fields.take("name"),
        content: fields.take("content"),
        request_id: fields.take("request_id"),
    })
    .await
}

async fn forget_script(State(door): State<Routed>, body: Body) -> Response {
    ask_with(&door, ToolId::DeleteScript, body, |mut fields| Request::ForgetDailyScript {
        name: fields.take("name"),
        request_id: fields.take("request_id"),
    })
    .await
}

fn status_code(status: Status) -> StatusCode {
    match status {
        Status::Done => StatusCode::OK,
        Status::Refused => StatusCode::BAD_REQUEST,
        Status::Unauthorized => StatusCode::UNAUTHORIZED,
        Status::Forbidden => StatusCode::FORBIDDEN,
        Status::Missing => StatusCode::NOT_FOUND,
        Status::Busy => StatusCode::CONFLICT,
        Status::Failed => StatusCode::INTERNAL_SERVER_ERROR,
        Status::TimedOut => StatusCode::GATEWAY_TIMEOUT,
        Status::TooSlow => StatusCode::REQUEST_TIMEOUT,
        Status::TooLarge => StatusCode::PAYLOAD_TOO_LARGE,
    }
}

fn response(answer: &Answer) -> Response {
    let mut response = json_response(status_code(answer.status), &answer.body);
    if answer.status == Status::Busy {
        response.headers_mut().insert(header::RETRY_AFTER, header::HeaderValue::from_static("1"));
    }
    response
}

/// Closes the connection after the response. Otherwise the unread rest of a body would be taken for the next request.
fn closing(mut response: Response) -> Response {
    response.headers_mut().insert(header::CONNECTION, header::HeaderValue::from_static("close"));
    response
}

fn json_response(status: StatusCode, body: &Value) -> Response {
    (status, [(header::CONTENT_TYPE, "application/json")], body.to_string()).into_response()
}
