//! Calculations and scripts of a run.
//!
//! Calculations and scripts are read-only SQL with the guard and the limits of a query, or Python code that sends
//! queries. Calls in the trajectory define calculations and scripts. The `advance` line of a week contains the output
//! of its calculations, so a resumed run shows the same dashboard without running them again.

use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::Session;
use crate::database::{RunDatabase, query_rejection, rows_to_json};
use crate::python::run::run_python;
use crate::python::{RawScriptOutput, ScriptHost, ScriptRequest, require_player, script_failed};
use novamind_database::query::{QueryLimits, SQL_CANCELLED};
use novamind_database::{QueryResult, text};
use novamind_record::trajectory::record::{CalculationOutput, QuerySource, Via};
use novamind_tools::{
    Language, NotebookChange, NotebookSection, Rejection, Script, ScriptOutput, python_marker_hint,
};

const MAX_OUTPUT_CHARACTERS: usize = 5000;
const MAX_REMARK_CHARACTERS: usize = 2000;

const OUTPUT_TRUNCATED: &str = "stdout is cut after 5,000 characters\n";

/// Appends a query result as a table, and its remarks, up to the length limits.
fn append_result(script_output: &mut RawScriptOutput, rows: &QueryResult) {
    if script_output.results.len() <= 4 * MAX_OUTPUT_CHARACTERS {
        script_output.results += &text::format_columns(rows);
    }
    for remark in [&rows.warning, &rows.hint].into_iter().flatten() {
        if script_output.remarks.len() <= 4 * MAX_REMARK_CHARACTERS {
            script_output.remarks += &format!("{remark}\n");
        }
    }
}

fn truncate(text: &str, most: usize) -> String {
    text.chars().take(most).collect()
}

impl Session {
    /// Disables Python, because the calls repeat recorded decisions.
    pub fn disable_python(&mut self) {
        self.context.is_python_disabled = true;
    }

    /// Executes the script of a tool call.
    ///
    /// # Errors
    /// `script_failed` or `script_timeout`, with the location in the script.
    pub(super) fn run_script(&mut self, script: &Script, via: Via) -> Result<ScriptOutput, Rejection> {
        let time = Duration::from_secs_f64(script.timeout_seconds);
        let script_output = match Language::detect(&script.code) {
            Language::Sql => self.run_statements(&script.code, time)?,
            Language::Python => {
                self.check_python_allowed(via)?;
                self.run_python(&script.code, time, true)?
            }
        };
        let stdout = truncate(&script_output.results, MAX_OUTPUT_CHARACTERS);
        let cut = if stdout.len() < script_output.results.len() { OUTPUT_TRUNCATED } else { "" };
        Ok(ScriptOutput {
            returncode: 0,
            stdout,
            stderr: truncate(&format!("{cut}{}", script_output.remarks), MAX_REMARK_CHARACTERS),
        })
    }

    /// Rejects Python unless a player executes the call.
    fn check_python_allowed(&self, via: Via) -> Result<(), Rejection> {
        let is_played = !matches!(via, Via::Policy | Via::Branch | Via::Lesson | Via::Import);
        require_player(is_played && !self.context.is_python_disabled)
    }

    /// Executes a Python script. Records the queries of the script if `records_queries` is true.
    fn run_python(
        &mut self,
        code: &str,
        time: Duration,
        records_queries: bool,
    ) -> Result<RawScriptOutput, Rejection> {
        let stop = self.up_to_date_database().and_then(RunDatabase::interrupt_handle);
        let stop = stop.map_err(|rejection| script_failed(rejection.message))?;
        let (ticket, mode) = (stop.issue_ticket(), self.manifest.mode);
        let mut answer = |request, left| self.answer_script_request(request, left, records_queries);
        let host = &mut ScriptHost { is_stopped: &|| stop.is_ticket_stopped(ticket), answer: &mut answer };
        run_python(code, time, mode, host)
    }

    fn answer_script_request(
        &mut self,
        request: ScriptRequest,
        left: Duration,
        records_queries: bool,
    ) -> Result<Value, Rejection> {
        match request {
            ScriptRequest::Vars => Ok(json!({ "current_day": self.day() })),
            ScriptRequest::Query { sql } => self
                .query_for_script(&sql, left, records_queries)
                .map(|rows| Value::Object(rows_to_json(&rows))),
        }
    }

    fn query_for_script(
        &mut self,
        sql: &str,
        left: Duration,
        records_queries: bool,
    ) -> Result<QueryResult, Rejection> {
        let started = Instant::now();
        let query_limits = self.company().query_limits();
        let limits = QueryLimits { time: query_limits.time.min(left), ..query_limits };
        let ticket = self.new_ticket()?;
        let answer = self.query_with_limits(ticket, sql, limits);
        if records_queries {
            self.record_query(sql, answer.as_ref(), started.elapsed(), QuerySource::Script);
        }
        answer
    }

    fn run_statements(&mut self, code: &str, time: Duration) -> Result<RawScriptOutput, Rejection> {
        let limits = self.company().query_limits();
        let connection = self.up_to_date_database().and_then(|database| database.connection());
        let connection =
            connection.map_err(|rejection| Rejection::new("script_failed", rejection.message))?;
        let mut script_output = RawScriptOutput::default();
        match connection.run_script(code, limits, time, |rows| append_result(&mut script_output, &rows)) {
            Ok(()) => Ok(script_output),
            Err(stopped) => {
                let rejection = query_rejection(stopped.error);
                let was_stopped = ["sql_timeout", SQL_CANCELLED].contains(&rejection.code);
                let kind = if was_stopped { "script_timeout" } else { "script_failed" };
                let (number, why) = (stopped.statement, rejection.message);
                let hint = python_marker_hint(code).map(|hint| format!("; {hint}")).unwrap_or_default();
                let message =
                    format!("statement {number}: {why}; the statements before it changed nothing{hint}");
                Err(Rejection::for_field("code", kind, message))
            }
        }
    }

    /// Executes all calculations on the current company. The output of a failed calculation is its error message. All
    /// calculations together have the time limit of one query.
    pub(super) fn run_calculations(&mut self, via: Via) -> Vec<CalculationOutput> {
        let entries = self.context.notebook.statements(NotebookSection::Calculation).entries().to_vec();
        let (most, started) = (self.company().query_limits().time, Instant::now());
        let shown = self.simulation.params.limits.dashboard_calculation_max_chars as usize;
        let run = |(name, code): (String, String)| {
            let time = most.saturating_sub(started.elapsed());
            let result = match Language::detect(&code) {
                _ if time.is_zero() => {
                    let message = format!("earlier calculations used all {} s of this week", most.as_secs());
                    Err(Rejection::new("script_timeout", message))
                }
                Language::Sql => self.run_statements(&code, time),
                // Do not record the queries of calculations.
                Language::Python => {
                    self.check_python_allowed(via).and_then(|()| self.run_python(&code, time, false))
                }
            };
            let output = match result {
                Ok(script_output) => script_output.results,
                Err(rejection) => format!("failed: {}", rejection.message),
            };
            CalculationOutput { name, output: truncate(&output, shown) }
        };
        entries.into_iter().map(run).collect()
    }

    /// Adds a remark that lists the Python calculations, because another user may have registered them.
    pub(super) fn report_python_calculations(&mut self) {
        let kept = self.context.notebook.statements(NotebookSection::Calculation).entries();
        let python = kept.iter().filter(|(_, code)| Language::detect(code) == Language::Python);
        let names: Vec<&str> = python.map(|(name, _)| name.as_str()).collect();
        if !names.is_empty() && self.log.is_written() && self.history.ended.is_none() {
            let remark = format!("Calculations in Python run before each week: {}.", names.join(", "));
            self.remarks.push(remark);
        }
    }

    pub(super) fn apply_notebook_change(&mut self, change: &NotebookChange) {
        self.context.notebook.apply(change);
    }
}
