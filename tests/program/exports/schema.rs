//! The JSON Schema of trajectories, compared with lines of every kind from real runs.

use std::collections::BTreeSet;
use std::path::Path;

use novamind::record::folder::configuration::Configuration;
use novamind::record::mode::Mode;
use novamind::record::trajectory::record::Via;
use novamind::session::{NewRun, Session, Storage, WeekRequest};
use serde_json::{Map, Value, json};
use time::OffsetDateTime;
use time::format_description::well_known::Rfc3339;

use crate::support::home::Home;

fn schema() -> Value {
    serde_json::from_str(include_str!("../../../assets/trajectory.schema.json")).expect("the schema is JSON")
}

/// Resolves a reference and returns the referenced part of the schema.
fn resolve<'a>(root: &'a Value, part: &'a Value) -> &'a Value {
    match part.get("$ref").and_then(Value::as_str) {
        Some(reference) => {
            let target = reference.strip_prefix('#').and_then(|pointer| root.pointer(pointer));
            resolve(root, target.unwrap_or_else(|| panic!("{reference} leads nowhere")))
        }
        None => part,
    }
}

/// Validates a value against a part of the schema. Supports exactly the keywords that the schema uses.
fn validate(root: &Value, part: &Value, value: &Value, place: &str, found: &mut Vec<String>) {
    let rules = resolve(root, part).as_object().expect("a schema is an object");
    let mut wrong = |what: String| found.push(format!("{place}: {what}"));
    let number = |rule: &Value| rule.as_f64().expect("a number");
    let mut inner: Vec<(Value, Value, String)> = Vec::new();
    for (keyword, rule) in rules {
        let ok = match keyword.as_str() {
            "title" | "description" | "examples" | "$schema" | "$defs" => true,
            "type" => allowed_types(rule).iter().any(|name| has_type(value, name)),
            "const" => value == rule,
            "enum" => rule.as_array().expect("values").contains(value),
            "minimum" => value.as_f64().is_none_or(|actual| actual >= number(rule)),
            "exclusiveMinimum" => value.as_f64().is_none_or(|actual| actual > number(rule)),
            "minItems" => value.as_array().is_none_or(|list| list.len() as f64 >= number(rule)),
            "maxItems" => value.as_array().is_none_or(|list| list.len() as f64 <= number(rule)),
            "pattern" => {
                value.as_str().is_none_or(|text| is_hexadecimal(text, rule.as_str().expect("a pattern")))
            }
            "format" => value.as_str().is_none_or(|text| OffsetDateTime::parse(text, &Rfc3339).is_ok()),
            "required" => strings_in_array(rule).iter().all(|name| value.get(name).is_some()),
            "properties" => {
                for (name, property) in rule.as_object().expect("properties") {
                    inner.extend(
                        value
                            .get(name)
                            .map(|value| (property.clone(), value.clone(), format!("{place}.{name}"))),
                    );
                }
                true
            }
            "additionalProperties" => {
                let known = rules.get("properties").and_then(Value::as_object);
                let others = value.as_object().into_iter().flatten();
                let others = others.filter(|(name, _)| known.is_none_or(|known| !known.contains_key(*name)));
                inner.extend(
                    others.map(|(name, member)| (rule.clone(), member.clone(), format!("{place}.{name}"))),
                );
                true
            }
            "items" => {
                let all = value.as_array().into_iter().flatten().enumerate();
                inner.extend(all.map(|(at, item)| (rule.clone(), item.clone(), format!("{place}[{at}]"))));
                true
            }
            "oneOf" => {
                let fits = rule.as_array().expect("choices").iter().filter(|choice| {
                    let mut against = Vec::new();
                    validate(root, choice, value, place, &mut against);
                    against.is_empty()
                });
                fits.count() == 1
            }
            other => panic!("the schema uses the keyword {other}, which this test does not know"),
        };
        if !ok {
            wrong(format!("{value} against {keyword} {rule}"));
        }
    }
    for (part, value, place) in inner {
        validate(root, &part, &value, &place, found);
    }
}

fn strings_in_array(rule: &Value) -> Vec<&str> {
    rule.as_array().into_iter().flatten().filter_map(Value::as_str).collect()
}

fn allowed_types(rule: &Value) -> Vec<&str> {
    rule.as_str().map_or_else(|| strings_in_array(rule), |one| vec![one])
}

fn has_type(value: &Value, name: &str) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        other => panic!("no type {other}"),
    }
}

/// Checks a text against a pattern of the schema. Every pattern requires a fixed number of hexadecimal digits.
fn is_hexadecimal(text: &str, pattern: &str) -> bool {
    let count = pattern.strip_prefix("^[0-9a-f]{").and_then(|rest| rest.strip_suffix("}$"));
    let count: usize =
        count.and_then(|count| count.parse().ok()).unwrap_or_else(|| panic!("pattern {pattern}"));
    text.len() == count && text.bytes().all(|digit| matches!(digit, b'0'..=b'9' | b'a'..=b'f'))
}

/// Returns the problems of a line. The line is checked against the schema of its kind, so that problems name the field.
fn line_problems(root: &Value, line: &Value) -> Vec<String> {
    let kind = line["kind"].as_str().unwrap_or_default();
    let Some(part) = root.pointer(&format!("/$defs/{kind}")) else { return vec![format!("no kind {kind}")] };
    let mut found = Vec::new();
    validate(root, part, line, kind, &mut found);
    if found.is_empty() {
        // The complete schema must give the same result.
        validate(root, root, line, "line", &mut found);
    }
    found
}

fn line_kinds(root: &Value) -> BTreeSet<String> {
    let references = root["oneOf"].as_array().expect("kinds").iter();
    references.map(|value| value["$ref"].as_str().expect("a reference").replace("#/$defs/", "")).collect()
}

/// Checks that the examples of a document are valid lines and include every kind.
pub fn check_examples(examples: &[Value]) {
    let root = schema();
    for example in examples {
        assert_eq!(line_problems(&root, example), Vec::<String>::new());
    }
    let shown: BTreeSet<String> =
        examples.iter().filter_map(|line| line["kind"].as_str()).map(str::to_owned).collect();
    assert_eq!(shown, line_kinds(&root));
}

fn trajectory_lines(folder: &Path) -> Vec<Value> {
    let text = std::fs::read_to_string(folder.join("trajectory.jsonl")).expect("a trajectory");
    text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
}

/// Records every kind of user activity except decisions, as in the examples of the schema.
fn record_every_activity(run: &mut Session) {
    use novamind::record::trajectory::record::*;
    let root = schema();
    let example = |kind: &str| root.pointer(&format!("/$defs/{kind}/examples/0")).expect(kind).clone();
    fn activity_from<T: serde::de::DeserializeOwned>(example: Value) -> T {
        serde_json::from_value(example).expect("an example")
    }
    run.activity().attach(novamind::session::Interface { name: "console", window: Some((120, 40)) });
    run.activity().record_presence(PresenceEvent::Idle, Some(90_000), None);
    run.activity().detach(DetachCause::Quit);
    run.activity().record(Activity::Clock(activity_from(example("clock"))));
    run.activity().record(Activity::Limit(activity_from(example("limit"))));
    run.activity().record(Activity::View(activity_from(example("view"))));
    run.activity().record(Activity::Select(activity_from(example("select"))));
    run.activity().record(Activity::Dialog(activity_from(example("dialog"))));
    run.activity().record(Activity::Help(activity_from(example("help"))));
    run.activity().record(Activity::Draft(activity_from(example("draft"))));
    run.activity().record(Activity::Question(activity_from(example("question"))));
    run.activity().record(Activity::Answer(activity_from(example("answer"))));
    run.activity().record(Activity::Lesson(activity_from(example("lesson"))));
    run.activity().record(Activity::ExternalRead(activity_from(example("look"))));
    run.activity().record(Activity::Inspection(activity_from(example("xray"))));
}

/// Returns lines of every kind.
fn all_kinds_of_lines(runs: &Path) -> Vec<Value> {
    let new = NewRun {
        days: Some(35),
        mode: Mode::Debug,
        participant: Some("P01".to_owned()),
        overrides: vec![("competitor.competitor_feedback_u_max".to_owned(), "0.5".to_owned())],
        storage: Storage::Runs(runs.to_owned()),
        ..NewRun::default()
    };
    let mut run = Session::create(new, &Configuration::bundled()).expect("a run");
    run.call("set_prices", &json!({"A": 12, "B": 25, "C": 55}), Via::Form).expect("prices");
    run.call("set_prices", &json!({"A": 14}), Via::Palette).expect("a price");
    run.undo(Via::Plain).expect("it is reverted");
    run.call("set_prices", &json!({"A": 0}), Via::Http).expect_err("no price");
    run.call("research_market", &json!({}), Via::Policy).expect("research");
    run.query("SELECT count(*) FROM ledger").expect("a count");
    run.query("SELECT 1 FROM nowhere").expect_err("no table");
    record_every_activity(&mut run);
    run.set_notes("größer").expect("a memo");
    let calculation = json!({"name": "cash now", "code": "SELECT sum(amount) FROM ledger"});
    run.call("register_daily_calculation", &calculation, Via::Script).expect("a calculation");
    run.advance_with_json(&json!(""), &json!({}), [false; 4], Via::Form, &mut |_| {})
        .expect_err("no rationale");
    run.call("set_wages", &json!({"A": 1}), Via::Mcp).expect_err("no tool");
    run.call_once("set_prices", &json!({"A": 15}), Via::Http, &json!("a")).expect("a price");
    let week = WeekRequest {
        rationale: &json!("wait"),
        predictions: &run.company().naive_forecasts().to_predictions(),
        expected_day: &json!(0),
        id: &json!("b"),
    };
    run.advance_once(&week, Via::Http).expect("a week");
    let forecasts = run.company().naive_forecasts();
    run.advance("wait", &forecasts, Via::Form, &mut |_| {}).expect("a week");
    run.step(2, &mut |_| {}).expect("two days");
    let mut branch = run.branch(2, Mode::Sandbox).expect("a branch");
    while branch.ended().is_none() {
        let forecasts = branch.company().naive_forecasts();
        branch.advance("on", &forecasts, Via::Form, &mut |_| {}).expect("a week");
    }
    run.abandon().expect("it is given up");
    let folders = [run.folder(), branch.folder()].map(|folder| folder.expect("a folder").to_owned());
    folders.iter().flat_map(|folder| trajectory_lines(folder)).collect()
}

#[test]
fn recorded_lines_match_the_schema() {
    let (root, runs) = (schema(), tempfile::tempdir().expect("a folder"));
    let lines = all_kinds_of_lines(runs.path());
    for line in &lines {
        assert_eq!(line_problems(&root, line), Vec::<String>::new());
        // New fields of the format must be documented.
        let kind = line["kind"].as_str().expect("a kind");
        let known =
            root.pointer(&format!("/$defs/{kind}/properties")).and_then(Value::as_object).expect("fields");
        for field in line.as_object().expect("an object").keys() {
            assert!(known.contains_key(field), "{kind}.{field} is not in the schema");
        }
    }
    let written: BTreeSet<String> =
        lines.iter().map(|line| line["kind"].as_str().expect("a kind").to_owned()).collect();
    let mut missing = line_kinds(&root);
    missing.retain(|kind| !written.contains(kind));
    assert_eq!(
        missing.into_iter().collect::<Vec<_>>(),
        ["memo", "override", "voice"],
        "all others are written"
    );
    assert!(lines.iter().any(|line| line.get("calculations").is_some() && line["kind"] == "advance"));
    assert!(lines.iter().any(|line| line.get("undoes").is_some()));
    for kind in ["call", "advance"] {
        assert!(lines.iter().any(|line| line["kind"] == kind && line.get("request_id").is_some()), "{kind}");
    }
    assert!(
        lines.iter().any(|line| line["tool"] == "set_wages" && line["refusal"]["code"] == "unknown_tool")
    );
}

#[test]
fn schema_has_examples_of_all_kinds_and_fields() {
    let root = schema();
    for kind in line_kinds(&root) {
        let value = root.pointer(&format!("/$defs/{kind}")).expect("a kind");
        assert!(value["description"].as_str().is_some_and(|text| text.len() > 15), "{kind}");
        for (name, field) in value["properties"].as_object().expect("fields") {
            let explained = resolve(&root, field).get("description").or(field.get("description")).is_some();
            assert!(explained || field.get("const").is_some(), "{kind}.{name}");
        }
        let examples = value["examples"].as_array().expect("examples");
        assert!(!examples.is_empty());
        for example in examples {
            assert_eq!(line_problems(&root, example), Vec::<String>::new());
        }
    }
}

#[test]
fn invalid_lines_violate_the_schema() {
    let root = schema();
    for kind in line_kinds(&root) {
        let value = root.pointer(&format!("/$defs/{kind}")).expect("a kind");
        let example: Map<String, Value> = value["examples"][0].as_object().expect("an example").clone();
        for name in strings_in_array(&value["required"]) {
            let mut without = example.clone();
            without.remove(name);
            assert!(!line_problems(&root, &without.into()).is_empty(), "{kind} without {name}");
            if value["properties"][name].get("type").is_some()
                || value["properties"][name].get("$ref").is_some()
            {
                let mut twisted = example.clone();
                twisted.insert(name.to_owned(), json!([["no such thing"]]));
                assert!(!line_problems(&root, &twisted.into()).is_empty(), "{kind} with a strange {name}");
            }
        }
    }
    assert!(!line_problems(&root, &json!({"kind": "wish"})).is_empty());
}

#[test]
fn runs_schema_prints_the_schema() {
    let program_output = Home::new().run(&["runs", "schema"]);
    assert_eq!(serde_json::from_str::<Value>(&program_output.stdout).expect("JSON"), schema());
}
