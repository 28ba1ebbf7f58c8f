//! An evaluation log of Inspect, version 2: one sample, whose messages are the steps of the run.

use serde_json::{Value, json};

use super::atif::atif;
use super::{Surroundings, Transcript};

const VERSION: u32 = 2;
const SCORER: &str = "cash";

/// The run in this format.
pub fn inspect(run: &Transcript, told: &Surroundings) -> Value {
    let steps = atif(run, told);
    let steps = steps["steps"].as_array().map(Vec::as_slice).unwrap_or_default();
    let messages: Vec<Value> = steps.iter().flat_map(messages).collect();
    let (created, ended) =
        (&run.manifest.created, run.acts.last().map_or(&run.manifest.created, |act| &act.at));
    let score = json!({ "value": run.last.1, "explanation": format!("cash on day {}", run.last.0) });
    let mut spec = json!({
        "created": created,
        "task": "novamind",
        "task_version": 1,
        "task_id": run.manifest.id,
        "run_id": run.manifest.id,
        "eval_id": run.manifest.id,
        "task_args": { "seed": run.manifest.seed, "scenario": run.manifest.scenario, "days": run.manifest.days },
        "dataset": { "name": run.manifest.scenario, "samples": 1, "sample_ids": [run.manifest.id], "shuffled": false },
        "model": format!("novamind/{}", run.player()),
        "config": { "epochs": 1 },
        "packages": { "novamind": run.manifest.version },
    });
    spec["metadata"] = run.facts().into();
    json!({
        "version": VERSION,
        "status": if run.end.is_some() { "success" } else { "started" },
        "eval": spec,
        "plan": { "name": "plan", "steps": [], "config": {} },
        "results": {
            "total_samples": 1,
            "completed_samples": usize::from(run.end.is_some()),
            "scores": [{
                "name": SCORER,
                "scorer": SCORER,
                "scored_samples": 1,
                "params": {},
                "metrics": { "value": { "name": "value", "value": run.last.1, "params": {} } },
            }],
        },
        "stats": { "started_at": created, "completed_at": ended, "model_usage": {} },
        "samples": [{
            "id": run.manifest.id,
            "epoch": 1,
            "input": told.page,
            "target": "",
            "messages": messages,
            "output": { "model": format!("novamind/{}", run.player()), "choices": [] },
            "scores": { SCORER: score },
            "metadata": { "asides": run.asides },
            "store": {},
            "events": [],
            "model_usage": {},
            "attachments": {},
        }],
    })
}

/// A step as messages: what was said or called, and what came back.
fn messages(step: &Value) -> Vec<Value> {
    let role = match step["source"].as_str() {
        Some("agent") => "assistant",
        Some(other) => other,
        None => "user",
    };
    let id = format!("step-{}", step["step_id"]);
    let mut said = json!({ "id": id, "role": role, "content": step["message"] });
    if let Some(extra) = step.get("extra") {
        said["metadata"] = extra.clone();
    }
    let Some(call) = step["tool_calls"].as_array().and_then(|calls| calls.first()) else { return vec![said] };
    said["source"] = "generate".into();
    said["tool_calls"] = json!([{
        "id": call["tool_call_id"],
        "function": call["function_name"],
        "arguments": call["arguments"],
        "type": "function",
    }]);
    let came_back = json!({
        "id": format!("{id}-answer"),
        "role": "tool",
        "content": step["observation"]["results"][0]["content"],
        "tool_call_id": call["tool_call_id"],
        "function": call["function_name"],
    });
    vec![said, came_back]
}
