//! Read-only playback of a recorded run: the company at any position, and the decisions at that position.
//!
//! Lines of the trajectory are applied to a separate session with a database in memory. Files on the disk do not
//! change. Seeking forward applies more lines; seeking back starts a new session.

pub(crate) mod position;
pub(crate) mod record_view;

use std::ops::ControlFlow;
use std::path::Path;

use self::position::{Chapter, PlaybackPosition, SeekResult, SeekTarget};
use self::record_view::RecordView;
use crate::figures::scored_forecast::cash_at_week_end;
use crate::figures::week::week_of_day;
use crate::play::Session;
use crate::resume::origin::{Origin, read_origin};
use novamind_record::error::RunError;
use novamind_record::lesson::is_lesson_over;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::{Note, RunEndReason};
use novamind_record::trajectory::{Line, Record, Trajectory, damaged_line_error};
use novamind_tools::Rejection;

#[derive(Debug, Clone, Copy, PartialEq)]
struct WeekBoundary {
    /// Number of lines up to the boundary, including an `end` line that follows directly.
    line_count: usize,
    day: u32,
    cash: f64,
}

/// Read-only playback of a recorded run.
pub struct Playback {
    origin: Origin,
    trajectory: Trajectory,
    /// Number of lines that can be applied: all lines before the first line that does not reproduce the recorded state.
    valid_lines: usize,
    boundaries: Vec<WeekBoundary>,
    session: Session,
    applied: usize,
    is_following: bool,
}

impl Playback {
    /// Opens the run in a folder, or a trajectory file, and starts the playback at the first line.
    ///
    /// # Errors
    /// The run is missing, damaged or recorded with another version. The error names the file and the data that is
    /// safe.
    pub fn open(path: &Path) -> Result<Playback, RunError> {
        let (origin, trajectory) = read_origin(path)?;
        let session = origin.initial_session()?;
        let good = trajectory.lines.len();
        let mut playback = Playback {
            origin,
            trajectory,
            valid_lines: good,
            boundaries: Vec::new(),
            session,
            applied: 0,
            is_following: false,
        };
        playback.find_boundaries(0);
        playback.seek_forward(1, &mut |_| ControlFlow::Continue(()))?;
        Ok(playback)
    }

    /// Returns the lines that can be applied, including the first line.
    pub fn lines(&self) -> &[Line] {
        &self.trajectory.lines[..self.valid_lines]
    }

    /// Starts waiting for new lines, unless the run has ended.
    pub fn start_following(&mut self) {
        self.is_following = !self.has_end_record();
    }

    /// Returns whether the playback waits for new lines.
    pub fn is_following(&self) -> bool {
        self.is_following
    }

    /// Returns the read-only session at the current position.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Returns a mutable reference to the session, for queries.
    pub fn session_mut(&mut self) -> &mut Session {
        &mut self.session
    }

    /// Moves the playback to a target. Seeking back uses a new session, so that a stopped seek has no effect.
    ///
    /// # Errors
    /// A line does not reproduce the recorded state. After such an error, the playback ends before this line.
    pub fn seek(
        &mut self,
        goal: SeekTarget,
        progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
    ) -> Result<SeekResult, RunError> {
        let line = self.target_line(goal).clamp(1, self.valid_lines);
        let before = self.valid_lines;
        let seek_result = if line < self.applied {
            self.seek_back(line, progress)
        } else {
            self.seek_forward(line, progress)
        };
        if seek_result.is_err() && self.valid_lines < before {
            // The session has applied the invalid line: restore the previous state with a new session.
            self.seek_back(self.boundary_before(self.valid_lines), &mut |_| ControlFlow::Continue(()))?;
        }
        seek_result
    }

    fn target_line(&self, goal: SeekTarget) -> usize {
        match goal {
            SeekTarget::First => 1,
            SeekTarget::Last => self.valid_lines,
            SeekTarget::Lines(count) => self.applied.saturating_add_signed(count as isize),
            SeekTarget::Week(0) => 1,
            SeekTarget::Week(week) => {
                let reached = self.boundaries.iter().rfind(|stop| week_of_day(stop.day) <= week);
                reached.map_or(1, |stop| stop.line_count)
            }
            SeekTarget::Weeks(count) if count >= 0 => {
                let coming = self.boundaries.iter().filter(|stop| stop.line_count > self.applied);
                coming.take(count as usize).last().map_or(self.valid_lines, |stop| stop.line_count)
            }
            SeekTarget::Weeks(count) => {
                let mut passed = self.boundaries.iter().rev().filter(|stop| stop.line_count < self.applied);
                passed.nth(count.unsigned_abs() as usize - 1).map_or(1, |stop| stop.line_count)
            }
        }
    }

    fn boundary_before(&self, line: usize) -> usize {
        self.boundaries.iter().rfind(|stop| stop.line_count <= line).map_or(1, |stop| stop.line_count)
    }

    /// Applies further lines. If the seek is stopped, keeps the lines that are applied already.
    fn seek_forward(
        &mut self,
        line: usize,
        progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
    ) -> Result<SeekResult, RunError> {
        let lines = &self.trajectory.lines[..line.min(self.trajectory.lines.len())];
        let (applied, end) = apply_lines(&mut self.session, &self.origin.path, lines, self.applied, progress);
        self.applied = applied;
        self.finish_seek(end)
    }

    fn seek_back(
        &mut self,
        line: usize,
        progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
    ) -> Result<SeekResult, RunError> {
        let (mut session, from) = self.initial_session()?;
        let lines = &self.trajectory.lines[..line];
        let (applied, end) = apply_lines(&mut session, &self.origin.path, lines, from, progress);
        let seek_result = self.finish_seek(end)?;
        if seek_result == SeekResult::Stopped {
            return Ok(seek_result);
        }
        (self.session, self.applied) = (session, applied);
        Ok(SeekResult::ReachedInNewSession)
    }

    /// Returns a session before the first line, and the number of lines that it includes.
    fn initial_session(&self) -> Result<(Session, usize), RunError> {
        self.origin.initial_session().map(|session| (session, 0))
    }

    fn finish_seek(
        &mut self,
        end: Result<ControlFlow<()>, (usize, RunError)>,
    ) -> Result<SeekResult, RunError> {
        match end {
            Ok(ControlFlow::Continue(())) => Ok(SeekResult::Reached),
            Ok(ControlFlow::Break(())) => Ok(SeekResult::Stopped),
            Err((line, error)) => {
                self.valid_lines = line;
                Err(error)
            }
        }
    }

    /// Reads lines that were written since the last poll. Returns whether there are new lines.
    ///
    /// # Errors
    /// The file cannot be read, or its new lines are damaged.
    pub fn poll_new_lines(&mut self) -> Result<bool, RunError> {
        let more = self.read_new_lines();
        if more.is_err() || self.has_end_record() {
            self.is_following = false;
        }
        more
    }

    fn read_new_lines(&mut self) -> Result<bool, RunError> {
        let path = &self.origin.path;
        let length = std::fs::metadata(path).map_err(RunError::io(path))?.len();
        let known = self.trajectory.length + self.trajectory.unfinished_bytes as u64;
        if length == known || self.valid_lines < self.trajectory.lines.len() {
            return Ok(false);
        }
        let before = self.trajectory.lines.len();
        let bytes = read_from(path, self.trajectory.length)?;
        if length < self.trajectory.length {
            let lines = format!("lines were removed; there were {before}");
            return Err(damaged_line_error(path)((before, lines)));
        }
        self.trajectory.append_bytes(&bytes).map_err(damaged_line_error(path))?;
        self.valid_lines = self.trajectory.lines.len();
        self.find_boundaries(before);
        Ok(self.valid_lines > before)
    }

    /// Returns whether all valid lines are applied.
    pub fn is_at_end(&self) -> bool {
        self.applied == self.valid_lines
    }

    fn has_end_record(&self) -> bool {
        self.trajectory.lines.last().is_some_and(|line| matches!(line.record, Record::End(_)))
    }

    /// Returns whether hidden state of the recorded run may be shown. The result depends on whether the recorded run
    /// has ended, not on the position.
    pub fn can_inspect(&self) -> bool {
        let Origin { manifest, folder, .. } = &self.origin;
        let is_over = || self.has_end_record() && is_lesson_over(folder.as_deref(), manifest);
        let is_open = manifest.mode == Mode::Debug || is_over();
        is_open && self.origin.folder.is_some() && !self.session.rules().withholds_results()
    }

    fn find_boundaries(&mut self, from: usize) {
        for line in &self.trajectory.lines[from..] {
            let after = line.seq as usize + 1;
            match &line.record {
                Record::Week(closing) | Record::Step(closing) => {
                    self.boundaries.push(WeekBoundary {
                        line_count: after,
                        day: line.day,
                        cash: closing.cash,
                    });
                }
                // The end of the last days and the end of the run are one position.
                Record::End(_) => {
                    if let Some(stop) = self.boundaries.last_mut().filter(|stop| stop.line_count + 1 == after)
                    {
                        stop.line_count = after;
                    }
                }
                _ => {}
            }
        }
    }

    /// Returns the current position and the decisions at this position.
    pub fn position(&self) -> PlaybackPosition {
        let recorded_day = self.boundaries.last().map_or(0, |stop| stop.day);
        PlaybackPosition {
            line: self.applied,
            lines: self.valid_lines,
            day: self.session.day(),
            week: week_of_day(self.session.day()),
            recorded_day,
            weeks: week_of_day(recorded_day),
            is_following: self.is_following,
            is_at_end: self.is_at_end(),
            chapter: self.current_chapter(),
            branch_rejection: self.branch_rejection().map(|rejection| rejection.message),
        }
    }

    /// Returns the decisions before the next week. At the end of the run, returns the decisions before the last week.
    fn current_chapter(&self) -> Chapter {
        let last = self.trajectory.lines.len();
        let at_end =
            self.boundaries.last().is_some_and(|stop| stop.line_count == last && self.applied == last);
        let shown = if at_end { self.applied - 1 } else { self.applied };
        let from = self.boundaries.iter().rfind(|stop| stop.line_count <= shown);
        let to =
            self.boundaries.iter().find(|stop| stop.line_count > shown).map_or(last, |stop| stop.line_count);
        let (first, day) = from.map_or((1, 0), |stop| (stop.line_count, stop.day));
        let lines = &self.trajectory.lines[first.min(to)..to];
        let (today, outcome) = (self.session.day(), |due: u32| self.cash_on_day(due));
        Chapter {
            week: day / 7 + 1,
            day,
            entries: lines.iter().map(|line| RecordView::new(line, today, &outcome)).collect(),
            applied_entries: self.applied.saturating_sub(first).min(lines.len()),
        }
    }

    /// Returns the cash at the end of the week that ends on a day. For days after the current position, returns the
    /// recorded cash, if any.
    fn cash_on_day(&self, day: u32) -> Option<f64> {
        if day <= self.session.day() {
            return cash_at_week_end(self.session.weeks(), day);
        }
        self.boundaries.iter().find(|stop| stop.day == day).map(|stop| stop.cash)
    }

    /// Returns the notes at this position. Lines of format 1 do not contain notes, so only the last notes of the run
    /// are known.
    pub fn notes(&self) -> Option<String> {
        let lines = self.trajectory.lines[..self.applied].iter().rev();
        let kept = lines.map(|line| &line.record).find(|record| record.notes_digest().is_some())?;
        if let Record::Note(Note { text: Some(text), .. }) = kept {
            return Some(text.clone());
        }
        let text = self.session.notes().ok()?;
        (kept.notes_digest()? == blake3::hash(text.as_bytes()).to_hex().as_str()).then_some(text)
    }

    fn branch_rejection(&self) -> Option<Rejection> {
        if self.origin.folder.is_none() {
            return Some(standalone_rejection());
        }
        let unfinished = !self.has_end_record();
        (self.origin.manifest.mode == Mode::Baseline && unfinished).then(|| {
            let message = "an unfinished baseline run cannot be branched, because that would reveal its future: end it \
                           first (novamind runs end)";
            Rejection::new("not_in_this_mode", message)
        })
    }

    /// Creates a branch with all lines up to this position and opens the branch.
    ///
    /// # Errors
    /// `not_in_this_mode` for an unfinished baseline run or a baseline branch. Otherwise `not_possible`, `run_over` or
    /// `not_saved`.
    pub fn create_branch(&self, mode: Mode) -> Result<Session, Rejection> {
        let folder = match (self.branch_rejection(), &self.origin.folder) {
            (None, Some(folder)) => folder,
            (rejection, _) => return Err(rejection.unwrap_or_else(standalone_rejection)),
        };
        // A branch can continue an abandoned run, but not a run that has reached its end.
        if self.session.ended().is_some() && self.session.ended() != Some(RunEndReason::Abandoned) {
            let message = "the run has ended at this position: go back to an earlier week first";
            return Err(Rejection::new("run_over", message));
        }
        crate::resume::branch::create_branch(folder, &self.origin.manifest, &self.shared_lines(), mode)
    }

    /// Returns the lines up to this position, without a week that was submitted but not simulated.
    fn shared_lines(&self) -> Vec<Line> {
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

fn standalone_rejection() -> Rejection {
    let message = "this trajectory has no run folder: import the run to branch it";
    Rejection::new("not_possible", message)
}

/// Applies the lines after the first `applied` lines. Returns the number of applied lines and the outcome: `Continue`
/// after the last line, `Break` if `progress` stopped the seek, or the index and error of an invalid line.
fn apply_lines(
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

fn read_from(path: &Path, from: u64) -> Result<Vec<u8>, RunError> {
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
