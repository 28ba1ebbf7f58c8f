//! What a program may ask of a run, and what it is answered.

use serde_json::{Map, Value, json};

use super::schema::REQUEST_ID;
use novamind_record::trajectory::record::RefusalRecord;
use novamind_tools::{Refusal, ToolId, find};

/// What a program asks of a run.
#[derive(Debug, Clone, PartialEq)]
pub enum Request {
    /// Call a tool.
    Call {
        /// Its name.
        tool: String,
        /// Its arguments, as they were sent.
        args: Value,
        /// The id of the request; null without one.
        request_id: Value,
    },
    /// Record a call that is refused before a tool receives it.
    Refused {
        /// Name of the tool.
        tool: String,
        /// Its arguments, as they were sent.
        args: Value,
        /// Why.
        refusal: Refusal,
    },
    /// File rationale and forecasts, and let a week pass.
    NextWeek {
        /// Why.
        rationale: Value,
        /// Forecasts of four horizons.
        predictions: Value,
        /// The day on which the run must be; null if any will do.
        expected_day: Value,
        /// The id of the request; null without one.
        request_id: Value,
    },
    /// Ask the database.
    Query {
        /// One statement.
        sql: Value,
    },
    /// The current day.
    Vars,
    /// The dashboard of the last week.
    Dashboard,
    /// Day, cash, subscribers, and whether the run is over.
    GameStatus,
    /// Names and sizes of the scripts that are kept.
    DailyScripts,
    /// Keep a script.
    KeepDailyScript {
        /// Its name.
        name: Value,
        /// Its text.
        content: Value,
        /// The id of the request; null without one.
        request_id: Value,
    },
    /// Forget a script.
    ForgetDailyScript {
        /// Its name.
        name: Value,
        /// The id of the request; null without one.
        request_id: Value,
    },
    /// The notes of the run.
    Memo,
}

impl Request {
    /// What a call of a tool asks: a statement and a week have requests of their own, whichever door they come through.
    ///
    /// The id of the request may be among the arguments.
    pub fn of_tool(name: &str, args: Value, request_id: Value) -> Request {
        let mut fields = match args {
            Value::Object(fields) => fields,
            given => return Request::Call { tool: name.to_owned(), args: given, request_id },
        };
        let request_id = match request_id {
            Value::Null => fields.remove(REQUEST_ID).unwrap_or(Value::Null),
            given => given,
        };
        let is_statement =
            |(field, value): (&String, &Value)| field == "sql" && (value.is_string() || value.is_null());
        if name == ToolId::Query.name() && !fields.iter().all(is_statement) {
            // The tool itself refuses wrong arguments, as every tool does.
            return Request::Call { tool: name.to_owned(), args: fields.into(), request_id };
        }
        if name == ToolId::NextWeek.name() {
            if let Some(refusal) = unknown_argument_of_week(&fields) {
                return Request::Refused { tool: name.to_owned(), args: fields.into(), refusal };
            }
            let mut take = |field: &str| fields.remove(field).unwrap_or(Value::Null);
            return Request::NextWeek {
                rationale: take("rationale"),
                predictions: take("predictions"),
                expected_day: take("expected_day"),
                request_id,
            };
        }
        if name == ToolId::Query.name() {
            return Request::Query { sql: fields.remove("sql").unwrap_or(Value::Null) };
        }
        Request::Call { tool: name.to_owned(), args: fields.into(), request_id }
    }

    /// Whether it runs a script or a statement, which changes nothing and may be stopped.
    pub fn runs_code(&self) -> bool {
        match self {
            Request::Query { .. } => true,
            Request::Call { tool, .. } => find(tool).is_some_and(|tool| tool.spec().id.runs_code()),
            _ => false,
        }
    }
}

/// Refuses a week with an argument that it does not have: a mistyped `expected_day` would protect nothing.
fn unknown_argument_of_week(fields: &Map<String, Value>) -> Option<Refusal> {
    const KNOWN: [&str; 3] = ["rationale", "predictions", "expected_day"];
    let unknown = fields.keys().find(|name| !KNOWN.contains(&name.as_str()))?;
    let message = format!(
        "next_week has no argument {unknown}; it has rationale, predictions, expected_day and request_id. No day has passed"
    );
    Some(Refusal::at(unknown.clone(), "unknown_argument", message))
}

/// The text of an error: if several deals are all refused, one line for each, as in the release.
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

/// Whether a request was answered, and how not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// It was; also a tool that refused.
    Done,
    /// What was asked is wrong.
    Refused,
    /// It does not carry the token.
    Unauthorized,
    /// It may not be asked.
    Forbidden,
    /// There is nothing of that name.
    Missing,
    /// Another week is being simulated.
    Busy,
    /// It failed.
    Failed,
    /// It took too long to answer.
    TimedOut,
    /// It took too long to arrive.
    TooSlow,
    /// It is larger than what is read.
    TooLarge,
}

/// What a program is answered.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Whether it is what was asked for.
    pub status: Status,
    /// The object.
    pub body: Value,
}

impl Answer {
    /// Fields beside `success: true`.
    pub fn done(fields: Map<String, Value>) -> Answer {
        let mut body = Map::from_iter([("success".to_owned(), true.into())]);
        body.extend(fields);
        Answer { status: Status::Done, body: body.into() }
    }

    /// What a tool said.
    pub fn data(data: Value) -> Answer {
        Answer::done(Map::from_iter([("data".to_owned(), data)]))
    }

    /// An object as it stands.
    pub fn plain(body: Value) -> Answer {
        Answer { status: Status::Done, body }
    }

    /// A refusal; programs written for the released simulator read `error` and `data`.
    pub fn refused(status: Status, refusal: impl Into<RefusalRecord>) -> Answer {
        let refusal = refusal.into();
        let error = error_text(&refusal.message, &json!(refusal.results));
        let mut body = json!({ "success": false, "error": error, "code": refusal.code });
        body["field"] = json!(refusal.field);
        if !refusal.results.is_empty() {
            body["results"] = json!(refusal.results);
        }
        body["data"] = Value::Null;
        Answer { status, body }
    }

    /// The same as the answer of a call: what a tool refuses, a statement and a week among them, is an answer like any other.
    pub fn told_as_call(mut self) -> Answer {
        let is_of_tool = match self.status {
            Status::Refused | Status::Forbidden | Status::TimedOut => true,
            Status::Failed => self.body["code"] == "sql_error",
            _ => false,
        };
        if is_of_tool {
            self.status = Status::Done;
        }
        self
    }

    /// Something wrong with a request that no tool looked at.
    pub fn wrong(status: Status, code: &'static str, message: impl Into<String>) -> Answer {
        Answer::refused(status, Refusal::new(code, message))
    }

    /// Whether it is what was asked for.
    pub fn succeeded(&self) -> bool {
        self.status == Status::Done && self.body["success"] != Value::Bool(false)
    }
}
