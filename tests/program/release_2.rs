//! The HTTP interface of release 2: request ids, the status of requests, the last committed state and targeted operations.

use std::io::Write;
use std::net::TcpStream;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::interfaces::{NEW_RUN_OPTIONS, Server, predictions};
use crate::support::home::Home;

pub fn release_2_options() -> Vec<&'static str> {
    [&NEW_RUN_OPTIONS[..], &["--scenario", "release-2"]].concat()
}

fn start_run(home: &Home) -> Server {
    Server::start(home, &release_2_options())
}

/// Returns the head that the newer client sends, with all fields that Python's `urllib` adds.
fn client_head(port: u16) -> String {
    format!(
        "Accept-Encoding: identity\r\nHost: 127.0.0.1:{port}\r\nUser-Agent: Python-urllib/3.13\r\nContent-Type: application/json\r\n"
    )
}

/// Sends a request as the newer client does.
fn send(server: &Server, path: &str, body: &Value) -> (u16, Value) {
    server.request_with_head("POST", path, &client_head(server.port), &body.to_string())
}

fn call(server: &Server, tool: &str, args: &Value, id: &str) -> Value {
    let (status, body) = send(server, "/call", &json!({ "tool": tool, "args": args, "request_id": id }));
    assert_eq!(status, 200, "{tool}: {body}");
    body
}

fn week(id: &str) -> Value {
    json!({ "request_id": id, "rationale": "Hold prices", "predictions": predictions() })
}

/// Sends a request without reading the response.
fn send_only(server: &Server, path: &str, body: &Value) -> TcpStream {
    let body = body.to_string();
    let (head, length) = (client_head(server.port), body.len());
    let mut stream = TcpStream::connect(("127.0.0.1", server.port)).expect("a connection");
    let request =
        format!("POST {path} HTTP/1.1\r\n{head}Connection: close\r\nContent-Length: {length}\r\n\r\n{body}");
    stream.write_all(request.as_bytes()).expect("sent");
    stream
}

fn recorded(home: &Home, kind: &str) -> usize {
    let text = std::fs::read_to_string(home.only_run().join("trajectory.jsonl")).expect("a trajectory");
    let lines = text.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
    lines.filter(|line| line["kind"] == kind).count()
}

#[test]
fn newer_client_plays_across_kills_of_the_server() {
    let home = Home::new();
    let server = start_run(&home);
    // Reads have ids too, because the client sends an id with every call.
    let costs = call(&server, "get_cost_info", &json!({}), "5f3e");
    assert_eq!(costs["success"], true);
    let plans = [
        ("set_prices", json!({ "A": 19, "B": 49.5 }), "a1"),
        ("set_capacity_tier", json!({ "tier": 9 }), "a2"),
        ("research_market", json!({}), "a3"),
        ("nonexistent_tool", json!({}), "a4"),
    ];
    let first: Vec<Value> = plans.iter().map(|(tool, args, id)| call(&server, tool, args, id)).collect();
    let succeeded: Vec<bool> = first.iter().map(|body| body["success"] == true).collect();
    assert_eq!(succeeded, [true, false, true, false], "{first:?}");
    let cash = server.get("/game-status")["cash"].clone();
    // Dropping the server kills its process, and the retries reach a new process.
    drop(server);
    let server = Server::start(&home, &["--run", "latest"]);
    let again: Vec<Value> = plans.iter().map(|(tool, args, id)| call(&server, tool, args, id)).collect();
    assert_eq!(again, first);
    for ((_, _, id), result) in plans.iter().zip(&first) {
        let expected = json!({ "request_id": id, "status": "completed", "result": result });
        assert_eq!(server.get(&format!("/requests/{id}")), expected);
    }
    assert_eq!(server.get("/requests/5f3e")["status"], "unknown", "reads are not stored");
    assert_eq!(server.get("/game-status")["cash"], cash, "the study was bought once");
    // The server is killed while it executes a week, and the client has no response.
    let unanswered = send_only(&server, "/next-week", &week("w1"));
    std::thread::sleep(Duration::from_millis(30));
    drop(server);
    drop(unanswered);
    let server = Server::start(&home, &["--run", "latest"]);
    let status = server.get("/requests/w1");
    assert!(status["status"] == "completed" || status["status"] == "unknown", "{status}");
    let (code, passed) = send(&server, "/next-week", &week("w1"));
    assert_eq!((code, &passed["success"], &passed["day"]), (200, &json!(true), &json!(7)), "{passed}");
    assert_eq!(server.get("/requests/w1")["result"], passed);
    let (_, rows) = send(&server, "/query", &json!({ "sql": "SELECT COUNT(*) AS n FROM predictions" }));
    assert_eq!((&rows["success"], &rows["rows"][0]["n"]), (&json!(true), &json!(4)), "{rows}");
    assert_eq!((recorded(&home, "advance"), recorded(&home, "week")), (1, 1));
}

#[test]
fn changing_requests_need_an_id() {
    let home = Home::new();
    let server = start_run(&home);
    for id in [Value::Null, json!(""), json!("x".repeat(129)), json!(7)] {
        for tool in
            ["set_prices", "post_social_media", "research_market", "next_week", "run_script", "none", ""]
        {
            let body = json!({ "tool": tool, "args": { "A": 5 }, "request_id": id });
            let (status, refused) = send(&server, "/call", &body);
            assert_eq!((status, &refused["success"]), (200, &json!(false)), "{tool} {id}: {refused}");
            assert_eq!(refused["error"], "request_id_required", "{tool} {id}");
        }
        let mut filed = week("");
        filed["request_id"] = id;
        let (status, refused) = send(&server, "/next-week", &filed);
        assert_eq!((status, &refused["error"]), (200, &json!("request_id_required")), "{refused}");
    }
    for tool in ["get_vars", "list_scripts"] {
        assert_eq!(send(&server, "/call", &json!({ "tool": tool, "args": {} })).1["success"], true, "{tool}");
    }
    assert_eq!(server.get("/vars")["current_day"], 0);
    call(&server, "set_prices", &json!({ "A": 5 }), &"ä".repeat(128));
    assert_eq!(call(&server, "set_prices", &json!({ "A": 6 }), "p")["success"], true);
    let mismatch = call(&server, "set_prices", &json!({ "A": 7 }), "p");
    assert_eq!(
        (&mismatch["success"], &mismatch["error"]),
        (&json!(false), &json!("request_id_payload_mismatch"))
    );
    let (status, mismatch) = send(&server, "/next-week", &week("p"));
    assert_eq!((status, &mismatch["error"]), (200, &json!("request_id_payload_mismatch")), "{mismatch}");
}

#[test]
fn unusable_payloads_are_rejected() {
    let home = Home::new();
    let server = start_run(&home);
    let ask =
        |path: &str, body: &str| server.request_with_head("POST", path, &client_head(server.port), body);
    for literal in ["NaN", "Infinity", "-Infinity"] {
        let prices = format!(r#"{{"tool": "set_prices", "args": {{"A": {literal}}}, "request_id": "p"}}"#);
        let (status, refused) = ask("/call", &prices);
        assert_eq!((status, &refused["success"]), (200, &json!(false)), "{refused}");
        assert_eq!((&refused["error"], &refused["field"]), (&json!("invalid_request_payload"), &json!("A")));
        let filed = week("w").to_string().replacen("2000000.0", literal, 1);
        let (status, refused) = ask("/next-week", &filed);
        assert_eq!((status, &refused["error"]), (200, &json!("invalid_request_payload")), "{refused}");
        let without_id = prices.replace("request_id", "id");
        assert_eq!(ask("/call", &without_id).1["error"], "request_id_required");
    }
    for path in ["/call", "/next-week"] {
        for body in ["", "{", "[]"] {
            let (status, refused) = ask(path, body);
            assert_eq!(
                (status, &refused["error"]),
                (400, &json!("invalid_request_payload")),
                "{path} {body}"
            );
        }
    }
    assert_eq!(server.get("/requests/p"), json!({ "request_id": "p", "status": "unknown" }));
    assert_eq!(call(&server, "set_prices", &json!({ "A": 9 }), "p")["success"], true);
}

#[test]
fn rejected_week_leaves_its_id_free() {
    let home = Home::new();
    let server = start_run(&home);
    let mut filed = week("w");
    filed["rationale"] = " ".into();
    assert_eq!(send(&server, "/next-week", &filed).0, 400);
    assert_eq!(server.get("/requests/w")["status"], "unknown");
    assert_eq!(send(&server, "/next-week", &week("w")).1["day"], 7);
}

#[test]
fn request_status_decodes_the_id() {
    let home = Home::new();
    let server = start_run(&home);
    let id = "a/b space?x#y%z ä";
    call(&server, "set_prices", &json!({ "A": 17 }), id);
    let status = server.get("/requests/a%2Fb%20space%3Fx%23y%25z%20%C3%A4");
    assert_eq!((&status["request_id"], &status["status"]), (&json!(id), &json!("completed")));
    assert_eq!(status["result"]["data"]["updated"], json!({ "A": 17 }));
    assert_eq!(server.get("/requests/%FF")["status"], "unknown");
}

#[test]
fn committed_state_is_reported_during_a_week() {
    let home = Home::new();
    let server = start_run(&home);
    let before = server.get("/game-status");
    assert_eq!(server.get("/dashboard"), json!({ "dashboard": "", "day": 0 }));
    assert_eq!(
        (&before["day"], &before["busy"], &before["timed_out"]),
        (&json!(0), &json!(false), &json!(false))
    );
    assert!(before["snapshot_at"].as_f64().is_some_and(|at| at > 1.7e9), "{before}");
    // Calculations run before the week, so the week takes as long as this statement.
    let count = "WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM c WHERE x < 8000000) SELECT max(x) FROM c";
    let kept = call(&server, "register_daily_calculation", &json!({ "name": "slow", "code": count }), "c");
    assert_eq!(kept["success"], true, "{kept}");
    let snapshot = server.get("/game-status");
    assert!(snapshot["snapshot_at"].as_f64() > before["snapshot_at"].as_f64());
    let mut unanswered = send_only(&server, "/next-week", &week("w"));
    let started = Instant::now();
    while server.get("/game-status")["busy"] == false {
        assert!(started.elapsed() < Duration::from_secs(60), "the week did not start");
    }
    let during = server.get("/game-status");
    assert_eq!((&during["day"], &during["snapshot_at"]), (&json!(0), &snapshot["snapshot_at"]), "{during}");
    assert_eq!(server.get("/requests/w"), json!({ "request_id": "w", "status": "pending" }));
    assert_eq!(
        (&server.get("/vars")["current_day"], &server.get("/dashboard")["dashboard"]),
        (&json!(0), &json!(""))
    );
    let mut response = String::new();
    std::io::Read::read_to_string(&mut unanswered, &mut response).expect("a response");
    let after = server.get("/game-status");
    assert_eq!((&after["day"], &after["busy"]), (&json!(7), &json!(false)));
    let shown = server.get("/dashboard");
    assert_eq!(shown["dashboard"], server.get("/requests/w")["result"]["dashboard"]);
    assert_eq!(shown["day"], 7);
    // Calls after the week change the cash, but not the dashboard.
    call(&server, "research_market", &json!({}), "m");
    let bought = server.get("/game-status");
    assert!(bought["cash"].as_f64() < after["cash"].as_f64(), "{bought}");
    assert_eq!(server.get("/dashboard"), shown);
}

#[test]
fn daily_scripts_and_restarts_are_refused() {
    let home = Home::new();
    let server = start_run(&home);
    let ask = |method: &str, path: &str| {
        let (status, body) = server.request_with_head(method, path, &client_head(server.port), "{}");
        (status, body["success"].clone(), body["error"].clone())
    };
    for method in ["GET", "POST", "DELETE"] {
        let gone = (410, json!(false), json!("daily_scripts_unsupported"));
        assert_eq!(ask(method, "/daily-scripts"), gone, "{method}");
    }
    assert_eq!(ask("POST", "/reinitialize"), (403, json!(false), json!("game_reset_forbidden")));
    assert_eq!(ask("GET", "/reinitialize").0, 404);
    let paths = server.get("/openapi.json")["paths"].clone();
    assert_eq!(
        paths["/next-week"]["post"]["requestBody"]["content"]["application/json"]["schema"]["required"],
        json!(["request_id"])
    );
    assert!(
        paths["/requests/{id}"]["get"].is_object()
            && paths["/daily-scripts"]["get"]["responses"]["410"].is_object()
    );
    assert_eq!(server.get("/health")["interface"], "release_2");
}

#[test]
fn targeted_operations_apply_all_scopes_or_none() {
    let home = Home::new();
    let server = start_run(&home);
    let number = std::cell::Cell::new(0);
    let set = |args: Value| {
        number.set(number.get() + 1);
        call(&server, "set_targeted_ops_spend", &args, &format!("t{}", number.get()))
    };
    let total = |args: Value| set(args)["data"]["total_extra_per_day"].as_f64().expect("a total");
    let all = json!({ "by_group": { "S1": 10 }, "by_plan": { "A": 20 }, "by_group_plan": { "S2": { "B": 30 } },
        "by_customer": { "42": 40 } });
    assert_eq!(total(all), 100.0);
    // A map without scopes replaces `by_group`, so the 10 for S1 becomes 5. `targeted_spend`, the older name of
    // `by_group`, then replaces the 5.
    assert_eq!(total(json!({ "S1": 5 })), 95.0);
    assert_eq!(total(json!({ "targeted_spend": { "S2": 7 } })), 97.0);
    let rows = |server: &Server| {
        let sql = json!({ "sql": "SELECT COUNT(*) AS n FROM config_overrides" });
        send(server, "/query", &sql).1["rows"][0]["n"].clone()
    };
    let before = (rows(&server), set(json!({}))["data"].clone());
    let invalid = [
        (json!([]), "Targeted operations arguments must be a dict."),
        (json!({ "by_plan": { "A": 1 }, "z": 2, "S1": 3 }), "Unknown targeted operations arguments: S1, z"),
        (json!({ "by_group": { "S1": -1 } }), "Amount for S1 must be a finite non-negative number"),
        (json!({ "S1": true }), "Amount for S1 must be a finite non-negative number"),
        (
            json!({ "by_group": { "S1": 9 }, "by_plan": { "A": "10" } }),
            "Amount for plan A must be a finite non-negative number",
        ),
        (
            json!({ "by_group_plan": { "S1": { "A": -4 } } }),
            "Amount for S1/A must be a finite non-negative number",
        ),
        (
            json!({ "by_group": { "S1": 9 }, "by_customer": { "42": -1 } }),
            "Amount for customer 42 must be a finite non-negative number",
        ),
        (
            json!({ "by_group": { "S1": 9 }, "by_customer": { "x": 1 } }),
            "Customer ID 'x' must be a positive integer",
        ),
        (
            json!({ "by_group": { "S1": 9 }, "by_customer": { "0": 1 } }),
            "Customer ID '0' must be a positive integer",
        ),
        (json!({ "by_customer": { "1.5": 1 } }), "Customer ID '1.5' must be a positive integer"),
        (
            json!({ "by_group": { "S1": 1e308 }, "by_plan": { "A": 1e308 } }),
            "Total targeted operations spend must be finite.",
        ),
    ];
    for (args, text) in invalid {
        let refused = set(args.clone());
        assert_eq!((&refused["success"], &refused["error"]), (&json!(false), &json!(text)), "{args}");
    }
    for args in [
        json!({ "targeted_spend": {}, "by_group": {} }),
        json!({ "by_group": { "S1": 9 }, "by_plan": { "D": 1 } }),
    ] {
        assert_eq!(set(args.clone())["success"], false, "{args}");
    }
    // A call without arguments returns the budgets, changes nothing and adds no row.
    assert_eq!((rows(&server), set(json!({}))["data"].clone()), before);
    assert_eq!(before.1["by_group"], json!({ "S2": 7.0 }));
    assert_eq!(total(json!({ "by_group": {} })), 90.0);
    assert_eq!(total(json!({ "by_plan": {}, "by_group_plan": {}, "by_customer": {} })), 0.0);
}

#[test]
fn mcp_needs_no_request_id() {
    let home = Home::new();
    let client = json!({ "protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": { "name": "t", "version": "1" } });
    let prices = json!({ "name": "set_prices", "arguments": { "A": 12 } });
    let requests = [("initialize", client), ("tools/call", prices)];
    let lines = requests.iter().zip(1..).map(|((method, params), id)| {
        json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }).to_string() + "\n"
    });
    let mut command = home.program();
    command.arg("mcp").args(release_2_options());
    let output = crate::support::home::run_with_input(&mut command, &lines.collect::<String>());
    assert_eq!(output.exit_code, 0, "{}", output.stderr);
    assert_eq!(output.json_lines()[1]["result"]["structuredContent"]["success"], true, "{}", output.stdout);
}

#[test]
fn release_1_has_none_of_these_routes() {
    let home = Home::new();
    let server = Server::start(&home, &NEW_RUN_OPTIONS);
    let status =
        |method: &str, path: &str| server.request_with_head(method, path, &client_head(server.port), "{}").0;
    assert_eq!([status("GET", "/requests/p"), status("POST", "/reinitialize")], [404, 404]);
    assert_eq!(server.get("/daily-scripts")["success"], true);
    let (_, set) = send(&server, "/call", &json!({ "tool": "set_prices", "args": { "A": 5 } }));
    assert_eq!(set["success"], true, "no id is needed");
    let now = server.get("/game-status");
    assert!(now.get("busy").is_none() && now.get("snapshot_at").is_none(), "{now}");
    assert!(server.get("/dashboard")["dashboard"].as_str().is_some_and(|text| !text.is_empty()));
    let refused = send(
        &server,
        "/call",
        &json!({ "tool": "set_targeted_ops_spend", "args": { "by_plan": { "A": -1 } } }),
    );
    assert!(refused.1["error"].as_str().is_some_and(|text| !text.starts_with("Amount for")), "{refused:?}");
}
