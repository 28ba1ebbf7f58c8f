//! Retries of HTTP requests from several threads, and after the server was killed and restarted.

use serde_json::{Value, json};

use crate::interfaces::{NEW_RUN_OPTIONS, Server, predictions};
use crate::support::home::Home;

fn week_request(id: &str, expected_day: u32) -> Value {
    json!({ "rationale": "on", "predictions": predictions(), "expected_day": expected_day, "request_id": id })
}

fn trajectory_lines(home: &Home, kind: &str) -> Vec<Value> {
    let text = std::fs::read_to_string(home.only_run().join("trajectory.jsonl")).expect("a trajectory");
    let lines = text.lines().map(|line| serde_json::from_str::<Value>(line).expect("JSON"));
    lines.filter(|line| line["kind"] == kind).collect()
}

#[test]
fn retry_after_a_kill_returns_the_first_response() {
    let home = Home::new();
    let server = Server::start(&home, &NEW_RUN_OPTIONS);
    let prices = json!({ "tool": "set_prices", "args": { "A": 10, "B": 20 }, "request_id": "p" });
    let script = json!({ "name": "s", "content": "SELECT 1", "request_id": "s" });
    let first = [server.post("/call", &prices), server.post("/daily-scripts", &script)];
    assert!(first.iter().all(|(status, body)| *status == 200 && body["success"] == true), "{first:?}");
    let refused =
        server.post("/call", &json!({ "tool": "set_prices", "args": { "A": 11 }, "request_id": "p" }));
    assert_eq!((refused.0, &refused.1["code"]), (200, &json!("request_id_payload_mismatch")), "{refused:?}");
    let passed = server.post("/next-week", &week_request("w", 0));
    assert_eq!((passed.0, &passed.1["day"]), (200, &json!(7)), "{passed:?}");
    let late = server.post("/next-week", &week_request("v", 0));
    assert_eq!(
        (late.0, &late.1["code"], &late.1["field"]),
        (400, &json!("unexpected_day"), &json!("expected_day"))
    );
    assert!(late.1["error"].as_str().is_some_and(|text| text.contains("day 7")), "{late:?}");
    // Dropping the server kills its process.
    drop(server);
    let server = Server::start(&home, &["--run", "latest"]);
    assert_eq!([server.post("/call", &prices), server.post("/daily-scripts", &script)], first);
    assert_eq!(server.post("/next-week", &week_request("w", 0)), passed);
    assert_eq!(server.post("/next-week", &week_request("v", 0)), late);
    let other = server.post("/next-week", &week_request("w", 7));
    assert_eq!((other.0, &other.1["code"]), (400, &json!("request_id_payload_mismatch")), "{other:?}");
    assert_eq!(server.get("/vars")["current_day"], 7);
    assert_eq!((trajectory_lines(&home, "advance").len(), trajectory_lines(&home, "week").len()), (1, 1));
}

#[test]
fn retries_during_the_first_request_wait_for_its_response() {
    let home = Home::new();
    let server = Server::start(&home, &NEW_RUN_OPTIONS);
    let answers: Vec<(u16, Value)> = std::thread::scope(|scope| {
        let ask = || server.post("/next-week", &week_request("w", 0));
        let all: Vec<_> = (0..8).map(|_| scope.spawn(ask)).collect();
        all.into_iter().map(|one| one.join().expect("an answer")).collect()
    });
    assert!(answers.iter().all(|answer| *answer == answers[0] && answer.0 == 200), "{answers:?}");
    assert_eq!(trajectory_lines(&home, "advance").len(), 1);
}

#[test]
fn next_week_rejects_unknown_arguments() {
    let home = Home::new();
    let server = Server::start(&home, &NEW_RUN_OPTIONS);
    let mut mistyped = week_request("a", 0);
    mistyped["expected_dy"] = 7.into();
    let routes = [
        ("/next-week", 400, mistyped.clone()),
        ("/call", 200, json!({ "tool": "next_week", "args": mistyped })),
    ];
    for (route, expected, body) in routes {
        let (status, answer) = server.post(route, &body);
        assert_eq!((status, &answer["code"]), (expected, &json!("unknown_argument")), "{answer}");
        assert_eq!(answer["field"], "expected_dy");
    }
    assert_eq!(trajectory_lines(&home, "call").len(), 2, "both are on record");
    // The request ID and the day can be arguments of the call or separate fields of the request.
    let filed = json!({ "rationale": "on", "predictions": predictions() });
    let mut within = filed.clone();
    within["request_id"] = "b".into();
    let within = json!({ "tool": "next_week", "args": within });
    assert_eq!(server.post("/call", &within), server.post("/call", &within));
    let late = json!({ "tool": "next_week", "args": filed, "expected_day": 0 });
    assert_eq!(server.post("/call", &late).1["code"], "unexpected_day");
    assert_eq!(trajectory_lines(&home, "advance").len(), 1);
}
