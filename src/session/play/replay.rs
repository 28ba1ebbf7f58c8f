//! Replay of the lines of a trajectory.

use std::path::Path;
use std::sync::Arc;

use super::Session;
use crate::company::facts_chain::StateHash;
use crate::company::reports::DayReport;
use crate::company::run_context::RunContext;
use crate::database::RunDatabase;
use crate::recording::recorder::read_afterwards;
use crate::snapshot::file::{RestoredSession, Snapshot};
use novamind_database::{ProjectionEntry, ProjectionPosition, Projector};
use novamind_record::error::RunError;
use novamind_record::folder::manifest::Manifest;
use novamind_record::trajectory::record::{ClosedDays, Outcome};
use novamind_record::trajectory::{Line, Record, Trajectory, damaged_line_error};
use novamind_world::params::Params;

impl Session {
    /// Creates a session on day 0, or from a snapshot. Also returns the number of lines that the session includes.
    pub(crate) fn prepare_replay(
        manifest: Manifest,
        folder: &Path,
        params: Arc<Params>,
        lines: &[Line],
        snapshot: Option<&Snapshot>,
    ) -> (Session, usize) {
        let path = Some(folder.to_owned());
        let recall = |snapshot: &Snapshot| snapshot.restore_session(&manifest, &params, lines);
        let recalled = snapshot.and_then(|snapshot| Some((recall(snapshot)?, snapshot)));
        let Some((RestoredSession { simulation, history, notebook }, snapshot)) = recalled else {
            return (Session::new_read_only(manifest, path, params, None), 0);
        };
        let position = snapshot.position();
        let seen = position.seq as usize + 1;
        let context = RunContext { notebook, ..RunContext::default() };
        let mut session = Session::assemble(manifest, path, simulation, RunDatabase::default());
        session.log.set_position(position);
        (Session { history, context, ..session }, seen)
    }

    /// Applies all lines after the first `seen` lines. Writes only missing rows to the database. Calls `reached` after
    /// each line with the current day.
    pub(crate) fn replay(
        &mut self,
        path: &Path,
        trajectory: &Trajectory,
        seen: usize,
        database: Option<(Projector, Option<ProjectionPosition>)>,
        reached: &mut dyn FnMut(u32),
    ) -> Result<(), RunError> {
        let (mut projector, projected): (Option<Projector>, _) = database.unzip();
        let projected = projected.flatten();
        for line in trajectory.lines.iter().skip(seen) {
            let missing = projected.as_ref().is_none_or(|position| line.seq > position.seq);
            if missing && projector.is_some() {
                self.attach_projector(projector.take());
            }
            self.apply_line(path, line)?;
            reached(self.simulation.world.day);
        }
        if projector.is_some() {
            self.attach_projector(projector);
        }
        Ok(())
    }

    /// Attaches a database, to which the replay writes the rows of all following lines.
    fn attach_projector(&mut self, projector: Option<Projector>) {
        self.database = RunDatabase::new(projector);
        if self.simulation.overrides.has_changes() {
            let params = self.simulation.params.clone();
            self.database
                .entry_writer()
                .send(|| ProjectionEntry { params: Some(params), ..ProjectionEntry::default() });
        }
    }

    pub(crate) fn apply_line(&mut self, path: &Path, line: &Line) -> Result<(), RunError> {
        self.apply_line_with_progress(path, line, &mut |_| {})
    }

    /// Applies a line like [`Session::apply_line`], and calls `progress` for each simulated day.
    pub(crate) fn apply_line_with_progress(
        &mut self,
        path: &Path,
        line: &Line,
        progress: &mut dyn FnMut(&DayReport<'_>),
    ) -> Result<(), RunError> {
        self.log.set_position(line.position());
        let damaged = damaged_line_error(path);
        self.replay_line(line, progress).map_err(|problem| damaged((line.seq as usize + 1, problem)))
    }

    fn replay_line(&mut self, line: &Line, progress: &mut dyn FnMut(&DayReport<'_>)) -> Result<(), String> {
        match &line.record {
            Record::Start(_) => self.write_initial_rows(),
            Record::Call(call) => {
                self.history.idempotent_responses.record_call(call);
                if let Outcome::Accepted(answer) = &call.outcome {
                    self.replay_call(call, answer)?;
                }
            }
            Record::Advance(filed) => {
                self.history.idempotent_responses.start_week(filed.request.clone());
                self.replay_forecasts(filed, &line.at)?;
            }
            Record::Week(closing) | Record::Step(closing) => {
                let from = self.simulation.world.day;
                let state = self.run_days(from.saturating_add(closing.days_run), progress);
                self.verify_closed_days(from, &state, closing)?;
                self.record_replayed_week();
                self.commit_projection();
            }
            Record::End(end) => {
                self.record_end(end.reason);
                self.history.ended = Some(end.reason);
                self.commit_projection();
            }
            Record::Override(change) => self.replay_override(line.seq, change)?,
            Record::Voice(voice_answer) => self.replay_voice(voice_answer)?,
            Record::Query(query) => self.add_to_query_history(query),
            Record::Activity(_)
            | Record::Memo(_)
            | Record::Note(_)
            | Record::Branch(_)
            | Record::Unknown(_) => {}
        }
        Ok(())
    }

    /// Completes the figures of replayed days and compares the state with the recorded state.
    fn verify_closed_days(
        &mut self,
        from: u32,
        state: &StateHash,
        recorded: &ClosedDays,
    ) -> Result<(), String> {
        let figures = self.finish_figures();
        let reached = self.closing_record(from, &figures, state);
        self.simulation.facts_chain.close();
        if reached.state_hash == recorded.state_hash {
            return compare_figures(&reached, recorded);
        }
        let differs = |(name, hash): &(&String, &String)| recorded.parts.get(*name) != Some(*hash);
        let differing = reached.parts.iter().filter(differs).map(|(name, _)| name.as_str());
        let differing: Vec<&str> = differing.collect();
        Err(format!(
            "the state on day {} differs from the recorded state (different: {}); an earlier line was changed, or \
             another version recorded the run",
            self.simulation.world.day,
            differing.join(", ")
        ))
    }

    /// Simulates a week that was confirmed but not completed.
    pub(super) fn finish_week(&mut self, trajectory: &Trajectory) {
        let open = trajectory.lines.iter().rev().find_map(|line| match line.record {
            Record::Advance(_) => Some(true),
            Record::End(_) | Record::Week(_) | Record::Step(_) => Some(false),
            _ => None,
        });
        if open == Some(true) {
            let week = self.run_week(&mut |_| {});
            self.remarks.push(format!("The week up to day {} was simulated again.", week.figures.day));
        } else if self.history.ended.is_none() && self.simulation.world.is_over(&self.simulation.params) {
            // The program stopped after the last week and before appending the `end` line.
            let remark = self.close_if_over();
            self.commit_projection();
            self.remarks.extend(remark);
        }
    }

    /// Applies the lines that were recorded after the end of the run. Adds a remark if their file is damaged.
    pub(crate) fn replay_afterwards(&mut self, trajectory: &Trajectory) {
        let Some(folder) = self.folder.clone().filter(|_| self.history.ended.is_some()) else { return };
        match read_afterwards(&folder, trajectory) {
            Ok(after) => {
                self.log.load_answers(trajectory.lines.iter().chain(&after.lines));
                after.lines.iter().for_each(|line| self.replay_afterwards_line(line));
            }
            Err(problem) => {
                self.remarks.push(format!("{problem} Lines recorded after the end are not shown."))
            }
        }
    }

    /// Applies a line that was recorded after the end of the run. The line does not affect the company.
    fn replay_afterwards_line(&mut self, line: &Line) {
        match &line.record {
            Record::Query(query) => self.add_to_query_history(query),
            Record::Call(call) => {
                self.history.idempotent_responses.record_call(call);
                if let Outcome::Accepted(answer) = &call.outcome {
                    let _ = self.replay_call(call, answer);
                }
            }
            _ => {}
        }
    }
}

/// Compares the recorded figures with the figures that the replay computed from its state.
fn compare_figures(reached: &ClosedDays, recorded: &ClosedDays) -> Result<(), String> {
    let name = if reached.days_run != recorded.days_run {
        "days_run"
    } else if reached.figures != recorded.figures {
        "figures"
    } else if reached.cash != recorded.cash {
        "cash"
    } else {
        return Ok(());
    };
    Err(format!("the recorded {name} does not match the recorded state: the line was changed"))
}
