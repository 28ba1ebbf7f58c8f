//! Every tool over HTTP compared with the served catalog: fields of results, rejections, and routes.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use crate::interfaces::{NEW_RUN_OPTIONS, Server};
use crate::support::home::Home;

/// Returns the documented field names of a result. A name in angle brackets stands for any requested name.
fn documented_fields(tool: &Value) -> BTreeSet<&str> {
    let returns = tool["returns"].as_array().expect("returns");
    returns.iter().map(|output| output["name"].as_str().expect("a name")).collect()
}

#[test]
fn tool_results_and_rejections_match_the_catalog() {
    let home = Home::new();
    let server = Server::start(&home, &NEW_RUN_OPTIONS);
    let tools = server.get("/tools");
    let mut answered = 0;
    for tool in tools.as_array().expect("tools") {
        let name = tool["name"].as_str().expect("a name");
        if ["query", "next_week"].contains(&name) {
            continue;
        }
        let call = |args: &Value| {
            let (status, response) = server.post("/call", &json!({ "tool": name, "args": args }));
            assert_eq!(status, 200, "{name}: {response}");
            response
        };
        let response = call(&tool["example"]);
        if response["success"] == true {
            answered += 1;
            let returned = response["data"].as_object().unwrap_or_else(|| panic!("{name}: {response}"));
            let known = documented_fields(tool);
            let other: Vec<&String> = returned
                .keys()
                .filter(|key| !known.contains(key.as_str()) && !known.contains("<tool>"))
                .collect();
            assert!(
                other.is_empty(),
                "{name} returns {other:?}, which the catalogue does not name: {response}"
            );
        } else {
            assert_documented_rejection(tool, &response);
        }
        let another = call(&json!({ "no_such_argument": 1 }));
        assert_eq!(another["success"], false, "{name}: {another}");
        assert_documented_rejection(tool, &another);
        for argument in tool["arguments"].as_array().expect("arguments") {
            let mut args = tool["example"].clone();
            args[argument["name"].as_str().expect("a name")] = json!([[["wrong"]]]);
            let response = call(&args);
            assert_eq!(response["success"], false, "{name}, {}: {response}", argument["name"]);
            assert_documented_rejection(tool, &response);
        }
    }
    assert!(answered > 20, "{answered}");
    check_described_routes(&server);
}

/// Checks that a rejection is documented for the tool or for all tools.
fn assert_documented_rejection(tool: &Value, value: &Value) {
    let code = value["code"].as_str().unwrap_or_else(|| panic!("{}: {value}", tool["name"]));
    let values = tool["refusals"].as_array().expect("refusals");
    let of_all = ["wrong_type", "unknown_argument", "argument_missing"];
    assert!(values.iter().any(|one| one == code) || of_all.contains(&code), "{}: {code}", tool["name"]);
}

/// Checks that every described route exists with the methods in its description.
fn check_described_routes(server: &Server) {
    let described = server.get("/openapi.json");
    let paths = described["paths"].as_object().expect("paths");
    assert!(paths.len() >= 10, "{paths:?}");
    for (path, methods) in paths {
        // `POST /shutdown` is excluded, because it stops the server.
        let may_be_tried = |method: &&String| path != "/shutdown" || *method != "post";
        for method in methods.as_object().expect("methods").keys().filter(may_be_tried) {
            let (status, value) =
                server.request_with_head(&method.to_uppercase(), path, "host: 127.0.0.1\r\n", "");
            assert_ne!(status, 404, "{method} {path}: {value}");
        }
        assert_eq!(server.request_with_head("PATCH", path, "host: 127.0.0.1\r\n", "").0, 404, "{path}");
    }
}
