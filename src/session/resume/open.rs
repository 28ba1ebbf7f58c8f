//! Going on with a run: reading its trajectory and simulating it again.

use std::path::Path;
use std::sync::Arc;

use super::integrity::Integrity;
use super::sealing::SealKey;
use super::snapshot::{Recalled, Snapshot};
use super::unnamed::remove_leftovers;
use crate::play::advance::DayReport;
use crate::play::facts_chain::StateHash;
use crate::play::personal_clock::PersonalClock;
use crate::play::projection::Projection;
use crate::play::recorder::Recorder;
use crate::play::surroundings::RunSurroundings;
use crate::state::Session;
use novamind_database::{Entry, Location, Position, Projector};
use novamind_record::error::RunError;
use novamind_record::folder::derived::{Derived, check_start};
use novamind_record::folder::lock::lock_run;
use novamind_record::folder::manifest::Manifest;
use novamind_record::folder::runs::find_run;
use novamind_record::trajectory::record::{Activity, Closing, Outcome};
use novamind_record::trajectory::{Line, Record, Trajectory, damaged_at};
use novamind_world::params::Params;

/// What may be done with an opened run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// Go on with it. One program at a time.
    Write,
    /// Look at it; nothing of it is changed.
    Read,
}

/// How a reading command keeps what it had to simulate.
#[derive(Clone, Copy)]
pub(crate) struct Keeping {
    /// Returns whether the end of the run may be kept.
    pub(crate) may_keep: fn(&Path, &Manifest, &Trajectory, &SealKey) -> bool,
    /// Keeps snapshot and database. Returns whether they were kept.
    pub(crate) keep_database: fn(&Path, &SealKey) -> bool,
    /// Keeps the snapshot.
    pub(crate) keep_snapshot: fn(&Session, &Path),
}

/// The screen that a line says was left, and the day.
fn view(line: &Line) -> Option<(String, u32)> {
    match &line.record {
        Record::Activity(Activity::View(view)) => Some((view.screen.clone(), line.day)),
        _ => None,
    }
}

impl Session {
    /// Opens the run in a folder and simulates it up to its last line.
    ///
    /// # Errors
    /// The run is missing, damaged, of another version, or in use; the error names the place and what is safe.
    pub fn open(folder: &Path, access: Access, projection: bool) -> Result<Session, RunError> {
        Session::open_sealed(folder, access, projection, SealKey::default())
    }

    /// As [`Session::open`], for a run whose snapshots a key seals.
    ///
    /// # Errors
    /// The same.
    pub fn open_sealed(
        folder: &Path,
        access: Access,
        projection: bool,
        key: SealKey,
    ) -> Result<Session, RunError> {
        Session::open_and_keep(folder, access, projection, key, None)
    }

    /// As [`Session::open_sealed`]. If `keeping` is given, what a reading command had to simulate is kept.
    ///
    /// # Errors
    /// The same.
    pub(crate) fn open_and_keep(
        folder: &Path,
        access: Access,
        projection: bool,
        key: SealKey,
        keeping: Option<Keeping>,
    ) -> Result<Session, RunError> {
        let derived = Derived::of(folder)?;
        let manifest = derived.manifest.clone();
        let params = Arc::new(manifest.params()?);
        let (lock, restored) = match access {
            Access::Write => {
                let lock = lock_run(folder, &manifest.id)?;
                folder.parent().into_iter().for_each(remove_leftovers);
                (Some(lock), derived.restore(folder)?)
            }
            Access::Read => (
                None,
                derived.problem.map(|problem| format!("{problem}: the first line of the trajectory counts.")),
            ),
        };
        let path = folder.join("trajectory.jsonl");
        let mut integrity = Integrity::of(folder, &manifest, &key);
        let trajectory = Trajectory::read(&path)?;
        check_start(&path, trajectory.lines.first(), &manifest)?;
        integrity.check(&path, &trajectory)?;
        let finished = (projection && access == Access::Read)
            .then(|| integrity.finished_database(folder, &trajectory))
            .flatten();
        let keeping = keeping.filter(|own| (own.may_keep)(folder, &manifest, &trajectory, &key));
        let simulates = projection && finished.is_none();
        if simulates && keeping.is_some_and(|own| (own.keep_database)(folder, &key)) {
            return Session::open_sealed(folder, access, projection, key);
        }
        let database = match projection && finished.is_none() {
            false => None,
            true => {
                let sound = access == Access::Write && integrity.vouch_for_database(folder);
                Some(open_projector(folder, access, (&manifest, &params), &trajectory, sound)?)
            }
        };
        // The number of the line up to which rows are there; rows that lack need the facts before them.
        let rows = database.as_ref().map(|(_, rows)| rows.as_ref().map_or(0, |position| position.seq));
        let snapshot = usable(&integrity, &manifest, &trajectory, rows);
        let lines = &trajectory.lines;
        let (mut session, seen) = Session::before_replay(manifest.clone(), folder, params, lines, snapshot);
        session.seal_key = key;
        session.remarks.extend(restored);
        session.remarks.append(&mut integrity.remarks);
        session.replay(&path, &trajectory, seen, database, &mut |_| {})?;
        if let Some(own) = keeping.filter(|_| !projection && seen < trajectory.lines.len()) {
            (own.keep_snapshot)(&session, folder);
        }
        if let Some(location) = finished {
            session.projection = Projection::finished(location);
        }
        if let Some(lock) = lock {
            session.recorder = Some(Recorder::resume(&path, &trajectory, lock)?);
        }
        if trajectory.unfinished > 0 {
            let bytes = trajectory.unfinished;
            session.remarks.push(format!(
                "The last line of the trajectory was unfinished ({bytes} bytes) and was dropped: it was never confirmed."
            ));
        }
        session.replay_afterwards(&trajectory);
        session.clock = PersonalClock::of(&trajectory);
        session.viewed = trajectory.lines.iter().filter_map(view).collect();
        session.check_memo(&trajectory, access);
        session.resume_lesson(folder, &trajectory.lines)?;
        session.finish_week(&trajectory);
        session.finish_beginning(&trajectory.lines)?;
        session.name_python_calculations();
        Ok(session)
    }

    /// A session that has seen no line yet, or everything up to a snapshot's; and how many it has seen.
    pub(crate) fn before_replay(
        manifest: Manifest,
        folder: &Path,
        params: Arc<Params>,
        lines: &[Line],
        snapshot: Option<&Snapshot>,
    ) -> (Session, usize) {
        let own = Some(folder.to_owned());
        let recall = |snapshot: &Snapshot| snapshot.recall(&manifest, &params, lines);
        let recalled = snapshot.and_then(|snapshot| Some((recall(snapshot)?, snapshot)));
        let Some((Recalled { simulation, history, notebook }, snapshot)) = recalled else {
            return (Session::unwritten(manifest, own, params, None), 0);
        };
        let position = snapshot.position();
        let seen = position.seq as usize + 1;
        let surroundings = RunSurroundings { notebook, ..RunSurroundings::default() };
        let session = Session::assemble(manifest, own, simulation, Projection::default());
        (Session { history, surroundings, position, ..session }, seen)
    }

    /// Applies every line again but those the session has seen; the database gets only what it does not have yet.
    /// `reached` is told the day after each line.
    pub(crate) fn replay(
        &mut self,
        path: &Path,
        trajectory: &Trajectory,
        seen: usize,
        database: Option<(Projector, Option<Position>)>,
        reached: &mut dyn FnMut(u32),
    ) -> Result<(), RunError> {
        let (mut projector, projected): (Option<Projector>, _) = database.unzip();
        let projected = projected.flatten();
        for line in trajectory.lines.iter().skip(seen) {
            let missing = projected.as_ref().is_none_or(|position| line.seq > position.seq);
            if missing && projector.is_some() {
                self.go_on_with(projector.take());
            }
            self.apply_line(path, line)?;
            reached(self.simulation.world.day);
        }
        if projector.is_some() {
            self.go_on_with(projector);
        }
        Ok(())
    }

    /// From here on rows are made, with the parameters in force.
    fn go_on_with(&mut self, projector: Option<Projector>) {
        self.projection = Projection::of(projector);
        if self.simulation.overrides.is_used() {
            let params = self.simulation.params.clone();
            self.projection.entries().write(|| Entry { params: Some(params), ..Entry::default() });
        }
    }

    /// Applies a line of a file again.
    pub(crate) fn apply_line(&mut self, path: &Path, line: &Line) -> Result<(), RunError> {
        self.apply_line_telling(path, line, &mut |_| {})
    }

    /// The same, and tells of each day that it simulates.
    pub(crate) fn apply_line_telling(
        &mut self,
        path: &Path,
        line: &Line,
        tell: &mut dyn FnMut(&DayReport<'_>),
    ) -> Result<(), RunError> {
        self.position = line.position();
        let damaged = damaged_at(path);
        self.replay_line(line, tell).map_err(|problem| damaged((line.seq as usize + 1, problem)))
    }

    fn replay_line(&mut self, line: &Line, tell: &mut dyn FnMut(&DayReport<'_>)) -> Result<(), String> {
        match &line.record {
            Record::Start(_) => self.project_opening(),
            Record::Call(call) => {
                self.history.first_answers.note_call(call);
                if let Outcome::Accepted(answer) = &call.outcome {
                    self.replay_call(call, answer)?;
                }
            }
            Record::Advance(filed) => {
                self.history.first_answers.begin_week(filed.request.clone());
                self.replay_forecasts(filed, &line.at)?;
            }
            Record::Week(closing) | Record::Step(closing) => {
                let from = self.simulation.world.day;
                let state = self.run_days(from.saturating_add(closing.days_run), tell);
                self.compare(from, &state, closing)?;
                self.note_answered_week();
                self.commit_projection();
            }
            Record::End(end) => {
                self.note_end(end.reason);
                self.history.ended = Some(end.reason);
                self.commit_projection();
            }
            Record::Override(change) => self.replay_override(line.seq, change)?,
            Record::Voice(said) => self.replay_voice(said)?,
            Record::Query(query) => self.remember_query(query),
            Record::Activity(_)
            | Record::Memo(_)
            | Record::Note(_)
            | Record::Branch(_)
            | Record::Unknown(_) => {}
        }
        Ok(())
    }

    /// Settles the figures of days that ran again and compares the state with the recorded one.
    fn compare(&mut self, from: u32, state: &StateHash, recorded: &Closing) -> Result<(), String> {
        let figures = self.settle_figures();
        let reached = self.closing(from, &figures, state);
        self.simulation.facts_chain.close();
        if reached.state_hash == recorded.state_hash {
            return same_figures(&reached, recorded);
        }
        let differs = |(name, hash): &(&String, &String)| recorded.parts.get(*name) != Some(*hash);
        let differing = reached.parts.iter().filter(differs).map(|(name, _)| name.as_str());
        let differing: Vec<&str> = differing.collect();
        Err(format!(
            "the state on day {} is not the recorded one (different: {}); a line before it was changed, or another \
             version recorded it",
            self.simulation.world.day,
            differing.join(", ")
        ))
    }

    /// A week that was confirmed but not finished is simulated now.
    fn finish_week(&mut self, trajectory: &Trajectory) {
        let open = trajectory.lines.iter().rev().find_map(|line| match line.record {
            Record::Advance(_) => Some(true),
            Record::End(_) | Record::Week(_) | Record::Step(_) => Some(false),
            _ => None,
        });
        if open == Some(true) {
            let week = self.run_week(&mut |_| {});
            self.remarks.push(format!("The week up to day {} was simulated again.", week.figures.day));
        } else if self.history.ended.is_none() && self.simulation.world.is_over(&self.simulation.params) {
            // The program ended between the last week and the line that closes the run.
            let remark = self.close_if_over();
            self.commit_projection();
            self.remarks.extend(remark);
        }
    }
}

/// The figures that stand beside a state are derived from it.
fn same_figures(reached: &Closing, recorded: &Closing) -> Result<(), String> {
    let name = if reached.days_run != recorded.days_run {
        "days_run"
    } else if reached.figures != recorded.figures {
        "figures"
    } else if reached.cash != recorded.cash {
        "cash"
    } else {
        return Ok(());
    };
    Err(format!("the recorded {name} does not belong to the recorded state: it was changed"))
}

/// Starts the database. What it holds already counts only if `sound` says so.
pub(crate) fn open_projector(
    folder: &Path,
    access: Access,
    (manifest, params): (&Manifest, &Arc<Params>),
    trajectory: &Trajectory,
    sound: bool,
) -> Result<(Projector, Option<Position>), RunError> {
    let location = match access {
        Access::Write => Location::File(folder.join("world.db")),
        // Somebody else may be writing the file; a reader makes its own.
        Access::Read => Location::memory(),
    };
    let known = |position: &Position| {
        let line = trajectory.lines.get(position.seq as usize);
        sound && line.is_some_and(|line| line.hash == position.line_hash)
    };
    Ok(Projector::start(location, manifest.number(), params.clone(), known)?)
}

/// The snapshot from which the run can go on: its line is in the trajectory, and the database lacks no row before it.
pub(crate) fn usable<'a>(
    integrity: &'a Integrity,
    manifest: &Manifest,
    trajectory: &Trajectory,
    rows_from: Option<u64>,
) -> Option<&'a Snapshot> {
    let snapshot = integrity.snapshot.as_ref().filter(|snapshot| snapshot.fits(manifest))?;
    let position = snapshot.position();
    let line = trajectory.lines.get(position.seq as usize)?;
    let complete = rows_from.is_none_or(|seq| seq >= position.seq);
    (line.hash == position.line_hash && complete).then_some(snapshot)
}

/// Ends an unfinished run for good.
///
/// # Errors
/// It is over already, in use, or cannot be read.
pub fn end_run(runs: &Path, id: &str) -> Result<(), RunError> {
    let mut session = Session::open(&find_run(runs, id)?, Access::Write, false)?;
    session.end().map_err(|refusal| RunError::NotPossible(refusal.message))
}
