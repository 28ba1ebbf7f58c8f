//! Reads tool calls from an evaluation log of Inspect, in JSON or in Inspect's `.eval` archive.

use serde_json::Value;

use super::transcript::{ForeignCall, ForeignTranscript, tool_name};
use super::zip::ZipArchive;

/// Instruction for converting an unsupported log.
const CONVERT_HELP: &str =
    "`inspect log convert --to json --output-dir FOLDER LOG` converts the log to JSON, which can be imported";

/// Reads the tool calls in an `.eval` archive.
///
/// # Errors
/// The archive is damaged, or does not contain exactly one sample that calls tools of this program.
pub(super) fn parse_archive(bytes: &[u8], limit: u64) -> Result<ForeignTranscript, String> {
    let archive =
        ZipArchive::open(bytes).ok_or("the archive has no readable directory; it may be truncated")?;
    let json = |name: &str| -> Result<Value, String> {
        let read = archive.read(name, limit).map_err(|problem| format!("{problem}; {CONVERT_HELP}"))?;
        serde_json::from_slice(&read)
            .map_err(|error| format!("{name} in the archive is not valid JSON ({error})"))
    };
    // An unfinished log has no header yet.
    let header =
        if archive.names().any(|name| name == "header.json") { "header.json" } else { "_journal/start.json" };
    let header = json(header)?;
    let mut names: Vec<&str> =
        archive.names().filter(|name| name.starts_with("samples/") && name.ends_with(".json")).collect();
    names.sort_unstable();
    names.dedup();
    let samples: Vec<Value> = names.into_iter().map(json).collect::<Result<_, _>>()?;
    parse_log(&header, &samples)
}

/// Reads the tool calls in a JSON log.
///
/// # Errors
/// The log does not contain exactly one sample that calls tools of this program.
pub(super) fn parse_json(log: &Value) -> Result<ForeignTranscript, String> {
    parse_log(log, log["samples"].as_array().map_or(&[], Vec::as_slice))
}

fn parse_log(header: &Value, samples: &[Value]) -> Result<ForeignTranscript, String> {
    let calls: Vec<(&Value, Vec<ForeignCall>)> =
        samples.iter().map(|sample| (sample, tool_calls(sample))).collect();
    let calls: Vec<_> = calls.into_iter().filter(|(_, calls)| !calls.is_empty()).collect();
    if calls.len() > 1 {
        let name = |sample: &Value| format!("{} (epoch {})", text_content(&sample["id"]), sample["epoch"]);
        let names: Vec<String> = calls.iter().map(|(sample, _)| name(sample)).collect();
        return Err(format!(
            "the log has {} samples that call tools of this program: {}. Import a log with one sample",
            names.len(),
            names.join(", ")
        ));
    }
    let (spec, arguments) = (&header["eval"]["metadata"], &header["eval"]["task_args"]);
    let world = |key: &str| if spec[key].is_null() { &arguments[key] } else { &spec[key] };
    Ok(ForeignTranscript {
        player: header["eval"]["model"].as_str().map(|name| name.trim_start_matches("novamind/").to_owned()),
        seed: world("seed").as_u64(),
        scenario: world("scenario").as_str().map(str::to_owned),
        days: world("total_days")
            .as_u64()
            .or(world("days").as_u64())
            .and_then(|days| u32::try_from(days).ok()),
        cash: world("starting_cash").as_f64(),
        state_hash: world("state_hash").as_str().filter(|hash| !hash.is_empty()).map(str::to_owned),
        calls: calls.into_iter().next().map(|(_, calls)| calls).unwrap_or_default(),
    })
}

/// Returns the tool calls in the messages of a sample, in order.
fn tool_calls(sample: &Value) -> Vec<ForeignCall> {
    let messages = sample["messages"].as_array().map_or(&[][..], Vec::as_slice);
    let mut found = Vec::new();
    for (at, message) in messages.iter().enumerate() {
        for call in message["tool_calls"].as_array().map_or(&[][..], Vec::as_slice) {
            let Some(tool) = call["function"].as_str().and_then(tool_name) else { continue };
            let arguments = call["arguments"].as_object().cloned().unwrap_or_default();
            let accepted = is_accepted(&messages[at + 1..], &call["id"]);
            found.push(ForeignCall { position: at + 1, tool: tool.to_owned(), arguments, accepted });
        }
    }
    found
}

/// Returns whether the response to a tool call reports acceptance. Returns `None` if the response is missing or
/// unclear.
fn is_accepted(after: &[Value], id: &Value) -> Option<bool> {
    let answer = after.iter().find(|message| message["role"] == "tool" && message["tool_call_id"] == *id)?;
    if !answer["error"].is_null() {
        return Some(false);
    }
    let content = match &answer["content"] {
        Value::Array(parts) => parts.iter().map(|part| text_content(&part["text"])).collect(),
        content => text_content(content),
    };
    super::transcript::is_acceptance(&content)
}

fn text_content(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}
