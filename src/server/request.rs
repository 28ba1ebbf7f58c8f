//! Requests of programs and their answers.

use serde_json::{Map, Value, json};

use super::schema::REQUEST_ID;
use novamind_record::trajectory::record::RejectionRecord;
use novamind_tools::{Rejection, ToolId, find};

/// A request of a program.
#[derive(Debug, Clone, PartialEq)]
pub enum ApiRequest {
    /// Call a tool.
    Call {
        /// Name of the tool.
        tool: String,
        /// Arguments as they were sent.
        args: Value,
        /// Request id, or null.
        request_id: Value,
    },
    /// Record a call that was rejected before it reached a tool.
    RejectedCall {
        /// Name of the tool.
        tool: String,
        /// Arguments as they were sent.
        args: Value,
        /// The reason.
        refusal: Rejection,
    },
    /// Submit rationale and forecasts, and simulate a week.
    NextWeek {
        /// Rationale.
        rationale: Value,
        /// Forecasts for four horizons.
        predictions: Value,
        /// The required current day, or null for any day.
        expected_day: Value,
        /// Request id, or null.
        request_id: Value,
    },
    /// Run a statement.
    Query {
        /// One statement.
        sql: Value,
    },
    /// The current day.
    CurrentDay,
    /// The dashboard of the last week.
    Dashboard,
    /// Day, cash, subscribers, and whether the run is over.
    GameStatus,
    /// Names and sizes of the stored scripts.
    DailyScripts,
    /// Store a script.
    SaveDailyScript {
        /// Name.
        name: Value,
        /// Text.
        content: Value,
        /// Request id, or null.
        request_id: Value,
    },
    /// Delete a script.
    DeleteDailyScript {
        /// Name.
        name: Value,
        /// Request id, or null.
        request_id: Value,
    },
    /// The notes of the run.
    Notes,
}

impl ApiRequest {
    /// Returns the request of a tool call. Statements and weeks become their own requests in all interfaces.
    ///
    /// The request id may be among the arguments.
    pub fn for_tool(name: &str, args: Value, request_id: Value) -> ApiRequest {
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
            if let Some(refusal) = unknown_week_argument(&fields) {
                return ApiRequest::RejectedCall { tool: name.to_owned(), args: fields.into(), refusal };
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

    /// Returns whether the request only runs a script or a statement, which changes nothing and may be stopped.
    pub fn runs_code(&self) -> bool {
        match self {
            ApiRequest::Query { .. } => true,
            ApiRequest::Call { tool, .. } => find(tool).is_some_and(|tool| tool.spec().id.executes_code()),
            _ => false,
        }
    }
}

/// Rejects a week with an unknown argument, because a misspelled `expected_day` would protect nothing.
fn unknown_week_argument(fields: &Map<String, Value>) -> Option<Rejection> {
    const KNOWN: [&str; 3] = ["rationale", "predictions", "expected_day"];
    let unknown = fields.keys().find(|name| !KNOWN.contains(&name.as_str()))?;
    let message = format!(
        "next_week has no argument {unknown}; it takes rationale, predictions, expected_day and request_id. No day has passed"
    );
    Some(Rejection::for_field(unknown.clone(), "unknown_argument", message))
}

/// Returns the text of an error. If several deals are all rejected, it has one line each, as in the released simulator.
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

/// The kind of an answer, from which its HTTP status follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ResponseStatus {
    /// Success, or a rejection by a tool.
    Done,
    /// The request is invalid.
    BadRequest,
    /// The token is missing or wrong.
    Unauthorized,
    /// The request is not allowed.
    Forbidden,
    /// The named object does not exist.
    NotFound,
    /// Another week is being simulated.
    Busy,
    /// An internal error.
    Failed,
    /// The answer took too long.
    TimedOut,
    /// The request took too long to arrive.
    TooSlow,
    /// The request is too large.
    TooLarge,
}

/// The answer to a request.
#[derive(Debug, Clone, PartialEq)]
pub struct ApiResponse {
    /// Kind of the answer.
    pub status: ResponseStatus,
    /// Body.
    pub body: Value,
}

impl ApiResponse {
    /// Returns the fields with `success: true`.
    pub fn success(fields: Map<String, Value>) -> ApiResponse {
        let mut body = Map::from_iter([("success".to_owned(), true.into())]);
        body.extend(fields);
        ApiResponse { status: ResponseStatus::Done, body: body.into() }
    }

    /// Returns the data of a tool.
    pub fn tool_data(data: Value) -> ApiResponse {
        ApiResponse::success(Map::from_iter([("data".to_owned(), data)]))
    }

    /// Returns an object unchanged.
    pub fn raw(body: Value) -> ApiResponse {
        ApiResponse { status: ResponseStatus::Done, body }
    }

    /// Returns a rejection. Programs for the released simulator read `error` and `data`.
    pub fn rejected(status: ResponseStatus, refusal: impl Into<RejectionRecord>) -> ApiResponse {
        let refusal = refusal.into();
        let error = error_text(&refusal.message, &json!(refusal.results));
        let mut body = json!({ "success": false, "error": error, "code": refusal.code });
        body["field"] = json!(refusal.field);
        if !refusal.results.is_empty() {
            body["results"] = json!(refusal.results);
        }
        body["data"] = Value::Null;
        ApiResponse { status, body }
    }

    /// Returns the same answer as for a tool call, where a rejection is a normal answer, including rejected statements and weeks.
    pub fn into_tool_response(mut self) -> ApiResponse {
        let is_of_tool = match self.status {
            ResponseStatus::BadRequest | ResponseStatus::Forbidden | ResponseStatus::TimedOut => true,
            ResponseStatus::Failed => self.body["code"] == "sql_error",
            _ => false,
        };
        if is_of_tool {
            self.status = ResponseStatus::Done;
        }
        self
    }

    /// Returns an error of a request that did not reach a tool.
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
