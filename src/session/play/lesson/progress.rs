//! Restrictions of a lesson before a week, and progress of the lesson after a week.

use serde_json::json;

use crate::play::Session;
use crate::play::tool_call::not_saved_rejection;
use novamind_record::lesson::LessonProgress;
use novamind_record::trajectory::record::{Activity, RecordedLessonEvent, RunEndReason, Via};
use novamind_record::trajectory::{Durability, Record};
use novamind_tools::{Rejection, ToolId};

/// Returns the number of whole weeks that have been simulated.
pub fn weeks_passed(session: &Session) -> u32 {
    session.day() / session.params().run.days_per_week
}

/// Returns the index of the step to which the next week belongs. Returns `None` outside lessons and after the part has
/// ended.
pub fn lesson_step(session: &Session) -> Option<usize> {
    let lesson_progress = session.lesson().filter(|_| session.ended().is_none())?;
    lesson_progress.current_part().step_at_week(weeks_passed(session))
}

impl Session {
    /// Returns the student's progress in the lesson of this run, or `None` if the run is not a lesson run.
    pub fn lesson(&self) -> Option<&LessonProgress> {
        self.lesson.as_deref()
    }

    pub(crate) fn check_lesson_tool(&self, tool: ToolId, via: Via) -> Result<(), Rejection> {
        let lesson_progress = self.lesson.as_deref().filter(|_| via != Via::Lesson);
        lesson_progress.map_or(Ok(()), |lesson_progress| lesson_progress.check_tool(tool))
    }

    /// Rejects a week if the question of the step is unanswered, or if the lesson has ended.
    pub(crate) fn check_lesson_week(&self, via: Via) -> Result<(), Rejection> {
        let Some(lesson_progress) = self.lesson.as_deref().filter(|_| via != Via::Lesson) else {
            return Ok(());
        };
        let Some(step) = lesson_step(self) else {
            return Err(Rejection::new(
                "lesson_over",
                "the lesson has ended; open its debrief to see the result",
            ));
        };
        if lesson_progress.has_started(step) {
            return lesson_progress.check_guess_submitted(weeks_passed(self));
        }
        let message =
            "the goals of the previous step are not judged yet; close the run and open it again to continue";
        Err(Rejection::new("step_not_begun", message))
    }

    pub(crate) fn prepare_lesson_week(&mut self) -> Result<(), Rejection> {
        if !self
            .lesson
            .as_deref()
            .is_some_and(|lesson_progress| lesson_progress.current_part().has_automatic_capacity())
        {
            return Ok(());
        }
        let (now, next) = (self.settings().core.capacity_tier, self.company().capacity_step_toward_usage());
        if now == next {
            return Ok(());
        }
        self.call(ToolId::SetCapacityTier, &json!({ "tier": next }), Via::Lesson).map(|_| ())
    }

    /// Judges a week before the `end` line of the run is written. If a step has ended, judges the step and starts the
    /// next step. After the last step, ends the run. Does not change existing judgements.
    pub(crate) fn finish_lesson_week(&mut self) {
        let is_open = self.ended().is_none();
        let Some(lesson_progress) = self.lesson.as_deref().filter(|_| is_open).cloned() else { return };
        let is_over = self.simulation().world.is_over(self.params());
        // A week that ends early by bankruptcy counts as a week.
        let weeks = self.day().div_ceil(self.params().run.days_per_week);
        let part = lesson_progress.current_part();
        let step = part.step_at_week(weeks.saturating_sub(1));
        let Some(step) =
            step.filter(|step| lesson_progress.has_started(*step) && !lesson_progress.has_started(step + 1))
        else {
            return;
        };
        if lesson_progress.is_judged {
            // SQL statements must return the rows of the week.
            self.commit_projection();
            self.record_pitfalls(&lesson_progress, step, weeks);
        }
        let (begin, end) = part.step_weeks(step);
        if weeks < end && !is_over {
            return;
        }
        if lesson_progress.is_judged {
            if self.lacks_rule_evaluator(&lesson_progress, step) {
                // `set_rule_evaluator` judges the step later.
                return;
            }
            self.judge_guesses(&lesson_progress, step, is_over);
            self.judge_goals(&lesson_progress, step, begin);
        }
        if is_over {
            return;
        }
        match part.steps.get(step + 1) {
            Some(_) => {
                let _ = self.start_step(step + 1, 1);
            }
            None => {
                self.close_run(RunEndReason::Lesson);
            }
        }
    }

    /// Records an event of the lesson on the current day.
    ///
    /// # Errors
    /// One of the rejections `not_in_a_lesson`, `not_saved`.
    pub fn record_lesson_event(&mut self, note: RecordedLessonEvent) -> Result<(), Rejection> {
        if self.lesson.is_none() {
            return Err(Rejection::new("not_in_a_lesson", "this run is not part of a lesson"));
        }
        self.append(&Record::Activity(Activity::Lesson(note.clone())), Durability::Synced)
            .map_err(not_saved_rejection)?;
        let day = self.day();
        if let Some(lesson_progress) = &mut self.lesson {
            lesson_progress.events.push((day, note));
        }
        Ok(())
    }
}
