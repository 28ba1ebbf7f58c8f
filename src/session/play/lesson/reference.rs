//! Reference plays: scheduled calls of a lesson that are executed in a run in memory.

use super::progress::lesson_step;
use std::sync::Arc;

use crate::create::NewRun;
use crate::create::lesson_entry::LessonOptions;
use crate::play::{RuleEvaluator, Session};
use novamind_record::error::RunError;
use novamind_record::folder::configuration::Configuration;
use novamind_record::lesson::{Lesson, LessonCall, ScheduledCalls};
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::{LessonEvent, RecordedLessonEvent, Via};
use novamind_tools::Rejection;

/// A play of a lesson part with scheduled calls.
#[derive(Debug, Clone, PartialEq)]
pub struct PartPlay<'a> {
    /// Lesson that contains the part.
    pub lesson: &'a Arc<Lesson>,
    /// Index of the part, from 0.
    pub part: usize,
    /// Seed of the run; defaults to the seed of the part.
    pub seed: Option<u64>,
    /// Calls of the play, by part and week.
    pub scheduled_calls: &'a [ScheduledCalls],
    /// Number of weeks after which the play stops; defaults to the length of the part.
    pub weeks: Option<u32>,
    /// Whether goals and pitfalls are checked.
    pub is_judged: bool,
    /// Whether the play needs a database for measurements.
    pub needs_database: bool,
}

pub(super) fn uses_rules(plays: &[ScheduledCalls]) -> bool {
    let is_rules = |call: &LessonCall| matches!(call, LessonCall::Rules(_));
    plays.iter().any(|play| play.calls.iter().any(is_rules))
}

/// Plays a part in memory and returns its session.
///
/// # Errors
/// The part cannot start, or a call is rejected.
pub fn play_part(play: &PartPlay<'_>, answers: RuleEvaluator) -> Result<Session, RunError> {
    play_part_with_hooks(play, answers, &mut |_| {}, &mut |_, _| Ok(()))
}

/// Plays a part like [`play_part`]. Calls `before_week` before each week, after the scheduled calls of that week.
/// Calls `after_week` with the number of simulated weeks.
///
/// # Errors
/// The same errors as [`play_part`], and the errors of `after_week`.
pub fn play_part_with_hooks(
    play: &PartPlay<'_>,
    answers: RuleEvaluator,
    before_week: &mut dyn FnMut(&Session),
    after_week: &mut dyn FnMut(&mut Session, u32) -> Result<(), RunError>,
) -> Result<Session, RunError> {
    let part = &play.lesson.plan.parts[play.part];
    let entry = LessonOptions { lesson: play.lesson.clone(), part: play.part, is_judged: play.is_judged };
    let new = NewRun {
        mode: Mode::Lesson,
        seed: play.seed,
        lesson: Some(entry),
        // Rules query the database for open threads.
        projection: play.needs_database || uses_rules(play.scheduled_calls),
        ..NewRun::default()
    };
    let mut session = Session::create(new, &Configuration::bundled())?;
    session.rule_evaluator = Some(answers);
    let last = play.weeks.unwrap_or(part.weeks()).min(part.weeks());
    for week in part.start_weeks..last {
        if session.ended().is_some() {
            break;
        }
        let made = play_week(&mut session, play, week, answers, before_week);
        made.map_err(|rejection| {
            let name = &play.lesson.name;
            RunError::InvalidRequest(format!(
                "lesson {name}, part {}, week {week}: {rejection}",
                play.part + 1
            ))
        })?;
        after_week(&mut session, week + 1)?;
    }
    Ok(session)
}

fn play_week(
    session: &mut Session,
    play: &PartPlay<'_>,
    week: u32,
    answers: RuleEvaluator,
    before_week: &mut dyn FnMut(&Session),
) -> Result<(), Rejection> {
    let due = play.scheduled_calls.iter().filter(|scheduled_calls| scheduled_calls.are_due(play.part, week));
    for call in due.flat_map(|calls| &calls.calls) {
        match call {
            LessonCall::Tool(tool, args) => {
                session.call(tool, args, Via::Script)?;
            }
            LessonCall::Rules(rules) => {
                for (tool, args) in answers(rules, session)? {
                    session.call(tool, &args, Via::Script)?;
                }
            }
        }
    }
    before_week(session);
    let awaits =
        |step: &usize| session.lesson().is_some_and(|lesson_progress| lesson_progress.awaits_guess(*step));
    if let Some(step) = lesson_step(session).filter(awaits) {
        let about = RecordedLessonEvent::new(LessonEvent::Guess, step as u32 + 1);
        session.record_lesson_event(RecordedLessonEvent { value: Some(1.0), ..about })?;
    }
    let forecasts = session.company().naive_forecasts();
    session.advance("reference play", &forecasts, Via::Script, &mut |_| {}).map(|_| ())
}
