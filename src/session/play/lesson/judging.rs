//! Evaluation of a lesson step: measurement of goals, guesses and pitfalls, and comparison of goals with the reference
//! play.

use super::progress::weeks_passed;
use super::reference::{PartPlay, play_part, uses_rules};
use crate::play::{RuleEvaluator, Session};
use novamind_database::Cell;
use novamind_record::lesson::{
    Guess, GuessForm, LessonGoal, LessonProgress, MeasurementSpec, OutcomeTiming, Pitfall,
};
use novamind_record::trajectory::record::{LessonEvent, RecordedLessonEvent};
use novamind_tools::Rejection;

/// Evaluates a measurement over the weeks that end after `from_day`. Returns `None` if the measurement has no value.
///
/// # Errors
/// The statement is rejected, or does not return one number.
pub fn measure(
    measurement: &MeasurementSpec,
    session: &mut Session,
    from_day: u32,
) -> Result<Option<f64>, String> {
    match measurement.statement(from_day + 1, session.day()) {
        Some(sql) => query_number(session, &sql),
        None => Ok(measurement.aggregate(session.weeks().iter().filter(|week| week.day > from_day))),
    }
}

fn query_number(session: &mut Session, sql: &str) -> Result<Option<f64>, String> {
    let rows = session.query_unrecorded(sql).map_err(|rejection| rejection.message)?;
    match rows.rows.as_slice() {
        [row] if row.len() == 1 => Ok(match &row[0] {
            Cell::Integer(number) => Some(*number as f64),
            Cell::Real(number) => Some(*number),
            _ => None,
        }),
        rows => Err(format!("the statement returns {} rows, not one number", rows.len())),
    }
}

impl Session {
    /// Sets the function that evaluates rules. Goals relative to a reference play with rules need this function.
    /// Judges a completed step that could not be judged without the function.
    pub fn set_rule_evaluator(&mut self, answers: RuleEvaluator) {
        self.rule_evaluator = Some(answers);
        if self.log().is_written() && self.awaits_judgement() {
            self.finish_lesson_week();
        }
    }

    /// Returns whether the weeks of a step have passed and the next step has not started.
    fn awaits_judgement(&self) -> bool {
        let Some(lesson_progress) = self.lesson.as_deref().filter(|_| self.ended().is_none()) else {
            return false;
        };
        let (part, weeks) = (lesson_progress.current_part(), weeks_passed(self));
        let step = weeks.checked_sub(1).and_then(|before| part.step_at_week(before));
        step.is_some_and(|step| {
            lesson_progress.has_started(step)
                && !lesson_progress.has_started(step + 1)
                && weeks == part.step_weeks(step).1
        })
    }

    /// Returns whether judging a step needs a function that evaluates rules, and this function is not set.
    pub(super) fn lacks_rule_evaluator(&self, lesson_progress: &LessonProgress, step: usize) -> bool {
        let is_relative = |goal: &LessonGoal| goal.bound.is_relative();
        self.rule_evaluator.is_none()
            && lesson_progress.step(step).is_some_and(|lesson_step| lesson_step.goals.iter().any(is_relative))
            && uses_rules(&lesson_progress.lesson.plan.good.plays)
    }

    /// Records the pitfalls that were first triggered in the last week.
    pub(super) fn record_pitfalls(&mut self, lesson_progress: &LessonProgress, step: usize, weeks: u32) {
        let texts = lesson_progress.triggered_pitfall_names();
        let is_open = |pitfall: &&Pitfall| {
            pitfall.part == lesson_progress.part && !texts.contains(&pitfall.name.as_str())
        };
        let from = weeks.saturating_sub(1) * self.params().run.days_per_week;
        for pitfall in lesson_progress.lesson.plan.pitfalls.iter().filter(is_open) {
            let value = measure(&pitfall.measurement, self, from).ok().flatten();
            if value.is_some_and(|value| pitfall.bound.is_triggered_by(value)) {
                let about = RecordedLessonEvent::new(LessonEvent::Pitfall, step as u32 + 1);
                let (name, bound) = (Some(pitfall.name.clone()), Some(pitfall.bound.limit()));
                let _ = self.record_lesson_event(RecordedLessonEvent { name, value, bound, ..about });
            }
        }
    }

    /// Records the outcomes of the guesses of a completed step. At the end of the part, also records the outcomes that
    /// are due then.
    pub(super) fn judge_guesses(&mut self, lesson_progress: &LessonProgress, step: usize, is_over: bool) {
        let part = lesson_progress.current_part();
        let is_last = is_over || step + 1 == part.steps.len();
        for (at, lesson_step) in part.steps.iter().enumerate().take(step + 1) {
            let Some(guess) = lesson_step.guess.as_ref().filter(|_| lesson_progress.outcome(at).is_none())
            else {
                continue;
            };
            let is_due = if guess.outcome_timing == OutcomeTiming::Part { is_last } else { at == step };
            if is_due {
                let from = part.step_weeks(at).0 * self.params().run.days_per_week;
                let outcome = self.guess_outcome(lesson_progress, guess, at, from);
                let _ = self.record_lesson_event(outcome);
            }
        }
    }

    fn guess_outcome(
        &mut self,
        lesson_progress: &LessonProgress,
        guess: &Guess,
        step: usize,
        from: u32,
    ) -> RecordedLessonEvent {
        let about = RecordedLessonEvent::new(LessonEvent::Outcome, step as u32 + 1);
        match &guess.form {
            GuessForm::Number { outcome, .. } => {
                RecordedLessonEvent { value: measure(outcome, self, from).ok().flatten(), ..about }
            }
            GuessForm::Choice { answer, .. } => {
                let right = *answer as f64 + 1.0;
                let is_correct = lesson_progress.guess(step).map(|guessed| guessed == right);
                RecordedLessonEvent { value: Some(right), met: is_correct, ..about }
            }
        }
    }

    pub(super) fn judge_goals(&mut self, lesson_progress: &LessonProgress, step: usize, begin: u32) {
        let Some(lesson_step) = lesson_progress.step(step) else { return };
        let from = begin * self.params().run.days_per_week;
        let judged = lesson_progress.goal_results(step).len();
        let mut good = self.reference_play(lesson_progress, step);
        for (number, goal) in lesson_step.goals.iter().enumerate().skip(judged) {
            let value = measure(&goal.measurement, self, from).ok().flatten();
            let good = good.as_mut().filter(|_| goal.bound.is_relative());
            let good = good.and_then(|play| measure(&goal.measurement, play, from).ok().flatten());
            let bound = goal.bound.value(good);
            let is_goal_met =
                value.zip(bound).is_some_and(|(value, bound)| goal.bound.is_reached(value, bound));
            let about = RecordedLessonEvent::new(LessonEvent::Goal, step as u32 + 1);
            let number = Some(number as u32 + 1);
            let _ = self.record_lesson_event(RecordedLessonEvent {
                number,
                value,
                bound,
                met: Some(is_goal_met),
                ..about
            });
        }
    }

    /// Returns the reference play on the seed of this run, up to the end of a step. Returns `None` if no goal of the
    /// step depends on the reference play, or if it cannot be simulated.
    fn reference_play(&self, lesson_progress: &LessonProgress, step: usize) -> Option<Session> {
        let goals = &lesson_progress.step(step)?.goals;
        let mut relative = goals.iter().filter(|goal| goal.bound.is_relative()).peekable();
        relative.peek()?;
        let play = PartPlay {
            lesson: &lesson_progress.lesson,
            part: lesson_progress.part,
            seed: Some(self.manifest().seed),
            scheduled_calls: &lesson_progress.lesson.plan.good.plays,
            weeks: Some(lesson_progress.current_part().step_weeks(step).1),
            // Do not judge the goals of the reference play, because judging them would need another reference play.
            is_judged: false,
            needs_database: relative.any(|goal| goal.measurement.needs_database()),
        };
        let refuses: RuleEvaluator = |_, _| Err(Rejection::new("not_possible", "rules are not available"));
        play_part(&play, self.rule_evaluator.unwrap_or(refuses)).ok()
    }
}
