//! Branches: new runs that copy the lines of another run up to a decision day.

use std::path::Path;

use super::staged_branch::{StagedBranch, write_branch_files};
use crate::play::Session;
use crate::play::lesson::progress::weeks_passed;
use crate::recording::folders::new_run_id;
use novamind_record::clock::now;
use novamind_record::error::RunError;
use novamind_record::files::create_folder;
use novamind_record::folder::manifest::{FORMAT, Manifest};
use novamind_record::mode::Mode;
use novamind_record::rules::SessionRules;
use novamind_record::trajectory::record::{Activity, LessonEvent, Parent, Via};
use novamind_record::trajectory::{Line, Record, Trajectory};
use novamind_tools::Rejection;

impl Session {
    /// Creates a branch at the start of a week and opens the branch. Weeks are counted from 1.
    ///
    /// # Errors
    /// `not_in_this_mode` for an unfinished baseline run and for a baseline branch. Also `not_in_this_mode` for a
    /// branch in a mode other than debug if the copied lines change parameters or the run has a seeded fault.
    /// `guess_first` if a question of a lesson is unanswered; `week_unknown`, `not_saved`.
    pub fn branch(&self, week: u32, mode: Mode) -> Result<Session, Rejection> {
        StagedBranch::stage(self, week, mode)?.publish().map_err(branch_not_saved_rejection)
    }
}

impl StagedBranch {
    /// Creates a branch in a staging folder.
    ///
    /// # Errors
    /// The same errors as [`Session::branch`].
    pub fn stage(run: &Session, week: u32, mode: Mode) -> Result<StagedBranch, Rejection> {
        if run.manifest().mode == Mode::Baseline && run.ended().is_none() {
            let message = "an unfinished baseline run cannot be branched; end it first";
            return Err(Rejection::new("not_in_this_mode", message));
        }
        if let Some(lesson) = run.lesson().filter(|_| run.ended().is_none()) {
            lesson.check_guess_submitted(weeks_passed(run))?;
        }
        let Some(folder) = run.folder() else {
            return Err(Rejection::new("not_saved", "a run in memory cannot be branched"));
        };
        let day = week.saturating_sub(1).saturating_mul(run.params().run.days_per_week);
        if week == 0 || day > run.day() {
            let last = run.day() / run.params().run.days_per_week + 1;
            return Err(Rejection::for_field(
                "week",
                "week_unknown",
                format!("cannot branch from week {week}; choose a week from 1 to {last}"),
            ));
        }
        let trajectory =
            Trajectory::read(&folder.join("trajectory.jsonl")).map_err(branch_not_saved_rejection)?;
        stage_branch(folder, run.manifest(), lines_before(&trajectory, day), mode)
    }
}

/// Returns the rejection for a line or file that could not be written.
pub fn branch_not_saved_rejection(error: RunError) -> Rejection {
    Rejection::new("not_saved", error.to_string())
}

/// Creates a branch from the first lines of a run, in a folder next to the run, and opens it.
///
/// # Errors
/// - `not_in_this_mode`: the branch would be a baseline run, or it would not be a debug run although the copied lines
///   change parameters or the run has a seeded fault.
/// - `not_saved`: the folder cannot be written.
pub(crate) fn create_branch(
    folder: &Path,
    parent: &Manifest,
    lines: &[Line],
    mode: Mode,
) -> Result<Session, Rejection> {
    stage_branch(folder, parent, lines, mode)?.publish().map_err(branch_not_saved_rejection)
}

fn stage_branch(
    folder: &Path,
    parent: &Manifest,
    lines: &[Line],
    mode: Mode,
) -> Result<StagedBranch, Rejection> {
    if mode == Mode::Baseline {
        return Err(Rejection::new("not_in_this_mode", "a branch can have any mode except baseline"));
    }
    if mode != Mode::Debug && parent.fault.is_some() {
        let message = "the run has a seeded fault, so its branches must be debug runs";
        return Err(Rejection::new("not_in_this_mode", message));
    }
    let shared = state_lines(lines);
    if mode != Mode::Debug
        && parent.lesson.is_none()
        && shared.iter().any(|line| matches!(line.record, Record::Override(_)))
    {
        let message = "parameters of the run were changed, so its branches must be debug runs";
        return Err(Rejection::new("not_in_this_mode", message));
    }
    let manifest = Manifest {
        id: new_run_id(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        created: now(),
        format: FORMAT,
        mode,
        study: None,
        lesson: None,
        handout: None,
        rules: Some(SessionRules::for_mode(mode)),
        parent: Some(Parent { run: parent.id.clone(), seq: shared.last().map_or(0, |line| line.seq) }),
        ..parent.clone()
    };
    StagedBranch::create(folder, &manifest, &shared).map_err(branch_not_saved_rejection)
}

/// Creates another attempt at a lesson that starts on a day of an earlier attempt, and opens the new run.
///
/// # Errors
/// The rejection `not_saved`.
pub fn create_lesson_branch(
    folder: &Path,
    parent: &Manifest,
    trajectory: &Trajectory,
    day: u32,
) -> Result<Session, Rejection> {
    let lines = lines_before(trajectory, day);
    let is_of_lesson =
        |line: &&Line| changes_state(line) || matches!(line.record, Record::Activity(Activity::Lesson(_)));
    let start = lines_before_step(&trajectory.lines[lines.len()..], day);
    let shared: Vec<&Line> = lines.iter().filter(is_of_lesson).chain(start).collect();
    let manifest = Manifest {
        id: new_run_id(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        created: now(),
        format: FORMAT,
        parent: Some(Parent { run: parent.id.clone(), seq: shared.last().map_or(0, |line| line.seq) }),
        ..parent.clone()
    };
    StagedBranch::create(folder, &manifest, &shared)
        .and_then(StagedBranch::publish)
        .map_err(branch_not_saved_rejection)
}

/// Returns the lesson's lines on the first day of a step, before the step starts: the initial calls, and the
/// evaluation of the previous step.
fn lines_before_step(lines: &[Line], day: u32) -> impl Iterator<Item = &Line> {
    let begins = |line: &Line| match &line.record {
        Record::Activity(Activity::Lesson(note)) => note.event == LessonEvent::Begun,
        _ => false,
    };
    let is_of_lesson = |line: &&Line| match &line.record {
        Record::Activity(Activity::Lesson(_)) => true,
        record => record.accepted_call().is_some_and(|(call, _)| call.via == Via::Lesson),
    };
    lines.iter().take_while(move |line| line.day == day && !begins(line)).filter(is_of_lesson)
}

/// Returns the lines before the decisions of a day, including the line that closes the week on that day.
fn lines_before(trajectory: &Trajectory, day: u32) -> &[Line] {
    let is_before = |line: &Line| {
        let is_voice_line_of_day = line.day == day && is_voice_line(line);
        line.day < day || (line.day == day && line.closes_days()) || is_voice_line_of_day || line.seq == 0
    };
    let after = trajectory.lines.iter().position(|line| !is_before(line));
    &trajectory.lines[..after.unwrap_or(trajectory.lines.len())]
}

/// Returns whether a language model produced the line. The lines of a model are written before the decisions of the
/// day.
fn is_voice_line(line: &Line) -> bool {
    matches!(line.record, Record::Voice(_))
}

/// Returns the lines that determine the state of the company.
fn state_lines(lines: &[Line]) -> Vec<&Line> {
    lines.iter().filter(|line| changes_state(line)).collect()
}

fn changes_state(line: &Line) -> bool {
    let record = &line.record;
    record.accepted_call().is_some()
        || matches!(
            record,
            Record::Advance(_) | Record::Voice(_) | Record::Week(_) | Record::Step(_) | Record::Override(_)
        )
}

/// Writes the files of a branch with the given lines of its parent, without opening the branch.
///
/// # Errors
/// The folder cannot be written.
pub fn create_branch_files(folder: &Path, manifest: &Manifest, lines: &[Line]) -> Result<(), RunError> {
    create_folder(folder)?;
    write_branch_files(folder, manifest, &state_lines(lines))
}
