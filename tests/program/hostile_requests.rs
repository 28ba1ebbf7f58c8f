//! A thousand malformed and hostile requests: the server keeps answering, and the run replays from its lines.

use std::io::Write;
use std::net::TcpStream;
use std::thread;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};

use crate::interfaces::{NEW_RUN_OPTIONS, Server, predictions};
use crate::support::home::Home;

const REQUEST_COUNT: usize = 1000;

/// Returns a value of an unexpected type.
fn unexpected_value(random: &mut ChaCha8Rng) -> Value {
    match random.random_range(0..12) {
        0 => Value::Null,
        1 => json!(true),
        2 => json!(-1),
        3 => json!(1e308),
        4 => json!(i64::MIN),
        5 => json!(""),
        6 => json!("\u{0}\u{202e}'; DROP TABLE ledger; --"),
        7 => json!("9".repeat(400)),
        8 => json!([[[[]]]]),
        9 => json!({ "A": { "A": { "A": [] } } }),
        10 => json!({ "": "" }),
        _ => json!([1, "two", null, { "three": 3 }]),
    }
}

/// Returns a random request body, which can be malformed.
fn random_body(tools: &[Value], random: &mut ChaCha8Rng) -> String {
    let tool = &tools[random.random_range(0..tools.len())];
    let mut args = tool["example"].clone();
    if let Some(fields) = args.as_object_mut() {
        let names: Vec<String> = fields.keys().cloned().collect();
        for name in names {
            if random.random_bool(0.7) {
                fields.insert(name, unexpected_value(random));
            }
        }
        if random.random_bool(0.2) {
            fields.insert("another".to_owned(), unexpected_value(random));
        }
    }
    let name = if random.random_bool(0.1) { unexpected_value(random) } else { tool["name"].clone() };
    json!({ "tool": name, "args": if random.random_bool(0.1) { unexpected_value(random) } else { args } })
        .to_string()
}

/// Returns a random request and the accepted statuses. If no status is listed, the server may close the connection
/// without a response.
fn random_request(tools: &[Value], known: &str, random: &mut ChaCha8Rng) -> (Vec<u8>, &'static [u16]) {
    let sent = random_body(tools, random);
    let head = |head: &str, path: &str, length: usize| {
        format!("POST {path} HTTP/1.1\r\n{head}connection: close\r\ncontent-length: {length}\r\n\r\n")
    };
    let with = |head: String, body: &str| [head.as_bytes(), body.as_bytes()].concat();
    match random.random_range(0..10) {
        0 => {
            let cut = (1..sent.len()).rev().find(|at| sent.is_char_boundary(*at) && *at < sent.len() / 2);
            let part = &sent[..cut.unwrap_or(0)];
            (with(head(known, "/call", part.len()), part), &[400])
        }
        1 | 2 => (with(head(known, "/call", sent.len()), &sent), &[200, 400, 404]),
        3 => {
            let query = json!({ "sql": unexpected_value(random) }).to_string();
            (with(head(known, "/query", query.len()), &query), &[400, 403, 500])
        }
        4 => {
            let path =
                ["/nothing", "/call/", "/../call", "/hidden.customers", "/%2e%2e/", "/call?tool=query"];
            let path = path[random.random_range(0..path.len())];
            (with(head(known, path, sent.len()), &sent), &[200, 400, 404])
        }
        5 => {
            let named = known.replace(
                "127.0.0.1",
                ["example.org", "127.0.0.1.example.org", ""][random.random_range(0..3)],
            );
            (with(head(&named, "/call", sent.len()), &sent), &[403])
        }
        6 => {
            let page = format!("{known}origin: https://example.org\r\n");
            (with(head(&page, "/call", sent.len()), &sent), &[403])
        }
        7 => (with(head("host: 127.0.0.1\r\n", "/call", sent.len()), &sent), &[401]),
        8 => {
            // The content length is too large, too small or not a number.
            let length = ["7", "-1", "99999999999999999999", "x"][random.random_range(0..4)];
            let head = format!(
                "POST /call HTTP/1.1\r\n{known}connection: close\r\ncontent-length: {length}\r\n\r\n"
            );
            (with(head, &sent[..sent.floor_char_boundary(sent.len().min(30))]), &[400, 413])
        }
        _ => {
            let noise: Vec<u8> = (0..random.random_range(1..200)).map(|_| random.random()).collect();
            ([noise, b"\r\n\r\n".to_vec()].concat(), &[])
        }
    }
}

#[test]
fn server_keeps_answering_after_a_thousand_hostile_requests() {
    let home = Home::new();
    let token = home.0.path().join("token.txt");
    let server =
        Server::start(&home, &[&NEW_RUN_OPTIONS[..], &["--token", &token.to_string_lossy()]].concat());
    let secret = std::fs::read_to_string(&token).expect("a token");
    let known = format!("host: 127.0.0.1\r\nauthorization: Bearer {}\r\n", secret.trim());
    let ask = |method: &str, path: &str, body: &str| server.request_with_head(method, path, &known, body);
    let tools = ask("GET", "/tools", "").1;
    let tools = tools.as_array().expect("tools");
    let mut random = ChaCha8Rng::seed_from_u64(85);
    for number in 0..REQUEST_COUNT {
        let (bytes, expected) = random_request(tools, &known, &mut random);
        let answer = server.send_raw(&bytes);
        let status: Option<u16> = answer.split(' ').nth(1).and_then(|code| code.parse().ok());
        match status {
            Some(status) => assert!(
                expected.contains(&status) || (expected.is_empty() && status == 400),
                "{number}: {}\n{answer}",
                String::from_utf8_lossy(&bytes)
            ),
            None => assert!(expected.is_empty(), "{number}: {}", String::from_utf8_lossy(&bytes)),
        }
        if number % 100 == 0 {
            assert_eq!(ask("GET", "/vars", "").0, 200, "after {number}");
        }
    }
    check_large_bodies(&server, &known);
    check_concurrent_weeks(&server, &known);
    assert_eq!(ask("GET", "/vars", "").0, 200);
    #[cfg(unix)]
    assert_eq!(server.stop(), 0);
    let id = home.only_run().file_name().expect("a name").to_string_lossy().into_owned();
    assert_eq!(home.run(&["replay", &id, "--verify"]).exit_code, 0);
}

/// Checks that a body of ten megabytes is rejected before it is received completely.
fn check_large_bodies(server: &Server, known: &str) {
    let text = format!(r#"{{"tool": "{}"}}"#, "x".repeat(10 << 20));
    for path in ["/call", "/query", "/next-week", "/daily-scripts"] {
        let (status, answer) = server.request_with_head("POST", path, known, &text);
        assert_eq!(status, 413, "{path}: {answer}");
    }
}

/// Checks that concurrent requests run one week at a time, even if clients disconnect.
fn check_concurrent_weeks(server: &Server, known: &str) {
    let day =
        || server.request_with_head("GET", "/vars", known, "").1["current_day"].as_u64().expect("a day");
    // The current day is requested, because a random call to `next_week` may have been valid.
    let before = day();
    let body = json!({ "rationale": "on", "predictions": predictions() }).to_string();
    let statuses: Vec<u16> = thread::scope(|scope| {
        let join_handles: Vec<_> = (0..4)
            .map(|_| scope.spawn(|| server.request_with_head("POST", "/next-week", known, &body).0))
            .collect();
        join_handles.into_iter().map(|join_handle| join_handle.join().expect("an answer")).collect()
    });
    assert!(statuses.contains(&200), "{statuses:?}");
    assert!(statuses.iter().all(|status| [200, 400, 409].contains(status)), "{statuses:?}");
    let passed = statuses.iter().filter(|status| **status == 200).count() as u64;
    assert_eq!(day(), before + 7 * passed);
    let length = body.len();
    let request = format!("POST /next-week HTTP/1.1\r\n{known}content-length: {length}\r\n\r\n{body}");
    let mut stream = TcpStream::connect(("127.0.0.1", server.port)).expect("a connection");
    stream.write_all(request.as_bytes()).expect("sent");
    drop(stream);
}
