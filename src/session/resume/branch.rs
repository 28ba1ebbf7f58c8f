//! Branches: a new run that shares the past of another up to a decision day.

use std::path::Path;

use super::unnamed::{UnnamedBranch, write_branch};
use crate::play::Session;
use crate::play::lesson::conduct::weeks_passed;
use crate::recording::folders::new_id;
use novamind_record::clock::now;
use novamind_record::error::RunError;
use novamind_record::files::create_folder;
use novamind_record::folder::manifest::{FORMAT, Manifest};
use novamind_record::mode::Mode;
use novamind_record::rules::SessionRules;
use novamind_record::trajectory::record::{Activity, LessonEvent, Parent, Via};
use novamind_record::trajectory::{Line, Record, Trajectory};
use novamind_tools::Refusal;

impl Session {
    /// Starts a branch at the beginning of a week, counted from 1, and opens it.
    ///
    /// # Errors
    /// `not_in_this_mode` for an unfinished baseline run, a baseline branch, and one that is no debug run though parameters
    /// were set in its past or a fault was planted; `guess_first` while the question of a lesson is open; `week_unknown`,
    /// `not_saved`.
    pub fn branch(&self, week: u32, mode: Mode) -> Result<Session, Refusal> {
        UnnamedBranch::begin(self, week, mode)?.name().map_err(not_saved)
    }
}

impl UnnamedBranch {
    /// Begins a branch that has no name yet.
    ///
    /// # Errors
    /// As for [`Session::branch`].
    pub fn begin(run: &Session, week: u32, mode: Mode) -> Result<UnnamedBranch, Refusal> {
        if run.manifest().mode == Mode::Baseline && run.ended().is_none() {
            let message = "an unfinished baseline run cannot be branched; end it first";
            return Err(Refusal::new("not_in_this_mode", message));
        }
        if let Some(lesson) = run.lesson().filter(|_| run.ended().is_none()) {
            lesson.refuse_before_guess(weeks_passed(run))?;
        }
        let Some(folder) = run.folder() else {
            return Err(Refusal::new("not_saved", "a run in memory cannot be branched"));
        };
        let day = week.saturating_sub(1).saturating_mul(run.params().run.days_per_week);
        if week == 0 || day > run.day() {
            let last = run.day() / run.params().run.days_per_week + 1;
            return Err(Refusal::at(
                "week",
                "week_unknown",
                format!("cannot branch from week {week}; choose a week from 1 to {last}"),
            ));
        }
        let trajectory = Trajectory::read(&folder.join("trajectory.jsonl")).map_err(not_saved)?;
        unnamed_branch(folder, run.manifest(), before(&trajectory, day), mode)
    }
}

/// The refusal for a write that failed.
pub fn not_saved(error: RunError) -> Refusal {
    Refusal::new("not_saved", error.to_string())
}

/// Starts a run beside another that shares some of its lines, and opens it.
///
/// # Errors
/// `not_in_this_mode` for a baseline branch, and for one that is no debug run though parameters were set in its past or a fault
/// was planted;
/// `not_saved`.
pub(crate) fn branch_of(
    folder: &Path,
    parent: &Manifest,
    lines: &[Line],
    mode: Mode,
) -> Result<Session, Refusal> {
    unnamed_branch(folder, parent, lines, mode)?.name().map_err(not_saved)
}

fn unnamed_branch(
    folder: &Path,
    parent: &Manifest,
    lines: &[Line],
    mode: Mode,
) -> Result<UnnamedBranch, Refusal> {
    if mode == Mode::Baseline {
        return Err(Refusal::new("not_in_this_mode", "a branch can have any mode but baseline"));
    }
    if mode != Mode::Debug && parent.fault.is_some() {
        let message = "it has a planted fault, so a branch of it is a debug run";
        return Err(Refusal::new("not_in_this_mode", message));
    }
    let shared = shared_lines(lines);
    if mode != Mode::Debug
        && parent.lesson.is_none()
        && shared.iter().any(|line| matches!(line.record, Record::Override(_)))
    {
        let message = "parameters were set in its past, so a branch of it is a debug run";
        return Err(Refusal::new("not_in_this_mode", message));
    }
    let manifest = Manifest {
        id: new_id(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        created: now(),
        format: FORMAT,
        mode,
        study: None,
        lesson: None,
        handout: None,
        rules: Some(SessionRules::of_mode(mode)),
        parent: Some(Parent { run: parent.id.clone(), seq: shared.last().map_or(0, |line| line.seq) }),
        ..parent.clone()
    };
    UnnamedBranch::write(folder, &manifest, &shared).map_err(not_saved)
}

/// Starts a run that is another try of a lesson from a day on, and opens it.
///
/// # Errors
/// `not_saved`.
pub fn branch_of_lesson(
    folder: &Path,
    parent: &Manifest,
    trajectory: &Trajectory,
    day: u32,
) -> Result<Session, Refusal> {
    let lines = before(trajectory, day);
    let is_of_lesson =
        |line: &&Line| makes_company(line) || matches!(line.record, Record::Activity(Activity::Lesson(_)));
    let start = before_step(&trajectory.lines[lines.len()..], day);
    let shared: Vec<&Line> = lines.iter().filter(is_of_lesson).chain(start).collect();
    let manifest = Manifest {
        id: new_id(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        created: now(),
        format: FORMAT,
        parent: Some(Parent { run: parent.id.clone(), seq: shared.last().map_or(0, |line| line.seq) }),
        ..parent.clone()
    };
    UnnamedBranch::write(folder, &manifest, &shared).and_then(UnnamedBranch::name).map_err(not_saved)
}

/// What the lesson does on the day on which a step begins, before it does: the calls of its start, and what the step before
/// came to.
fn before_step(lines: &[Line], day: u32) -> impl Iterator<Item = &Line> {
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

/// The lines before a decision day: those of the days before it and the week that ends on it, without what was
/// decided on that day itself.
fn before(trajectory: &Trajectory, day: u32) -> &[Line] {
    let is_before = |line: &Line| {
        let said_on_it = line.day == day && is_of_model(line);
        line.day < day || (line.day == day && line.closes_days()) || said_on_it || line.seq == 0
    };
    let after = trajectory.lines.iter().position(|line| !is_before(line));
    &trajectory.lines[..after.unwrap_or(trajectory.lines.len())]
}

/// Whether a language model said it: that is written before anything is decided on its day.
fn is_of_model(line: &Line) -> bool {
    matches!(line.record, Record::Voice(_))
}

/// Those lines that make a company what it is.
fn shared_lines(lines: &[Line]) -> Vec<&Line> {
    lines.iter().filter(|line| makes_company(line)).collect()
}

fn makes_company(line: &Line) -> bool {
    let record = &line.record;
    record.accepted_call().is_some()
        || matches!(
            record,
            Record::Advance(_) | Record::Voice(_) | Record::Week(_) | Record::Step(_) | Record::Override(_)
        )
}

/// Writes the files of a branch that shares some lines with its parent; nothing is opened.
///
/// # Errors
/// The folder cannot be written.
pub fn write_past(folder: &Path, manifest: &Manifest, lines: &[Line]) -> Result<(), RunError> {
    create_folder(folder)?;
    write_branch(folder, manifest, &shared_lines(lines))
}
