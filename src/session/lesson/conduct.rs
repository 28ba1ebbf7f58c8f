//! How a lesson goes: what it does by itself before and after a week, and what it asks of the student.

use std::path::Path;
use std::sync::Arc;

use serde_json::json;

use super::definition::{CapacityMover, GoalBound, GuessForm, Pitfall, PitfallBound, RationaleAsked};
use super::lesson_call::LessonCall;
use super::lesson_file::Lesson;
use super::stamp::LessonStamp;
use super::standing::LessonStanding;
use crate::session::error::RunError;
use crate::session::folder::create::NewRun;
use crate::session::play::act::not_saved;
use crate::session::state::Session;
use crate::session::trajectory::record::{Activity, Ended, LessonEvent, LessonNote, Via};
use crate::session::trajectory::{Durability, Line, Record};
use crate::tools::{Refusal, ToolId};

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
    pub(in crate::session) fn stamp(&self) -> LessonStamp {
        let (name, digest) = (self.lesson.name.clone(), self.lesson.digest.clone());
        LessonStamp { name, digest, part: self.part as u32 + 1 }
    }

    /// A new run with the company of the lesson.
    pub(in crate::session) fn terms_of(&self, new: NewRun) -> NewRun {
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
        standing.own_part().step_after(self.weeks_passed()).filter(|_| self.history.ended.is_none())
    }

    /// Whole weeks that have passed.
    pub(in crate::session) fn weeks_passed(&self) -> u32 {
        self.simulation.world.day / self.simulation.params.run.days_per_week
    }

    /// Keeps the lesson with the run.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub(in crate::session) fn keep_lesson(&self, entry: &LessonEntry) -> Result<(), RunError> {
        self.folder.as_deref().map_or(Ok(()), |folder| entry.lesson.keep_with(folder))
    }

    /// Takes up the lesson of a run that was opened again.
    ///
    /// # Errors
    /// The lesson that is kept with the run is missing, wrong, or another than the first line names.
    pub(in crate::session) fn resume_lesson(
        &mut self,
        folder: &Path,
        lines: &[Line],
    ) -> Result<(), RunError> {
        let Some(stamp) = self.manifest.lesson.clone() else { return Ok(()) };
        let lesson = Lesson::of_run(folder, &stamp.name)?;
        let part = stamp.part as usize;
        if lesson.digest != stamp.digest || !(1..=lesson.plan.parts.len()).contains(&part) {
            return Err(RunError::Damaged {
                path: folder.join("lesson.toml"),
                line: 1,
                problem: format!("the lesson is not the one that was played, {}", stamp.name),
                safe: "The trajectory was not touched; restore lesson.toml and lesson.md from a copy to open the run"
                    .to_owned(),
            });
        }
        self.lesson = Some(Box::new(LessonStanding::of(Arc::new(lesson), part - 1, lines)));
        // The program may have ended between a week and what it came to.
        let is_open = |line: &Line| {
            matches!(
                line.record,
                Record::Week(_) | Record::Override(_) | Record::Activity(Activity::Lesson(_))
            )
        };
        if self.recorder.is_some() && lines.last().is_some_and(is_open) {
            self.settle_lesson();
        }
        Ok(())
    }

    /// Plays the start of a lesson, up to the moment at which the student sees the company.
    ///
    /// # Errors
    /// A call of the start is refused.
    pub(in crate::session) fn begin_lesson(&mut self, entry: &LessonEntry) -> Result<(), RunError> {
        let LessonEntry { lesson, part, is_judged } = entry;
        let (lesson, is_judged) = (lesson.clone(), *is_judged);
        self.lesson = Some(Box::new(LessonStanding {
            lesson: lesson.clone(),
            part: *part,
            is_judged,
            notes: Vec::new(),
        }));
        let start = &lesson.plan.parts[*part];
        for week in 0..=start.start_weeks {
            let due = start.start.iter().filter(|own| own.week == week);
            for call in due.flat_map(|own| &own.calls) {
                self.call_of_start(call).map_err(|refusal| {
                    RunError::NotPossible(format!(
                        "the start of lesson {} is refused: {refusal}",
                        lesson.name
                    ))
                })?;
            }
            if week < start.start_weeks {
                let forecasts = self.naive_forecasts();
                let refused = |refusal: Refusal| RunError::NotPossible(refusal.to_string());
                self.advance("the start of the lesson", &forecasts, Via::Lesson, &mut |_| {})
                    .map_err(refused)?;
            }
        }
        self.begin_step(0, 1).map_err(|refusal| RunError::NotPossible(refusal.to_string()))
    }

    fn call_of_start(&mut self, call: &LessonCall) -> Result<(), Refusal> {
        match call {
            LessonCall::Tool(tool, args) => self.call(tool, args, Via::Lesson).map(|_| ()),
            LessonCall::Rules(_) => {
                Err(Refusal::new("not_possible", "no rules answer companies in the start of a lesson"))
            }
        }
    }

    /// Begins a step: its parameters are set.
    pub(super) fn begin_step(&mut self, step: usize, number: u32) -> Result<(), Refusal> {
        let Some(own) = self.lesson.as_deref().and_then(|standing| standing.step(step)).cloned() else {
            return Ok(());
        };
        for (key, value) in &own.parameters {
            let value = serde_json::to_value(value).unwrap_or_default();
            self.set_parameter_of_lesson(key, &value)?;
        }
        let note =
            LessonNote { number: Some(number), ..LessonNote::about(LessonEvent::Begun, step as u32 + 1) };
        self.note_lesson(note).map_err(not_saved)
    }

    /// Refuses a tool that the lesson does not have.
    pub(in crate::session) fn refuse_outside_lesson(&self, tool: ToolId, via: Via) -> Result<(), Refusal> {
        let standing = self.lesson.as_deref().filter(|_| via != Via::Lesson);
        standing.map_or(Ok(()), |standing| standing.refuse_tool(tool))
    }

    /// Whether the lesson asks for no rationale of a week.
    pub(in crate::session) fn lesson_asks_no_rationale(&self) -> bool {
        let access = self.lesson.as_deref().map(|standing| &standing.lesson.plan.access);
        access.is_some_and(|access| access.rationale == RationaleAsked::Off)
    }

    /// Refuses a week that the lesson does not let pass: its question is open, or it is over.
    pub(in crate::session) fn refuse_week_of_lesson(&self, via: Via) -> Result<(), Refusal> {
        let Some(standing) = self.lesson.as_deref().filter(|_| via != Via::Lesson) else { return Ok(()) };
        match self.lesson_step() {
            Some(_) => standing.refuse_before_guess(self.weeks_passed()),
            None => Err(Refusal::new("lesson_over", "the lesson is over; its debrief tells what came of it")),
        }
    }

    /// What the lesson does by itself before a week.
    pub(in crate::session) fn prepare_week_of_lesson(&mut self) -> Result<(), Refusal> {
        let follows =
            self.lesson.as_deref().is_some_and(|own| own.own_part().capacity == CapacityMover::FollowsUsage);
        if !follows {
            return Ok(());
        }
        let (now, next) = (self.simulation.world.settings.core.capacity_tier, self.capacity_towards_usage());
        if now == next {
            return Ok(());
        }
        self.call(ToolId::SetCapacityTier, &json!({ "tier": next }), Via::Lesson).map(|_| ())
    }

    /// Judges what a week came to, before the line that ends the run. A step that is over is measured and the next begins;
    /// after the last one the run is over. What is judged already stays as it is.
    pub(in crate::session) fn settle_lesson(&mut self) {
        let is_open = self.history.ended.is_none();
        let Some(standing) = self.lesson.as_deref().filter(|_| is_open).cloned() else { return };
        let is_over = self.simulation.world.is_over(&self.simulation.params);
        // A week in which the cash ran out counts.
        let weeks = self.simulation.world.day.div_ceil(self.simulation.params.run.days_per_week);
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
        let days = self.simulation.params.run.days_per_week;
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

    /// Measures what was guessed and what was to be reached.
    fn judge(&mut self, standing: &LessonStanding, step: usize, begin: u32) {
        let Some(own) = standing.step(step) else { return };
        let from = begin * self.simulation.params.run.days_per_week;
        if let Some(guess) = own.guess.as_ref().filter(|_| standing.outcome(step).is_none()) {
            let about = LessonNote::about(LessonEvent::Outcome, step as u32 + 1);
            let note = match &guess.form {
                GuessForm::Number { outcome, .. } => {
                    LessonNote { value: outcome.of(self, from).ok().flatten(), ..about }
                }
                GuessForm::Choice { answer, .. } => {
                    let right = *answer as f64 + 1.0;
                    let met = standing.guess(step).map(|guessed| guessed == right);
                    LessonNote { value: Some(right), met, ..about }
                }
            };
            let _ = self.note_lesson(note);
        }
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

    fn note_lesson(&mut self, note: LessonNote) -> Result<(), RunError> {
        self.append(&Record::Activity(Activity::Lesson(note.clone())), Durability::Synced)?;
        let day = self.simulation.world.day;
        if let Some(standing) = &mut self.lesson {
            standing.notes.push((day, note));
        }
        Ok(())
    }
}
