//! Reference plays: scheduled calls of a lesson, played in memory.

use super::progress::lesson_step;
use std::sync::Arc;

use crate::create::NewRun;
use crate::create::lesson_entry::LessonEntry;
use crate::play::{RuleEvaluator, Session};
use novamind_record::error::RunError;
use novamind_record::folder::configuration::Configuration;
use novamind_record::lesson::{Lesson, LessonCall, ScheduledCalls};
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::{LessonEvent, LessonNote, Via};
use novamind_tools::Rejection;

/// A scheduled play of a part.
#[derive(Debug, Clone, PartialEq)]
pub struct PartPlay<'a> {
    /// The lesson.
    pub lesson: &'a Arc<Lesson>,
    /// Index of the part, from 0.
    pub part: usize,
    /// The seed; by default that of the part.
    pub seed: Option<u64>,
    /// Scheduled calls.
    pub scheduled_calls: &'a [ScheduledCalls],
    /// Number of weeks after which the play stops; by default at the end of the part.
    pub weeks: Option<u32>,
    /// Whether goals and pitfalls are checked.
    pub is_judged: bool,
    /// Whether it needs a database.
    pub needs_database: bool,
}

pub(super) fn uses_rules(plays: &[ScheduledCalls]) -> bool {
    let is_rules = |call: &LessonCall| matches!(call, LessonCall::Rules(_));
    plays.iter().any(|play| play.calls.iter().any(is_rules))
}

/// Plays a part in memory.
///
/// # Errors
/// The part cannot start, or a call is rejected.
pub fn play_part(play: &PartPlay<'_>, answers: RuleEvaluator) -> Result<Session, RunError> {
    play_part_with_hooks(play, answers, &mut |_| {}, &mut |_, _| Ok(()))
}

/// Like [`play_part`]. `before_week` is called before each week, after its calls. `after_week` is called with the
/// number of weeks that have passed.
///
/// # Errors
/// As [`play_part`], and the errors of `after_week`.
pub fn play_part_with_hooks(
    play: &PartPlay<'_>,
    answers: RuleEvaluator,
    before_week: &mut dyn FnMut(&Session),
    after_week: &mut dyn FnMut(&mut Session, u32) -> Result<(), RunError>,
) -> Result<Session, RunError> {
    let part = &play.lesson.plan.parts[play.part];
    let entry = LessonEntry { lesson: play.lesson.clone(), part: play.part, is_judged: play.is_judged };
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
        made.map_err(|refusal| {
            let name = &play.lesson.name;
            RunError::InvalidRequest(format!("lesson {name}, part {}, week {week}: {refusal}", play.part + 1))
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
        let about = LessonNote::new(LessonEvent::Guess, step as u32 + 1);
        session.record_lesson_event(LessonNote { value: Some(1.0), ..about })?;
    }
    let forecasts = session.company().naive_forecasts();
    session.advance("reference play", &forecasts, Via::Script, &mut |_| {}).map(|_| ())
}
