//! Export to the Agent Trajectory Interchange Format, version 1.8, with one step per action.

use serde_json::{Map, Value, json};

use super::{AgentContext, Transcript, TranscriptAction, TranscriptStep, WeekResult, forecasts_as_json};

const VERSION: &str = "ATIF-v1.8";

/// Returns the run in the Agent Trajectory Interchange Format.
pub fn to_atif(run: &Transcript, agent_context: &AgentContext) -> Value {
    let mut steps = vec![
        json!({ "source": "system", "message": agent_context.instructions }),
        json!({ "source": "user", "message": run.opening_dashboard }),
    ];
    steps.extend(run.steps.iter().filter_map(step_json));
    for (at, step) in steps.iter_mut().enumerate() {
        step["step_id"] = json!(at + 1);
    }
    let total = steps.len();
    let version = run.manifest.version.clone();
    let mut agent = json!({ "name": run.player_name(), "version": version });
    if !agent_context.tools.is_empty() {
        agent["tool_definitions"] = json!(agent_context.tools);
    }
    json!({
        "schema_version": VERSION,
        "session_id": run.manifest.id,
        "agent": agent,
        "steps": steps,
        "final_metrics": { "total_steps": total, "extra": run.run_facts() },
        "extra": { "asides": run.other_lines },
    })
}

/// Returns the step of an action, or `None` if no interface for programs offers the action.
fn step_json(act: &TranscriptStep) -> Option<Value> {
    let id = format!("line-{}", act.seq);
    let called = |name: &str, args: &Value, content: String, extra: &Map<String, Value>| {
        json!({
            "source": "agent",
            "message": "",
            "tool_calls": [{ "tool_call_id": id, "function_name": name, "arguments": as_object(args), "extra": extra }],
            "observation": { "results": [{ "source_call_id": id, "content": content }] },
        })
    };
    let mut step = match &act.action {
        TranscriptAction::Call { tool, args, answer, extra } => {
            let value = match answer {
                Ok(data) => json!({ "success": true, "data": data }),
                Err(rejection) => json!({
                    "success": false,
                    "error": rejection.message,
                    "code": rejection.code,
                    "field": rejection.field,
                }),
            };
            called(tool.name(), args, value.to_string(), extra)
        }
        TranscriptAction::Query { sql, answer, extra } => {
            let output = match answer {
                Ok(rows) => rows.clone(),
                Err((code, message)) => json!({ "success": false, "error": message, "code": code }),
            };
            called("query", &json!({ "sql": sql }), output.to_string(), extra)
        }
        TranscriptAction::Note(text) => json!({
            "source": "agent",
            "message": text.clone().unwrap_or_default(),
            "extra": { "kind": "note", "text_is_recorded": text.is_some() },
        }),
        TranscriptAction::Week { rationale, forecasts, result: passed } => {
            let args = json!({ "rationale": rationale, "predictions": forecasts_as_json(forecasts) });
            let filled: Vec<u32> = forecasts
                .iter()
                .filter(|filed_forecast| filed_forecast.filled_naively)
                .map(|forecast| forecast.horizon_days)
                .collect();
            let extra = Map::from_iter([("naive_horizons_days".to_owned(), json!(filled))]);
            let mut step = called("next_week", &args, describe_week(passed.as_ref()), &extra);
            step["message"] = rationale.clone().into();
            step
        }
        TranscriptAction::Debugging(_) => return None,
    };
    step["timestamp"] = act.at.clone().into();
    let day = json!(act.day);
    match step.get_mut("extra").and_then(Value::as_object_mut) {
        Some(extra) => {
            extra.insert("day".to_owned(), day);
        }
        None => step["extra"] = json!({ "day": day }),
    }
    Some(step)
}

fn describe_week(passed: Option<&WeekResult>) -> String {
    match passed {
        Some(week) => json!({ "day": week.day, "cash": week.cash, "dashboard": week.dashboard }).to_string(),
        None => "the week did not end".to_owned(),
    }
}

/// Wraps arguments that are not an object, because the format requires an object even for rejected calls.
fn as_object(args: &Value) -> Value {
    match args {
        Value::Object(_) => args.clone(),
        other => json!({ "sent": other }),
    }
}
