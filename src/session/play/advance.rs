//! Advancing the simulation by weeks and days.

use std::sync::Arc;

use serde_json::{Value, json};

use super::Session;
use super::tool_call::not_saved_rejection;
use crate::company::facts_chain::StateHash;
use crate::company::overrides::DerivedValues;
use crate::company::reports::{DayReport, WeekResult};
use crate::company::simulation::Simulation;
use crate::figures::journal::JournalEntry;
use crate::figures::week::Forecasts;
use crate::snapshot::file::SNAPSHOT_INTERVAL_WEEKS;
use novamind_database::{ForecastRow, ProjectionEntry, ProjectionError};
use novamind_record::clock::parse_seconds;
use novamind_record::figures::WeekFigures;
use novamind_record::trajectory::record::{Advance, ClosedDays, End, RequestId, RunEndReason, Via};
use novamind_record::trajectory::{Durability, Record};
use novamind_tools::{Rejection, ToolId, ToolKind};
use novamind_world::fixed_inputs::FixedInputs;

/// Recorded rationale of a week in lessons that do not ask for a rationale.
const NO_RATIONALE_TEXT: &str = "(not asked for in this lesson)";

pub(crate) struct WeekSubmission<'a> {
    pub(crate) rationale: &'a Value,
    pub(crate) predictions: &'a Value,
    /// Whether each forecast is a naive forecast, completely or partly.
    pub(crate) filled_naively: [bool; 4],
    /// Day on which the caller expects the run to be; null to skip the check.
    pub(crate) expected_day: &'a Value,
    pub(crate) request: Option<RequestId>,
}

impl Session {
    /// Submits a rationale and forecasts, then simulates the days until the next decision day, the last day or
    /// bankruptcy.
    ///
    /// # Errors
    /// `run_over`, `too_many_leads`, the rejections of next_week, `not_saved`. After an error, nothing has changed.
    pub fn advance(
        &mut self,
        rationale: &str,
        forecasts: &Forecasts,
        via: Via,
        progress: &mut dyn FnMut(&DayReport<'_>),
    ) -> Result<WeekResult, Rejection> {
        let predictions = forecasts.to_predictions();
        self.advance_with_json(&json!(rationale), &predictions, forecasts.filled_naively, via, progress)
    }

    /// Simulates a week like [`Session::advance`], with rationale and predictions as JSON.
    ///
    /// # Errors
    /// The same errors as [`Session::advance`].
    pub fn advance_with_json(
        &mut self,
        rationale: &Value,
        predictions: &Value,
        filled_naively: [bool; 4],
        via: Via,
        progress: &mut dyn FnMut(&DayReport<'_>),
    ) -> Result<WeekResult, Rejection> {
        let submission = WeekSubmission {
            rationale,
            predictions,
            filled_naively,
            expected_day: &Value::Null,
            request: None,
        };
        self.submit_week(submission, via, progress)
    }

    pub(crate) fn submit_week(
        &mut self,
        submission: WeekSubmission<'_>,
        via: Via,
        progress: &mut dyn FnMut(&DayReport<'_>),
    ) -> Result<WeekResult, Rejection> {
        let WeekSubmission { rationale, predictions, filled_naively, expected_day, request } = submission;
        let allowed = self.check_lesson_week(via).and_then(|()| self.check_can_act(ToolKind::Time));
        let allowed = allowed.and_then(|()| self.check_expected_day(expected_day));
        let unasked = Value::from(NO_RATIONALE_TEXT);
        let asks_none = self.lesson().is_some_and(|lesson| lesson.access().is_rationale_off());
        let rationale = if asks_none { &unasked } else { rationale };
        let checked = allowed.and_then(|()| {
            let text = novamind_tools::parse_rationale(rationale)?;
            let all = novamind_tools::parse_forecasts(
                predictions,
                &self.simulation.params.limits.prediction_horizons_days,
            )?;
            self.simulation.check_lead_capacity()?;
            Ok((text, Forecasts { all, filled_naively }))
        });
        let (text, forecasts) = match checked {
            Ok(checked) => checked,
            Err(rejection) => {
                let arguments = week_arguments(rationale, predictions, expected_day);
                // Release 2 validates a week before it stores the id, so a corrected week can have the same id.
                let request = request.filter(|_| !self.has_release_2_interface());
                self.record_rejection(ToolId::NextWeek.name(), &arguments, via, &rejection, request);
                return Err(rejection);
            }
        };
        self.prepare_lesson_week()?;
        let calculated = self.run_calculations(via);
        let filed = Advance {
            rationale: text.clone(),
            forecasts: forecasts.to_submitted(),
            via,
            calculations: calculated.clone(),
            request: request.clone(),
        };
        let at =
            self.append(&Record::Advance(filed), self.log.call_durability()).map_err(not_saved_rejection)?;
        self.history.idempotent_responses.start_week(request);
        self.history.calculation_outputs = calculated;
        self.store_forecasts(text, &forecasts, &at);
        Ok(self.run_week(progress))
    }

    fn check_expected_day(&self, expected: &Value) -> Result<(), Rejection> {
        let day = self.simulation.world.day;
        if expected.is_null() || expected.as_u64() == Some(day.into()) {
            return Ok(());
        }
        let (code, message) = match expected.is_i64() || expected.is_u64() {
            true => (
                "unexpected_day",
                format!("the run is on day {day}, not on day {expected}; no day has passed"),
            ),
            false => {
                ("wrong_type", "expected_day must be a whole number: the current day of the run".to_owned())
            }
        };
        Err(Rejection::for_field("expected_day", code, message))
    }

    /// Simulates single days of a debug run, up to the end of the week.
    ///
    /// # Errors
    /// One of the rejections `not_in_this_mode`, `run_over`, `too_many_leads`, `not_saved`.
    pub fn step(
        &mut self,
        days: u32,
        progress: &mut dyn FnMut(&DayReport<'_>),
    ) -> Result<WeekResult, Rejection> {
        self.step_while(&|_| true, days, progress)
    }

    /// Simulates single days like [`Session::step`], but stops after a day for which `goes_on` returns false.
    ///
    /// # Errors
    /// The same errors as [`Session::step`].
    pub(crate) fn step_while(
        &mut self,
        goes_on: &dyn Fn(u32) -> bool,
        days: u32,
        progress: &mut dyn FnMut(&DayReport<'_>),
    ) -> Result<WeekResult, Rejection> {
        self.check_can_step()?;
        self.simulation.check_lead_capacity()?;
        let from = self.simulation.world.day;
        let until = self.company().next_decision_day().min(from.saturating_add(days.max(1)));
        let goes_on =
            |day: &Simulation| (day.world.day == from || goes_on(day.world.day)) && has_lead_capacity(day);
        let last_day = self.run_days_while(&goes_on, until, progress);
        Ok(self.close_days(Record::Step, from, last_day))
    }

    /// Checks that single days of the run can be simulated.
    ///
    /// # Errors
    /// One of the rejections `not_in_this_mode`, `run_over`.
    pub(crate) fn check_can_step(&self) -> Result<(), Rejection> {
        if self.manifest.mode != novamind_record::mode::Mode::Debug {
            return Err(Rejection::new(
                "not_in_this_mode",
                "single days can be simulated in debug runs only",
            ));
        }
        self.check_can_act(ToolKind::Time)
    }

    /// Abandons an unfinished run permanently.
    ///
    /// # Errors
    /// `run_over`, `not_saved`. After an error, nothing has changed.
    pub fn abandon(&mut self) -> Result<(), Rejection> {
        self.check_can_act(ToolKind::Time)?;
        let end =
            End { reason: RunEndReason::Abandoned, cash: self.simulation.world.finance.cash, score: None };
        self.append(&Record::End(end), Durability::Synced).map_err(not_saved_rejection)?;
        self.history.ended = Some(RunEndReason::Abandoned);
        self.commit_projection();
        Ok(())
    }

    /// Simulates and closes the week of an `advance` line. The simulation stops before a day that would exceed the lead
    /// limit.
    pub(crate) fn run_week(&mut self, progress: &mut dyn FnMut(&DayReport<'_>)) -> WeekResult {
        let (from, until) = (self.simulation.world.day, self.company().next_decision_day());
        let last_day = self.run_days_while(&has_lead_capacity, until, progress);
        let Simulation { world, params, .. } = &self.simulation;
        let is_whole = world.day == until || world.is_over(params);
        self.close_days(if is_whole { Record::Week } else { Record::Step }, from, last_day)
    }

    /// Simulates days until `until` or bankruptcy. Returns the state hash after the last day.
    pub(crate) fn run_days(&mut self, until: u32, progress: &mut dyn FnMut(&DayReport<'_>)) -> StateHash {
        let last_day = self.run_days_while(&|_| true, until, progress);
        self.simulation.finish_days(self.database.entry_writer(), last_day)
    }

    /// Simulates days while `goes_on` returns true. Returns the notices of the last simulated day, whose facts are not
    /// processed yet.
    fn run_days_while(
        &mut self,
        goes_on: &dyn Fn(&Simulation) -> bool,
        until: u32,
        progress: &mut dyn FnMut(&DayReport<'_>),
    ) -> Option<Vec<String>> {
        let week_end = self.company().next_decision_day();
        self.voice.start_week();
        self.history.notices.clear();
        let (mut day_before, nothing) = (None, FixedInputs::default());
        let params = self.simulation.params.clone();
        while self.simulation.world.day < until && !self.simulation.world.is_over(&self.simulation.params) {
            if !goes_on(&self.simulation) {
                break;
            }
            let figures =
                self.simulation.simulate_day(&nothing, self.database.entry_writer(), day_before.take());
            self.score_pending_posts();
            self.simulation.judge_own_posts(self.database.entry_writer());
            let notices = self.simulation.notice_texts();
            self.history.record_day(&figures, &self.simulation, &notices);
            let debug = self.manifest.mode == novamind_record::mode::Mode::Debug;
            let xray = (debug || self.is_replay).then(|| self.hidden_state());
            progress(&DayReport { figures: &figures, week_end, xray });
            self.history.call_ledger.clear();
            day_before = Some(notices);
        }
        if !Arc::ptr_eq(&params, &self.simulation.params) {
            self.derived_values = DerivedValues::default();
        }
        day_before
    }

    /// Processes the facts of the last day and hashes the state. For runs in memory, the hash is empty, because it is
    /// not recorded.
    fn finish_days(&mut self, last_day: Option<Vec<String>>) -> StateHash {
        let entries = self.database.entry_writer();
        if self.log.is_on_disk() {
            return self.simulation.finish_days(entries, last_day);
        }
        self.simulation.process_last_day(entries, last_day);
        StateHash::default()
    }

    pub(crate) fn finish_figures(&mut self) -> WeekFigures {
        let open_issues = self.simulation.open_issues();
        let figures = self.history.finish_days(&self.simulation, self.manifest.cash, open_issues);
        self.history.last_dashboard = Some(self.company().build_dashboard(figures.open_issues));
        figures
    }

    /// Writes the line that closes simulated days. Returns the report on the days, with a remark if the line could not
    /// be written.
    fn close_days(
        &mut self,
        kind: fn(ClosedDays) -> Record,
        from: u32,
        last_day: Option<Vec<String>>,
    ) -> WeekResult {
        let state = self.finish_days(last_day);
        let figures = self.finish_figures();
        let closing = self.closing_record(from, &figures, &state);
        let record = kind(closing);
        let is_week = matches!(record, Record::Week(_));
        let unclosed = self.append_irrevocable(&record);
        self.simulation.facts_chain.close();
        self.finish_lesson_week();
        if unclosed.is_none() {
            self.reword_posts_after(from);
        }
        // The run ends even if the line of its last week is not saved: this line and the `end` line stay in memory
        // until the disk is writable.
        let problem = match self.pending_end_reason() {
            Some(ended) => self.close_run(ended),
            None => unclosed,
        };
        let due = self.history.weeks.len().is_multiple_of(SNAPSHOT_INTERVAL_WEEKS)
            && self.history.current_week.days_run == 0;
        let snapshot = due && problem.is_none() && self.log.call_durability() == Durability::Synced;
        // An `advance` line precedes a week, but not single days.
        let next = match is_week {
            true => "the days are simulated again when the run is opened, with the same result",
            false => {
                "these days are lost if the program ends before they are saved: free some disk space, then step again"
            }
        };
        let unsaved = problem.map(|problem| format!("{problem}; {next}"));
        let crowded = self.simulation.check_lead_capacity().err().filter(|_| self.history.ended.is_none());
        let remark = unsaved.or(crowded.map(|rejection| rejection.message));
        let remarks = remark.into_iter().chain(self.database_remark()).chain(self.voice.take_notice());
        let remarks: Vec<String> = remarks.collect();
        let week = self.week_result((!remarks.is_empty()).then(|| remarks.join(". ")));
        self.history.idempotent_responses.record_week(|| week.clone());
        // The database is written after progress was reported, because writing competes for processors.
        if snapshot {
            self.save_snapshot(|| state.0, false);
        } else {
            self.commit_projection();
        }
        week
    }

    /// Closes a run that has reached its last day or is bankrupt. The caller must commit the database.
    pub(crate) fn close_if_over(&mut self) -> Option<String> {
        self.pending_end_reason().and_then(|ended| self.close_run(ended))
    }

    /// Returns the reason for the end of the run, if the run is over and not closed yet.
    fn pending_end_reason(&self) -> Option<RunEndReason> {
        let Simulation { world, params, .. } = &self.simulation;
        let due = if world.finance.is_bankrupt(params) {
            Some(RunEndReason::Bankruptcy)
        } else {
            world.is_over(params).then_some(RunEndReason::Horizon)
        };
        due.filter(|_| self.history.ended.is_none())
    }

    /// Describes a failure to write world.db. Rows are written after the week was reported, so a failure is reported
    /// with the next week. After the last week, waits until all rows are written.
    fn database_remark(&self) -> Option<String> {
        if self.history.ended.is_some() {
            self.commit_projection();
            let _ = self.database.wait_until_written();
        }
        let ProjectionError(problem) = self.database.failure()?;
        let recovery = match self.folder {
            Some(_) => {
                "The run is safe: its record, trajectory.jsonl, is complete. Free some disk space; the next query or \
                 the next opening of the run rebuilds world.db"
            }
            None => "Queries do not return these rows",
        };
        Some(format!(
            "The database could not be written ({problem}), so the newest rows are missing. {recovery}"
        ))
    }

    pub(crate) fn close_run(&mut self, ended: RunEndReason) -> Option<String> {
        self.history.ended = Some(ended);
        self.record_end(ended);
        let end = End { reason: ended, cash: self.simulation.world.finance.cash, score: self.score() };
        self.append_irrevocable(&Record::End(end))
    }

    pub(crate) fn record_replayed_week(&mut self) {
        let mut answers = std::mem::take(&mut self.history.idempotent_responses);
        answers.record_week(|| self.week_result(None));
        self.history.idempotent_responses = answers;
    }

    /// Adds the reason for the end of the run to the response for its last week, unless the run was abandoned.
    pub(crate) fn record_end(&mut self, ended: RunEndReason) {
        if ended != RunEndReason::Abandoned {
            self.history.idempotent_responses.record_end(self.simulation.world.day, ended);
        }
    }

    /// Returns the content of the line that closes days. A replay must reproduce this content.
    pub(crate) fn closing_record(&self, from: u32, figures: &WeekFigures, state: &StateHash) -> ClosedDays {
        let (state_hash, parts) = state.clone();
        ClosedDays {
            days_run: self.simulation.world.day - from,
            figures: figures.to_json(),
            cash: self.simulation.world.finance.cash,
            state_hash,
            parts,
        }
    }

    fn week_result(&self, remark: Option<String>) -> WeekResult {
        WeekResult {
            figures: self.history.latest_week(),
            dashboard: self.company().dashboard(),
            notices: self.history.notices.clone(),
            ended: self.history.ended,
            remark,
        }
    }

    fn store_forecasts(&mut self, rationale: String, forecasts: &Forecasts, at: &str) {
        self.write_forecast_rows(forecasts, at);
        self.history.journal.push(JournalEntry::Advance {
            day: self.simulation.world.day,
            rationale,
            forecasts: forecasts.all.to_vec(),
            filled_naively: forecasts.filled_naively,
        });
    }

    pub(crate) fn replay_forecasts(&mut self, filed: &Advance, at: &str) -> Result<(), String> {
        let forecasts =
            Forecasts::from_submitted(&filed.forecasts).ok_or("the line does not have four forecasts")?;
        self.history.calculation_outputs.clone_from(&filed.calculations);
        self.store_forecasts(filed.rationale.clone(), &forecasts, at);
        Ok(())
    }

    fn write_forecast_rows(&self, forecasts: &Forecasts, at: &str) {
        let submitted_at = parse_seconds(at);
        let row = |forecast: &novamind_tools::Forecast| ForecastRow {
            submit_day: self.simulation.world.day,
            horizon_days: forecast.horizon_days,
            point: forecast.point,
            lower: forecast.lower,
            upper: forecast.upper,
            submitted_at,
        };
        let rows = || forecasts.all.iter().map(row).collect();
        self.database
            .entry_writer()
            .send(|| ProjectionEntry { forecasts: rows(), ..ProjectionEntry::default() });
    }
}

fn has_lead_capacity(simulation: &Simulation) -> bool {
    simulation.check_lead_capacity().is_ok()
}

/// Returns the arguments that are recorded for a rejected week.
pub(crate) fn week_arguments(rationale: &Value, predictions: &Value, expected_day: &Value) -> Value {
    let mut args = json!({ "rationale": rationale, "predictions": predictions });
    if !expected_day.is_null() {
        args["expected_day"] = expected_day.clone();
    }
    args
}
