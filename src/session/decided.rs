//! What a person did, line by line, as a trajectory tells it: for looking back at how a week was decided.

use serde_json::{Map, Value};

use super::trajectory::Line;
use super::undo::Reversal;
use crate::tools::Forecast;

/// A line of a trajectory, read.
#[derive(Debug, Clone, PartialEq)]
pub struct Decided {
    /// Number of the line.
    pub seq: u64,
    /// Day of the run.
    pub day: u32,
    /// When it was written, RFC 3339.
    pub at: String,
    /// What was done.
    pub act: Act,
}

/// Something that was done.
#[derive(Debug, Clone, PartialEq)]
pub enum Act {
    /// A tool was called and answered.
    Call {
        /// Tool.
        tool: String,
        /// Arguments.
        args: Value,
        /// What it answered.
        answer: Value,
        /// What it did to an earlier call.
        reversal: Option<Reversal>,
    },
    /// A call was refused.
    Refused {
        /// Tool.
        tool: String,
        /// Arguments.
        args: Value,
        /// Why.
        message: String,
    },
    /// The database was asked.
    Query {
        /// Statement.
        sql: String,
        /// Rows of the answer, or the code of what was wrong.
        rows: Result<u64, String>,
        /// Milliseconds it took.
        took_ms: f64,
    },
    /// A screen was looked at.
    View {
        /// Screen.
        screen: String,
        /// Milliseconds.
        for_ms: u64,
    },
    /// The notes were kept; their text is not in the trajectory.
    Memo {
        /// Bytes of the text.
        length: u64,
    },
    /// The week was let pass.
    Advance {
        /// Why.
        rationale: String,
        /// Forecasts of cash.
        forecasts: Vec<Foreseen>,
        /// They were filled by the naive projection.
        filled_naively: bool,
    },
    /// Days have passed.
    Closing {
        /// How many.
        days_run: u32,
        /// Cash after them, dollars.
        cash: f64,
    },
    /// The run was over.
    End {
        /// Why: horizon, bankruptcy, abandoned.
        reason: String,
    },
    /// The run began as a branch of another.
    Branch {
        /// The other run.
        run: String,
    },
    /// Anything else, by its kind.
    Other(String),
}

/// A forecast, and what came of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foreseen {
    /// What was said.
    pub forecast: Forecast,
    /// The day it speaks of.
    pub due: u32,
    /// Cash on that day, dollars; none where nobody recorded it.
    pub outcome: Option<f64>,
    /// The day had not come yet at the moment that is looked at: the outcome is taken from the rest of the record.
    pub later: bool,
}

impl Foreseen {
    /// Whether the interval held what came; none where that is not known.
    pub fn is_inside(&self) -> Option<bool> {
        self.outcome.map(|cash| self.forecast.lower <= cash && cash <= self.forecast.upper)
    }
}

impl Decided {
    /// Reads a line. `outcome` knows cash on a day, and whether that day had not come yet.
    pub(super) fn of(line: &Line, outcome: &dyn Fn(u32) -> (Option<f64>, bool)) -> Decided {
        Decided { seq: line.seq, day: line.day, at: line.at.clone(), act: Act::of(line, outcome) }
    }

    /// Whether it may have changed the company or its record: looking and asking do not.
    pub fn acts(&self) -> bool {
        !matches!(self.act, Act::Query { .. } | Act::View { .. } | Act::Other(_))
    }
}

impl Act {
    fn of(line: &Line, outcome: &dyn Fn(u32) -> (Option<f64>, bool)) -> Act {
        let fields = &line.fields;
        match line.kind.as_str() {
            "call" => call(fields),
            "query" => Act::Query {
                sql: word(fields, "sql"),
                rows: match fields.get("rows").and_then(Value::as_u64) {
                    Some(rows) => Ok(rows),
                    None => Err(word(fields, "error")),
                },
                took_ms: fields.get("took_ms").and_then(Value::as_f64).unwrap_or(0.0),
            },
            "view" => Act::View { screen: word(fields, "screen"), for_ms: count(fields, "for_ms") },
            "memo" => Act::Memo { length: count(fields, "length") },
            "advance" => advance(line, outcome),
            "week" | "step" => Act::Closing {
                days_run: count(fields, "days_run") as u32,
                cash: cash_of(line).unwrap_or(f64::NAN),
            },
            "end" => Act::End { reason: word(fields, "reason") },
            "branch" => {
                let from = fields.get("from").and_then(|from| from.get("run"));
                Act::Branch { run: from.and_then(Value::as_str).unwrap_or_default().to_owned() }
            }
            other => Act::Other(other.to_owned()),
        }
    }
}

/// Cash after the days that a line closes, dollars.
pub(super) fn cash_of(line: &Line) -> Option<f64> {
    line.fields.get("cash").and_then(Value::as_f64)
}

fn word(fields: &Map<String, Value>, name: &str) -> String {
    fields.get(name).and_then(Value::as_str).unwrap_or_default().to_owned()
}

fn count(fields: &Map<String, Value>, name: &str) -> u64 {
    fields.get(name).and_then(Value::as_u64).unwrap_or(0)
}

fn call(fields: &Map<String, Value>) -> Act {
    let (tool, args) = (word(fields, "tool"), fields.get("args").cloned().unwrap_or(Value::Null));
    if fields.get("ok") == Some(&Value::Bool(true)) {
        let answer = fields.get("result").cloned().unwrap_or(Value::Null);
        return Act::Call { tool, args, answer, reversal: Reversal::of(fields) };
    }
    let message = fields.get("refusal").and_then(|refusal| refusal.get("message"));
    Act::Refused { tool, args, message: message.and_then(Value::as_str).unwrap_or("refused").to_owned() }
}

fn advance(line: &Line, outcome: &dyn Fn(u32) -> (Option<f64>, bool)) -> Act {
    let list = line.fields.get("forecasts").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let foreseen = |value: &Value| {
        let forecast: Forecast = serde_json::from_value(value.clone()).ok()?;
        let due = line.day + forecast.horizon_days;
        let (outcome, later) = outcome(due);
        Some(Foreseen { forecast, due, outcome, later })
    };
    Act::Advance {
        rationale: word(&line.fields, "rationale"),
        forecasts: list.iter().filter_map(foreseen).collect(),
        filled_naively: list.iter().any(|one| one.get("filled_naively") == Some(&Value::Bool(true))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn read(kind: &str, fields: Value) -> Act {
        let line = Line {
            seq: 5,
            kind: kind.to_owned(),
            day: 14,
            at: String::new(),
            fields: fields.as_object().cloned().expect("an object"),
            hash: String::new(),
        };
        Decided::of(&line, &|due| if due == 21 { (Some(90.0), false) } else { (None, true) }).act
    }

    #[test]
    fn every_kind_of_line_is_told() {
        let call = read(
            "call",
            json!({"tool": "set_prices", "args": {"A": 1}, "ok": true, "result": 2, "undoes": 3}),
        );
        assert_eq!(
            call,
            Act::Call {
                tool: "set_prices".to_owned(),
                args: json!({"A": 1}),
                answer: json!(2),
                reversal: Some(Reversal::Undoes(3))
            }
        );
        let refusal = json!({"tool": "x", "args": null, "ok": false, "refusal": {"message": "no"}});
        let refused = Act::Refused { tool: "x".to_owned(), args: Value::Null, message: "no".to_owned() };
        assert_eq!(read("call", refusal), refused);
        let query = json!({"sql": "SELECT 1", "rows": null, "error": "sql_error", "took_ms": 1.5});
        let asked =
            Act::Query { sql: "SELECT 1".to_owned(), rows: Err("sql_error".to_owned()), took_ms: 1.5 };
        assert_eq!(read("query", query), asked);
        assert_eq!(
            read("view", json!({"screen": "cash", "for_ms": 1200})),
            Act::View { screen: "cash".to_owned(), for_ms: 1200 }
        );
        assert_eq!(
            read("week", json!({"days_run": 7, "cash": 12})),
            Act::Closing { days_run: 7, cash: 12.0 }
        );
        assert_eq!(read("end", json!({"reason": "horizon"})), Act::End { reason: "horizon".to_owned() });
        assert_eq!(read("branch", json!({"from": {"run": "aa"}})), Act::Branch { run: "aa".to_owned() });
        assert_eq!(read("override", json!({})), Act::Other("override".to_owned()));
    }

    #[test]
    fn a_forecast_says_what_came_and_what_is_still_to_come() {
        let one = |days: u32| json!({"horizon_days": days, "point": 100.0, "lower": 80.0, "upper": 95.0});
        let advance = read("advance", json!({"rationale": "if", "forecasts": [one(7), one(28)]}));
        let Act::Advance { rationale, forecasts, filled_naively } = advance else { panic!("{advance:?}") };
        assert_eq!((rationale.as_str(), filled_naively), ("if", false));
        assert_eq!((forecasts[0].due, forecasts[0].is_inside(), forecasts[0].later), (21, Some(true), false));
        assert_eq!((forecasts[1].due, forecasts[1].is_inside(), forecasts[1].later), (42, None, true));
    }
}
