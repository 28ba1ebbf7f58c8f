//! Export to an evaluation log of Inspect, version 2. The log has one sample, whose messages are the steps of the run.

use serde_json::{Value, json};
use time::OffsetDateTime;
use time::format_description::well_known::Rfc3339;

use super::atif::to_atif;
use super::{AgentContext, Transcript};
use novamind_base::formatting::dollars;
use novamind_record::folder::manifest::Manifest;
use novamind_record::trajectory::record::RunEndReason;

const VERSION: u32 = 2;
const TASK: &str = "novamind";
const SCORER: &str = "cash";

/// Returns the file name of a run's log in the naming scheme of Inspect, because Inspect does not list JSON logs with
/// other names.
pub fn inspect_file_name(manifest: &Manifest) -> String {
    // Start time in UTC, without fractional seconds.
    let created = manifest.created.get(..19).unwrap_or(&manifest.created).replace(':', "-");
    format!("{created}-00-00_{TASK}_{}.json", manifest.id)
}

/// Returns the run as an evaluation log of Inspect.
pub fn to_inspect(run: &Transcript, agent_context: &AgentContext) -> Value {
    let steps = to_atif(run, agent_context);
    let steps = steps["steps"].as_array().map(Vec::as_slice).unwrap_or_default();
    let steps: Vec<MessageStep> =
        steps.iter().map(|step| MessageStep::from_json(step, &run.manifest)).collect();
    let messages: Vec<&Value> = steps.iter().flat_map(MessageStep::messages).collect();
    let (created, ended) =
        (&run.manifest.created, run.steps.last().map_or(&run.manifest.created, |act| &act.at));
    let score = sample_score(run);
    let model = format!("novamind/{}", run.player_name());
    let mut spec = json!({
        "created": created,
        "task": TASK,
        "task_version": 1,
        "task_id": run.manifest.id,
        "run_id": run.manifest.id,
        "eval_id": run.manifest.id,
        "task_args": { "seed": run.manifest.seed, "scenario": run.manifest.scenario, "days": run.manifest.days },
        "dataset": { "name": run.manifest.scenario, "samples": 1, "sample_ids": [run.manifest.id], "shuffled": false },
        "model": model,
        "config": { "epochs": 1 },
        "packages": { "novamind": run.manifest.version },
    });
    spec["metadata"] = run.run_facts().into();
    json!({
        "version": VERSION,
        "status": run_status(run),
        "eval": spec,
        "plan": { "name": "plan", "steps": [], "config": {} },
        "results": {
            "total_samples": 1,
            "completed_samples": usize::from(run.end.is_some()),
            "scores": score.iter().map(score_to_json).collect::<Vec<Value>>(),
        },
        "stats": { "started_at": created, "completed_at": ended, "model_usage": {} },
        "samples": [{
            "id": run.manifest.id,
            "uuid": run.manifest.id,
            "epoch": 1,
            "input": agent_context.instructions,
            "target": "",
            "messages": messages,
            "output": { "model": model, "choices": [] },
            "scores": score.map_or_else(|| json!({}), |score| json!({ SCORER: score })),
            "metadata": { "asides": run.other_lines },
            "store": {},
            "events": step_events(&steps, &run.manifest.created, &model),
            "model_usage": {},
            "attachments": {},
        }],
    })
}

fn run_status(run: &Transcript) -> &'static str {
    match run.end.as_ref().map(|end| end.reason) {
        None => "started",
        Some(RunEndReason::Abandoned) => "cancelled",
        Some(_) => "success",
    }
}

/// Returns the score of the sample, or `None` if the run has no score: it is unfinished, abandoned or part of a lesson.
fn sample_score(run: &Transcript) -> Option<Value> {
    let end = run.end.as_ref()?;
    let explanation = match end.reason {
        RunEndReason::Bankruptcy => {
            format!("bankrupt on day {} with cash of {}", run.last_day_and_cash.0, dollars(end.cash))
        }
        _ => format!("cash on day {}", run.last_day_and_cash.0),
    };
    Some(json!({ "value": end.score?, "explanation": explanation }))
}

fn score_to_json(score: &Value) -> Value {
    json!({
        "name": SCORER,
        "scorer": SCORER,
        "scored_samples": 1,
        "params": {},
        "metrics": { "value": { "name": "value", "value": score["value"], "params": {} } },
    })
}

struct MessageStep {
    at: Option<String>,
    message: Value,
    answer: Option<Value>,
}

impl MessageStep {
    /// Converts a step of an exported trajectory to messages. Message IDs are unique across runs, because Inspect drops
    /// duplicates from its tables.
    fn from_json(step: &Value, manifest: &Manifest) -> MessageStep {
        let role = match step["source"].as_str() {
            Some("agent") => "assistant",
            Some(other) => other,
            None => "user",
        };
        let id = format!("{}-step-{}", manifest.id, step["step_id"]);
        let mut message = json!({ "id": id, "role": role, "content": step["message"] });
        if let Some(extra) = step.get("extra") {
            message["metadata"] = extra.clone();
        }
        let at = step["timestamp"].as_str().map(str::to_owned);
        let Some(call) = step["tool_calls"].as_array().and_then(|calls| calls.first()) else {
            return MessageStep { at, message, answer: None };
        };
        message["source"] = "generate".into();
        message["tool_calls"] = json!([{
            "id": call["tool_call_id"],
            "function": call["function_name"],
            "arguments": call["arguments"],
            "type": "function",
        }]);
        let answer = json!({
            "id": format!("{id}-answer"),
            "role": "tool",
            "content": step["observation"]["results"][0]["content"],
            "tool_call_id": call["tool_call_id"],
            "function": call["function_name"],
        });
        MessageStep { at, message, answer: Some(answer) }
    }

    fn messages(&self) -> impl Iterator<Item = &Value> {
        std::iter::once(&self.message).chain(&self.answer)
    }
}

/// Returns the steps as events. Inspect builds its message tables from these events. Each step of the player becomes a
/// model event that contains the messages since the previous step, and each call becomes a tool event. The last model
/// event has no output, and its input is the last result.
fn step_events(steps: &[MessageStep], created: &str, model: &str) -> Vec<Value> {
    let mut events = Vec::new();
    let (mut input, mut at) = (Vec::new(), created);
    let model_event = |input: &[&Value], at: &str, choices: Value| {
        json!({
            "event": "model",
            "timestamp": at,
            "working_start": seconds_between(created, at),
            "model": model,
            "input": input,
            "tools": [],
            "tool_choice": "auto",
            "config": {},
            "output": { "model": model, "choices": choices },
        })
    };
    for step in steps {
        at = step.at.as_deref().unwrap_or(at);
        if step.message["role"] != "assistant" {
            input.push(&step.message);
            continue;
        }
        let stop_reason = if step.answer.is_some() { "tool_calls" } else { "stop" };
        events.push(model_event(
            &input,
            at,
            json!([{ "message": step.message, "stop_reason": stop_reason }]),
        ));
        input.clear();
        if let Some(answer) = &step.answer {
            let call = &step.message["tool_calls"][0];
            events.push(json!({
                "event": "tool",
                "timestamp": at,
                "working_start": seconds_between(created, at),
                "id": call["id"],
                "function": call["function"],
                "arguments": call["arguments"],
                "result": answer["content"],
                "message_id": answer["id"],
                "events": [],
            }));
            input.push(answer);
        }
    }
    events.push(model_event(&input, at, json!([])));
    events
}

/// Returns the number of seconds between two times, or 0 if one of the times cannot be parsed.
fn seconds_between(from: &str, to: &str) -> f64 {
    let moment = |text: &str| OffsetDateTime::parse(text, &Rfc3339).ok();
    moment(to).zip(moment(from)).map_or(0.0, |(to, from)| (to - from).as_seconds_f64())
}
