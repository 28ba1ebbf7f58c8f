//! A run told action by action, in the formats of programs that study or train agents (docs/formats/exports.md).
//!
//! The run is played again from its lines, so that every statement is answered with the rows that whoever played was shown:
//! the record does not keep them. Nothing is told that the player was not told; looks and timings stand apart from it.

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

/// A run, action by action.
#[derive(Debug)]
pub struct Transcript {
    /// What the run is.
    pub manifest: Manifest,
    /// The numbers in force on day 0, as manuals tell them.
    pub numbers: Numbers,
    /// The dashboard of day 0.
    pub opening: String,
    /// What was done, in order.
    pub acts: Vec<TranscriptAct>,
    /// What changed nothing: looks, timings, presence, as their lines have it.
    pub asides: Vec<Value>,
    /// How it ended, if it did.
    pub end: Option<End>,
    /// Day and cash of the last state that was recorded.
    pub last: (u32, f64),
    /// Hash of that state.
    pub state_hash: String,
}

/// Something that was done.
#[derive(Debug)]
pub struct TranscriptAct {
    /// Number of its line.
    pub seq: u64,
    /// Day of the run.
    pub day: u32,
    /// When, RFC 3339.
    pub at: String,
    /// What.
    pub deed: Deed,
}

/// What was done.
#[derive(Debug)]
pub enum Deed {
    /// A tool was called.
    Call {
        /// Tool, known or not.
        tool: CalledTool,
        /// Its arguments.
        args: Value,
        /// What it said.
        answer: Result<Value, RefusalRecord>,
        /// Through which door, and how long it took.
        extra: Map<String, Value>,
    },
    /// The database was asked.
    Query {
        /// Statement.
        sql: String,
        /// Its rows as programs read them, or the code and the words of what was wrong.
        answer: Result<Value, (String, String)>,
        /// Where the statement came from, and how long it took.
        extra: Map<String, Value>,
    },
    /// The notes were kept; none where the record holds no text.
    Note(Option<String>),
    /// A week was let pass.
    Week {
        /// Why.
        rationale: String,
        /// What was expected.
        forecasts: Vec<FiledForecast>,
        /// What came of it; none of a week that did not end.
        passed: Option<PassedWeek>,
    },
    /// What no program can do over the doors: single days, parameters that were set.
    Debugging(String),
}

/// What a week came to.
#[derive(Debug)]
pub struct PassedWeek {
    /// The day it ended on.
    pub day: u32,
    /// Cash then, dollars.
    pub cash: f64,
    /// The dashboard.
    pub dashboard: String,
}

impl Transcript {
    /// Of the run in a folder, or of a trajectory file. `progress` is told each day that was simulated.
    ///
    /// # Errors
    /// The run is missing, damaged, or of another version; the error names the place and what is safe.
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
            // What a script asked is part of its call.
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
            // Texts are in what is read of them; how they came about is beside it.
            Record::Activity(_) | Record::Voice(_) => return self.asides.push(told::aside(line)),
            Record::Start(_) | Record::Branch(_) | Record::Unknown(_) => return,
        };
        self.acts.push(TranscriptAct { seq: line.seq, day: line.day, at: line.at.clone(), deed });
    }

    /// What a week came to stands with the act that let it pass.
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

    /// Who played, as formats name an agent.
    fn player(&self) -> String {
        self.manifest.participant.clone().unwrap_or_else(|| "unnamed player".to_owned())
    }

    /// What the run is and came to, for places that formats leave to others.
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

/// The forecasts of a week as `next_week` takes them.
fn predictions(forecasts: &[FiledForecast]) -> Value {
    let one = |(key, filed): (&&str, &FiledForecast)| {
        let said = json!({ "point": filed.point, "lower": filed.lower, "upper": filed.upper });
        ((*key).to_owned(), said)
    };
    Value::Object(FORECAST_KEYS.iter().zip(forecasts).map(one).collect())
}
