//! How a lesson goes: what it does by itself before and after a week, and what it asks of the student.

use std::sync::Arc;

use serde_json::json;

use super::definition::{
    ForecastsAsked, GoalBound, Guess, GuessForm, GuessTold, LessonAccess, Pitfall, PitfallBound,
    RationaleAsked,
};
use super::lesson_file::Lesson;
use super::standing::LessonStanding;
use crate::create::NewRun;
use crate::play::Session;
use crate::play::act::not_saved;
use novamind_record::error::RunError;
use novamind_record::stamp::LessonStamp;
use novamind_record::trajectory::record::{Activity, Ended, LessonEvent, LessonNote, Via};
use novamind_record::trajectory::{Durability, Record};
use novamind_tools::{Refusal, ToolId};

/// Which lesson a new run is to be a part of.
#[derive(Debug, Clone, PartialEq)]
pub struct LessonEntry {
    /// The lesson.
    pub lesson: Arc<Lesson>,
    /// The part, counted from 0.
    pub part: usize,
    /// Whether goals and pitfalls are looked at; not in plays that others are held against.
    pub is_judged: bool,
}

impl LessonEntry {
    /// What the first line says of it.
    pub(crate) fn stamp(&self) -> LessonStamp {
        let (name, digest) = (self.lesson.name.clone(), self.lesson.digest.clone());
        LessonStamp { name, digest, part: self.part as u32 + 1 }
    }

    /// A new run with the company of the lesson.
    pub(crate) fn terms_of(&self, new: NewRun) -> NewRun {
        let part = &self.lesson.plan.parts[self.part];
        let quiet = (!part.surges).then(|| ("demand_surge.probability".to_owned(), "0.0".to_owned()));
        let own = part.parameters.iter().map(|(key, value)| (key.clone(), value.to_string()));
        NewRun {
            seed: new.seed.or(Some(part.seed)),
            days: part.days,
            cash: part.cash,
            scenario: part.scenario.clone(),
            overrides: quiet.into_iter().chain(own).collect(),
            ..new
        }
    }
}

impl Session {
    /// Where the student stands in the lesson that this run belongs to; none where it belongs to none.
    pub fn lesson(&self) -> Option<&LessonStanding> {
        self.lesson.as_deref()
    }

    /// The step that the next week belongs to, counted from 0; none outside lessons and once the part is over.
    pub fn lesson_step(&self) -> Option<usize> {
        let standing = self.lesson.as_deref()?;
        standing.own_part().step_after(self.weeks_passed()).filter(|_| self.ended().is_none())
    }

    /// Whole weeks that have passed.
    pub fn weeks_passed(&self) -> u32 {
        self.day() / self.params().run.days_per_week
    }

    /// Refuses a tool that the lesson does not have.
    pub(crate) fn refuse_outside_lesson(&self, tool: ToolId, via: Via) -> Result<(), Refusal> {
        let standing = self.lesson.as_deref().filter(|_| via != Via::Lesson);
        standing.map_or(Ok(()), |standing| standing.refuse_tool(tool))
    }

    /// Whether the lesson asks for no rationale of a week.
    pub fn lesson_asks_no_rationale(&self) -> bool {
        self.lesson_access().is_some_and(|access| access.rationale == RationaleAsked::Off)
    }

    /// Whether the lesson fills the forecasts of a week in naively.
    pub fn lesson_fills_forecasts(&self) -> bool {
        self.lesson_access().is_some_and(|access| access.forecasts == ForecastsAsked::Naive)
    }

    fn lesson_access(&self) -> Option<&LessonAccess> {
        self.lesson.as_deref().map(|standing| &standing.lesson.plan.access)
    }

    /// Refuses a week that the lesson does not let pass: its question is open, or it is over.
    pub(crate) fn refuse_week_of_lesson(&self, via: Via) -> Result<(), Refusal> {
        let Some(standing) = self.lesson.as_deref().filter(|_| via != Via::Lesson) else { return Ok(()) };
        let Some(step) = self.lesson_step() else {
            return Err(Refusal::new("lesson_over", "the lesson is over; its debrief tells what came of it"));
        };
        if standing.has_begun(step) {
            return standing.refuse_before_guess(self.weeks_passed());
        }
        let message =
            "the goals of the step before are not judged yet; close the run and open it again to go on";
        Err(Refusal::new("step_not_begun", message))
    }

    /// What the lesson does by itself before a week.
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

    /// Judges what a week came to, before the line that ends the run. A step that is over is measured and the next begins;
    /// after the last one the run is over. What is judged already stays as it is.
    pub(crate) fn settle_lesson(&mut self) {
        let is_open = self.ended().is_none();
        let Some(standing) = self.lesson.as_deref().filter(|_| is_open).cloned() else { return };
        let is_over = self.simulation().world.is_over(self.params());
        // A week in which the cash ran out counts.
        let weeks = self.day().div_ceil(self.params().run.days_per_week);
        let part = standing.own_part();
        let step = part.step_after(weeks.saturating_sub(1));
        let Some(step) = step.filter(|step| standing.has_begun(*step) && !standing.has_begun(step + 1))
        else {
            return;
        };
        if standing.is_judged {
            // Statements are to see the week.
            self.commit_projection();
            self.note_pitfalls(&standing, step, weeks);
        }
        let (begin, end) = part.weeks_of(step);
        if weeks < end && !is_over {
            return;
        }
        if standing.is_judged {
            if self.lacks_answers(&standing, step) {
                // It is judged when somebody says how rules answer companies.
                return;
            }
            self.judge_guesses(&standing, step, is_over);
            self.judge(&standing, step, begin);
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

    fn note_pitfalls(&mut self, standing: &LessonStanding, step: usize, weeks: u32) {
        let met = standing.pitfalls();
        let own = |pitfall: &&Pitfall| pitfall.part == standing.part && !met.contains(&pitfall.name.as_str());
        let looked: Vec<_> = standing.lesson.plan.pitfalls.iter().filter(own).cloned().collect();
        let days = self.params().run.days_per_week;
        let from = weeks.saturating_sub(1) * days;
        for pitfall in looked {
            let Ok(Some(value)) = pitfall.measurement.of(self, from) else { continue };
            let (is_met, bound) = match pitfall.bound {
                PitfallBound::Above(bound) => (value > bound, bound),
                PitfallBound::Below(bound) => (value < bound, bound),
            };
            if is_met {
                let about = LessonNote::about(LessonEvent::Pitfall, step as u32 + 1);
                let note =
                    LessonNote { name: Some(pitfall.name), value: Some(value), bound: Some(bound), ..about };
                let _ = self.note_lesson(note);
            }
        }
    }

    /// Measures what was guessed in the step that is over; where the part is over, also what waited for its end.
    fn judge_guesses(&mut self, standing: &LessonStanding, step: usize, is_over: bool) {
        let part = standing.own_part();
        let is_last = is_over || step + 1 == part.steps.len();
        for (at, own) in part.steps.iter().enumerate().take(step + 1) {
            let Some(guess) = own.guess.as_ref().filter(|_| standing.outcome(at).is_none()) else { continue };
            let is_due = if guess.told == GuessTold::Part { is_last } else { at == step };
            if is_due {
                let from = part.weeks_of(at).0 * self.params().run.days_per_week;
                let outcome = self.outcome_of(standing, guess, at, from);
                let _ = self.note_lesson(outcome);
            }
        }
    }

    /// What came of a guess, from a day on.
    fn outcome_of(&mut self, standing: &LessonStanding, guess: &Guess, step: usize, from: u32) -> LessonNote {
        let about = LessonNote::about(LessonEvent::Outcome, step as u32 + 1);
        match &guess.form {
            GuessForm::Number { outcome, .. } => {
                LessonNote { value: outcome.of(self, from).ok().flatten(), ..about }
            }
            GuessForm::Choice { answer, .. } => {
                let right = *answer as f64 + 1.0;
                let met = standing.guess(step).map(|guessed| guessed == right);
                LessonNote { value: Some(right), met, ..about }
            }
        }
    }

    /// Measures what was to be reached.
    fn judge(&mut self, standing: &LessonStanding, step: usize, begin: u32) {
        let Some(own) = standing.step(step) else { return };
        let from = begin * self.params().run.days_per_week;
        let judged = standing.goals(step).len();
        let good = self.good_play_values(standing, step);
        for (number, goal) in own.goals.iter().enumerate().skip(judged) {
            let value = goal.measurement.of(self, from).ok().flatten();
            let (bound, most) = match goal.bound {
                GoalBound::AtLeast(bound) => (Some(bound), false),
                GoalBound::AtMost(bound) => (Some(bound), true),
                GoalBound::OfGoodPlay(share) => (good[number].map(|good| share * good), false),
            };
            let reached = |value: f64, bound: f64| if most { value <= bound } else { value >= bound };
            let met = value.zip(bound).is_some_and(|(value, bound)| reached(value, bound));
            let about = LessonNote::about(LessonEvent::Goal, step as u32 + 1);
            let number = Some(number as u32 + 1);
            let _ = self.note_lesson(LessonNote { number, value, bound, met: Some(met), ..about });
        }
    }

    /// Answers the question of the step that has begun: a number, or the number of a choice counted from 1.
    ///
    /// # Errors
    /// `no_question` where none is open, `guess_not_possible` for a number of no choice, `run_over`, `not_saved`.
    pub fn guess_in_lesson(&mut self, value: f64) -> Result<(), Refusal> {
        let awaits = |step: &usize| self.lesson().is_some_and(|standing| standing.awaits_guess(*step));
        let Some(step) = self.lesson_step().filter(awaits) else {
            return Err(Refusal::new("no_question", "no question of the lesson is open"));
        };
        let choices = self.lesson().and_then(|standing| standing.choices(step)).map(<[String]>::len);
        let fits = choices.is_none_or(|count| value.fract() == 0.0 && (1.0..=count as f64).contains(&value));
        if !value.is_finite() || !fits {
            let message = match choices {
                Some(count) => format!("choose a number from 1 to {count}"),
                None => "a guess is a number".to_owned(),
            };
            return Err(Refusal::at("guess", "guess_not_possible", message));
        }
        let about = LessonNote::about(LessonEvent::Guess, step as u32 + 1);
        self.note_lesson(LessonNote { value: Some(value), ..about }).map_err(not_saved)
    }

    /// The next hint of the step; once all were given, none. That it was asked for is recorded.
    ///
    /// # Errors
    /// `no_hint` where there is no further one, `not_saved`.
    pub fn hint_in_lesson(&mut self) -> Result<String, Refusal> {
        let next = |session: &Session| {
            let (standing, step) = (session.lesson()?, session.lesson_step()?);
            let given = standing.hints(step);
            Some((step, given, standing.lesson.filled(standing.step(step)?.hints.get(given)?)))
        };
        let Some((step, given, text)) = next(self) else {
            return Err(Refusal::new("no_hint", "there is no further hint"));
        };
        let about = LessonNote::about(LessonEvent::Hint, step as u32 + 1);
        self.note_lesson(LessonNote { number: Some(given as u32 + 1), ..about }).map_err(not_saved)?;
        Ok(text)
    }

    pub(super) fn note_lesson(&mut self, note: LessonNote) -> Result<(), RunError> {
        self.append(&Record::Activity(Activity::Lesson(note.clone())), Durability::Synced)?;
        let day = self.day();
        if let Some(standing) = &mut self.lesson {
            standing.notes.push((day, note));
        }
        Ok(())
    }
}
