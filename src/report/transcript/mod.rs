//! A run as a sequence of actions, exported to formats of programs that study or train agents
//! (docs/formats/exports.md).
//!
//! The run is replayed from its lines to reproduce the rows of every query, which the record does not contain. The
//! actions contain only what the player could see. Inspections and timings are kept separately.

mod atif;
mod inspect;
mod plain_script;
mod python_script;
mod told;

use std::ops::ControlFlow;
use std::path::Path;

use serde_json::{Map, Value, json};

pub use atif::atif;
pub use inspect::{inspect, inspect_file_name};
pub use plain_script::plain_script;
pub use python_script::python_script;
pub use told::Surroundings;

use novamind_record::error::RunError;
use novamind_record::folder::manifest::Manifest;
use novamind_record::trajectory::record::{
    CalledTool, End, FiledForecast, Outcome, QuerySource, RefusalRecord,
};
use novamind_record::trajectory::{Line, Record};
use novamind_session::{Goal, Playback, Session, rows_as_json};
use novamind_tools::{FORECAST_KEYS, Numbers};

/// A run as a sequence of actions.
#[derive(Debug)]
pub struct Transcript {
    /// Manifest of the run.
    pub manifest: Manifest,
    /// Parameters in force on day 0, as documented in manuals.
    pub numbers: Numbers,
    /// Dashboard of day 0.
    pub opening: String,
    /// Actions in order.
    pub acts: Vec<TranscriptAct>,
    /// Lines that changed nothing, such as inspections, timings and presence.
    pub asides: Vec<Value>,
    /// End of the run, if it has ended.
    pub end: Option<End>,
    /// Day and cash of the last recorded state.
    pub last: (u32, f64),
    /// Hash of that state.
    pub state_hash: String,
}

/// An action with its place.
#[derive(Debug)]
pub struct TranscriptAct {
    /// Number of the action's line.
    pub seq: u64,
    /// Day of the run.
    pub day: u32,
    /// Time, RFC 3339.
    pub at: String,
    /// The action.
    pub deed: Deed,
}

/// An action of the player.
#[derive(Debug)]
pub enum Deed {
    /// A tool call.
    Call {
        /// Tool, which can be unknown.
        tool: CalledTool,
        /// Its arguments.
        args: Value,
        /// Result or rejection.
        answer: Result<Value, RefusalRecord>,
        /// Interface and duration.
        extra: Map<String, Value>,
    },
    /// A database query.
    Query {
        /// SQL statement.
        sql: String,
        /// Rows as programs receive them, or error code and message.
        answer: Result<Value, (String, String)>,
        /// Source of the statement, and duration.
        extra: Map<String, Value>,
    },
    /// Saved notes; `None` if the record does not contain the text.
    Note(Option<String>),
    /// A simulated week.
    Week {
        /// Rationale.
        rationale: String,
        /// Forecasts.
        forecasts: Vec<FiledForecast>,
        /// Result; `None` if the week did not end.
        passed: Option<PassedWeek>,
    },
    /// Actions that no interface for programs offers: single days and changed parameters.
    Debugging(String),
}

/// Result of a week.
#[derive(Debug)]
pub struct PassedWeek {
    /// Last day of the week.
    pub day: u32,
    /// Cash on that day, dollars.
    pub cash: f64,
    /// Dashboard on that day.
    pub dashboard: String,
}

impl Transcript {
    /// Reads a run folder or a trajectory file and replays it. `progress` is called with each simulated day.
    ///
    /// # Errors
    /// Returns an error if the run is missing, damaged or of another version. The error names the place and what is
    /// intact.
    pub fn of(path: &Path, progress: &mut dyn FnMut(u32)) -> Result<Transcript, RunError> {
        let mut playback = Playback::open(path)?;
        let lines: Vec<Line> = playback.lines().to_vec();
        let manifest = playback.session().manifest().clone();
        let opening = playback.session().company().dashboard();
        let mut told = Transcript {
            last: (0, manifest.cash),
            manifest,
            numbers: Numbers::of(playback.session().params()),
            opening,
            acts: Vec::new(),
            asides: Vec::new(),
            end: None,
            state_hash: String::new(),
        };
        for line in lines.iter().skip(1) {
            playback.go(Goal::Lines(1), &mut |day| {
                progress(day);
                ControlFlow::Continue(())
            })?;
            told.take(line, playback.session_mut());
        }
        Ok(told)
    }

    fn take(&mut self, line: &Line, session: &mut Session) {
        let deed = match &line.record {
            Record::Call(call) => {
                let mut extra = told::door(call.via, call.took_ms);
                extra.extend(told::reversal(call.reversal));
                let answer = match &call.outcome {
                    Outcome::Accepted(answer) => Ok(answer.clone()),
                    Outcome::Refused(refusal) => Err(refusal.clone()),
                };
                Deed::Call { tool: call.tool.clone(), args: call.args.clone(), answer, extra }
            }
            // Queries of a script are part of its call.
            Record::Query(query) if query.via == Some(QuerySource::Script) => {
                return self.asides.push(told::aside(line));
            }
            Record::Query(query) => {
                let extra = told::source(query.via, query.took_ms, query.stopped);
                let answer = match (&query.error, session.query(&query.sql)) {
                    (None, Ok(rows)) => Ok(rows_as_json(&rows).into()),
                    (None, Err(refusal)) => Err((refusal.code.to_owned(), refusal.message)),
                    (Some(code), _) => Err((code.clone(), query.message.clone().unwrap_or_default())),
                };
                Deed::Query { sql: query.sql.clone(), answer, extra }
            }
            Record::Note(note) => Deed::Note(note.text.clone()),
            Record::Memo(_) => Deed::Note(None),
            Record::Advance(filed) => {
                let (rationale, forecasts) = (filed.rationale.clone(), filed.forecasts.clone());
                Deed::Week { rationale, forecasts, passed: None }
            }
            Record::Week(closing) => return self.close(line.day, closing.cash, &closing.state_hash, session),
            Record::Step(closing) => {
                self.last = (line.day, closing.cash);
                self.state_hash.clone_from(&closing.state_hash);
                Deed::Debugging(format!("step {}", closing.days_run))
            }
            Record::Override(change) => {
                let from = change.from_day.map(|day| format!(" from {day}")).unwrap_or_default();
                Deed::Debugging(format!("set {} {}{from}", change.key, change.new))
            }
            Record::End(end) => {
                self.end = Some(end.clone());
                return;
            }
            // Notes contain the final text; edits are kept separately.
            Record::Activity(_) | Record::Voice(_) => return self.asides.push(told::aside(line)),
            Record::Start(_) | Record::Branch(_) | Record::Unknown(_) => return,
        };
        self.acts.push(TranscriptAct { seq: line.seq, day: line.day, at: line.at.clone(), deed });
    }

    /// Attaches the result of a week to the action that ran it.
    fn close(&mut self, day: u32, cash: f64, state_hash: &str, session: &Session) {
        self.last = (day, cash);
        self.state_hash = state_hash.to_owned();
        let week = PassedWeek { day, cash, dashboard: session.company().dashboard() };
        let open = self.acts.iter_mut().rev().find_map(|act| match &mut act.deed {
            Deed::Week { passed, .. } => Some(passed),
            _ => None,
        });
        if let Some(passed) = open.filter(|passed| passed.is_none()) {
            *passed = Some(week);
        }
    }

    fn player(&self) -> String {
        self.manifest.participant.clone().unwrap_or_else(|| "unnamed player".to_owned())
    }

    /// Returns the definition and result of the run, for metadata fields of the formats.
    fn facts(&self) -> Map<String, Value> {
        let own = &self.manifest;
        let all = json!({
            "run": own.id,
            "seed": own.seed,
            "scenario": own.scenario,
            "mode": own.mode.id(),
            "days": own.days,
            "starting_cash": own.cash,
            "parameters_digest": own.parameters_digest,
            "program": format!("NovaMind console {}", own.version),
            "last_day": self.last.0,
            "cash": self.last.1,
            "state_hash": self.state_hash,
            "ended": self.end.as_ref().map(|end| end.reason),
            "score": self.end.as_ref().and_then(|end| end.score),
        });
        let Value::Object(all) = all else { return Map::new() };
        all
    }
}

fn predictions(forecasts: &[FiledForecast]) -> Value {
    let one = |(key, filed): (&&str, &FiledForecast)| {
        let said = json!({ "point": filed.point, "lower": filed.lower, "upper": filed.upper });
        ((*key).to_owned(), said)
    };
    Value::Object(FORECAST_KEYS.iter().zip(forecasts).map(one).collect())
}
