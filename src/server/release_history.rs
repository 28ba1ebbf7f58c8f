//! Imports `history.jsonl` of release 2 and plays its entries in a new run
//! (docs/formats/exports.md#importing-a-history-of-release-2).

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::{Map, Value};

use super::request::ApiRequest;
use super::request_handler::handle_request;
use novamind_record::trajectory::record::Via;
use novamind_session::{Session, request_id};
use novamind_tools::{ToolId, find};

/// Maximum length of a line, in bytes. Requests to the released simulator are shorter.
const MAX_LINE_BYTES: usize = 4 << 20;
const WEEK_OPERATION: &str = "next-week";
const CALL_PREFIX: &str = "call:";

/// The entries of a history that can be executed, and the lines that cannot.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReleaseHistory {
    /// Executable entries in the order of the file.
    pub entries: Vec<HistoryEntry>,
    /// Lines that are not executed, with the reason.
    pub skipped: Vec<LineRemark>,
}

/// A request in a history that changed the game or was rejected.
#[derive(Debug, Clone, PartialEq)]
pub struct HistoryEntry {
    /// Number of the line, counted from 1.
    pub line: usize,
    /// Request ID that the client sent.
    pub request_id: String,
    /// Name of the tool in this program.
    pub tool: &'static str,
    /// Arguments of the call, as recorded.
    pub input: Value,
    /// Day after the request, according to the history.
    pub day: u32,
    /// Whether the request was successful in the released simulator.
    pub success: bool,
}

/// A line of a history with an explanation.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LineRemark {
    /// Number of the line, counted from 1.
    pub line: usize,
    /// Why the line was skipped or differs.
    pub reason: String,
}

/// The result of playing a history.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Default)]
pub struct PlayedHistory {
    /// Number of entries in the history, including skipped lines.
    pub entries: usize,
    /// Number of entries that were executed before the run ended.
    pub executed: usize,
    /// Lines that cannot be executed, with the reason.
    pub skipped: Vec<LineRemark>,
    /// Number of entries after the end of the run, which were not executed.
    pub after_end: usize,
    /// Entries that were successful in the released simulator and rejected here.
    pub rejected_here: Vec<LineRemark>,
    /// Entries that were rejected in the released simulator and successful here.
    pub accepted_here: Vec<LineRemark>,
    /// Entries after which the day of this run differs from the recorded day.
    pub different_days: Vec<LineRemark>,
}

/// The fields of a line that are checked against the earlier lines.
struct Checked {
    operation: String,
    request_id: String,
    day: u32,
}

impl ReleaseHistory {
    /// Returns whether the first line of a file is an entry of a history or of the log of an older client.
    pub fn is_history(bytes: &[u8]) -> bool {
        let first = bytes.split(|byte| *byte == b'\n').find(|line| !line.trim_ascii().is_empty());
        let line = first.and_then(|line| serde_json::from_slice::<Map<String, Value>>(line).ok());
        line.is_some_and(|line| {
            line.contains_key("operation") || line.contains_key("type") && !line.contains_key("tool")
        })
    }

    /// Parses a history of release 2.
    ///
    /// # Errors
    /// A line is not an entry, the days of the entries do not follow each other, or no entry can be executed. The error
    /// names the line.
    pub fn parse(bytes: &[u8]) -> Result<ReleaseHistory, String> {
        let mut history = ReleaseHistory::default();
        let (mut day, mut lines_by_id) = (0, BTreeMap::new());
        let lines: Vec<&[u8]> = bytes.split(|byte| *byte == b'\n').collect();
        for (number, text) in (1..).zip(&lines).filter(|(_, text)| !text.trim_ascii().is_empty()) {
            if text.len() > MAX_LINE_BYTES {
                return Err(format!("line {number} has more than {MAX_LINE_BYTES} bytes"));
            }
            let entry: Map<String, Value> = match serde_json::from_slice(text) {
                Ok(entry) => entry,
                // A complete line ends with a line feed, so the last element can only be an incomplete line.
                Err(_) if number == lines.len() => {
                    history.skip(number, "the line is incomplete");
                    continue;
                }
                Err(error) => return Err(format!("line {number} is not a JSON object: {error}")),
            };
            let checked = check_entry(&entry, day).map_err(|problem| format!("line {number}: {problem}"))?;
            let Some(checked) = checked else {
                history.skip(number, "the outcome of the request is not known");
                continue;
            };
            day = checked.day;
            if let Some(first) = lines_by_id.insert(checked.request_id.clone(), number) {
                history.skip(number, &format!("line {first} has the same request id"));
            } else if let Some(tool) = tool_of_operation(&checked.operation) {
                history.entries.push(HistoryEntry {
                    line: number,
                    request_id: checked.request_id,
                    tool,
                    input: entry.get("input").cloned().unwrap_or_default(),
                    day,
                    success: entry["success"] == true,
                });
            } else {
                history.skip(number, &format!("this program has no operation {:?}", checked.operation));
            }
        }
        match history.entries.is_empty() {
            true => Err("the file contains no entry that can be executed".to_owned()),
            false => Ok(history),
        }
    }

    fn skip(&mut self, line: usize, reason: &str) {
        self.skipped.push(LineRemark { line, reason: reason.to_owned() });
    }

    /// Plays the entries in a new run, until the run ends. `progress` is called with the number of executed entries.
    pub fn play(&self, session: &mut Session, progress: &mut dyn FnMut(usize)) -> PlayedHistory {
        let mut played = PlayedHistory {
            entries: self.entries.len() + self.skipped.len(),
            skipped: self.skipped.clone(),
            ..PlayedHistory::default()
        };
        session.disable_python();
        for entry in &self.entries {
            if session.ended().is_some() {
                played.after_end += 1;
                continue;
            }
            let id = Value::from(entry.request_id.clone());
            let request = ApiRequest::from_tool_call(entry.tool, entry.input.clone(), id);
            let response = handle_request(session, request, Via::Import);
            played.executed += 1;
            let remark = |reason: String| LineRemark { line: entry.line, reason };
            match (entry.success, response.is_success()) {
                (true, false) => {
                    // The error of a call with several deals has one line per deal.
                    let error = response.body["error"].as_str().unwrap_or_default();
                    let message = error.lines().next().unwrap_or_default();
                    played.rejected_here.push(remark(format!("{}: {message}", entry.tool)));
                }
                (false, true) => played.accepted_here.push(remark(entry.tool.to_owned())),
                _ => {}
            }
            if session.day() != entry.day {
                let reason = format!("day {} here, day {} there", session.day(), entry.day);
                played.different_days.push(remark(reason));
            }
            progress(played.executed);
        }
        played
    }
}

/// Checks the fields of an entry. `day` is the day after the previous entry. Returns `None` if the outcome of the
/// request is unknown.
fn check_entry(entry: &Map<String, Value>, day: u32) -> Result<Option<Checked>, String> {
    let Some(operation) = entry.get("operation").and_then(Value::as_str) else {
        return Err("the entry has no operation. Logs of older clients do not contain the input of requests, so they \
                    cannot be played"
            .to_owned());
    };
    let Some(id) = entry.get("request_id").and_then(request_id) else {
        return Err("request_id must be a text of 1 to 128 characters".to_owned());
    };
    if entry.get("outcome").is_some_and(|outcome| outcome != "completed") {
        return Ok(None);
    }
    let day_in = |key: &str| {
        let day = entry.get(key).and_then(Value::as_u64).and_then(|day| u32::try_from(day).ok());
        day.ok_or_else(|| format!("{key} is not a day"))
    };
    let (before, after) = (day_in("day_before")?, day_in("day")?);
    if before != day {
        return Err(format!(
            "the request begins on day {before}, but the previous entries end on day {day}: entries are missing or in \
             another order"
        ));
    }
    let can_advance = operation == WEEK_OPERATION;
    if after < before || (after > before && !can_advance) {
        return Err(format!("{operation} cannot advance the run from day {before} to day {after}"));
    }
    if !entry.get("success").is_some_and(Value::is_boolean) {
        return Err("success is neither true nor false".to_owned());
    }
    Ok(Some(Checked { operation: operation.to_owned(), request_id: id.to_owned(), day: after }))
}

/// Returns the tool of an operation, or `None` if no tool that changes a run corresponds to the operation.
fn tool_of_operation(operation: &str) -> Option<&'static str> {
    if operation == WEEK_OPERATION {
        return Some(ToolId::NextWeek.name());
    }
    let tool = find(operation.strip_prefix(CALL_PREFIX)?)?;
    let id = tool.spec().id;
    (id.takes_request_id() && id != ToolId::NextWeek).then(|| id.name())
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use novamind_record::folder::configuration::Configuration;
    use novamind_record::trajectory::record::RunEndReason;
    use novamind_session::NewRun;

    fn entry(id: &str, operation: &str, input: Value, days: (u32, u32), success: bool) -> Value {
        json!({
            "type": "mutation", "request_id": id, "operation": operation, "input": input, "day_before": days.0,
            "day": days.1, "started_at": 1.5, "timestamp": 2.5, "outcome": "completed", "success": success,
        })
    }

    fn week(id: &str, day: u32) -> Value {
        let forecast = json!({ "point": 1e6, "lower": 0, "upper": 2e6 });
        let keys = ["cash_1wk", "cash_4wk", "cash_12wk", "cash_26wk"];
        let predictions: Map<String, Value> =
            keys.iter().map(|key| ((*key).to_owned(), forecast.clone())).collect();
        let input = json!({ "predictions": predictions, "rationale": "as planned" });
        entry(id, WEEK_OPERATION, input, (day, day + 7), true)
    }

    fn prices(id: &str, day: u32) -> Value {
        entry(id, "call:set_prices", json!({ "A": 19 }), (day, day), true)
    }

    fn text(lines: &[Value]) -> String {
        lines.iter().map(|line| format!("{line}\n")).collect()
    }

    fn new_session(days: u32) -> Session {
        let new =
            NewRun { seed: Some(5), days: Some(days), scenario: "release-2".to_owned(), ..NewRun::default() };
        Session::create(new, &Configuration::bundled()).expect("a run")
    }

    #[test]
    fn play_executes_entries_in_order_and_counts_differences() {
        let two_deals = json!({ "deals": [{ "customer_id": 900 }, { "customer_id": 901 }] });
        let lines = [
            prices("a", 0),
            entry("b", "call:reject_enterprise_deal", two_deals, (0, 0), true),
            entry("c", "call:set_prices", json!({ "A": 20 }), (0, 0), false),
            entry("d", "call:teleport", json!({}), (0, 0), false),
            prices("a", 0),
            week("e", 0),
            week("f", 7),
            week("g", 14),
            prices("h", 21),
        ];
        let history = ReleaseHistory::parse(text(&lines).as_bytes()).expect("a history");
        let mut session = new_session(10);
        let played = history.play(&mut session, &mut |_| {});
        let lines = |remarks: &[LineRemark]| remarks.iter().map(|remark| remark.line).collect::<Vec<_>>();
        assert_eq!((played.entries, played.executed, played.after_end), (9, 5, 2), "{played:?}");
        assert_eq!(lines(&played.skipped), [4, 5]);
        assert_eq!(lines(&played.rejected_here), [2]);
        assert_eq!(played.rejected_here[0].reason, "reject_enterprise_deal: customer 900: no active thread");
        assert_eq!(lines(&played.accepted_here), [3]);
        // The run has ten days, so its second week ends on day 10.
        assert_eq!(played.different_days[0].reason, "day 10 here, day 14 there");
        assert_eq!(lines(&played.different_days), [7]);
        assert_eq!((session.day(), session.ended()), (10, Some(RunEndReason::Horizon)));
    }

    #[test]
    fn incomplete_last_line_is_skipped() {
        let whole = text(&[prices("a", 0), week("b", 0)]);
        let cut = ReleaseHistory::parse(&whole.as_bytes()[..whole.len() - 20]).expect("a history");
        assert_eq!((cut.entries.len(), cut.skipped.len()), (1, 1));
        assert_eq!(cut.skipped[0], LineRemark { line: 2, reason: "the line is incomplete".to_owned() });
        let without_line_feed = ReleaseHistory::parse(whole.trim_end().as_bytes()).expect("a history");
        assert_eq!((without_line_feed.entries.len(), without_line_feed.skipped.len()), (2, 0));
    }

    #[test]
    fn request_without_outcome_is_skipped() {
        let mut pending = prices("b", 0);
        pending["outcome"] = "pending".into();
        let history = ReleaseHistory::parse(text(&[prices("a", 0), pending]).as_bytes()).expect("a history");
        assert_eq!((history.entries.len(), history.skipped[0].line), (1, 2));
    }

    #[test]
    fn parse_names_the_line_of_an_invalid_entry() {
        let without = |key: &str| {
            let mut line = prices("b", 0);
            line.as_object_mut().expect("an object").remove(key);
            line.to_string()
        };
        let nan = without("input").replacen('{', "{\"input\": {\"A\": NaN}, ", 1);
        let huge = format!("{{\"operation\": \"{}\"}}", "x".repeat(MAX_LINE_BYTES));
        let moved = entry("b", "call:set_prices", json!({}), (0, 7), true).to_string();
        let back = entry("b", WEEK_OPERATION, json!({}), (0, 0), true).to_string();
        for (line, problem) in [
            ("hello".to_owned(), "not a JSON object"),
            ("[1]".to_owned(), "not a JSON object"),
            (nan, "not a JSON object"),
            (huge, "has more than"),
            (without("operation"), "older clients"),
            (without("request_id"), "request_id must be"),
            (prices(&"x".repeat(129), 0).to_string(), "request_id must be"),
            (without("day"), "day is not a day"),
            (without("success"), "neither true nor false"),
            (prices("b", 7).to_string(), "begins on day 7, but the previous entries end on day 0"),
            (moved, "cannot advance the run from day 0 to day 7"),
        ] {
            let file = format!("{}\n{line}\n{}\n", prices("a", 0), prices("z", 0));
            let error = ReleaseHistory::parse(file.as_bytes()).expect_err(problem);
            assert!(error.starts_with("line 2") && error.contains(problem), "{problem}: {error}");
        }
        assert!(ReleaseHistory::parse(back.as_bytes()).is_ok(), "a rejected week passes no day");
        assert!(ReleaseHistory::parse(b"").is_err_and(|error| error.contains("no entry")));
    }

    #[test]
    fn is_history_recognizes_entries_and_older_logs() {
        assert!(ReleaseHistory::is_history(text(&[prices("a", 0)]).as_bytes()));
        assert!(ReleaseHistory::is_history(b"\n{\"type\":\"next_week\",\"day\":7}\n"));
        for other in ["{\"tool\": \"set_prices\"}", "{\"steps\": []}", "hello", ""] {
            assert!(!ReleaseHistory::is_history(other.as_bytes()), "{other}");
        }
    }

    #[test]
    fn only_operations_that_change_a_run_have_tools() {
        let tool = |operation: &str| tool_of_operation(operation);
        assert_eq!(
            (tool("next-week"), tool("call:research_market")),
            (Some("next_week"), Some("research_market"))
        );
        let others =
            ["call:next_week", "call:query", "call:python_exec", "call:get_cost_info", "set_prices", "call:"];
        assert_eq!(others.map(tool), [None; 6]);
    }
}
