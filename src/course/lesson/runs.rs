//! Starts further runs of a lesson: a new try of a step, or a different part.

use novamind_record::error::RunError;
use novamind_record::folder::configuration::Configuration;
use novamind_record::lesson::LessonProgress;
use novamind_record::mode::Mode;
use novamind_record::stamp::HandoutOptions;
use novamind_record::trajectory::Trajectory;
use novamind_record::trajectory::record::{LessonEvent, RecordedLessonEvent};
use novamind_session::{LessonOptions, NewRun, Session, Storage, create_lesson_branch};
use novamind_tools::Rejection;

/// Returns the lesson of a run, or the rejection `not_in_a_lesson`.
pub(super) fn require_lesson(session: &Session) -> Result<&LessonProgress, Rejection> {
    session.lesson().ok_or_else(|| Rejection::new("not_in_a_lesson", "this run is not part of a lesson"))
}

/// Retries a step from its beginning in a new run. The record of the new run contains the number of the try. Steps are
/// counted from 0.
///
/// # Errors
/// `not_in_a_lesson`, `step_unknown` for a step that has not started, `not_saved`.
pub fn retry_step(session: &Session, step: usize) -> Result<Session, Rejection> {
    let lesson_progress = require_lesson(session)?;
    if !lesson_progress.has_started(step) {
        let message = format!("choose a step from 1 to {}", lesson_progress.last_started_step() + 1);
        return Err(Rejection::for_field("step", "step_unknown", message));
    }
    let Some(folder) = session.folder() else {
        return Err(Rejection::new("not_saved", "a run in memory cannot be retried"));
    };
    let trajectory = Trajectory::read(&folder.join("trajectory.jsonl")).map_err(not_saved_rejection)?;
    let started = lesson_progress.current_part().step_weeks(step).0 * session.params().run.days_per_week;
    let mut retry = create_lesson_branch(folder, session.manifest(), &trajectory, started)?;
    // The first guess counts, because the student has seen the outcome.
    if let Some(value) = lesson_progress.guess(step) {
        let about = RecordedLessonEvent::new(LessonEvent::Guess, step as u32 + 1);
        retry.record_lesson_event(RecordedLessonEvent { value: Some(value), ..about })?;
    }
    Ok(retry)
}

/// Starts a part of the lesson as a new run in the same folder of runs. Parts are counted from 0.
///
/// # Errors
/// `not_in_a_lesson`, `part_unknown`, `not_saved`.
pub fn start_part(session: &Session, part: usize) -> Result<Session, Rejection> {
    let lesson_progress = require_lesson(session)?;
    let parts = lesson_progress.lesson.plan.parts.len();
    if part >= parts {
        return Err(Rejection::for_field("part", "part_unknown", format!("choose a part from 1 to {parts}")));
    }
    let Some(runs) = session.folder().and_then(|folder| folder.parent()) else {
        return Err(Rejection::new("not_saved", "a run in memory has no other parts"));
    };
    let manifest = session.manifest();
    let new = NewRun {
        mode: Mode::Lesson,
        participant: manifest.participant.clone(),
        lesson: Some(LessonOptions { lesson: lesson_progress.lesson.clone(), part, is_judged: true }),
        handout: manifest.handout.clone().map(HandoutOptions::for_later_run),
        storage: Storage::Runs(runs.to_owned()),
        ..NewRun::default()
    };
    Session::create(new, &Configuration::bundled()).map_err(not_saved_rejection)
}

fn not_saved_rejection(error: RunError) -> Rejection {
    Rejection::new("not_saved", error.to_string())
}
