//! Actions of a student in a step of a lesson: answering the question and requesting hints.

use super::runs::require_lesson;
use novamind_record::lesson::{LessonProgress, MeasurementSpec};
use novamind_record::trajectory::record::{LessonEvent, RecordedLessonEvent};
use novamind_session::{Session, lesson_step, measure};
use novamind_tools::Rejection;

/// Records the student's guess for the open question of the current step. `value` is the guessed number or, for a
/// question with choices, the number of the choice, counted from 1.
///
/// # Errors
/// `no_question` if no question is open, `guess_not_possible` if `value` is not finite or not the number of a choice,
/// `run_over`, `not_saved`.
pub fn submit_guess(session: &mut Session, value: f64) -> Result<(), Rejection> {
    let awaits =
        |step: &usize| session.lesson().is_some_and(|lesson_progress| lesson_progress.awaits_guess(*step));
    let Some(step) = lesson_step(session).filter(awaits) else {
        return Err(Rejection::new("no_question", "the lesson has no open question"));
    };
    let choices =
        session.lesson().and_then(|lesson_progress| lesson_progress.choices(step)).map(<[String]>::len);
    let fits = choices.is_none_or(|count| value.fract() == 0.0 && (1.0..=count as f64).contains(&value));
    if !value.is_finite() || !fits {
        let message = match choices {
            Some(count) => format!("choose a number from 1 to {count}"),
            None => "enter a number".to_owned(),
        };
        return Err(Rejection::for_field("guess", "guess_not_possible", message));
    }
    let about = RecordedLessonEvent::new(LessonEvent::Guess, step as u32 + 1);
    session.record_lesson_event(RecordedLessonEvent { value: Some(value), ..about })
}

/// Returns the next hint of the current step and records that the student used the hint.
///
/// # Errors
/// `not_in_a_lesson`, `no_hint` if the step has no further hint, `not_saved`.
pub fn take_hint(session: &mut Session) -> Result<String, Rejection> {
    require_lesson(session)?;
    let Some((step, given, text)) = next_hint(session) else {
        return Err(Rejection::new("no_hint", "this step has no further hint"));
    };
    let about = RecordedLessonEvent::new(LessonEvent::Hint, step as u32 + 1);
    session.record_lesson_event(RecordedLessonEvent { number: Some(given as u32 + 1), ..about })?;
    Ok(text)
}

/// Returns the current step, the number of hints already used in this step, and the text of the next hint.
fn next_hint(session: &Session) -> Option<(usize, usize, String)> {
    let (lesson_progress, step) = (session.lesson()?, lesson_step(session)?);
    let given = lesson_progress.hint_count(step);
    Some((step, given, lesson_progress.lesson.fill_figures(lesson_progress.step(step)?.hints.get(given)?)))
}

/// Evaluates a measurement from the first week in which the student could decide up to the current week.
///
/// # Errors
/// Returns an error if the SQL statement is rejected or does not return a single number.
pub fn measure_over_part(
    measurement: &MeasurementSpec,
    session: &mut Session,
) -> Result<Option<f64>, String> {
    let own_part = session.lesson().map(LessonProgress::current_part);
    let from_week = own_part.map_or(0, |part| part.start_weeks);
    let from_day = from_week * session.params().run.days_per_week;
    measure(measurement, session, from_day)
}
