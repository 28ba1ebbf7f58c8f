//! Requests of programs and the responses to these requests.

use serde_json::{Map, Value, json};

use super::schema::REQUEST_ID;
use novamind_record::trajectory::record::RejectionRecord;
use novamind_tools::{Rejection, ToolId, find};

/// A request that a program sends through HTTP or the Model Context Protocol.
#[derive(Debug, Clone, PartialEq)]
pub enum ApiRequest {
    /// Request to call a tool.
    Call {
        /// Name of the called tool.
        tool: String,
        /// Arguments as they were sent.
        args: Value,
        /// ID of the request, or null if the client sent no id.
        request_id: Value,
    },
    /// Request to record a tool call that was rejected before the tool was executed.
    RejectedCall {
        /// Name of the called tool.
        tool: String,
        /// Arguments as they were sent.
        args: Value,
        /// Rejection that the response contains.
        rejection: Rejection,
    },
    /// Request to submit a rationale and forecasts and to simulate a week.
    NextWeek {
        /// Rationale of the week, not yet validated.
        rationale: Value,
        /// Forecasts of cash for four horizons.
        predictions: Value,
        /// The day on which the run must be for the week to start, or null for any day.
        expected_day: Value,
        /// ID of the request, or null if the client sent no id.
        request_id: Value,
    },
    /// Request to run an SQL statement.
    Query {
        /// A single SQL statement.
        sql: Value,
    },
    /// Request for the current day.
    CurrentDay,
    /// Request for the dashboard of the last week.
    Dashboard,
    /// Request for the day, the cash, the subscribers, and the status of the run.
    GameStatus,
    /// Request for the names and sizes of the stored scripts.
    DailyScripts,
    /// Request to store a script.
    SaveDailyScript {
        /// Name of the script to store.
        name: Value,
        /// Text of the script.
        content: Value,
        /// ID of the request, or null if the client sent no id.
        request_id: Value,
    },
    /// Request to delete a stored script.
    DeleteDailyScript {
        /// Name of the script to delete.
        name: Value,
        /// ID of the request, or null if the client sent no id.
        request_id: Value,
    },
    /// Request for the status of an earlier request, and for its response if it is completed.
    RequestStatus {
        /// ID of the earlier request.
        id: String,
    },
    /// Request for the notes of the run.
    Notes,
}

impl ApiRequest {
    /// Returns the request for a tool call. Calls to `query` and `next_week` become [`ApiRequest::Query`] and
    /// [`ApiRequest::NextWeek`].
    ///
    /// `args` may contain the request id. It is used if `request_id` is null.
    pub fn from_tool_call(name: &str, args: Value, request_id: Value) -> ApiRequest {
        let mut fields = match args {
            Value::Object(fields) => fields,
            given => return ApiRequest::Call { tool: name.to_owned(), args: given, request_id },
        };
        let request_id = match request_id {
            Value::Null => fields.remove(REQUEST_ID).unwrap_or(Value::Null),
            given => given,
        };
        let is_statement =
            |(field, value): (&String, &Value)| field == "sql" && (value.is_string() || value.is_null());
        if name == ToolId::Query.name() && !fields.iter().all(is_statement) {
            // The tool rejects invalid arguments itself.
            return ApiRequest::Call { tool: name.to_owned(), args: fields.into(), request_id };
        }
        if name == ToolId::NextWeek.name() {
            if let Some(rejection) = unknown_week_argument(&fields) {
                return ApiRequest::RejectedCall { tool: name.to_owned(), args: fields.into(), rejection };
            }
            let mut take = |field: &str| fields.remove(field).unwrap_or(Value::Null);
            return ApiRequest::NextWeek {
                rationale: take("rationale"),
                predictions: take("predictions"),
                expected_day: take("expected_day"),
                request_id,
            };
        }
        if name == ToolId::Query.name() {
            return ApiRequest::Query { sql: fields.remove("sql").unwrap_or(Value::Null) };
        }
        ApiRequest::Call { tool: name.to_owned(), args: fields.into(), request_id }
    }

    /// Returns the id under which the session stores the response, or `None` if the response is not stored.
    pub fn stored_id(&self) -> Option<&str> {
        match self {
            ApiRequest::NextWeek { request_id, .. } => request_id.as_str(),
            ApiRequest::Call { tool, request_id, .. } => {
                let is_stored = find(tool).is_none_or(|tool| tool.spec().id.takes_request_id());
                request_id.as_str().filter(|_| is_stored)
            }
            _ => None,
        }
    }

    /// Returns whether the request only runs a script or a statement. Such a request does not change the run and can be
    /// stopped.
    pub fn runs_code(&self) -> bool {
        match self {
            ApiRequest::Query { .. } => true,
            ApiRequest::Call { tool, .. } => find(tool).is_some_and(|tool| tool.spec().id.executes_code()),
            _ => false,
        }
    }
}

/// Rejects a request for a week that has an unknown argument, because a misspelled `expected_day` would have no effect.
fn unknown_week_argument(fields: &Map<String, Value>) -> Option<Rejection> {
    const KNOWN: [&str; 3] = ["rationale", "predictions", "expected_day"];
    let unknown = fields.keys().find(|name| !KNOWN.contains(&name.as_str()))?;
    let message = format!(
        "next_week has no argument {unknown}; it takes rationale, predictions, expected_day and request_id. No day has passed"
    );
    Some(Rejection::for_field(unknown.clone(), "unknown_argument", message))
}

/// Returns the text of an error. If a call has several deals and all were rejected, the text has one line per deal, as
/// in the released simulator.
fn error_text(message: &str, results: &Value) -> String {
    let line = |result: &Value| {
        let who = result["customer_id"].as_i64().map(|customer| format!("customer {customer}"));
        let error = result["error"].as_str().unwrap_or_default();
        format!("{}: {error}", who.as_deref().unwrap_or("no customer"))
    };
    match results.as_array().map(Vec::as_slice) {
        Some(several @ [_, _, ..]) => several.iter().map(line).collect::<Vec<String>>().join("\n"),
        _ => message.to_owned(),
    }
}

/// The kind of a response, which determines the HTTP status code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ResponseStatus {
    /// The request succeeded, or a tool rejected the call.
    Done,
    /// The request is malformed, or a statement, week or script was rejected.
    BadRequest,
    /// The token is missing or wrong.
    Unauthorized,
    /// The request is forbidden, for example because a web page sent it.
    Forbidden,
    /// The route, tool or script named by the request does not exist.
    NotFound,
    /// Another week is being simulated, so the request cannot be executed now.
    Busy,
    /// An internal error occurred.
    Failed,
    /// The execution of the request exceeded a time limit.
    TimedOut,
    /// The request did not arrive within the time limit.
    TooSlow,
    /// The request is too large.
    TooLarge,
}

/// The response to a request.
#[derive(Debug, Clone, PartialEq)]
pub struct ApiResponse {
    /// Kind of the response.
    pub status: ResponseStatus,
    /// JSON body of the response.
    pub body: Value,
}

impl ApiResponse {
    /// Returns a successful response with these fields and `success: true`.
    pub fn success(fields: Map<String, Value>) -> ApiResponse {
        let mut body = Map::from_iter([("success".to_owned(), true.into())]);
        body.extend(fields);
        ApiResponse { status: ResponseStatus::Done, body: body.into() }
    }

    /// Returns a successful response with the data of a tool.
    pub fn tool_data(data: Value) -> ApiResponse {
        ApiResponse::success(Map::from_iter([("data".to_owned(), data)]))
    }

    /// Returns a successful response whose body is `body`.
    pub fn with_body(body: Value) -> ApiResponse {
        ApiResponse { status: ResponseStatus::Done, body }
    }

    /// Returns the response for a rejection. Programs that were written for the released simulator read the fields
    /// `error` and `data`.
    pub fn rejected(status: ResponseStatus, rejection: impl Into<RejectionRecord>) -> ApiResponse {
        let rejection = rejection.into();
        let error = error_text(&rejection.message, &json!(rejection.results));
        let mut body = json!({ "success": false, "error": error, "code": rejection.code });
        body["field"] = json!(rejection.field);
        if !rejection.results.is_empty() {
            body["results"] = json!(rejection.results);
        }
        body["data"] = Value::Null;
        ApiResponse { status, body }
    }

    /// Converts the response to the response of a tool call. In tool calls, every rejection is a normal result,
    /// including rejections of statements and weeks.
    pub fn into_tool_response(mut self) -> ApiResponse {
        let is_tool_rejection = match self.status {
            ResponseStatus::BadRequest | ResponseStatus::Forbidden | ResponseStatus::TimedOut => true,
            ResponseStatus::Failed => self.body["code"].as_str().is_some_and(|code| code.starts_with("sql_")),
            _ => false,
        };
        if is_tool_rejection {
            self.status = ResponseStatus::Done;
        }
        self
    }

    /// Returns the response for an invalid request, which is rejected before a tool is called.
    pub fn invalid_request(
        status: ResponseStatus,
        code: &'static str,
        message: impl Into<String>,
    ) -> ApiResponse {
        ApiResponse::rejected(status, Rejection::new(code, message))
    }

    /// Returns whether the request succeeded.
    pub fn is_success(&self) -> bool {
        self.status == ResponseStatus::Done && self.body["success"] != Value::Bool(false)
    }
}
