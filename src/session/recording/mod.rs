//! The lines of an open run: what writes them, when they have to be on the disk, and what they say about the person who plays.

pub(crate) mod activity;
pub(crate) mod folders;
pub(crate) mod machine;
pub(crate) mod personal_clock;
pub(crate) mod recorder;

use std::collections::BTreeMap;

use self::personal_clock::{PersonalClock, TimeLeft};
use self::recorder::Recorder;
use crate::figures::attendance::TimeSpent;
use novamind_database::Position;
use novamind_record::answer_book::AnswerBook;
use novamind_record::clock::{nanoseconds, now, seconds};
use novamind_record::error::RunError;
use novamind_record::rules::SessionRules;
use novamind_record::trajectory::record::{Activity, LimitScope};
use novamind_record::trajectory::{Durability, Line, Record, Trajectory};

/// The lines of an open run, and what follows from them besides the company.
pub struct RunLog {
    rules: SessionRules,
    /// The last line that was written, or applied again.
    position: Position,
    /// Whether the person has stopped the clock, and what was told of limits.
    clock: PersonalClock,
    /// Answers to the questions of a study.
    answers: AnswerBook,
    /// The last day on which each screen of the console was left, in the sittings before this one.
    viewed: BTreeMap<String, u32>,
    /// What writes the lines; none when the run is only read.
    recorder: Option<Recorder>,
}

impl RunLog {
    /// The log of a run of which no line was read, and which nothing writes.
    pub(crate) fn unwritten(rules: SessionRules) -> RunLog {
        RunLog {
            rules,
            position: Position { seq: 0, line_hash: String::new() },
            clock: PersonalClock::default(),
            answers: AnswerBook::default(),
            viewed: BTreeMap::new(),
            recorder: None,
        }
    }

    /// The log of a new run.
    pub(crate) fn written(rules: SessionRules, recorder: Recorder) -> RunLog {
        RunLog { position: recorder.position(), recorder: Some(recorder), ..RunLog::unwritten(rules) }
    }

    /// Continues to write with a recorder.
    pub(crate) fn resume(&mut self, recorder: Recorder) {
        self.recorder = Some(recorder);
    }

    /// Takes in what the lines of the run say about clock, screens and answers.
    pub(crate) fn read(&mut self, trajectory: &Trajectory) {
        self.clock = PersonalClock::of(trajectory);
        self.viewed = trajectory.lines.iter().filter_map(view).collect();
        self.answers = AnswerBook::of(&trajectory.lines);
    }

    /// Takes in the answers of all lines, those after the end of the run included.
    pub(crate) fn read_answers<'a>(&mut self, lines: impl IntoIterator<Item = &'a Line>) {
        self.answers = AnswerBook::of(lines);
    }

    /// Whether the person has stopped the clock.
    pub fn clock_stands(&self) -> bool {
        self.clock.stopped.is_some()
    }

    /// Whether a limit has stopped it, and nobody has started it since: leaving the run does not.
    pub fn is_held(&self) -> bool {
        self.clock.held
    }

    /// Time that is left to each limit of the rules; while the clock stands, as when it was stopped.
    pub fn time_left(&self) -> Vec<TimeLeft> {
        let limits = &self.rules.limits;
        let all = [
            (LimitScope::Week, limits.week_minutes),
            (LimitScope::Session, limits.session_minutes),
            (LimitScope::Study, limits.study_minutes),
        ];
        let left = |(scope, minutes): (LimitScope, Option<u32>)| {
            let minutes = minutes?;
            let seconds = f64::from(minutes) * 60.0 - self.time_spent(scope).active_ms() as f64 / 1e3;
            Some(TimeLeft { scope, minutes, seconds })
        };
        all.into_iter().filter_map(left).collect()
    }

    /// What was spent of what a time limit is on, up to now; nothing of a run that is only read.
    pub fn time_spent(&self, scope: LimitScope) -> TimeSpent {
        let attendance = self.recorder.as_ref().map(Recorder::attendance);
        attendance.map(|time| time.so_far(scope, nanoseconds(&now()))).unwrap_or_default()
    }

    /// Answers to the questions of a study that the record holds.
    pub fn answer_book(&self) -> &AnswerBook {
        &self.answers
    }

    /// The last day on which each screen of the console was left in an earlier sitting.
    pub fn viewed(&self) -> &BTreeMap<String, u32> {
        &self.viewed
    }

    /// Whether everything that happened stands in the run's trajectory: not where a run is only read, or its file took no
    /// more lines.
    pub fn is_complete(&self) -> bool {
        self.recorder.as_ref().is_some_and(Recorder::is_complete)
    }

    /// Why the run has to stop: its file is no longer the one it was, so nothing more is saved. None while all is well.
    pub fn loss(&self) -> Option<&str> {
        self.recorder.as_ref()?.loss()
    }

    /// Whether lines are written: not where the run is only read, or played again.
    pub fn is_written(&self) -> bool {
        self.recorder.is_some()
    }

    /// Whether a file holds the lines.
    pub(crate) fn is_on_disk(&self) -> bool {
        self.recorder.as_ref().is_some_and(Recorder::is_on_disk)
    }

    /// The last line that was written, or applied again.
    pub(crate) fn position(&self) -> &Position {
        &self.position
    }

    /// Continues after a line that was applied again.
    pub(crate) fn move_to(&mut self, position: Position) {
        self.position = position;
    }

    /// When the line of an accepted call has to be on the disk; a run that is only read keeps its database as one that is
    /// played.
    pub(crate) fn durability_of_calls(&self) -> Durability {
        self.recorder.as_ref().map_or(Durability::Synced, Recorder::durability_of_calls)
    }

    /// Appends a line; a run that is only read has none.
    pub(crate) fn append(
        &mut self,
        (day, is_over): (u32, bool),
        record: &Record,
        durability: Durability,
    ) -> Result<String, RunError> {
        let Some(recorder) = &mut self.recorder else { return Ok(String::new()) };
        if is_over {
            // The end is the last line.
            return recorder.append_afterwards(day, record, durability);
        }
        let at = recorder.append(day, record, durability)?;
        self.position = recorder.position();
        self.clock.pass(record, seconds(&at));
        Ok(at)
    }

    /// Appends a line about something that cannot be taken back. Returns what keeps it from the disk for now.
    pub(crate) fn append_done(&mut self, day: u32, record: &Record) -> Option<String> {
        let recorder = self.recorder.as_mut()?;
        let problem = recorder.append_done(day, record);
        self.position = recorder.position();
        self.clock.pass(record, seconds(&now()));
        problem
    }

    /// Puts everything on the disk.
    pub(crate) fn sync(&mut self) -> Result<(), RunError> {
        self.recorder.as_mut().map_or(Ok(()), Recorder::sync)
    }

    /// Puts the lines of calls on the disk that wait for the week. Returns whether there can be any.
    pub(crate) fn sync_waiting_calls(&self) -> Result<bool, RunError> {
        match self.recorder.as_ref().filter(|recorder| !recorder.syncs_calls()) {
            Some(recorder) => recorder.sync_calls().map(|()| true),
            None => Ok(false),
        }
    }

    /// Puts another medium in place of the file.
    #[cfg(test)]
    pub(crate) fn write_to(&mut self, medium: Box<dyn novamind_record::trajectory::Medium>) {
        self.recorder.as_mut().expect("it is written").write_to(medium);
    }
}

/// The screen that a line says was left, and the day.
fn view(line: &Line) -> Option<(String, u32)> {
    match &line.record {
        Record::Activity(Activity::View(view)) => Some((view.screen.clone(), line.day)),
        _ => None,
    }
}
