//! Executes requests from all interfaces on the session.

use serde_json::{Map, Value, json};

use super::request::{ApiRequest, ApiResponse, ResponseStatus};
use novamind_database::Interface;
use novamind_record::trajectory::record::{Outcome, QuerySource, Via};
use novamind_session::{IdempotentResponse, Session, WeekRequest, WeekResult, rows_to_json};
use novamind_tools::{NotebookSection, Rejection, ToolId};

/// Tools that ignore null arguments, because older programs send null for omitted arguments.
const TOOLS_IGNORING_NULLS: [ToolId; 3] = [ToolId::SetPrices, ToolId::SetModelTiers, ToolId::SetDailySpend];

/// Executes a request. `via` is the interface that the record names as the source of the request.
pub fn handle_request(session: &mut Session, request: ApiRequest, via: Via) -> ApiResponse {
    match request {
        ApiRequest::Call { tool, args, request_id } => handle_call(session, &tool, args, &request_id, via),
        ApiRequest::NextWeek { rationale, predictions, expected_day, request_id } => {
            let week = WeekRequest {
                rationale: &rationale,
                predictions: &predictions,
                expected_day: &expected_day,
                id: &request_id,
            };
            handle_next_week(session, &week, via)
        }
        ApiRequest::Query { sql } => handle_query(session, &sql),
        ApiRequest::RejectedCall { tool, args, rejection } => ApiResponse::rejected(
            ResponseStatus::BadRequest,
            session.record_early_rejection(&tool, &args, via, rejection),
        ),
        ApiRequest::CurrentDay => ApiResponse::with_body(json!({ "current_day": session.day() })),
        ApiRequest::Dashboard => ApiResponse::with_body(
            json!({ "dashboard": session.company().dashboard(), "day": session.day() }),
        ),
        ApiRequest::GameStatus => game_status(session),
        ApiRequest::DailyScripts => ApiResponse::tool_data(json!({ "scripts": daily_scripts(session) })),
        ApiRequest::SaveDailyScript { name, content, request_id } => {
            save_script(session, &json!({ "name": name, "code": content }), &request_id, via)
        }
        ApiRequest::DeleteDailyScript { name, request_id } => delete_script(session, name, &request_id, via),
        ApiRequest::RequestStatus { id } => request_status(session, &id),
        ApiRequest::Notes => match session.notes() {
            Ok(text) => ApiResponse::tool_data(json!({ "text": text })),
            Err(error) => ApiResponse::invalid_request(ResponseStatus::Failed, "not_read", error.to_string()),
        },
    }
}

fn handle_call(
    session: &mut Session,
    tool: &str,
    mut args: Value,
    request_id: &Value,
    via: Via,
) -> ApiResponse {
    if let Value::Object(fields) = &mut args
        && TOOLS_IGNORING_NULLS.iter().any(|id| id.name() == tool)
    {
        fields.retain(|_, value| !value.is_null());
    }
    // Release 1 treats the arguments as the map by group, so a call without arguments clears the map. In release 2,
    // such a call changes nothing.
    if tool == ToolId::SetTargetedOpsSpend.name()
        && args.as_object().is_some_and(Map::is_empty)
        && !session.has_release_2_interface()
    {
        args = json!({ "targeted_spend": {} });
    }
    match session.call_once(tool, &args, via, request_id) {
        Ok(data) => ApiResponse::tool_data(data),
        Err(rejection) if tool == ToolId::Query.name() => {
            ApiResponse::rejected(ResponseStatus::BadRequest, rejection)
        }
        Err(rejection) => ApiResponse::rejected(ResponseStatus::Done, rejection),
    }
}

fn handle_next_week(session: &mut Session, request: &WeekRequest<'_>, via: Via) -> ApiResponse {
    match session.advance_once(request, via) {
        Err(rejection) => ApiResponse::rejected(ResponseStatus::BadRequest, rejection),
        Ok(week) => week_response(&week),
    }
}

fn week_response(week: &WeekResult) -> ApiResponse {
    let mut fields = Map::from_iter([
        ("day".to_owned(), week.figures.day.into()),
        ("dashboard".to_owned(), week.dashboard.clone().into()),
        ("cash".to_owned(), novamind_base::formatting::json_number(week.figures.cash)),
        ("figures".to_owned(), Value::Object(week.figures.to_json())),
        ("ended".to_owned(), json!(week.ended)),
    ]);
    if let Some(remark) = &week.remark {
        fields.insert("remark".to_owned(), remark.clone().into());
    }
    ApiResponse::success(fields)
}

/// Returns the status of an earlier request, and its response if the request is completed.
fn request_status(session: &Session, id: &str) -> ApiResponse {
    let Some(stored) = session.stored_response(id) else {
        return ApiResponse::with_body(json!({ "request_id": id, "status": "unknown" }));
    };
    let response = match stored {
        IdempotentResponse::Call(Outcome::Accepted(answer)) => ApiResponse::tool_data(answer.clone()),
        IdempotentResponse::Call(Outcome::Rejected(rejection)) => {
            ApiResponse::rejected(ResponseStatus::Done, rejection.clone())
        }
        IdempotentResponse::Week(week) => week_response(week),
    };
    ApiResponse::with_body(json!({ "request_id": id, "status": "completed", "result": response.body }))
}

fn handle_query(session: &mut Session, sql: &Value) -> ApiResponse {
    let Some(sql) = sql.as_str() else {
        return ApiResponse::rejected(
            ResponseStatus::BadRequest,
            Rejection::for_field("sql", "sql_empty", "sql must be a text"),
        );
    };
    match session.query_as(None, sql, QuerySource::Program) {
        Ok(rows) => ApiResponse::success(rows_to_json(&rows)),
        Err(rejection) => {
            let interface = session.params().fidelity.interface;
            ApiResponse::rejected(query_error_status(rejection.code, interface), rejection)
        }
    }
}

/// Returns the status that the released simulator's server returns for this error of a statement.
fn query_error_status(code: &str, interface: Interface) -> ResponseStatus {
    match code {
        "sql_empty" => ResponseStatus::BadRequest,
        "sql_schema" | "sql_hidden_table" | "sql_hidden_column" | "sql_write"
            if interface == Interface::Release1 =>
        {
            ResponseStatus::Forbidden
        }
        "sql_timeout" | "sql_cancelled" => ResponseStatus::TimedOut,
        _ => ResponseStatus::Failed,
    }
}

/// Returns the day, the cash, the subscribers, the last day, and how the run ended.
pub fn game_status(session: &Session) -> ApiResponse {
    let seen = session.company().observe();
    ApiResponse::with_body(json!({
        "day": seen.day,
        "cash": seen.cash,
        "subscribers": seen.active_subscriptions(),
        "timed_out": false,
        "total_days": session.manifest().total_days(),
        "ended": session.ended(),
    }))
}

fn daily_scripts(session: &Session) -> Vec<Value> {
    let kept = session.notebook().statements(NotebookSection::Script).entries();
    kept.iter().map(|(name, code)| json!({ "name": name, "size": code.len() })).collect()
}

fn save_script(session: &mut Session, args: &Value, request_id: &Value, via: Via) -> ApiResponse {
    match session.call_once(ToolId::RegisterScript, args, via, request_id) {
        Ok(answer) => ApiResponse::tool_data(json!({ "name": answer["name"], "registered": true })),
        Err(rejection) => ApiResponse::rejected(ResponseStatus::BadRequest, rejection),
    }
}

fn delete_script(session: &mut Session, name: Value, request_id: &Value, via: Via) -> ApiResponse {
    match session.call_once(ToolId::DeleteScript, &json!({ "name": name }), via, request_id) {
        Ok(_) => ApiResponse::tool_data(json!({ "removed": name })),
        Err(rejection) if rejection.code == "script_not_found" => {
            ApiResponse::rejected(ResponseStatus::NotFound, rejection)
        }
        Err(rejection) => ApiResponse::rejected(ResponseStatus::BadRequest, rejection),
    }
}
