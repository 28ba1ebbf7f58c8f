//! A run as a sequence of actions, for export to formats of programs that study or train agents
//! (docs/formats/exports.md).
//!
//! The run is replayed from its lines, because the record does not contain the rows that queries returned. The actions
//! contain only data that the player could see. Inspections and timings are stored separately.

mod atif;
mod context;
mod inspect;
mod plain_script;
mod python_script;
mod viewer;
mod viewer_files;

use std::ops::ControlFlow;
use std::path::Path;

use serde_json::{Map, Value, json};

pub use atif::to_atif;
pub use context::AgentContext;
pub use inspect::{inspect_file_name, to_inspect};
pub use plain_script::to_plain_script;
pub use python_script::to_python_script;
pub use viewer::{ViewerExport, add_to_viewer_manifest, to_viewer};

use novamind_record::error::RunError;
use novamind_record::folder::manifest::Manifest;
use novamind_record::trajectory::record::{
    CalledTool, End, Outcome, QuerySource, RejectionRecord, SubmittedForecast,
};
use novamind_record::trajectory::{Line, Record, find_policy};
use novamind_session::{Playback, SeekTarget, Session, rows_to_json};
use novamind_tools::{FORECAST_KEYS, ParameterNumbers};

/// A run as a sequence of actions.
#[derive(Debug)]
pub struct Transcript {
    /// Manifest of the run.
    pub manifest: Manifest,
    /// Values of the parameters that manuals document, as in force on day 0.
    pub numbers: ParameterNumbers,
    /// Text of the dashboard on day 0, before the first action.
    pub opening_dashboard: String,
    /// Actions of the player in order.
    pub steps: Vec<TranscriptStep>,
    /// Lines that did not change the run, such as inspections, timings and presence.
    pub other_lines: Vec<Value>,
    /// Recorded end of the run; `None` if the run has not ended.
    pub end: Option<End>,
    /// Day and cash of the last recorded state.
    pub last_day_and_cash: (u32, f64),
    /// Hash of the last recorded state.
    pub state_hash: String,
    /// Name of the policy that decided all weeks, if any.
    pub policy: Option<String>,
}

/// An action of the player, with its line, day and time.
#[derive(Debug)]
pub struct TranscriptStep {
    /// Number of the line that recorded the action.
    pub seq: u64,
    /// Day of the run on which the player acted.
    pub day: u32,
    /// Time of the action, RFC 3339.
    pub at: String,
    /// What the player did.
    pub action: TranscriptAction,
}

/// An action of the player.
#[derive(Debug)]
pub enum TranscriptAction {
    /// A tool call, accepted or rejected.
    Call {
        /// Tool that the player called. The program may not have a tool of this name.
        tool: CalledTool,
        /// Arguments as recorded.
        args: Value,
        /// Result or rejection of the call.
        answer: Result<Value, RejectionRecord>,
        /// Interface and duration of the call.
        extra: Map<String, Value>,
    },
    /// A database query of the player.
    Query {
        /// SQL as recorded.
        sql: String,
        /// Rows in the form that programs receive, or an error code and a message.
        answer: Result<Value, (String, String)>,
        /// Source of the statement and duration of the query.
        extra: Map<String, Value>,
    },
    /// Saved notes; `None` if the record does not contain the text.
    Note(Option<String>),
    /// A simulated week.
    Week {
        /// Rationale of the player.
        rationale: String,
        /// Forecasts that were filed before the week.
        forecasts: Vec<SubmittedForecast>,
        /// Result of the week; `None` if the week did not end.
        result: Option<WeekResult>,
    },
    /// An action that no interface for programs offers: simulating a single day, or changing a parameter. Contains the
    /// command.
    Debugging(String),
}

/// State of the company after a week.
#[derive(Debug)]
pub struct WeekResult {
    /// Last day of the week.
    pub day: u32,
    /// Hash of the state at the end of the week.
    pub state_hash: String,
    /// Cash at the end of the week, dollars.
    pub cash: f64,
    /// Dashboard at the end of the week as text.
    pub dashboard: String,
}

impl Transcript {
    /// Reads a run folder or a trajectory file and replays the run. `progress` is called with each simulated day.
    ///
    /// # Errors
    /// Returns an error if the run is missing, is damaged or has a different version. For a damaged run, the error
    /// names the damaged line and the intact part.
    pub fn open(path: &Path, progress: &mut dyn FnMut(u32)) -> Result<Transcript, RunError> {
        Transcript::open_observed(path, progress, &mut |_| {})
    }

    /// Reads and replays a run like [`Transcript::open`]. `observe` is called with the company on day 0 and after every
    /// recorded week.
    ///
    /// # Errors
    /// Returns the errors of [`Transcript::open`].
    pub fn open_observed(
        path: &Path,
        progress: &mut dyn FnMut(u32),
        observe: &mut dyn FnMut(&mut Session),
    ) -> Result<Transcript, RunError> {
        let mut playback = Playback::open(path)?;
        let lines: Vec<Line> = playback.lines().to_vec();
        let manifest = playback.session().manifest().clone();
        let opening = playback.session().company().dashboard();
        let mut transcript = Transcript {
            last_day_and_cash: (0, manifest.cash),
            manifest,
            numbers: ParameterNumbers::from_params(playback.session().params()),
            opening_dashboard: opening,
            steps: Vec::new(),
            other_lines: Vec::new(),
            end: None,
            state_hash: String::new(),
            policy: find_policy(&lines).map(str::to_owned),
        };
        observe(playback.session_mut());
        for line in lines.iter().skip(1) {
            playback.seek(SeekTarget::Lines(1), &mut |day| {
                progress(day);
                ControlFlow::Continue(())
            })?;
            transcript.add_line(line, playback.session_mut());
            if matches!(line.record, Record::Week(_) | Record::Step(_)) {
                observe(playback.session_mut());
            }
        }
        Ok(transcript)
    }

    fn add_line(&mut self, line: &Line, session: &mut Session) {
        let transcript_action = match &line.record {
            Record::Call(call) => {
                let mut extra = context::call_metadata(call.via, call.took_ms);
                extra.extend(context::undone_call_field(call.reversal));
                let answer = match &call.outcome {
                    Outcome::Accepted(answer) => Ok(answer.clone()),
                    Outcome::Rejected(rejection) => Err(rejection.clone()),
                };
                TranscriptAction::Call { tool: call.tool.clone(), args: call.args.clone(), answer, extra }
            }
            // Queries of a script belong to the tool call that ran the script.
            Record::Query(query) if query.via == Some(QuerySource::Script) => {
                return self.other_lines.push(context::line_as_json(line));
            }
            Record::Query(query) => {
                let extra = context::query_metadata(query.via, query.took_ms, query.stopped);
                let answer = match (&query.error, session.query(&query.sql)) {
                    (None, Ok(rows)) => Ok(rows_to_json(&rows).into()),
                    (None, Err(rejection)) => Err((rejection.code.to_owned(), rejection.message)),
                    (Some(code), _) => Err((code.clone(), query.message.clone().unwrap_or_default())),
                };
                TranscriptAction::Query { sql: query.sql.clone(), answer, extra }
            }
            Record::Note(note) => TranscriptAction::Note(note.text.clone()),
            Record::Memo(_) => TranscriptAction::Note(None),
            Record::Advance(filed) => {
                let (rationale, forecasts) = (filed.rationale.clone(), filed.forecasts.clone());
                TranscriptAction::Week { rationale, forecasts, result: None }
            }
            Record::Week(closing) => {
                return self.close_week(line.day, closing.cash, &closing.state_hash, session);
            }
            Record::Step(closing) => {
                self.last_day_and_cash = (line.day, closing.cash);
                self.state_hash.clone_from(&closing.state_hash);
                TranscriptAction::Debugging(format!("step {}", closing.days_run))
            }
            Record::Override(change) => {
                let from = change.from_day.map(|day| format!(" from {day}")).unwrap_or_default();
                TranscriptAction::Debugging(format!("set {} {}{from}", change.key, change.new))
            }
            Record::End(end) => {
                self.end = Some(end.clone());
                return;
            }
            // Notes are exported in their final form. Their edits are among the other lines.
            Record::Activity(_) | Record::Voice(_) => {
                return self.other_lines.push(context::line_as_json(line));
            }
            Record::Start(_) | Record::Branch(_) | Record::Unknown(_) => return,
        };
        self.steps.push(TranscriptStep {
            seq: line.seq,
            day: line.day,
            at: line.at.clone(),
            action: transcript_action,
        });
    }

    /// Attaches the result of a week to the action that ran the week.
    fn close_week(&mut self, day: u32, cash: f64, state_hash: &str, session: &Session) {
        self.last_day_and_cash = (day, cash);
        self.state_hash = state_hash.to_owned();
        let (state_hash, dashboard) = (state_hash.to_owned(), session.company().dashboard());
        let week = WeekResult { day, state_hash, cash, dashboard };
        let open = self.steps.iter_mut().rev().find_map(|act| match &mut act.action {
            TranscriptAction::Week { result: passed, .. } => Some(passed),
            _ => None,
        });
        if let Some(passed) = open.filter(|passed| passed.is_none()) {
            *passed = Some(week);
        }
    }

    fn player_name(&self) -> String {
        self.manifest.participant.clone().unwrap_or_else(|| "unnamed player".to_owned())
    }

    /// Returns the definition and the result of the run, for metadata fields of the export formats.
    fn run_facts(&self) -> Map<String, Value> {
        let manifest = &self.manifest;
        let all = json!({
            "run": manifest.id,
            "seed": manifest.seed,
            "scenario": manifest.scenario,
            "mode": manifest.mode.id(),
            "days": manifest.days,
            "total_days": manifest.total_days(),
            "generation": manifest.generation(),
            "starting_cash": manifest.cash,
            "parameters_digest": manifest.parameters_digest,
            "program": format!("NovaMind console {}", manifest.version),
            "last_day": self.last_day_and_cash.0,
            "cash": self.last_day_and_cash.1,
            "state_hash": self.state_hash,
            "ended": self.end.as_ref().map(|end| end.reason),
            "score": self.end.as_ref().and_then(|end| end.score),
        });
        let Value::Object(all) = all else { return Map::new() };
        all
    }
}

fn forecasts_as_json(forecasts: &[SubmittedForecast]) -> Value {
    let one = |(key, filed): (&&str, &SubmittedForecast)| {
        let value = json!({ "point": filed.point, "lower": filed.lower, "upper": filed.upper });
        ((*key).to_owned(), value)
    };
    Value::Object(FORECAST_KEYS.iter().zip(forecasts).map(one).collect())
}
