//! Interfaces for programs: HTTP, the Model Context Protocol, and the Python client.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use serde_json::{Value, json};

use crate::support::home::{Home, run_with_input};

/// A server of a new run, which is stopped at the end of the test.
pub struct Server {
    child: Child,
    pub port: u16,
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The status and the JSON body of a response.
type StatusAndBody = (u16, Value);

impl Server {
    pub fn start(home: &Home, options: &[&str]) -> Server {
        let mut child = home.program().arg("serve").args(options).spawn().expect("the program starts");
        let mut line = String::new();
        BufReader::new(child.stdout.take().expect("a pipe")).read_line(&mut line).expect("a line");
        let ready: Value = serde_json::from_str(&line).expect("JSON");
        let port = ready["port"].as_u64().expect("a port") as u16;
        assert_eq!(ready["pid"], child.id());
        Server { child, port }
    }

    /// Sends bytes and reads the response until the server closes the connection.
    pub fn send_raw(&self, bytes: &[u8]) -> String {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).expect("a connection");
        stream.set_read_timeout(Some(Duration::from_secs(60))).expect("a socket");
        // The server may close the connection before all bytes are sent.
        let _ = stream.write_all(bytes);
        let mut answer = String::new();
        let _ = stream.read_to_string(&mut answer);
        answer
    }

    pub fn request_with_head(&self, method: &str, path: &str, head: &str, body: &str) -> StatusAndBody {
        let length = body.len();
        let request = format!(
            "{method} {path} HTTP/1.1\r\n{head}connection: close\r\ncontent-length: {length}\r\n\r\n{body}"
        );
        let answer = self.send_raw(request.as_bytes());
        let status = answer.split(' ').nth(1).and_then(|code| code.parse().ok()).expect("a status");
        let body = answer.split_once("\r\n\r\n").map(|(_, body)| body).unwrap_or_default();
        (status, serde_json::from_str(body).unwrap_or(Value::Null))
    }

    pub fn get(&self, path: &str) -> Value {
        let (status, body) = self.request_with_head("GET", path, "host: 127.0.0.1\r\n", "");
        assert_eq!(status, 200, "{path}: {body}");
        body
    }

    pub fn post(&self, path: &str, body: &Value) -> StatusAndBody {
        self.request_with_head("POST", path, "host: localhost\r\n", &body.to_string())
    }

    fn advance_week(&self) -> StatusAndBody {
        self.post("/next-week", &json!({ "rationale": "on", "predictions": predictions() }))
    }

    #[cfg(unix)]
    pub fn stop(mut self) -> i32 {
        let pid = self.child.id().to_string();
        assert!(Command::new("kill").args(["-TERM", &pid]).status().expect("kill").success());
        self.child.wait().expect("it ends").code().expect("it ends on its own")
    }
}

pub fn predictions() -> Value {
    let forecast = json!({ "point": 1e6, "lower": 0, "upper": 2e6 });
    json!({ "cash_1wk": forecast, "cash_4wk": forecast, "cash_12wk": forecast, "cash_26wk": forecast })
}

pub const NEW_RUN_OPTIONS: [&str; 7] = ["--new", "--seed", "7", "--days", "28", "--mode", "sandbox"];

/// Calls that are made through every interface.
pub const CALLS: [(&str, &str); 3] = [
    ("set_prices", r#"{"A": 10, "B": 20, "C": null}"#),
    ("set_usage_quotas", r#"{"A": 50000, "B": 200000, "C": 900000}"#),
    ("set_targeted_ad_spend", r#"{"content_marketing": {"S1": 500}}"#),
];

/// Returns the last state hash of the only run.
pub fn last_state_hash(home: &Home) -> String {
    let id = home.only_run().file_name().expect("a name").to_string_lossy().into_owned();
    let verified = home.run(&["replay", &id, "--verify"]);
    assert_eq!(verified.exit_code, 0, "{}", verified.stderr);
    let text = std::fs::read_to_string(home.only_run().join("trajectory.jsonl")).expect("a trajectory");
    let mut weeks = text.lines().map(|line| serde_json::from_str::<Value>(line).expect("JSON"));
    let last = weeks.rfind(|line| line["kind"] == "week").expect("a week");
    last["state_hash"].as_str().expect("a hash").to_owned()
}

pub fn plain_mode_state_hash() -> String {
    let home = Home::new();
    let mut lines: String = CALLS.iter().map(|(tool, args)| format!("{tool} {args}\n")).collect();
    for _ in 0..2 {
        lines += &format!("next {}\n", json!({ "rationale": "on", "predictions": predictions() }));
    }
    lines = lines.replace(r#", "C": null"#, "");
    let program_output = home.play(&["--seed", "7", "--days", "28", "--mode", "sandbox", "--strict"], &lines);
    assert_eq!(program_output.exit_code, 0, "{}", program_output.stdout);
    last_state_hash(&home)
}

#[cfg(unix)]
#[test]
fn sql_statement_and_week_can_be_called_as_tools() {
    let home = Home::new();
    let server = Server::start(&home, &NEW_RUN_OPTIONS);
    let call = |tool: &str, args: Value| server.post("/call", &json!({ "tool": tool, "args": args }));
    let (status, rows) = call("query", json!({ "sql": "SELECT 5 AS x" }));
    assert_eq!((status, &rows["rows"]), (200, &json!([{ "x": 5 }])), "{rows}");
    for sql in ["SELEC", "SELECT * FROM sqlite_master"] {
        let (status, refused) = call("query", json!({ "sql": sql }));
        assert_eq!((status, &refused["success"]), (200, &json!(false)), "{refused}");
    }
    let (_, week) = call("next_week", json!({ "rationale": "on", "predictions": predictions() }));
    assert_eq!((&week["success"], &week["day"]), (&json!(true), &json!(7)), "{week}");
    assert_eq!(server.stop(), 0);
}

#[cfg(unix)]
#[test]
fn abandoned_script_is_stopped() {
    if !Command::new("python3").args(["-c", ""]).output().is_ok_and(|done| done.status.success()) {
        eprintln!("SKIPPED: there is no python3 on the path");
        return;
    }
    let home = Home::new();
    let server = Server::start(&home, &NEW_RUN_OPTIONS);
    let endless = json!({ "name": "endless", "code": "# python\nwhile True:\n    pass" });
    assert_eq!(server.post("/call", &json!({ "tool": "register_script", "args": endless })).0, 200);
    let body = json!({ "tool": "run_script", "args": { "name": "endless" } }).to_string();
    let request =
        format!("POST /call HTTP/1.1\r\nhost: 127.0.0.1\r\ncontent-length: {}\r\n\r\n{body}", body.len());
    let begin = || {
        let mut stream = TcpStream::connect(("127.0.0.1", server.port)).expect("a connection");
        stream.write_all(request.as_bytes()).expect("sent");
        std::thread::sleep(std::time::Duration::from_millis(500));
        stream
    };
    // The client of the script disconnects, and other clients are answered again. The script would run for ten minutes.
    drop(begin());
    assert_eq!(server.get("/vars")["current_day"], 0);
    // The server is stopped while a script is running.
    let waiting = begin();
    assert_eq!(server.stop(), 0);
    drop(waiting);
}

#[cfg(unix)]
#[test]
fn server_of_release_2_publishes_its_tables_and_tools() {
    let home = Home::new();
    let server = Server::start(&home, &["--new", "--seed", "1", "--scenario", "release-2"]);
    let asked = |sql: &str| server.post("/query", &json!({ "sql": sql }));
    let (status, rows) = asked("SELECT * FROM subscriptions");
    assert_eq!((status, rows["columns"].as_array().map(Vec::len)), (200, Some(15)), "{rows}");
    for refused in
        ["DELETE FROM ledger", "SELECT * FROM events", "SELECT first_billing_done FROM subscriptions"]
    {
        assert_eq!(asked(refused).0, 500, "{refused}");
    }
    assert_eq!(asked("").0, 400);
    let tables = server.get("/tables").to_string();
    assert!(tables.contains("thread_id") && !tables.contains("first_billing_done"), "{tables}");
    assert!(!server.get("/tools").to_string().contains("persona_name"));
    assert_eq!(server.stop(), 0);
}

#[cfg(unix)]
#[test]
fn http_client_reaches_the_same_state() {
    let home = Home::new();
    let server = Server::start(&home, &NEW_RUN_OPTIONS);
    let run = home.only_run().file_name().expect("a name").to_string_lossy().into_owned();
    assert_eq!(server.get("/health"), json!({ "status": "ok", "run": run }));
    assert_eq!(server.get("/vars"), json!({ "current_day": 0 }));
    for (tool, args) in CALLS {
        let args: Value = serde_json::from_str(args).expect("JSON");
        let (status, body) = server.post("/call", &json!({ "tool": tool, "args": args }));
        assert_eq!((status, &body["success"]), (200, &json!(true)), "{body}");
    }
    let (status, refused) =
        server.post("/call", &json!({ "tool": "set_capacity_tier", "args": { "tier": 9 } }));
    assert_eq!((status, refused["success"].as_bool(), refused["data"].is_null()), (200, Some(false), true));
    assert_eq!(server.post("/next-week", &json!({ "rationale": "x" })).0, 400);
    for day in [7, 14] {
        let (status, week) = server.advance_week();
        assert_eq!((status, &week["day"], &week["ended"]), (200, &json!(day), &Value::Null), "{week}");
    }
    let status = server.get("/game-status");
    assert_eq!((status["day"].as_u64(), status["timed_out"].as_bool()), (Some(14), Some(false)));
    assert!(server.get("/dashboard")["dashboard"].as_str().is_some_and(|text| text.contains("Cash")));
    let asked = |sql: &str| server.post("/query", &json!({ "sql": sql }));
    let (ok, rows) = asked("SELECT SUM(amount) AS cash FROM ledger");
    assert_eq!((ok, &rows["row_count"], &rows["rows"][0]["cash"]), (200, &json!(1), &status["cash"]));
    assert_eq!(asked("SELECT * FROM events").0, 403);
    assert_eq!(asked("DELETE FROM ledger").0, 403);
    assert_eq!(asked("").0, 400);
    assert_eq!(asked("SELECT nothing FROM ledger").0, 500);
    assert_eq!(server.get("/tools").as_array().map(Vec::len), Some(36));
    assert_eq!(server.get("/tables").as_array().map(Vec::len), Some(19));
    assert!(server.get("/openapi.json")["components"]["schemas"]["set_prices"].is_object());
    assert_eq!(server.stop(), 0);
    assert_eq!(last_state_hash(&home), plain_mode_state_hash());
}

#[test]
fn week_response_has_the_figures_of_plain_mode() {
    let (home, plain) = (Home::new(), Home::new());
    let server = Server::start(&home, &NEW_RUN_OPTIONS);
    let (_, week) = server.advance_week();
    let line = format!("next {}\n", json!({ "rationale": "on", "predictions": predictions() }));
    let options = ["--seed", "7", "--days", "28", "--mode", "sandbox", "--json"];
    let program_output = plain.play(&options, &line);
    let mut answers =
        program_output.stdout.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let next = answers.find(|answer| answer["command"] == "next").expect("an answer");
    let figures = &next["data"]["figures"];
    assert!(figures["new_individual_leads"].is_number(), "{next}");
    assert_eq!(week["figures"], *figures);
}

#[cfg(unix)]
#[test]
fn hostile_requests_do_not_change_the_run() {
    let home = Home::new();
    let token = home.0.path().join("token.txt");
    let server =
        Server::start(&home, &[&NEW_RUN_OPTIONS[..], &["--token", &token.to_string_lossy()]].concat());
    let secret = std::fs::read_to_string(&token).expect("a token");
    let known = format!("host: 127.0.0.1\r\nauthorization: Bearer {}\r\n", secret.trim());
    let call = json!({ "tool": "get_vars" }).to_string();
    for (head, status) in [
        ("host: 127.0.0.1\r\n".to_owned(), 401),
        ("host: 127.0.0.1\r\nauthorization: Bearer x\r\n".to_owned(), 401),
        (known.replace("127.0.0.1", "example.org"), 403),
        (format!("{known}origin: https://example.org\r\n"), 403),
        (format!("{known}host: 127.0.0.1\r\n"), 403),
        (known.replace("Bearer", "bearer"), 200),
        (known.clone(), 200),
    ] {
        assert_eq!(server.request_with_head("POST", "/call", &head, &call).0, status, "{head}");
    }
    let ask = |method: &str, path: &str, body: &str| server.request_with_head(method, path, &known, body).0;
    for body in ["", "{", "[]", "null", "7", "\"x\"", "{\"tool\": }", "\u{0}"] {
        assert_eq!(ask("POST", "/call", body), 400, "{body}");
    }
    for body in [
        json!({}),
        json!({ "tool": 7 }),
        json!({ "tool": "next_week" }),
        json!({ "tool": "set_prices", "args": [[]] }),
    ] {
        let (status, answer) = server.request_with_head("POST", "/call", &known, &body.to_string());
        assert_eq!((status, answer["success"].as_bool()), (200, Some(false)), "{body}");
    }
    assert_eq!(ask("GET", "/nothing", ""), 404);
    assert_eq!(ask("DELETE", "/call", ""), 404);
    assert_eq!(ask("DELETE", "/daily-scripts", r#"{"name": "none"}"#), 404);
    let large = format!("{{\"tool\": \"{}\"}}", "x".repeat(2 << 20));
    assert_eq!(ask("POST", "/call", &large), 413);
    for garbage in
        [&b"\x16\x03\x01\x02\x00"[..], b"GET\r\n\r\n", b"POST /call HTTP/1.1\r\ncontent-length: -1\r\n\r\n"]
    {
        let answer = server.send_raw(garbage);
        assert!(answer.is_empty() || answer.starts_with("HTTP/1.1 400"), "{answer}");
    }
    // A client disconnects in the middle of a week.
    let body = json!({ "rationale": "on", "predictions": predictions() }).to_string();
    let request = format!("POST /next-week HTTP/1.1\r\n{known}content-length: {}\r\n\r\n{body}", body.len());
    let mut stream = TcpStream::connect(("127.0.0.1", server.port)).expect("a connection");
    stream.write_all(request.as_bytes()).expect("sent");
    drop(stream);
    assert_eq!(ask("GET", "/vars", ""), 200);
    assert_eq!(server.stop(), 0);
    let id = home.only_run().file_name().expect("a name").to_string_lossy().into_owned();
    assert_eq!(home.run(&["replay", &id, "--verify"]).exit_code, 0);
}

#[test]
fn non_finite_number_is_rejected_like_an_argument() {
    let home = Home::new();
    let server = Server::start(&home, &NEW_RUN_OPTIONS);
    let ask = |path: &str, body: &str| server.request_with_head("POST", path, "host: localhost\r\n", body);
    let (status, refused) = ask("/call", r#"{"tool": "set_prices", "args": {"A": 10, "B": NaN}}"#);
    assert_eq!((status, &refused["success"], &refused["code"]), (200, &json!(false), &json!("wrong_type")));
    assert_eq!((&refused["field"], refused["data"].is_null()), (&json!("B"), true));
    assert!(refused["error"].as_str().is_some_and(|text| text.contains("B is NaN")), "{refused}");
    let (_, unnamed) = ask("/call", "{}");
    assert!(unnamed["error"].as_str().is_some_and(|text| text.contains("names no tool")), "{unnamed}");
    let filed = json!({ "rationale": "on", "predictions": predictions() }).to_string();
    let (status, refused) = ask("/next-week", &filed.replacen("2000000.0", "Infinity", 1));
    assert_eq!((status, &refused["success"]), (400, &json!(false)), "{refused}");
    assert_eq!(refused["field"], "predictions.cash_1wk.upper");
    assert_eq!(server.get("/vars")["current_day"], 0);
    let text = std::fs::read_to_string(home.only_run().join("trajectory.jsonl")).expect("a trajectory");
    let calls: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let sent = calls.iter().find(|line| line["tool"] == "set_prices").expect("it is recorded");
    assert_eq!(sent["args"], json!({ "A": 10, "B": "NaN" }));
}

#[test]
fn excess_connection_gets_status_503() {
    let home = Home::new();
    let server = Server::start(&home, &NEW_RUN_OPTIONS);
    let tcp_streams: Vec<TcpStream> = (0..64)
        .map(|_| {
            let mut stream = TcpStream::connect(("127.0.0.1", server.port)).expect("a connection");
            // An answered request shows that the server has accepted the connection.
            stream.write_all(b"GET /health HTTP/1.1\r\nhost: 127.0.0.1\r\n\r\n").expect("sent");
            assert!(stream.read(&mut [0; 1024]).expect("an answer") > 0);
            stream
        })
        .collect();
    let body = json!({ "tool": "get_vars", "args": { "long": "x".repeat(100_000) } }).to_string();
    let request =
        format!("POST /call HTTP/1.1\r\nhost: 127.0.0.1\r\ncontent-length: {}\r\n\r\n{body}", body.len());
    let answer = server.send_raw(request.as_bytes());
    let (head, body) = answer.split_once("\r\n\r\n").unwrap_or_else(|| panic!("{answer}"));
    assert!(head.starts_with("HTTP/1.1 503 ") && head.contains("retry-after: 1"), "{head}");
    let body: Value = serde_json::from_str(body).expect("JSON");
    assert_eq!((&body["success"], &body["code"]), (&json!(false), &json!("too_many_connections")));
    let run = home.only_run().file_name().expect("a name").to_string_lossy().into_owned();
    for command in ["status", "stop"] {
        let full = home.run(&["agent", command, "--run", &run]);
        assert_eq!(full.exit_code, 7, "{command}: {}{}", full.stdout, full.stderr);
    }
    drop(tcp_streams);
}

#[test]
fn mcp_answers_invalid_json_with_a_parse_error() {
    let home = Home::new();
    let mut child = home.program().arg("mcp").args(NEW_RUN_OPTIONS).spawn().expect("the program starts");
    let mut to = child.stdin.take().expect("a pipe");
    let mut from = BufReader::new(child.stdout.take().expect("a pipe")).lines();
    let mut ask = |line: &str| -> Value {
        writeln!(to, "{line}").expect("sent");
        serde_json::from_str(&from.next().expect("an answer").expect("a line")).expect("JSON")
    };
    let client = json!({ "protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": { "name": "t", "version": "1" } });
    let first = json!({ "jsonrpc": "2.0", "id": 1, "method": "initialize", "params": client });
    assert_eq!(ask(&first.to_string())["id"], 1);
    let deep = "[".repeat(100_000);
    for line in
        ["{", "\u{1}", r#"{"jsonrpc": "2.0", "id": 3, "#, &deep, &format!("{deep}{}", "]".repeat(100_000))]
    {
        let answer = ask(line);
        assert_eq!(
            (&answer["error"]["code"], answer.get("id")),
            (&json!(-32700), Some(&Value::Null)),
            "{answer}"
        );
    }
    let not_a_number = r#"{"jsonrpc": "2.0", "id": 3, "method": "tools/call", "params": {"name": "set_prices", "arguments": {"A": NaN}}}"#;
    let answer = ask(not_a_number);
    assert_eq!((&answer["id"], &answer["error"]["code"]), (&json!(3), &json!(-32700)), "{answer}");
    assert!(answer["error"]["message"].as_str().is_some_and(|text| text.contains("A is NaN")), "{answer}");
    let call = json!({ "jsonrpc": "2.0", "id": 4, "method": "tools/call", "params": { "name": "get_vars", "arguments": {} } });
    assert_eq!(ask(&call.to_string())["id"], 4);
    let tools = ask(&json!({ "jsonrpc": "2.0", "id": 5, "method": "tools/list", "params": {} }).to_string());
    let declares = |name: &str, field: &str| {
        let tools = tools["result"]["tools"].as_array().expect("tools").iter();
        let mut matching = tools.filter(|tool| tool["name"] == name);
        matching.next().expect(name)["inputSchema"]["properties"].get(field).is_some()
    };
    assert!(declares("set_prices", "request_id") && declares("next_week", "expected_day"));
    assert!(!declares("get_vars", "request_id") && !declares("set_prices", "expected_day"));
    let prices = |id: u32, a: u32| {
        let arguments = json!({ "A": a, "request_id": "p" });
        json!({ "jsonrpc": "2.0", "id": id, "method": "tools/call", "params": { "name": "set_prices", "arguments": arguments } })
    };
    let first = ask(&prices(6, 12).to_string());
    assert_eq!(first["result"]["structuredContent"]["success"], true, "{first}");
    assert_eq!(ask(&prices(7, 12).to_string())["result"], first["result"]);
    let other = ask(&prices(8, 13).to_string());
    assert_eq!(other["result"]["structuredContent"]["code"], "request_id_payload_mismatch", "{other}");
    let unknown = json!({ "jsonrpc": "2.0", "id": 9, "method": "tools/call", "params": { "name": "set_wages", "arguments": { "A": 1 } } });
    assert_eq!(ask(&unknown.to_string())["result"]["structuredContent"]["code"], "unknown_tool");
    drop(to);
    assert!(child.wait().expect("it ends").success());
    let text = std::fs::read_to_string(home.only_run().join("trajectory.jsonl")).expect("a trajectory");
    let mut lines = text.lines().map(|line| serde_json::from_str::<Value>(line).expect("JSON"));
    let line = lines.find(|line| line["tool"] == "set_wages").expect("it is recorded");
    assert_eq!((&line["via"], &line["args"]), (&json!("mcp"), &json!({ "A": 1 })));
}

#[test]
fn mcp_client_lists_tools_and_plays() {
    let home = Home::new();
    let mut child = home.program().arg("mcp").args(NEW_RUN_OPTIONS).spawn().expect("the program starts");
    let mut to = child.stdin.take().expect("a pipe");
    let mut from = BufReader::new(child.stdout.take().expect("a pipe")).lines();
    let mut ask = |id: u32, method: &str, params: Value| -> Value {
        let request = json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params });
        writeln!(to, "{request}").expect("sent");
        loop {
            let line = from.next().expect("an answer").expect("a line");
            let answer: Value = serde_json::from_str(&line).expect("JSON");
            if answer["id"] == id {
                return answer;
            }
        }
    };
    let client = json!({ "protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": { "name": "t", "version": "1" } });
    assert_eq!(ask(1, "initialize", client)["result"]["serverInfo"]["name"], "novamind");
    let tools = ask(2, "tools/list", json!({}));
    assert_eq!(tools["result"]["tools"].as_array().map(Vec::len), Some(36), "{tools}");
    let mut call = |id, name: &str, arguments: Value| {
        ask(id, "tools/call", json!({ "name": name, "arguments": arguments }))["result"].clone()
    };
    for (at, (tool, args)) in CALLS.iter().enumerate() {
        let response = call(10 + at as u32, tool, serde_json::from_str(args).expect("JSON"));
        assert_eq!(response["structuredContent"]["success"], true, "{response}");
    }
    assert_eq!(call(20, "set_capacity_tier", json!({ "tier": 9 }))["isError"], true);
    for at in 0..2 {
        let response = call(30 + at, "next_week", json!({ "rationale": "on", "predictions": predictions() }));
        assert_eq!(response["structuredContent"]["day"], 7 * (at + 1), "{response}");
    }
    let rows = call(40, "query", json!({ "sql": "SELECT COUNT(*) AS n FROM customers" }));
    assert_eq!(rows["structuredContent"]["row_count"], 1);
    let manual = ask(50, "resources/read", json!({ "uri": "novamind://manual" }));
    assert!(manual["result"]["contents"][0]["text"].as_str().is_some_and(|text| text.contains("set_prices")));
    assert!(ask(51, "resources/read", json!({ "uri": "novamind://hidden" }))["error"].is_object());
    let listed = || home.run(&["runs", "list"]).stdout.contains("played by a program");
    assert!(listed());
    home.run(&["agent", "status", "--run", "latest"]).assert_fails(1, &["open in another program"]);
    drop(to);
    assert!(child.wait().expect("it ends").success());
    assert!(!listed() && !home.only_run().join("server.json").exists());
    assert_eq!(last_state_hash(&home), plain_mode_state_hash());
}

#[test]
fn python_client_plays_a_run() {
    if Command::new("python3").arg("--version").stdout(Stdio::null()).status().is_err() {
        println!("SKIPPED: python3 is not installed");
        return;
    }
    let home = Home::new();
    let folder = home.0.path().join("client");
    assert_eq!(home.run(&["serve", "--client", &folder.to_string_lossy()]).exit_code, 0);
    let server = Server::start(&home, &NEW_RUN_OPTIONS);
    let program = "
import novamind
from novamind import infrastructure, marketing, pricing
pricing.set_prices(A=10, B=20)
pricing.set_usage_quotas(A=50000, B=200000, C=900000)
marketing.set_targeted_ad_spend({'content_marketing': {'S1': 500}})
try:
    infrastructure.set_capacity_tier(9)
except novamind.NovamindError as error:
    assert error.code, error
else:
    raise SystemExit('not refused')
forecast = {'point': 1e6, 'lower': 0, 'upper': 2e6}
filed = {key: forecast for key in novamind.naive_predictions()}
for day in (7, 14):
    assert novamind.next_week('on', filed)['day'] == day == novamind.current_day()
assert novamind.query('SELECT COUNT(*) AS n FROM customers')['row_count'] == 1
";
    let mut python = home.command("python3");
    python.env("PYTHONPATH", &folder).env("NOVAMIND_API_PORT", server.port.to_string());
    let output = python.args(["-c", program]).output().expect("python");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    #[cfg(unix)]
    {
        assert_eq!(server.stop(), 0);
        assert_eq!(last_state_hash(&home), plain_mode_state_hash());
    }
}

#[test]
fn served_run_with_non_baseline_options_is_reported_as_sandbox() {
    // The client disconnects immediately, but the run has been created.
    let mode_of = |options: &[&str]| {
        let home = Home::new();
        let program_output = home.run(&[&["mcp", "--seed", "3"], options].concat());
        let list: Value = serde_json::from_str(&home.run(&["runs", "list", "--json"]).stdout).expect("JSON");
        (list[0]["mode"].clone(), program_output.stderr)
    };
    for (options, mode, words) in [
        (&[][..], "baseline", None),
        (&["--days", "500", "--cash", "1000000"], "baseline", None),
        (
            &["--days", "28"],
            "sandbox",
            Some(
                "this is a sandbox run with 28 days; a baseline run has scenario default or release-2, 500 days and $1,000,000",
            ),
        ),
        (&["--cash", "5e5"], "sandbox", Some("with $500,000;")),
        (&["--scenario", "paper"], "sandbox", Some("with scenario paper;")),
        (&["--days", "28", "--mode", "debug"], "debug", None),
    ] {
        let (found, err) = mode_of(options);
        assert_eq!(found, json!(mode), "{options:?}: {err}");
        match words {
            Some(words) => assert!(err.contains(words), "{options:?}: {err}"),
            None => assert!(!err.contains("sandbox run"), "{options:?}: {err}"),
        }
    }
    assert!(
        mode_of(&["--days", "28", "--mode", "baseline"]).1.contains("28 days can be set only in a study")
    );
    let help = Home::new().run(&["serve", "--help"]).stdout;
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(help.contains("baseline runs have 500") && help.contains("for programs, baseline"), "{help}");
}

#[test]
fn mcp_reports_a_run_that_cannot_be_opened() {
    let home = Home::new();
    let lines = "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"initialize\",\"params\":{}}\n";
    let program_output = run_with_input(home.program().args(["mcp", "--run", "nothere"]), lines);
    program_output.assert_fails(3, &["nothere"]);
    let answer: Value = serde_json::from_str(&program_output.stdout).expect("JSON");
    assert_eq!((&answer["id"], &answer["jsonrpc"]), (&json!(1), &json!("2.0")));
    let message = answer["error"]["message"].as_str().expect("a message");
    assert!(program_output.stderr.contains(message) && message.contains("nothere"), "{answer}");
    // If the client sends no request, the message is written to standard error.
    home.run(&["mcp", "--run", "nothere"]).assert_fails(3, &["nothere"]);
}
