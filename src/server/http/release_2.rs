//! The routes and rejections of release 2, for runs with this interface (docs/interfaces/http.md#release-2).

use axum::Router;
use axum::extract::rejection::PathRejection;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::response::Response;
use axum::routing::{get, post};
use serde_json::{Value, json};

use super::routes::{RouteState, json_response, to_http_response};
use crate::committed::CommittedState;
use crate::request::{ApiRequest, ApiResponse, ResponseStatus};
use crate::request_id::needs_request_id;
use novamind_session::request_id;
use novamind_tools::Rejection;

/// Rejections that have status 200 and whose code is in `error`, as in release 2.
const CODES_IN_ERROR: [&str; 3] = [REQUEST_ID_REQUIRED, INVALID_PAYLOAD, "request_id_payload_mismatch"];
const REQUEST_ID_REQUIRED: &str = "request_id_required";
const INVALID_PAYLOAD: &str = "invalid_request_payload";

/// Returns the routes that exist only in release 2, or whose responses differ in release 2.
pub fn router(committed: &CommittedState) -> Router<RouteState> {
    let read = |respond: fn(&CommittedState) -> ApiResponse| {
        let committed = committed.clone();
        get(move || {
            let response = to_http_response(&respond(&committed));
            async move { response }
        })
    };
    let forbidden =
        || async { refuse(StatusCode::FORBIDDEN, "game_reset_forbidden", "a run cannot be restarted") };
    let gone = || async {
        let message = "release 2 has no daily scripts; run scripts with the tools of the module scripts";
        refuse(StatusCode::GONE, "daily_scripts_unsupported", message)
    };
    Router::new()
        .route("/vars", read(CommittedState::variables))
        .route("/dashboard", read(CommittedState::dashboard))
        .route("/game-status", read(CommittedState::game_status))
        .route("/requests/{*id}", get(request_status))
        .route("/reinitialize", post(forbidden))
        .route("/daily-scripts", get(gone).post(gone).delete(gone))
}

fn refuse(status: StatusCode, code: &str, message: &str) -> Response {
    json_response(status, &json!({ "success": false, "error": code, "code": code, "message": message }))
}

async fn request_status(
    State(state): State<RouteState>,
    id: Result<Path<String>, PathRejection>,
) -> Response {
    // An id that is not valid UTF-8 is unknown to the session.
    let id = id.map_or_else(|_| String::new(), |Path(id)| id);
    if state.handle.committed().is_some_and(|committed| committed.is_running(&id)) {
        return json_response(StatusCode::OK, &json!({ "request_id": id, "status": "pending" }));
    }
    to_http_response(&state.handle.send(ApiRequest::RequestStatus { id }).await)
}

/// Checks a request to a tool that needs a request id. Returns a rejection if the id is missing or invalid, or
/// `literal`, the rejection of a literal such as `NaN` in the request.
pub fn rejection(tool: &str, id: &Value, literal: Option<&Rejection>) -> Option<Rejection> {
    if !needs_request_id(tool) {
        return None;
    }
    if request_id(id).is_none() {
        let message = "the request needs a request_id, a text of 1 to 128 characters; nothing was changed. Send a \
             new id with each new request, and the same id with a retry";
        return Some(Rejection::for_field("request_id", REQUEST_ID_REQUIRED, message));
    }
    literal.map(|literal| Rejection { code: INVALID_PAYLOAD, ..literal.clone() })
}

/// Converts a response to the form of release 2, in which `error` contains the code of some rejections instead of a
/// message.
pub fn convert(mut response: ApiResponse) -> ApiResponse {
    let body = &mut response.body;
    if body["success"] != false {
        return response;
    }
    let is_malformed = body["code"] == "malformed_json";
    if is_malformed {
        body["code"] = INVALID_PAYLOAD.into();
    } else if CODES_IN_ERROR.iter().any(|code| body["code"] == *code) {
        response.status = ResponseStatus::Done;
    } else {
        return response;
    }
    body["message"] = body["error"].take();
    body["error"] = body["code"].clone();
    response
}
