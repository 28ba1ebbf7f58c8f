//! Calculations and scripts of a run.
//!
//! Both are read-only SQL under the guard and the limits of a query, or Python that sends such queries. Calls in the
//! trajectory define them. The output of calculations before a week is in its `advance` line, so a resumed run shows
//! the same dashboard without running them.

use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::Session;
use crate::database::{RunDatabase, query_refusal, rows_as_json};
use crate::python::run::run_python;
use crate::python::{Said, ScriptHost, ScriptRequest, failed, refuse_unless_played};
use novamind_database::query::{Limits, SQL_CANCELLED};
use novamind_database::{Rows, text};
use novamind_record::trajectory::record::{Calculated, QuerySource, Via};
use novamind_tools::{Kept, Language, NotebookChange, Refusal, Script, ScriptOutput, hint_at_python};

const MOST_OUTPUT: usize = 5000;
const MOST_REMARKS: usize = 2000;

const OUTPUT_IS_CUT: &str = "stdout is cut after 5,000 characters\n";

/// Appends a result as a table, and its remarks, up to the limits.
fn add(said: &mut Said, rows: &Rows) {
    if said.results.len() <= 4 * MOST_OUTPUT {
        said.results += &text::columns(rows);
    }
    for remark in [&rows.warning, &rows.hint].into_iter().flatten() {
        if said.remarks.len() <= 4 * MOST_REMARKS {
            said.remarks += &format!("{remark}\n");
        }
    }
}

fn first(text: &str, most: usize) -> String {
    text.chars().take(most).collect()
}

impl Session {
    /// Prevents Python from being started, because the calls were decided elsewhere.
    pub fn keep_python_out(&mut self) {
        self.surroundings.keeps_python_out = true;
    }

    /// Runs the script of a tool call.
    ///
    /// # Errors
    /// `script_failed`, `script_timeout`, with the location.
    pub(super) fn run_script(&mut self, script: &Script, via: Via) -> Result<ScriptOutput, Refusal> {
        let time = Duration::from_secs_f64(script.seconds);
        let said = match Language::of(&script.code) {
            Language::Sql => self.run_statements(&script.code, time)?,
            Language::Python => {
                self.refuse_python(via)?;
                self.run_python(&script.code, time, true)?
            }
        };
        let stdout = first(&said.results, MOST_OUTPUT);
        let cut = if stdout.len() < said.results.len() { OUTPUT_IS_CUT } else { "" };
        Ok(ScriptOutput {
            returncode: 0,
            stdout,
            stderr: first(&format!("{cut}{}", said.remarks), MOST_REMARKS),
        })
    }

    /// Rejects Python unless a player makes the call.
    fn refuse_python(&self, via: Via) -> Result<(), Refusal> {
        let is_played = !matches!(via, Via::Policy | Via::Branch | Via::Lesson);
        refuse_unless_played(is_played && !self.surroundings.keeps_python_out)
    }

    /// Runs a script in Python. Its statements are recorded if `noted` is true.
    fn run_python(&mut self, code: &str, time: Duration, noted: bool) -> Result<Said, Refusal> {
        let stop = self.complete_database().and_then(RunDatabase::interrupt);
        let stop = stop.map_err(|refusal| failed(refusal.message))?;
        let (ticket, mode) = (stop.ticket(), self.manifest.mode);
        let mut answer = |request, left| self.answer_script(request, left, noted);
        let host = &mut ScriptHost { is_stopped: &|| stop.has_stopped(ticket), answer: &mut answer };
        run_python(code, time, mode, host)
    }

    fn answer_script(
        &mut self,
        request: ScriptRequest,
        left: Duration,
        noted: bool,
    ) -> Result<Value, Refusal> {
        match request {
            ScriptRequest::Vars => Ok(json!({ "current_day": self.day() })),
            ScriptRequest::Query { sql } => {
                self.query_of_script(&sql, left, noted).map(|rows| Value::Object(rows_as_json(&rows)))
            }
        }
    }

    fn query_of_script(&mut self, sql: &str, left: Duration, noted: bool) -> Result<Rows, Refusal> {
        let started = Instant::now();
        let own = self.company().query_limits();
        let limits = Limits { time: own.time.min(left), ..own };
        let ticket = self.draw_ticket()?;
        let answer = self.answer_within(ticket, sql, limits);
        if noted {
            self.note_query(sql, answer.as_ref(), started.elapsed(), QuerySource::Script);
        }
        answer
    }

    fn run_statements(&mut self, code: &str, time: Duration) -> Result<Said, Refusal> {
        let limits = self.company().query_limits();
        let connection = self.complete_database().and_then(|database| database.connection());
        let connection = connection.map_err(|refusal| Refusal::new("script_failed", refusal.message))?;
        let mut said = Said::default();
        match connection.run_script(code, limits, time, |rows| add(&mut said, &rows)) {
            Ok(()) => Ok(said),
            Err(stopped) => {
                let refusal = query_refusal(stopped.error);
                let was_stopped = ["sql_timeout", SQL_CANCELLED].contains(&refusal.code);
                let kind = if was_stopped { "script_timeout" } else { "script_failed" };
                let (number, why) = (stopped.statement, refusal.message);
                let hint = hint_at_python(code).map(|hint| format!("; {hint}")).unwrap_or_default();
                let message =
                    format!("statement {number}: {why}; the ones before it changed nothing either{hint}");
                Err(Refusal::at("code", kind, message))
            }
        }
    }

    /// Runs all calculations on the current company. The output of a failed one is its error message. All
    /// calculations together have the time limit of one query.
    pub(super) fn run_calculations(&mut self, via: Via) -> Vec<Calculated> {
        let entries = self.surroundings.notebook.statements(Kept::Calculation).entries().to_vec();
        let (most, started) = (self.company().query_limits().time, Instant::now());
        let shown = self.simulation.params.limits.dashboard_calculation_max_chars as usize;
        let run = |(name, code): (String, String)| {
            let time = most.saturating_sub(started.elapsed());
            let said = match Language::of(&code) {
                _ if time.is_zero() => {
                    let message =
                        format!("the calculations before it used the {} s of a week", most.as_secs());
                    Err(Refusal::new("script_timeout", message))
                }
                Language::Sql => self.run_statements(&code, time),
                // Queries of calculations are not recorded.
                Language::Python => {
                    self.refuse_python(via).and_then(|()| self.run_python(&code, time, false))
                }
            };
            let output = match said {
                Ok(said) => said.results,
                Err(refusal) => format!("failed: {}", refusal.message),
            };
            Calculated { name, output: first(&output, shown) }
        };
        entries.into_iter().map(run).collect()
    }

    /// Adds a remark that lists the calculations in Python, because another user may have registered them.
    pub(super) fn name_python_calculations(&mut self) {
        let kept = self.surroundings.notebook.statements(Kept::Calculation).entries();
        let python = kept.iter().filter(|(_, code)| Language::of(code) == Language::Python);
        let names: Vec<&str> = python.map(|(name, _)| name.as_str()).collect();
        if !names.is_empty() && self.log.is_written() && self.history.ended.is_none() {
            let remark = format!("Calculations in Python run before each week: {}.", names.join(", "));
            self.remarks.push(remark);
        }
    }

    pub(super) fn keep(&mut self, change: &NotebookChange) {
        self.surroundings.notebook.apply(change);
    }
}
