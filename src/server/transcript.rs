//! Imports an external transcript and plays it call by call (docs/formats/exports.md#importing-a-transcript).

use serde_json::{Map, Value};

use super::inspect_log;
use super::request::ApiRequest;
use super::request_handler::handle_request;
use super::zip::ZipArchive;
use novamind_record::trajectory::record::Via;
use novamind_session::{PYTHON_DISABLED_MESSAGE, Session};
use novamind_tools::{ToolId, find};

/// Maximum size of a file in an archive, in bytes. A transcript of 500 days has a few megabytes.
const MAX_FILE_BYTES: u64 = 512 << 20;

/// The calls of this program's tools in an external transcript, with the settings of the run.
#[derive(Debug, Clone, PartialEq)]
pub struct ForeignTranscript {
    /// Name of the player; `None` if the transcript does not contain it.
    pub player: Option<String>,
    /// Seed of the run; `None` if the transcript does not contain it.
    pub seed: Option<u64>,
    /// Name of the scenario; `None` if the transcript does not contain it.
    pub scenario: Option<String>,
    /// Last day of the run; `None` if the transcript does not contain it.
    pub days: Option<u32>,
    /// Cash on day 0 in dollars; `None` if the transcript does not contain it.
    pub cash: Option<f64>,
    /// Hash of the final state; `None` if the transcript does not contain it.
    pub state_hash: Option<String>,
    /// Tool calls in the order of the transcript.
    pub calls: Vec<ForeignCall>,
}

/// A tool call in a transcript.
#[derive(Debug, Clone, PartialEq)]
pub struct ForeignCall {
    /// Number of the step or line that contains the call, counted from 1.
    pub position: usize,
    /// Name of the tool in this program.
    pub tool: String,
    /// Arguments of the call.
    pub arguments: Map<String, Value>,
    /// Whether the call was accepted; `None` if the transcript does not say so clearly.
    pub accepted: Option<bool>,
}

/// The result of playing a transcript.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct PlayedTranscript {
    /// Number of executed calls, including weeks and statements.
    pub call_count: usize,
    /// Position, tool and reason of each call whose result differs from the transcript, or that follows the end of the
    /// run.
    pub mismatches: Vec<(usize, String, String)>,
    /// Number of calls that were not run because they contain a Python program.
    pub not_run: usize,
}

impl ForeignTranscript {
    /// Parses a trajectory in the Agent Trajectory Interchange Format, an Inspect log (JSON or `.eval`), or JSON lines
    /// with the keys `tool` and `args`.
    ///
    /// # Errors
    /// The file has none of these formats, or contains no call to a tool of this program.
    pub fn parse(bytes: &[u8]) -> Result<ForeignTranscript, String> {
        let read = match serde_json::from_slice::<Value>(bytes) {
            Ok(Value::Object(whole)) if whole.contains_key("steps") => from_steps(&whole),
            Ok(whole) if whole["eval"].is_object() => inspect_log::parse_json(&whole)?,
            _ if ZipArchive::is_zip(bytes) => inspect_log::parse_archive(bytes, MAX_FILE_BYTES)?,
            _ => {
                let text = std::str::from_utf8(bytes)
                    .map_err(|_| "the file is neither text nor an .eval archive of Inspect".to_owned())?;
                parse_lines(text)?
            }
        };
        match read.calls.is_empty() {
            true => Err("the file contains no call to a tool of this program".to_owned()),
            false => Ok(read),
        }
    }

    /// Plays the calls in a run. Does not execute Python programs in the calls. `progress` is called after each tool
    /// call.
    pub fn play(&self, session: &mut Session, progress: &mut dyn FnMut(usize)) -> PlayedTranscript {
        let mut played = PlayedTranscript::default();
        session.disable_python();
        for call in &self.calls {
            let api_response = handle_request(
                session,
                ApiRequest::from_tool_call(&call.tool, call.arguments.clone().into(), Value::Null),
                Via::Script,
            );
            let accepted = api_response.is_success();
            let is_not_run = || {
                api_response.body["error"].as_str().is_some_and(|text| text.contains(PYTHON_DISABLED_MESSAGE))
            };
            if is_not_run() {
                played.not_run += 1;
            } else if call.accepted.is_some_and(|before| before != accepted) {
                let reason = api_response.body["error"]
                    .as_str()
                    .unwrap_or("the call is accepted in this run")
                    .to_owned();
                played.mismatches.push((call.position, call.tool.clone(), reason));
            }
            played.call_count += 1;
            progress(played.call_count);
        }
        played
    }
}

/// Finds a tool by the name that a client recorded. Some clients add the name of the server as a prefix.
pub(super) fn tool_name(name: &str) -> Option<&'static str> {
    let bare = name.rsplit(['.', '/', ':']).next().unwrap_or(name);
    let bare = bare.rsplit_once("__").map_or(bare, |(_, bare)| bare);
    let known = |name: &str| ToolId::all().map(ToolId::name).find(|text| *text == name);
    known(bare).or_else(|| find(bare).map(|tool| tool.spec().name()))
}

fn from_steps(whole: &Map<String, Value>) -> ForeignTranscript {
    let steps = whole["steps"].as_array().map_or(&[][..], Vec::as_slice);
    let world = &whole.get("final_metrics").map_or(&Value::Null, |metrics| &metrics["extra"]);
    let calls = steps.iter().enumerate().flat_map(|(at, step)| {
        let calls = step["tool_calls"].as_array().map_or(&[][..], Vec::as_slice);
        calls.iter().filter_map(move |call| {
            let arguments = call["arguments"].as_object().cloned().unwrap_or_default();
            let tool = tool_name(call["function_name"].as_str()?)?.to_owned();
            Some(ForeignCall {
                position: at + 1,
                tool,
                arguments,
                accepted: step_acceptance(step, &call["tool_call_id"]),
            })
        })
    });
    ForeignTranscript {
        player: whole.get("agent").and_then(|agent| agent["name"].as_str()).map(str::to_owned),
        seed: world["seed"].as_u64(),
        scenario: world["scenario"].as_str().map(str::to_owned),
        days: world["total_days"]
            .as_u64()
            .or(world["days"].as_u64())
            .and_then(|days| u32::try_from(days).ok()),
        cash: world["starting_cash"].as_f64(),
        state_hash: world["state_hash"].as_str().filter(|hash| !hash.is_empty()).map(str::to_owned),
        calls: calls.collect(),
    }
}

/// Returns whether the observation of a step reports that a call was accepted, or `None` if the observation is missing
/// or unclear.
fn step_acceptance(step: &Value, id: &Value) -> Option<bool> {
    let results = step["observation"]["results"].as_array()?;
    let value = results.iter().find(|result| result["source_call_id"] == *id)?;
    is_acceptance(value["content"].as_str()?)
}

/// Returns whether a tool result reports that the call was accepted, or `None` if the result is unclear.
pub(super) fn is_acceptance(answer: &str) -> Option<bool> {
    let value: Value = serde_json::from_str(answer).ok()?;
    match (&value["success"], value.get("dashboard")) {
        (Value::Bool(success), _) => Some(*success),
        (_, Some(_)) => Some(true),
        _ => None,
    }
}

fn parse_lines(text: &str) -> Result<ForeignTranscript, String> {
    let mut calls = Vec::new();
    for (at, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let place = at + 1;
        let read: Value = serde_json::from_str(line).map_err(|error| {
            format!("line {place} is not valid JSON ({error}), and the file is not a trajectory with steps")
        })?;
        let name = read["tool"].as_str().ok_or_else(|| format!("line {place} has no tool"))?;
        let tool =
            tool_name(name).ok_or_else(|| format!("line {place}: there is no tool {name}"))?.to_owned();
        let arguments = match read.get("args").or_else(|| read.get("arguments")) {
            None | Some(Value::Null) => Map::new(),
            Some(Value::Object(arguments)) => arguments.clone(),
            Some(_) => return Err(format!("line {place}: the arguments are not an object")),
        };
        calls.push(ForeignCall { position: place, tool, arguments, accepted: read["success"].as_bool() });
    }
    Ok(ForeignTranscript {
        player: None,
        seed: None,
        scenario: None,
        days: None,
        cash: None,
        state_hash: None,
        calls,
    })
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use novamind_record::folder::configuration::Configuration;
    use novamind_session::NewRun;

    #[test]
    fn tool_name_accepts_client_prefixes() {
        for name in ["set_prices", "mcp__novamind__set_prices", "novamind.set_prices", "novamind/set_prices"]
        {
            assert_eq!(tool_name(name), Some("set_prices"), "{name}");
        }
        assert_eq!((tool_name("next_week"), tool_name("query")), (Some("next_week"), Some("query")));
        assert_eq!([tool_name("bash"), tool_name(""), tool_name("set_prices_now")], [None; 3]);
    }

    #[test]
    fn play_reports_calls_with_different_results() {
        let forecast = json!({"point": 1e6, "lower": 0, "upper": 2e6});
        let predictions =
            json!({"cash_1wk": forecast, "cash_4wk": forecast, "cash_12wk": forecast, "cash_26wk": forecast});
        let week = json!({"rationale": "on", "predictions": predictions});
        let lines = format!(
            "{}\n\n{}\n{}\n",
            json!({"tool": "set_prices", "args": {"B": 30}}),
            json!({"tool": "set_prices", "args": {"B": -1}, "success": true}),
            json!({"tool": "next_week", "args": week, "success": true}),
        );
        let steps = json!({
            "agent": {"name": "somebody"}, "final_metrics": {"extra": {"seed": 5}},
            "steps": [
                {"source": "user", "message": "play"},
                {"tool_calls": [
                    {"tool_call_id": "1", "function_name": "mcp__n__set_prices", "arguments": {"B": 30}},
                    {"tool_call_id": "2", "function_name": "bash", "arguments": {}},
                    {"tool_call_id": "3", "function_name": "set_prices", "arguments": {"B": -1}},
                 ], "observation": {"results": [{"source_call_id": "3", "content": "{\"success\": true}"}]}},
                {"tool_calls": [{"tool_call_id": "4", "function_name": "next_week", "arguments": week}],
                 "observation": {"results": [{"source_call_id": "4", "content": "{\"day\": 7, \"dashboard\": \"…\"}"}]}},
            ],
        });
        for (text, place) in [(lines, 3), (steps.to_string(), 2)] {
            let read = ForeignTranscript::parse(text.as_bytes()).expect("a transcript");
            assert_eq!(read.calls.len(), 3, "{read:?}");
            let new = NewRun { seed: read.seed, days: Some(28), ..NewRun::default() };
            let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
            let played = read.play(&mut session, &mut |_| {});
            assert_eq!((played.call_count, played.mismatches.len(), session.day()), (3, 1, 7), "{played:?}");
            assert_eq!((played.mismatches[0].0, played.mismatches[0].1.as_str()), (place, "set_prices"));
        }
    }

    #[test]
    fn programs_in_a_transcript_are_not_started() {
        let script = json!({"tool": "python_exec", "args": {"code": "# python\nprint(1)"}, "success": true});
        let read = ForeignTranscript::parse(script.to_string().as_bytes()).expect("a transcript");
        let new = NewRun { days: Some(28), ..NewRun::default() };
        let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
        let played = read.play(&mut session, &mut |_| {});
        assert_eq!((played.call_count, played.not_run, played.mismatches.len()), (1, 1, 0), "{played:?}");
    }

    #[test]
    fn parse_rejects_other_files() {
        for (text, words) in [
            ("", "no call"),
            ("{\"steps\": []}", "no call"),
            ("hello", "line 1 is not valid JSON"),
            ("{\"tool\": \"bash\"}", "there is no tool bash"),
            ("{\"args\": {}}", "has no tool"),
            ("{\"tool\": \"set_prices\", \"args\": [1]}", "not an object"),
        ] {
            let error = ForeignTranscript::parse(text.as_bytes()).expect_err(text);
            assert!(error.contains(words), "{text}: {error}");
        }
    }
}
