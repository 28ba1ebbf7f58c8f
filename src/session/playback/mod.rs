//! Playback of a recorded run: its company at any position, read-only, with the decisions made there.
//!
//! Lines of the trajectory are applied to a separate session with a database in memory; nothing on disk changes.
//! Seeking forward applies more lines, seeking back starts a new session.

pub(crate) mod position;
pub(crate) mod record_view;

use std::ops::ControlFlow;
use std::path::Path;

use self::position::{Chapter, Goal, PlaybackPosition, SeekResult};
use self::record_view::RecordView;
use crate::figures::week::week_of;
use crate::play::Session;
use crate::resume::recorded::{Origin, read};
use novamind_record::error::RunError;
use novamind_record::lesson::is_lesson_over;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::{Ended, Note};
use novamind_record::trajectory::{Line, Record, Trajectory, damaged_at};
use novamind_tools::Refusal;

#[derive(Debug, Clone, Copy, PartialEq)]
struct Stop {
    /// Number of lines up to it, including the end of the run if it follows directly.
    after: usize,
    day: u32,
    cash: f64,
}

/// Playback of a recorded run.
pub struct Playback {
    origin: Origin,
    trajectory: Trajectory,
    /// Number of lines that can be applied: all, unless one does not reproduce.
    good: usize,
    stops: Vec<Stop>,
    session: Session,
    applied: usize,
    follows: bool,
}

impl Playback {
    /// Opens the run in a folder, or a trajectory file, at its start.
    ///
    /// # Errors
    /// The run is missing, damaged or of another version. The error names the file and what is safe.
    pub fn open(path: &Path) -> Result<Playback, RunError> {
        let (origin, trajectory) = read(path)?;
        let session = origin.begin()?;
        let good = trajectory.lines.len();
        let mut playback =
            Playback { origin, trajectory, good, stops: Vec::new(), session, applied: 0, follows: false };
        playback.find_stops(0);
        playback.forward(1, &mut |_| ControlFlow::Continue(()))?;
        Ok(playback)
    }

    /// Returns the lines that can be applied, including the first.
    pub fn lines(&self) -> &[Line] {
        &self.trajectory.lines[..self.good]
    }

    /// Starts to wait for new lines.
    pub fn follow(&mut self) {
        self.follows = !self.is_recorded_to_the_end();
    }

    /// Whether the playback waits for new lines.
    pub fn follows(&self) -> bool {
        self.follows
    }

    /// Returns the session at this position; it is read-only.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Returns the session mutably, for queries.
    pub fn session_mut(&mut self) -> &mut Session {
        &mut self.session
    }

    /// Seeks a target. Seeking back uses a new session, so that it can be stopped without an effect.
    ///
    /// # Errors
    /// A line does not reproduce the recorded state. The playback then ends before this line.
    pub fn go(
        &mut self,
        goal: Goal,
        progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
    ) -> Result<SeekResult, RunError> {
        let line = self.line_of(goal).clamp(1, self.good);
        let before = self.good;
        let went = if line < self.applied { self.back(line, progress) } else { self.forward(line, progress) };
        if went.is_err() && self.good < before {
            // The session has applied the invalid line: restore the state before it with a new session.
            self.back(self.stop_before(self.good), &mut |_| ControlFlow::Continue(()))?;
        }
        went
    }

    fn line_of(&self, goal: Goal) -> usize {
        match goal {
            Goal::First => 1,
            Goal::Last => self.good,
            Goal::Lines(count) => self.applied.saturating_add_signed(count as isize),
            Goal::Week(0) => 1,
            Goal::Week(week) => {
                let reached = self.stops.iter().rfind(|stop| week_of(stop.day) <= week);
                reached.map_or(1, |stop| stop.after)
            }
            Goal::Weeks(count) if count >= 0 => {
                let coming = self.stops.iter().filter(|stop| stop.after > self.applied);
                coming.take(count as usize).last().map_or(self.good, |stop| stop.after)
            }
            Goal::Weeks(count) => {
                let mut passed = self.stops.iter().rev().filter(|stop| stop.after < self.applied);
                passed.nth(count.unsigned_abs() as usize - 1).map_or(1, |stop| stop.after)
            }
        }
    }

    fn stop_before(&self, line: usize) -> usize {
        self.stops.iter().rfind(|stop| stop.after <= line).map_or(1, |stop| stop.after)
    }

    /// Applies further lines. If stopped, keeps the lines applied so far.
    fn forward(
        &mut self,
        line: usize,
        progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
    ) -> Result<SeekResult, RunError> {
        let lines = &self.trajectory.lines[..line.min(self.trajectory.lines.len())];
        let (applied, end) = apply(&mut self.session, &self.origin.path, lines, self.applied, progress);
        self.applied = applied;
        self.end(end)
    }

    fn back(
        &mut self,
        line: usize,
        progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
    ) -> Result<SeekResult, RunError> {
        let (mut session, from) = self.session_before()?;
        let lines = &self.trajectory.lines[..line];
        let (applied, end) = apply(&mut session, &self.origin.path, lines, from, progress);
        let went = self.end(end)?;
        if went == SeekResult::Stopped {
            return Ok(went);
        }
        (self.session, self.applied) = (session, applied);
        Ok(SeekResult::Anew)
    }

    /// Returns a session before any target line, and the number of lines that it includes.
    fn session_before(&self) -> Result<(Session, usize), RunError> {
        self.origin.begin().map(|session| (session, 0))
    }

    fn end(&mut self, end: Result<ControlFlow<()>, (usize, RunError)>) -> Result<SeekResult, RunError> {
        match end {
            Ok(ControlFlow::Continue(())) => Ok(SeekResult::There),
            Ok(ControlFlow::Break(())) => Ok(SeekResult::Stopped),
            Err((line, error)) => {
                self.good = line;
                Err(error)
            }
        }
    }

    /// Reads lines that were written since. Returns whether there are any.
    ///
    /// # Errors
    /// The file cannot be read, or its new lines are damaged.
    pub fn look_for_more(&mut self) -> Result<bool, RunError> {
        let more = self.read_more();
        if more.is_err() || self.is_recorded_to_the_end() {
            self.follows = false;
        }
        more
    }

    fn read_more(&mut self) -> Result<bool, RunError> {
        let path = &self.origin.path;
        let length = std::fs::metadata(path).map_err(RunError::io(path))?.len();
        let known = self.trajectory.length + self.trajectory.unfinished as u64;
        if length == known || self.good < self.trajectory.lines.len() {
            return Ok(false);
        }
        let before = self.trajectory.lines.len();
        let bytes = tail(path, self.trajectory.length)?;
        if length < self.trajectory.length {
            let lines = format!("lines were removed; there were {before}");
            return Err(damaged_at(path)((before, lines)));
        }
        self.trajectory.extend(&bytes).map_err(damaged_at(path))?;
        self.good = self.trajectory.lines.len();
        self.find_stops(before);
        Ok(self.good > before)
    }

    /// Whether the playback is after the last line.
    pub fn at_end(&self) -> bool {
        self.applied == self.good
    }

    fn is_recorded_to_the_end(&self) -> bool {
        self.trajectory.lines.last().is_some_and(|line| matches!(line.record, Record::End(_)))
    }

    /// Whether hidden state of the recorded run may be shown. The end of the record counts, not the position.
    pub fn may_look_inside(&self) -> bool {
        let Origin { manifest, folder, .. } = &self.origin;
        let is_over = || self.is_recorded_to_the_end() && is_lesson_over(folder.as_deref(), manifest);
        let is_open = manifest.mode == Mode::Debug || is_over();
        is_open && self.origin.folder.is_some() && !self.session.rules().hides_results()
    }

    fn find_stops(&mut self, from: usize) {
        for line in &self.trajectory.lines[from..] {
            let after = line.seq as usize + 1;
            match &line.record {
                Record::Week(closing) | Record::Step(closing) => {
                    self.stops.push(Stop { after, day: line.day, cash: closing.cash });
                }
                // The last days and the end of the run are one position.
                Record::End(_) => {
                    if let Some(stop) = self.stops.last_mut().filter(|stop| stop.after + 1 == after) {
                        stop.after = after;
                    }
                }
                _ => {}
            }
        }
    }

    /// Returns the position and the decisions made there.
    pub fn place(&self) -> PlaybackPosition {
        let recorded_day = self.stops.last().map_or(0, |stop| stop.day);
        PlaybackPosition {
            line: self.applied,
            lines: self.good,
            day: self.session.day(),
            week: week_of(self.session.day()),
            recorded_day,
            weeks: week_of(recorded_day),
            follows: self.follows,
            at_end: self.at_end(),
            chapter: self.chapter(),
            no_branch: self.no_branch().map(|refusal| refusal.message),
        }
    }

    /// Returns the decisions before the next week, or before the last one at the end.
    fn chapter(&self) -> Chapter {
        let last = self.trajectory.lines.len();
        let at_end = self.stops.last().is_some_and(|stop| stop.after == last && self.applied == last);
        let shown = if at_end { self.applied - 1 } else { self.applied };
        let from = self.stops.iter().rfind(|stop| stop.after <= shown);
        let to = self.stops.iter().find(|stop| stop.after > shown).map_or(last, |stop| stop.after);
        let (first, day) = from.map_or((1, 0), |stop| (stop.after, stop.day));
        let lines = &self.trajectory.lines[first.min(to)..to];
        let (today, outcome) = (self.session.day(), |due: u32| self.outcome(due));
        Chapter {
            week: day / 7 + 1,
            day,
            entries: lines.iter().map(|line| RecordView::of(line, today, &outcome)).collect(),
            done: self.applied.saturating_sub(first).min(lines.len()),
        }
    }

    /// Returns cash on a day, including later days if they are recorded.
    fn outcome(&self, day: u32) -> Option<f64> {
        if day <= self.session.day() {
            return self.session.cash_by_day().get(day as usize).copied();
        }
        self.stops.iter().find(|stop| stop.day == day).map(|stop| stop.cash)
    }

    /// Returns the notes at this position. Lines of format 1 do not contain them, so only the last notes are known.
    pub fn memo(&self) -> Option<String> {
        let lines = self.trajectory.lines[..self.applied].iter().rev();
        let kept = lines.map(|line| &line.record).find(|record| record.notes_digest().is_some())?;
        if let Record::Note(Note { text: Some(text), .. }) = kept {
            return Some(text.clone());
        }
        let text = self.session.memo().ok()?;
        (kept.notes_digest()? == blake3::hash(text.as_bytes()).to_hex().as_str()).then_some(text)
    }

    fn no_branch(&self) -> Option<Refusal> {
        if self.origin.folder.is_none() {
            return Some(stands_alone());
        }
        let unfinished = !self.is_recorded_to_the_end();
        (self.origin.manifest.mode == Mode::Baseline && unfinished).then(|| {
            let message = "an unfinished baseline run cannot be branched, because that would reveal its future: end it \
                           first (novamind runs end)";
            Refusal::new("not_in_this_mode", message)
        })
    }

    /// Creates a branch with all lines up to this position and opens it.
    ///
    /// # Errors
    /// `not_in_this_mode` for an unfinished baseline run or a baseline branch, `not_possible`, `run_over`, `not_saved`.
    pub fn take_over(&self, mode: Mode) -> Result<Session, Refusal> {
        let folder = match (self.no_branch(), &self.origin.folder) {
            (None, Some(folder)) => folder,
            (refusal, _) => return Err(refusal.unwrap_or_else(stands_alone)),
        };
        // An abandoned run can be continued in a branch; a run that reached its end cannot.
        if self.session.ended().is_some() && self.session.ended() != Some(Ended::Abandoned) {
            let message = "the run has ended at this position: go back to a week first";
            return Err(Refusal::new("run_over", message));
        }
        crate::resume::branch::branch_of(folder, &self.origin.manifest, &self.shared(), mode)
    }

    /// Returns the lines up to this position, without a week that was submitted but not simulated.
    fn shared(&self) -> Vec<Line> {
        let mut lines = self.trajectory.lines[..self.applied].to_vec();
        if let Some(last) = lines.iter().rposition(|line| matches!(line.record, Record::Advance(_))) {
            let ran = lines[last..].iter().any(Line::closes_days);
            if !ran {
                lines.truncate(last);
            }
        }
        lines
    }
}

fn stands_alone() -> Refusal {
    let message = "this trajectory has no run folder: import the run to branch it";
    Refusal::new("not_possible", message)
}

/// Applies lines after the first `applied`. Returns the number of applied lines, and how it ended.
fn apply(
    session: &mut Session,
    path: &Path,
    lines: &[Line],
    applied: usize,
    progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
) -> (usize, Result<ControlFlow<()>, (usize, RunError)>) {
    for (at, line) in lines.iter().enumerate().skip(applied) {
        if let Err(error) = session.apply_line(path, line) {
            return (at, Err((at, error)));
        }
        if line.closes_days() && at + 1 < lines.len() && progress(line.day).is_break() {
            return (at + 1, Ok(ControlFlow::Break(())));
        }
    }
    (lines.len().max(applied), Ok(ControlFlow::Continue(())))
}

fn tail(path: &Path, from: u64) -> Result<Vec<u8>, RunError> {
    use std::io::{Read, Seek, SeekFrom};
    let mut bytes = Vec::new();
    let read = std::fs::File::open(path).and_then(|mut file| {
        file.seek(SeekFrom::Start(from))?;
        file.read_to_end(&mut bytes)
    });
    read.map(|_| bytes).map_err(RunError::io(path))
}

#[cfg(test)]
pub(super) mod tests;
