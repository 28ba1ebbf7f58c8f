//! Progress of a lesson before and after a week, and its restrictions.

use serde_json::json;

use crate::play::Session;
use crate::play::act::not_saved;
use novamind_record::lesson::LessonStanding;
use novamind_record::trajectory::record::{Activity, Ended, LessonNote, Via};
use novamind_record::trajectory::{Durability, Record};
use novamind_tools::{Refusal, ToolId};

/// Returns the whole weeks that have passed.
pub fn weeks_passed(session: &Session) -> u32 {
    session.day() / session.params().run.days_per_week
}

/// Returns the step that the next week belongs to, counted from 0; `None` outside lessons and once the part has ended.
pub fn lesson_step(session: &Session) -> Option<usize> {
    let standing = session.lesson().filter(|_| session.ended().is_none())?;
    standing.own_part().step_after(weeks_passed(session))
}

impl Session {
    /// Returns the position of the student in the lesson of this run; `None` outside lessons.
    pub fn lesson(&self) -> Option<&LessonStanding> {
        self.lesson.as_deref()
    }

    pub(crate) fn refuse_outside_lesson(&self, tool: ToolId, via: Via) -> Result<(), Refusal> {
        let standing = self.lesson.as_deref().filter(|_| via != Via::Lesson);
        standing.map_or(Ok(()), |standing| standing.refuse_tool(tool))
    }

    /// Rejects a week if the question of the lesson has no answer yet, or if the lesson has ended.
    pub(crate) fn refuse_week_of_lesson(&self, via: Via) -> Result<(), Refusal> {
        let Some(standing) = self.lesson.as_deref().filter(|_| via != Via::Lesson) else { return Ok(()) };
        let Some(step) = lesson_step(self) else {
            return Err(Refusal::new(
                "lesson_over",
                "the lesson has ended; open its debrief to see the result",
            ));
        };
        if standing.has_begun(step) {
            return standing.refuse_before_guess(weeks_passed(self));
        }
        let message =
            "the goals of the previous step are not judged yet; close the run and open it again to continue";
        Err(Refusal::new("step_not_begun", message))
    }

    pub(crate) fn prepare_week_of_lesson(&mut self) -> Result<(), Refusal> {
        if !self.lesson.as_deref().is_some_and(|own| own.own_part().moves_capacity()) {
            return Ok(());
        }
        let (now, next) = (self.settings().core.capacity_tier, self.company().capacity_towards_usage());
        if now == next {
            return Ok(());
        }
        self.call(ToolId::SetCapacityTier, &json!({ "tier": next }), Via::Lesson).map(|_| ())
    }

    /// Judges a week, before the line that ends the run. When a step has ended, judges it and starts the next one;
    /// after the last step the run ends. Existing judgements are not changed.
    pub(crate) fn settle_lesson(&mut self) {
        let is_open = self.ended().is_none();
        let Some(standing) = self.lesson.as_deref().filter(|_| is_open).cloned() else { return };
        let is_over = self.simulation().world.is_over(self.params());
        // A week with a bankruptcy counts.
        let weeks = self.day().div_ceil(self.params().run.days_per_week);
        let part = standing.own_part();
        let step = part.step_after(weeks.saturating_sub(1));
        let Some(step) = step.filter(|step| standing.has_begun(*step) && !standing.has_begun(step + 1))
        else {
            return;
        };
        if standing.is_judged {
            // Statements must see the week.
            self.commit_projection();
            self.note_pitfalls(&standing, step, weeks);
        }
        let (begin, end) = part.weeks_of(step);
        if weeks < end && !is_over {
            return;
        }
        if standing.is_judged {
            if self.lacks_answers(&standing, step) {
                // It is judged when `answer_companies_by` is called.
                return;
            }
            self.judge_guesses(&standing, step, is_over);
            self.judge_goals(&standing, step, begin);
        }
        if is_over {
            return;
        }
        match part.steps.get(step + 1) {
            Some(_) => {
                let _ = self.begin_step(step + 1, 1);
            }
            None => {
                self.close_run(Ended::Lesson);
            }
        }
    }

    /// Records an event of the lesson on the current day.
    ///
    /// # Errors
    /// `not_in_a_lesson`, `not_saved`.
    pub fn note_lesson(&mut self, note: LessonNote) -> Result<(), Refusal> {
        if self.lesson.is_none() {
            return Err(Refusal::new("not_in_a_lesson", "this run is not part of a lesson"));
        }
        self.append(&Record::Activity(Activity::Lesson(note.clone())), Durability::Synced)
            .map_err(not_saved)?;
        let day = self.day();
        if let Some(standing) = &mut self.lesson {
            standing.notes.push((day, note));
        }
        Ok(())
    }
}
