//! Advancing the simulation by weeks and days.

use std::sync::Arc;

use serde_json::{Value, json};

use super::Session;
use super::act::not_saved;
use crate::company::facts_chain::StateHash;
use crate::company::overrides::DerivedOfParameters;
use crate::company::reports::{DayReport, Week};
use crate::company::simulation::Simulation;
use crate::figures::journal::JournalEntry;
use crate::figures::week::Forecasts;
use crate::snapshot::file::WEEKS_BETWEEN;
use novamind_database::{Entry, ForecastRow, ProjectionError};
use novamind_record::clock::seconds;
use novamind_record::figures::WeekFigures;
use novamind_record::trajectory::record::{Advance, Closing, End, Ended, RequestId, Via};
use novamind_record::trajectory::{Durability, Record};
use novamind_tools::{Kind, Refusal, ToolId};
use novamind_world::held::Held;

/// Recorded rationale of a week in lessons that ask for none.
const UNASKED: &str = "(not asked for in this lesson)";

pub(crate) struct Filing<'a> {
    pub(crate) rationale: &'a Value,
    pub(crate) predictions: &'a Value,
    /// Whether the naive projection filled in each forecast.
    pub(crate) filled_naively: [bool; 4],
    /// The day on which the run must be; null for any.
    pub(crate) expected_day: &'a Value,
    pub(crate) request: Option<RequestId>,
}

impl Session {
    /// Submits rationale and forecasts and simulates the days until the next decision day, the last day or
    /// bankruptcy.
    ///
    /// # Errors
    /// `run_over`, `too_many_leads`, the rejections of next_week, `not_saved`. Nothing has happened then.
    pub fn advance(
        &mut self,
        rationale: &str,
        forecasts: &Forecasts,
        via: Via,
        progress: &mut dyn FnMut(&DayReport<'_>),
    ) -> Result<Week, Refusal> {
        let predictions = forecasts.as_predictions();
        self.advance_given(&json!(rationale), &predictions, forecasts.filled_naively, via, progress)
    }

    /// Like [`Session::advance`], with rationale and predictions as JSON.
    ///
    /// # Errors
    /// As [`Session::advance`].
    pub fn advance_given(
        &mut self,
        rationale: &Value,
        predictions: &Value,
        filled_naively: [bool; 4],
        via: Via,
        progress: &mut dyn FnMut(&DayReport<'_>),
    ) -> Result<Week, Refusal> {
        let filing =
            Filing { rationale, predictions, filled_naively, expected_day: &Value::Null, request: None };
        self.file_week(filing, via, progress)
    }

    pub(crate) fn file_week(
        &mut self,
        filing: Filing<'_>,
        via: Via,
        progress: &mut dyn FnMut(&DayReport<'_>),
    ) -> Result<Week, Refusal> {
        let Filing { rationale, predictions, filled_naively, expected_day, request } = filing;
        let allowed = self.refuse_week_of_lesson(via).and_then(|()| self.refuse_if_over(Kind::Time));
        let allowed = allowed.and_then(|()| self.refuse_unexpected_day(expected_day));
        let unasked = Value::from(UNASKED);
        let asks_none = self.lesson().is_some_and(|lesson| lesson.access().asks_no_rationale());
        let rationale = if asks_none { &unasked } else { rationale };
        let checked = allowed.and_then(|()| {
            let text = novamind_tools::rationale(rationale)?;
            let all = novamind_tools::forecasts(
                predictions,
                &self.simulation.params.limits.prediction_horizons_days,
            )?;
            self.simulation.refuse_crowded_day()?;
            Ok((text, Forecasts { all, filled_naively }))
        });
        let (text, forecasts) = match checked {
            Ok(checked) => checked,
            Err(refusal) => {
                let arguments = arguments_of_week(rationale, predictions, expected_day);
                self.record_refusal(ToolId::NextWeek.name(), &arguments, via, &refusal, request);
                return Err(refusal);
            }
        };
        self.prepare_week_of_lesson()?;
        let calculated = self.run_calculations(via);
        let filed = Advance {
            rationale: text.clone(),
            forecasts: forecasts.filed(),
            via,
            calculations: calculated.clone(),
            request: request.clone(),
        };
        let at = self.append(&Record::Advance(filed), self.log.durability_of_calls()).map_err(not_saved)?;
        self.history.first_answers.begin_week(request);
        self.history.calculated = calculated;
        self.file(text, &forecasts, &at);
        Ok(self.run_week(progress))
    }

    fn refuse_unexpected_day(&self, expected: &Value) -> Result<(), Refusal> {
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
                ("wrong_type", "expected_day must be a whole number: the day on which the run is".to_owned())
            }
        };
        Err(Refusal::at("expected_day", code, message))
    }

    /// Simulates single days of a debug run, at most to the end of the week.
    ///
    /// # Errors
    /// `not_in_this_mode`, `run_over`, `too_many_leads`, `not_saved`.
    pub fn step(&mut self, days: u32, progress: &mut dyn FnMut(&DayReport<'_>)) -> Result<Week, Refusal> {
        self.step_while(&|_| true, days, progress)
    }

    /// Like [`Session::step`]; stops after a day for which `goes_on` returns false.
    ///
    /// # Errors
    /// As [`Session::step`].
    pub(crate) fn step_while(
        &mut self,
        goes_on: &dyn Fn(u32) -> bool,
        days: u32,
        progress: &mut dyn FnMut(&DayReport<'_>),
    ) -> Result<Week, Refusal> {
        self.refuse_to_step()?;
        self.simulation.refuse_crowded_day()?;
        let from = self.simulation.world.day;
        let until = self.company().next_decision_day().min(from.saturating_add(days.max(1)));
        let goes_on = |day: &Simulation| (day.world.day == from || goes_on(day.world.day)) && has_room(day);
        let last_day = self.run_days_while(&goes_on, until, progress);
        Ok(self.close_days(Record::Step, from, last_day))
    }

    /// Checks that single days can be simulated.
    ///
    /// # Errors
    /// `not_in_this_mode`, `run_over`.
    pub(crate) fn refuse_to_step(&self) -> Result<(), Refusal> {
        if self.manifest.mode != novamind_record::mode::Mode::Debug {
            return Err(Refusal::new("not_in_this_mode", "single days can be stepped in debug runs only"));
        }
        self.refuse_if_over(Kind::Time)
    }

    /// Abandons an unfinished run permanently.
    ///
    /// # Errors
    /// `run_over`, `not_saved`. Nothing has happened then.
    pub fn end(&mut self) -> Result<(), Refusal> {
        self.refuse_if_over(Kind::Time)?;
        let end = End { reason: Ended::Abandoned, cash: self.simulation.world.finance.cash, score: None };
        self.append(&Record::End(end), Durability::Synced).map_err(not_saved)?;
        self.history.ended = Some(Ended::Abandoned);
        self.commit_projection();
        Ok(())
    }

    /// Simulates the week of an `advance` line and closes it. The week ends early before a day that would exceed the
    /// limit of leads.
    pub(crate) fn run_week(&mut self, progress: &mut dyn FnMut(&DayReport<'_>)) -> Week {
        let (from, until) = (self.simulation.world.day, self.company().next_decision_day());
        let last_day = self.run_days_while(&has_room, until, progress);
        let Simulation { world, params, .. } = &self.simulation;
        let is_whole = world.day == until || world.is_over(params);
        self.close_days(if is_whole { Record::Week } else { Record::Step }, from, last_day)
    }

    /// Simulates days until `until` or bankruptcy. Returns the hash of the state reached.
    pub(crate) fn run_days(&mut self, until: u32, progress: &mut dyn FnMut(&DayReport<'_>)) -> StateHash {
        let last_day = self.run_days_while(&|_| true, until, progress);
        self.simulation.end_days(self.database.entries(), last_day)
    }

    /// Simulates days while `goes_on` returns true. Returns the notices of the last simulated day, whose facts are
    /// not processed yet.
    fn run_days_while(
        &mut self,
        goes_on: &dyn Fn(&Simulation) -> bool,
        until: u32,
        progress: &mut dyn FnMut(&DayReport<'_>),
    ) -> Option<Vec<String>> {
        let week_end = self.company().next_decision_day();
        self.voice.begin_week();
        self.history.notices.clear();
        let (mut day_before, nothing) = (None, Held::default());
        let params = self.simulation.params.clone();
        while self.simulation.world.day < until && !self.simulation.world.is_over(&self.simulation.params) {
            if !goes_on(&self.simulation) {
                break;
            }
            let figures = self.simulation.simulate_day(&nothing, self.database.entries(), day_before.take());
            self.ask_readers();
            self.simulation.judge_own_posts(self.database.entries());
            let notices = self.simulation.notice_texts();
            self.history.count_day(&figures, &self.simulation, &notices);
            let debug = self.manifest.mode == novamind_record::mode::Mode::Debug;
            let xray = (debug || self.is_shadow).then(|| self.hidden_state());
            progress(&DayReport { figures: &figures, week_end, xray });
            self.history.called.clear();
            day_before = Some(notices);
        }
        if !Arc::ptr_eq(&params, &self.simulation.params) {
            self.derived = DerivedOfParameters::default();
        }
        day_before
    }

    /// Processes the facts of the last day and hashes the state. For runs in memory the hash is empty, because no
    /// line contains it.
    fn end_days(&mut self, last_day: Option<Vec<String>>) -> StateHash {
        let entries = self.database.entries();
        if self.log.is_on_disk() {
            return self.simulation.end_days(entries, last_day);
        }
        self.simulation.follow_last_day(entries, last_day);
        StateHash::default()
    }

    pub(crate) fn settle_figures(&mut self) -> WeekFigures {
        let open_issues = self.simulation.open_issues();
        let figures = self.history.settle(&self.simulation, self.manifest.cash, open_issues);
        self.history.last_dashboard = Some(self.company().build_dashboard(figures.open_issues));
        figures
    }

    /// Writes the line that closes simulated days. Returns the report, with a remark if the line could not be
    /// written.
    fn close_days(&mut self, kind: fn(Closing) -> Record, from: u32, last_day: Option<Vec<String>>) -> Week {
        let state = self.end_days(last_day);
        let figures = self.settle_figures();
        let closing = self.closing(from, &figures, &state);
        let record = kind(closing);
        let is_week = matches!(record, Record::Week(_));
        let unclosed = self.append_done(&record);
        self.simulation.facts_chain.close();
        self.settle_lesson();
        if unclosed.is_none() {
            self.word_days_after(from);
        }
        // The run ends even if the line of its last week is not saved: both lines wait for the disk.
        let problem = match self.due_end() {
            Some(ended) => self.close_run(ended),
            None => unclosed,
        };
        let due =
            self.history.weeks.len().is_multiple_of(WEEKS_BETWEEN) && self.history.running_week.days_run == 0;
        let snapshot = due && problem.is_none() && self.log.durability_of_calls() == Durability::Synced;
        // A week has an `advance` line before it, single days do not.
        let next = match is_week {
            true => "the days are simulated again when the run is opened, with the same result",
            false => {
                "these days are lost if the program ends before they are saved: free some disk space, then step again"
            }
        };
        let unsaved = problem.map(|problem| format!("{problem}; {next}"));
        let crowded = self.simulation.refuse_crowded_day().err().filter(|_| self.history.ended.is_none());
        let remark = unsaved.or(crowded.map(|refusal| refusal.message));
        let remarks = remark.into_iter().chain(self.database_remark()).chain(self.voice.take_notice());
        let remarks: Vec<String> = remarks.collect();
        let week = self.report((!remarks.is_empty()).then(|| remarks.join(". ")));
        self.history.first_answers.note_week(|| week.clone());
        // The database is written after progress was reported, because it competes for processors.
        if snapshot {
            self.keep_snapshot(|| state.0, false);
        } else {
            self.commit_projection();
        }
        week
    }

    /// Closes a run that has reached its last day or bankruptcy. The caller commits the database.
    pub(crate) fn close_if_over(&mut self) -> Option<String> {
        self.due_end().and_then(|ended| self.close_run(ended))
    }

    /// Returns how the run ends, if it has ended and is not closed.
    fn due_end(&self) -> Option<Ended> {
        let Simulation { world, params, .. } = &self.simulation;
        let due = if world.finance.is_bankrupt(params) {
            Some(Ended::Bankruptcy)
        } else {
            world.is_over(params).then_some(Ended::Horizon)
        };
        due.filter(|_| self.history.ended.is_none())
    }

    /// Describes a failure to write world.db. Rows are written after the week was reported, so a failure is reported
    /// with the next week. After the last week, waits for its rows.
    fn database_remark(&self) -> Option<String> {
        if self.history.ended.is_some() {
            self.commit_projection();
            let _ = self.database.wait();
        }
        let ProjectionError(problem) = self.database.failure()?;
        let recovery = match self.folder {
            Some(_) => {
                "The run is safe: world.db is rebuilt from its record, trajectory.jsonl. Free some disk space; the \
                 next query or the next opening of the run rebuilds it"
            }
            None => "Queries do not return them",
        };
        Some(format!("The database could not be written ({problem}): it lacks the newest rows. {recovery}"))
    }

    pub(crate) fn close_run(&mut self, ended: Ended) -> Option<String> {
        self.history.ended = Some(ended);
        self.note_end(ended);
        let end = End { reason: ended, cash: self.simulation.world.finance.cash, score: self.score() };
        self.append_done(&Record::End(end))
    }

    pub(crate) fn note_answered_week(&mut self) {
        let mut answers = std::mem::take(&mut self.history.first_answers);
        answers.note_week(|| self.report(None));
        self.history.first_answers = answers;
    }

    /// Adds the end of the run to the response to its last week, unless the run was abandoned.
    pub(crate) fn note_end(&mut self, ended: Ended) {
        if ended != Ended::Abandoned {
            self.history.first_answers.note_end(self.simulation.world.day, ended);
        }
    }

    /// Returns the record that closes days, which a replay must reproduce.
    pub(crate) fn closing(&self, from: u32, figures: &WeekFigures, state: &StateHash) -> Closing {
        let (state_hash, parts) = state.clone();
        Closing {
            days_run: self.simulation.world.day - from,
            figures: figures.as_json(),
            cash: self.simulation.world.finance.cash,
            state_hash,
            parts,
        }
    }

    fn report(&self, remark: Option<String>) -> Week {
        Week {
            figures: self.history.latest_week(),
            dashboard: self.company().dashboard(),
            notices: self.history.notices.clone(),
            ended: self.history.ended,
            remark,
        }
    }

    fn file(&mut self, rationale: String, forecasts: &Forecasts, at: &str) {
        self.project_forecasts(forecasts, at);
        self.history.journal.push(JournalEntry::Advance {
            day: self.simulation.world.day,
            rationale,
            forecasts: forecasts.all.to_vec(),
            filled_naively: forecasts.filled_naively,
        });
    }

    pub(crate) fn replay_forecasts(&mut self, filed: &Advance, at: &str) -> Result<(), String> {
        let forecasts = Forecasts::of(&filed.forecasts).ok_or("the line does not have four forecasts")?;
        self.history.calculated.clone_from(&filed.calculations);
        self.file(filed.rationale.clone(), &forecasts, at);
        Ok(())
    }

    fn project_forecasts(&self, forecasts: &Forecasts, at: &str) {
        let submitted_at = seconds(at);
        let row = |forecast: &novamind_tools::Forecast| ForecastRow {
            submit_day: self.simulation.world.day,
            horizon_days: forecast.horizon_days,
            point: forecast.point,
            lower: forecast.lower,
            upper: forecast.upper,
            submitted_at,
        };
        let rows = || forecasts.all.iter().map(row).collect();
        self.database.entries().write(|| Entry { forecasts: rows(), ..Entry::default() });
    }
}

fn has_room(simulation: &Simulation) -> bool {
    simulation.refuse_crowded_day().is_ok()
}

/// Returns the arguments of a week as its rejection records them.
pub(crate) fn arguments_of_week(rationale: &Value, predictions: &Value, expected_day: &Value) -> Value {
    let mut args = json!({ "rationale": rationale, "predictions": predictions });
    if !expected_day.is_null() {
        args["expected_day"] = expected_day.clone();
    }
    args
}
