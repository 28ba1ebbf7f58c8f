//! The OpenAPI description of the HTTP interface, generated from the catalog.

use serde_json::{Map, Value, json};

use super::request_id::needs_request_id;
use super::schema;
use novamind_tools::{ParameterNumbers, ToolId};

/// Returns the OpenAPI description of the HTTP interface.
///
/// `is_release_2` selects the interface of release 2 instead of that of release 1.
pub fn document(numbers: &ParameterNumbers, is_release_2: bool) -> Value {
    let mut paths = paths(numbers);
    if is_release_2 {
        describe_release_2(&mut paths);
    }
    json!({
        "openapi": "3.1.0",
        "info": {
            "title": "NovaMind",
            "version": env!("CARGO_PKG_VERSION"),
            "description": "One run of a simulated company. Requests are answered one after the other.",
        },
        "paths": paths,
        "components": { "schemas": schemas(numbers) },
    })
}

fn paths(numbers: &ParameterNumbers) -> Value {
    let retries = |tool: ToolId, mut body: Value| {
        for (name, field) in schema::retry_fields(tool) {
            body["properties"][name] = field;
        }
        body
    };
    let next_week = Value::Object(schema::arguments_schema(ToolId::NextWeek.spec(), numbers));
    let next_week = retries(ToolId::NextWeek, next_week);
    let script = json!({ "type": "object", "required": ["name"],
        "properties": { "name": { "type": "string" }, "content": { "type": "string" } } });
    let script = retries(ToolId::RegisterScript, script);
    let sql = json!({ "type": "object", "required": ["sql"], "properties": { "sql": { "type": "string" } } });
    json!({
        "/health": { "get": get_operation("Whether the server accepts requests, and the id of the run") },
        "/shutdown": { "post": { "summary": "Finish pending requests and close the run",
            "responses": { "200": { "description": "success, run" } } } },
        "/vars": { "get": get_operation("The current day") },
        "/dashboard": { "get": get_operation("The dashboard of the last week, and the day") },
        "/game-status": { "get": get_operation("Day, cash, active subscriptions, last day, and how the run ended") },
        "/tools": { "get": get_operation("Every tool: arguments, effect, cost, rejections, result") },
        "/tables": { "get": get_operation("Every table that can be queried, and its columns") },
        "/call": { "post": post_operation("Call a tool", json!({ "oneOf": call_schemas() }),
            "success and data, or success false with error, code and field") },
        "/next-week": { "post": post_operation("Submit rationale and forecasts, and simulate a week", next_week,
            "day, dashboard, cash, figures, ended") },
        "/query": { "post": post_operation("Run one SQL statement", sql, "columns, rows, row_count") },
        "/daily-scripts": {
            "get": get_operation("Names and sizes of the stored scripts"),
            "post": post_operation("Store a script, which is never executed", script.clone(), "name, registered"),
            "delete": post_operation("Delete a script", script, "removed"),
        },
    })
}

/// Changes the paths so that they describe the interface of release 2.
fn describe_release_2(paths: &mut Value) {
    let require_id = |schema: &mut Value| match &mut schema["required"] {
        Value::Array(fields) => fields.push(schema::REQUEST_ID.into()),
        other => *other = json!([schema::REQUEST_ID]),
    };
    let body = "/requestBody/content/application~1json/schema";
    if let Some(schema) = paths["/next-week"]["post"].pointer_mut(body) {
        require_id(schema);
    }
    let calls = paths["/call"]["post"].pointer_mut(&format!("{body}/oneOf"));
    for schema in calls.and_then(Value::as_array_mut).into_iter().flatten() {
        let tool = schema["properties"]["tool"]["const"].as_str().unwrap_or_default();
        if needs_request_id(tool) {
            schema["properties"][schema::REQUEST_ID] = schema::request_id_schema();
            require_id(schema);
        }
    }
    let rejection = |summary: &str, status: &str, code: &str| json!({ "summary": summary, "responses": { status: { "description": format!("always {code}") } } });
    let gone = rejection("Not supported", "410", "daily_scripts_unsupported");
    paths["/daily-scripts"] = json!({ "get": gone, "post": gone, "delete": gone });
    paths["/reinitialize"] = json!({ "post": rejection("Not supported", "403", "game_reset_forbidden") });
    let mut status = get_operation("Status of a request: unknown, pending or completed with its result");
    status["parameters"] =
        json!([{ "name": "id", "in": "path", "required": true, "schema": { "type": "string" } }]);
    paths["/requests/{id}"] = json!({ "get": status });
}

fn get_operation(summary: &str) -> Value {
    json!({ "summary": summary, "responses": { "200": { "description": "a JSON object or list" } } })
}

fn post_operation(summary: &str, body: Value, answer: &str) -> Value {
    json!({
        "summary": summary,
        "requestBody": { "required": true, "content": { "application/json": { "schema": body } } },
        "responses": {
            "200": { "description": answer },
            "400": { "description": "rejected, or not a JSON object: success false, error, code, field" },
            "413": { "description": "the body is too large" },
            "503": { "description": "too many connections: send the request again after the seconds in Retry-After" },
        },
    })
}

fn call_schemas() -> Vec<Value> {
    let callable = schema::specs().filter(|spec| !matches!(spec.id, ToolId::NextWeek | ToolId::Query));
    let call = |tool: ToolId| {
        let name = tool.name();
        let mut properties = json!({
            "tool": { "const": name },
            "args": { "$ref": format!("#/components/schemas/{name}") },
        });
        if tool.takes_request_id() {
            properties[schema::REQUEST_ID] = schema::retry_fields(tool)[schema::REQUEST_ID].clone();
        }
        json!({ "type": "object", "required": ["tool"], "properties": properties })
    };
    callable.map(|spec| call(spec.id)).collect()
}

fn schemas(numbers: &ParameterNumbers) -> Map<String, Value> {
    let one = |spec: &novamind_tools::ToolSpec| {
        let mut arguments = schema::arguments_schema(spec, numbers);
        arguments.insert("description".to_owned(), numbers.substitute(spec.summary).into());
        (spec.name().to_owned(), Value::Object(arguments))
    };
    schema::specs().map(one).collect()
}
