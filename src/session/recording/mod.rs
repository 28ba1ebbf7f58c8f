//! The record of an open run: recorder, durability, and data about the user.

pub(crate) mod activity;
pub(crate) mod folders;
pub(crate) mod idle_watch;
pub(crate) mod machine;
pub(crate) mod recorder;
pub(crate) mod session_clock;

use std::collections::BTreeMap;

use self::recorder::Recorder;
use self::session_clock::{SessionClock, TimeLeft};
use crate::figures::attendance::TimeSpent;
use novamind_database::ProjectionPosition;
use novamind_record::answered_questions::AnsweredQuestions;
use novamind_record::clock::{now, parse_nanoseconds, parse_seconds};
use novamind_record::error::RunError;
use novamind_record::rules::SessionRules;
use novamind_record::trajectory::record::{Activity, LimitScope};
use novamind_record::trajectory::{Durability, Line, Record, Trajectory};

/// The record of an open run, and the state that is derived from the record, except the company.
pub struct RunLog {
    rules: SessionRules,
    position: ProjectionPosition,
    clock: SessionClock,
    answers: AnsweredQuestions,
    /// Day on which the user last left each screen of the console in an earlier session.
    last_views: BTreeMap<String, u32>,
    /// Recorder of the run; `None` if the run is open read-only.
    recorder: Option<Recorder>,
}

impl RunLog {
    /// Creates an empty log without a recorder, for a run that is not written.
    pub(crate) fn new_read_only(rules: SessionRules) -> RunLog {
        RunLog {
            rules,
            position: ProjectionPosition { seq: 0, line_hash: String::new() },
            clock: SessionClock::default(),
            answers: AnsweredQuestions::default(),
            last_views: BTreeMap::new(),
            recorder: None,
        }
    }

    pub(crate) fn with_recorder(rules: SessionRules, recorder: Recorder) -> RunLog {
        RunLog { position: recorder.position(), recorder: Some(recorder), ..RunLog::new_read_only(rules) }
    }

    pub(crate) fn set_recorder(&mut self, recorder: Recorder) {
        self.recorder = Some(recorder);
    }

    /// Reads the clock, the viewed screens and the answers from the lines of the run.
    pub(crate) fn load(&mut self, trajectory: &Trajectory) {
        self.clock = SessionClock::from_trajectory(trajectory);
        self.last_views = trajectory.lines.iter().filter_map(viewed_screen).collect();
        self.answers = AnsweredQuestions::from_lines(&trajectory.lines);
    }

    /// Reads the answers from all lines, including lines after the end of the run.
    pub(crate) fn load_answers<'a>(&mut self, lines: impl IntoIterator<Item = &'a Line>) {
        self.answers = AnsweredQuestions::from_lines(lines);
    }

    /// Returns whether the clock is stopped.
    pub fn is_clock_stopped(&self) -> bool {
        self.clock.stopped_at.is_some()
    }

    /// Returns whether a time limit has stopped the clock and the clock was not started since. Closing the run does
    /// not start the clock.
    pub fn is_stopped_by_limit(&self) -> bool {
        self.clock.is_stopped_by_limit
    }

    /// Returns the time left for each limit of the rules. While the clock is stopped, these times do not change.
    pub fn time_left(&self) -> Vec<TimeLeft> {
        let limits = &self.rules.limits;
        let all = [
            (LimitScope::Week, limits.week_minutes),
            (LimitScope::Session, limits.session_minutes),
            (LimitScope::Study, limits.study_minutes),
        ];
        let left = |(scope, minutes): (LimitScope, Option<u32>)| {
            let minutes = minutes?;
            let seconds = f64::from(minutes) * 60.0 - self.limit_ms(scope) as f64 / 1e3;
            Some(TimeLeft { scope, minutes, seconds })
        };
        all.into_iter().filter_map(left).collect()
    }

    /// Returns the milliseconds that count for a limit. The time is zero if the run is open read-only.
    fn limit_ms(&self, scope: LimitScope) -> u64 {
        let attendance = self.recorder.as_ref().map(Recorder::attendance);
        attendance.map_or(0, |time| time.limit_ms_until(scope, parse_nanoseconds(&now())))
    }

    /// Returns the time spent in the scope of a limit. The time is zero if the run is open read-only.
    pub fn time_spent(&self, scope: LimitScope) -> TimeSpent {
        let attendance = self.recorder.as_ref().map(Recorder::attendance);
        attendance.map(|time| time.spent_until(scope, parse_nanoseconds(&now()))).unwrap_or_default()
    }

    /// Returns the recorded answers to the questions of a study.
    pub fn answered_questions(&self) -> &AnsweredQuestions {
        &self.answers
    }

    /// Returns the day on which the user last left each screen of the console in an earlier session.
    pub fn last_views(&self) -> &BTreeMap<String, u32> {
        &self.last_views
    }

    /// Returns whether all events are in the trajectory file. Returns false if the run is open read-only.
    pub fn is_complete(&self) -> bool {
        self.recorder.as_ref().is_some_and(Recorder::is_complete)
    }

    /// Returns the reason why no more lines can be saved, or `None` if lines can be saved.
    pub fn loss_reason(&self) -> Option<&str> {
        self.recorder.as_ref()?.loss_reason()
    }

    /// Returns whether lines are written. Returns false if the run is open read-only or replayed.
    pub fn is_written(&self) -> bool {
        self.recorder.is_some()
    }

    /// Returns whether the lines are written to a file, not only to memory.
    pub(crate) fn is_on_disk(&self) -> bool {
        self.recorder.as_ref().is_some_and(Recorder::is_on_disk)
    }

    pub(crate) fn position(&self) -> &ProjectionPosition {
        &self.position
    }

    pub(crate) fn set_position(&mut self, position: ProjectionPosition) {
        self.position = position;
    }

    /// Returns when the line of an accepted call must be synced. A read-only run has the same value as a played run.
    pub(crate) fn call_durability(&self) -> Durability {
        self.recorder.as_ref().map_or(Durability::Synced, Recorder::call_durability)
    }

    /// Appends a line. Does nothing if the run is open read-only.
    pub(crate) fn append(
        &mut self,
        (day, is_over): (u32, bool),
        record: &Record,
        durability: Durability,
    ) -> Result<String, RunError> {
        let Some(recorder) = &mut self.recorder else { return Ok(String::new()) };
        if is_over {
            // Lines after the end of the run are not part of the trajectory.
            return recorder.append_afterwards(day, record, durability);
        }
        let at = recorder.append(day, record, durability)?;
        self.position = recorder.position();
        self.clock.apply(record, parse_seconds(&at));
        Ok(at)
    }

    /// Appends a line about an irrevocable action. Returns a description of the problem if the line is not saved yet.
    pub(crate) fn append_irrevocable(&mut self, day: u32, record: &Record) -> Option<String> {
        let recorder = self.recorder.as_mut()?;
        let problem = recorder.append_irrevocable(day, record);
        self.position = recorder.position();
        self.clock.apply(record, parse_seconds(&now()));
        problem
    }

    pub(crate) fn sync(&mut self) -> Result<(), RunError> {
        self.recorder.as_mut().map_or(Ok(()), Recorder::sync)
    }

    /// Syncs pending lines of calls. Returns false if calls are always synced at once.
    pub(crate) fn sync_pending_calls(&self) -> Result<bool, RunError> {
        match self.recorder.as_ref().filter(|recorder| !recorder.syncs_calls()) {
            Some(recorder) => recorder.sync_calls().map(|()| true),
            None => Ok(false),
        }
    }

    #[cfg(test)]
    pub(crate) fn set_medium(&mut self, medium: Box<dyn novamind_record::trajectory::Medium>) {
        self.recorder.as_mut().expect("it is written").set_medium(medium);
    }
}

fn viewed_screen(line: &Line) -> Option<(String, u32)> {
    match &line.record {
        Record::Activity(Activity::View(view)) => Some((view.screen.clone(), line.day)),
        _ => None,
    }
}
