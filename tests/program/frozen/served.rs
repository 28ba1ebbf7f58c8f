//! Responses of a served run over HTTP.

use serde_json::{Value, json};

use super::home::FrozenHome;
use super::{compare_or_write, report, stored_form};
use crate::interfaces::{Server, predictions};

#[test]
fn output_of_http_routes_is_unchanged() {
    let mut frozen = FrozenHome::new();
    let run = frozen.id("http").to_owned();
    let server = Server::start(&frozen.home, &["--run", &run]);
    frozen.masks.mask_new_ids(&frozen.home.runs());
    let call = |tool: &str, args: Value| ("POST", "/call", json!({ "tool": tool, "args": args }));
    let requests = [
        ("openapi", "GET", "/openapi.json", Value::Null),
        ("tools", "GET", "/tools", Value::Null),
        ("tables", "GET", "/tables", Value::Null),
        ("health", "GET", "/health", Value::Null),
        ("vars", "GET", "/vars", Value::Null),
        ("game-status", "GET", "/game-status", Value::Null),
        ("dashboard", "GET", "/dashboard", Value::Null),
        ("query", "POST", "/query", json!({ "sql": "SELECT * FROM config_history ORDER BY day" })),
        ("query-refused", "POST", "/query", json!({ "sql": "SELECT nothing FROM ledger" })),
        (
            "week",
            "POST",
            "/next-week",
            json!({ "rationale": "on", "predictions": predictions(), "expected_day": 14 }),
        ),
        ("week-refused", "POST", "/next-week", json!({ "rationale": "on" })),
        ("script", "POST", "/daily-scripts", json!({ "name": "s", "content": "SELECT 1" })),
        ("scripts", "GET", "/daily-scripts", Value::Null),
        ("script-deleted", "DELETE", "/daily-scripts", json!({ "name": "s" })),
        ("nothing", "GET", "/nothing", Value::Null),
    ];
    let calls = [
        ("call", call("set_prices", json!({ "A": 12, "B": 22 }))),
        ("call-refused", call("set_prices", json!({ "A": -1 }))),
        ("call-misspelt", call("set_price", json!({}))),
        ("call-market", call("get_market_overview", json!({}))),
        ("call-costs", call("get_cost_info", json!({}))),
    ];
    let calls = calls.into_iter().map(|(name, (method, path, body))| (name, method, path, body));
    let mut found = Vec::new();
    for (name, method, path, body) in requests.into_iter().chain(calls) {
        let body = if body.is_null() { String::new() } else { body.to_string() };
        let answer = server.send_raw(
            format!(
                "{method} {path} HTTP/1.1\r\nhost: 127.0.0.1\r\nconnection: close\r\ncontent-length: {}\r\n\r\n{body}",
                body.len()
            )
            .as_bytes(),
        );
        let (head, body) = answer.split_once("\r\n\r\n").expect("a head");
        let status = head.lines().next().unwrap_or_default();
        let output = format!("{status}\n{}\n", stored_form(frozen.masks.apply(body)));
        found.extend(compare_or_write("served", name, &output));
    }
    report(found);
}
