//! Requests with an ID run only once: within a session, after reopening the run, and after a kill during a week.

use std::fs;
use std::path::Path;

use novamind::record::mode::Mode;
use novamind::record::trajectory::record::Via;
use novamind::record::trajectory::{Record, Trajectory};
use novamind::session::{Session, WeekRequest, read_afterwards, verify};
use serde_json::{Value, json};

use crate::durability::run::{create_run, open_run, temporary_runs_folder};

fn advance_week(
    session: &mut Session,
    rationale: &str,
    expected_day: Value,
    id: &str,
) -> Result<Value, String> {
    let predictions = session.company().naive_forecasts().to_predictions();
    // The forecasts are part of the digest, so they must not change.
    let predictions = if rationale == "naive" { predictions } else { fixed_predictions() };
    let request = WeekRequest {
        rationale: &json!(rationale),
        predictions: &predictions,
        expected_day: &expected_day,
        id: &json!(id),
    };
    session
        .advance_once(&request, Via::Http)
        .map(|week| {
            let mut value = week.to_json();
            value.as_object_mut().expect("an object").remove("notifications");
            value
        })
        .map_err(|refusal| refusal.code)
}

fn fixed_predictions() -> Value {
    let forecast = json!({ "point": 1e6, "lower": 0, "upper": 2e6 });
    json!({ "cash_1wk": forecast, "cash_4wk": forecast, "cash_12wk": forecast, "cash_26wk": forecast })
}

fn call(session: &mut Session, tool: &str, args: Value, id: &str) -> Result<Value, String> {
    session.call_once(tool, &args, Via::Http, &json!(id)).map_err(|refusal| refusal.code)
}

fn count_lines(folder: &Path, kind: &str) -> usize {
    let trajectory = Trajectory::read(&folder.join("trajectory.jsonl")).expect("it reads");
    trajectory.lines.iter().filter(|line| line.record.kind() == kind).count()
}

#[test]
fn retry_returns_the_first_response_after_reopening() {
    let place = temporary_runs_folder();
    let mut session = create_run(place.path(), 7, 28);
    let folder = session.folder().expect("a folder").to_owned();
    let prices = json!({ "A": 12, "B": 25 });
    let first = call(&mut session, "set_prices", prices.clone(), "p").expect("prices");
    let refused = call(&mut session, "set_prices", json!({ "A": -1 }), "r");
    assert_eq!(refused, Err("price_not_positive".to_owned()));
    let unknown = call(&mut session, "set_wages", json!({ "A": 1 }), "u");
    assert_eq!(unknown, Err("unknown_tool".to_owned()));
    let weeks: Vec<Value> = (0..4)
        .map(|n| advance_week(&mut session, "on", json!(7 * n), &format!("w{n}")).expect("a week"))
        .collect();
    assert_eq!((&weeks[3]["ended"], &weeks[0]["ended"]), (&json!("horizon"), &Value::Null));
    call(&mut session, "delete_script", json!({ "name": "none" }), "after").expect_err("none of that name");
    let written = fs::read(folder.join("trajectory.jsonl")).expect("a file");
    let retry = |session: &mut Session| {
        assert_eq!(call(session, "set_prices", prices.clone(), "p").as_ref(), Ok(&first));
        assert_eq!(call(session, "set_prices", json!({ "A": -1 }), "r"), refused);
        assert_eq!(call(session, "set_wages", json!({ "A": 1 }), "u"), unknown);
        for (n, first) in weeks.iter().enumerate() {
            assert_eq!(
                advance_week(session, "on", json!(7 * n), &format!("w{n}")).as_ref(),
                Ok(first),
                "week {n}"
            );
        }
        call(session, "delete_script", json!({ "name": "none" }), "after").expect_err("none of that name");
    };
    retry(&mut session);
    session.save().expect("it is saved");
    drop(session);
    // The run is opened with the snapshot, and from its lines alone.
    let mut session = open_run(&folder);
    retry(&mut session);
    drop(session);
    fs::remove_file(folder.join("snapshot.bin")).expect("a snapshot");
    let mut session = open_run(&folder);
    retry(&mut session);
    drop(session);
    assert_eq!(fs::read(folder.join("trajectory.jsonl")).expect("a file"), written, "nothing ran again");
    let trajectory = Trajectory::read(&folder.join("trajectory.jsonl")).expect("it reads");
    let after = read_afterwards(&folder, &trajectory).expect("it reads").lines;
    assert_eq!(after.iter().filter(|line| line.record.kind() == "call").count(), 1);
    verify(&folder).expect("it verifies");
}

#[test]
fn reused_or_invalid_request_ids_are_rejected() {
    let place = temporary_runs_folder();
    let mut session = create_run(place.path(), 7, 28);
    let code = |refused: Result<Value, String>| refused.expect_err("a refusal");
    call(&mut session, "set_prices", json!({ "A": 12, "B": 25 }), "x").expect("prices");
    // The order of keys does not matter.
    call(&mut session, "set_prices", json!({ "B": 25, "A": 12 }), "x").expect("the first answer");
    assert_eq!(
        code(call(&mut session, "set_prices", json!({ "A": 13 }), "x")),
        "request_id_payload_mismatch"
    );
    assert_eq!(
        code(call(&mut session, "set_usage_quotas", json!({ "A": 12, "B": 25 }), "x")),
        "request_id_payload_mismatch"
    );
    assert_eq!(code(advance_week(&mut session, "on", Value::Null, "x")), "request_id_payload_mismatch");
    assert_eq!(session.company().current_arguments("set_prices")["A"], 12.0);
    for id in ["".to_owned(), "ä".repeat(129)] {
        assert_eq!(code(call(&mut session, "set_prices", json!({ "A": 13 }), &id)), "request_id_invalid");
    }
    let seven = session.call_once("set_prices", &json!({ "A": 13 }), Via::Http, &json!(7));
    assert_eq!(seven.expect_err("no text").code, "request_id_invalid");
    call(&mut session, "set_prices", json!({ "A": 13 }), &"ä".repeat(128)).expect("prices");
    // Read-only tools ignore the request ID.
    call(&mut session, "get_vars", json!({}), "x").expect("the day");
    call(&mut session, "get_vars", json!({}), "").expect("the day");
    assert_eq!(code(advance_week(&mut session, "on", json!(7), "w")), "unexpected_day");
    assert_eq!(code(advance_week(&mut session, "on", json!("0"), "v")), "wrong_type");
    assert_eq!(session.day(), 0);
    advance_week(&mut session, "on", json!(0), "w0").expect("a week");
    // The rejection is repeated, although the run has reached the expected day.
    assert_eq!(code(advance_week(&mut session, "on", json!(7), "w")), "unexpected_day");
    assert_eq!(session.day(), 7);
}

#[test]
fn retry_returns_the_response_after_an_interrupted_week() {
    let place = temporary_runs_folder();
    let mut session = create_run(place.path(), 7, 28);
    let folder = session.folder().expect("a folder").to_owned();
    advance_week(&mut session, "on", Value::Null, "w0").expect("a week");
    let first = advance_week(&mut session, "on", Value::Null, "w1").expect("a week");
    session.save().expect("it is saved");
    drop(session);
    // The program is killed directly after it wrote the line of the request.
    let path = folder.join("trajectory.jsonl");
    let text = fs::read_to_string(&path).expect("a trajectory");
    let at = text.match_indices("\"kind\":\"advance\"").nth(1).expect("a second week").0;
    let end = at + text[at..].find('\n').expect("its end") + 1;
    fs::write(&path, &text[..end]).expect("a file");
    for derived in ["snapshot.bin", "world.db"] {
        fs::remove_file(folder.join(derived)).expect("it was there");
    }
    let mut session = open_run(&folder);
    assert_eq!(session.day(), 14);
    assert_eq!(advance_week(&mut session, "on", Value::Null, "w1"), Ok(first));
    assert_eq!((session.day(), count_lines(&folder, "advance"), count_lines(&folder, "week")), (14, 2, 2));
    drop(session);
    verify(&folder).expect("it verifies");
}

#[test]
fn branch_keeps_request_ids_of_shared_lines() {
    let place = temporary_runs_folder();
    let mut session = create_run(place.path(), 7, 28);
    let first = call(&mut session, "set_prices", json!({ "A": 12 }), "p").expect("a price");
    let passed = advance_week(&mut session, "on", Value::Null, "w0").expect("a week");
    call(&mut session, "set_prices", json!({ "A": 14 }), "q").expect("a price");
    let mut branch = session.branch(2, Mode::Sandbox).expect("a branch");
    assert_eq!(call(&mut branch, "set_prices", json!({ "A": 12 }), "p"), Ok(first));
    assert_eq!(advance_week(&mut branch, "on", Value::Null, "w0"), Ok(passed));
    // The record of the branch does not contain later decisions of the parent run.
    assert_eq!(branch.company().current_arguments("set_prices")["A"], 12.0);
    call(&mut branch, "set_prices", json!({ "A": 15 }), "q").expect("a new request");
    assert_eq!(branch.company().current_arguments("set_prices")["A"], 15.0);
}

#[test]
fn undo_does_not_release_a_request_id() {
    let place = temporary_runs_folder();
    let mut session = create_run(place.path(), 7, 28);
    call(&mut session, "set_prices", json!({ "A": 12 }), "o").expect("a price");
    let first = call(&mut session, "set_prices", json!({ "A": 14 }), "p").expect("a price");
    session.undo(Via::Plain).expect("it is taken back");
    assert_eq!(call(&mut session, "set_prices", json!({ "A": 14 }), "p"), Ok(first));
    assert_eq!(session.company().current_arguments("set_prices")["A"], 12.0);
}

#[test]
fn records_without_request_ids_are_unchanged() {
    let place = temporary_runs_folder();
    let mut session = create_run(place.path(), 7, 28);
    session.call_once("set_prices", &json!({ "A": 12 }), Via::Http, &Value::Null).expect("a price");
    advance_week(&mut session, "naive", Value::Null, "w").expect("a week");
    let path = session.folder().expect("a folder").join("trajectory.jsonl");
    let text = fs::read_to_string(path).expect("a trajectory");
    let with: Vec<&str> = text.lines().filter(|line| line.contains("request_")).collect();
    assert!(with.len() == 1 && with[0].contains("\"kind\":\"advance\""), "{with:?}");
}

#[test]
fn names_of_unknown_tools_are_truncated_in_the_record() {
    let place = temporary_runs_folder();
    let mut session = create_run(place.path(), 7, 28);
    let folder = session.folder().expect("a folder").to_owned();
    let long = "x".repeat(10_000_000);
    for name in ["", "get_customer_feedback", long.as_str()] {
        let args = json!({ "group": "S1", "sent": [1, null] });
        let refusal = session.call(name, &args, Via::Mcp).expect_err("no tool");
        assert_eq!((refusal.code, refusal.field.as_deref()), ("unknown_tool", Some("tool")));
        assert!(refusal.message.len() < 1000 && !refusal.message.contains("tool  "), "{}", refusal.message);
    }
    drop(session);
    let lines = Trajectory::read(&folder.join("trajectory.jsonl")).expect("it reads").lines;
    let calls: Vec<_> = lines
        .iter()
        .filter_map(|line| match &line.record {
            Record::Call(call) => Some(call),
            _ => None,
        })
        .collect();
    let names: Vec<usize> = calls.iter().map(|call| call.tool.name().chars().count()).collect();
    assert_eq!(names, [0, 21, 128]);
    assert!(calls.iter().all(|call| call.tool.tool_id().is_none() && call.args["sent"] == json!([1, null])));
    verify(&folder).expect("it verifies");
}
