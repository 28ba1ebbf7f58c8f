//! The progress of a student in a lesson, derived from the lesson plan and the recorded lines.

use std::sync::Arc;

use super::definition::{GuessForm, LessonAccess, LessonPart, LessonStep};
use super::lesson_file::Lesson;
use crate::trajectory::record::{Activity, LessonEvent, RecordedLessonEvent};
use crate::trajectory::{Line, Record};
use novamind_tools::{Rejection, ToolId};

/// The state of a lesson in a run: the current part and the recorded events.
#[derive(Debug, Clone, PartialEq)]
pub struct LessonProgress {
    /// Lesson that the student plays.
    pub lesson: Arc<Lesson>,
    /// Part of this run, from 0.
    pub part: usize,
    /// Whether goals and pitfalls are checked in this run.
    pub is_judged: bool,
    /// Lesson events in the order of recording, each with its day.
    pub events: Vec<(u32, RecordedLessonEvent)>,
}

impl LessonPart {
    /// Returns whether the part starts with an empty company and no step sets parameters.
    pub fn starts_empty(&self) -> bool {
        let is_set = |step: &LessonStep| !step.parameters.is_empty();
        self.start_weeks == 0 && self.start.is_empty() && !self.steps.iter().any(is_set)
    }

    /// Returns the number of weeks from day 0 to the end of the last step.
    pub fn weeks(&self) -> u32 {
        self.start_weeks + self.steps.iter().map(|step| step.weeks).sum::<u32>()
    }

    /// Returns the number of simulated weeks at the start and at the end of a step. Steps are counted from 0.
    pub fn step_weeks(&self, step: usize) -> (u32, u32) {
        let before: u32 = self.steps.iter().take(step).map(|lesson_step| lesson_step.weeks).sum();
        let begin = self.start_weeks + before;
        (begin, begin + self.steps.get(step).map_or(0, |lesson_step| lesson_step.weeks))
    }

    /// Returns the index of the step that follows `weeks` simulated weeks, or `None` if all steps are over.
    pub fn step_at_week(&self, weeks: u32) -> Option<usize> {
        (0..self.steps.len()).find(|step| weeks < self.step_weeks(*step).1)
    }
}

impl LessonProgress {
    /// Builds the progress from the lines of a run.
    pub fn from_lines<'a>(
        lesson: Arc<Lesson>,
        part: usize,
        lines: impl IntoIterator<Item = &'a Line>,
    ) -> LessonProgress {
        let noted = |line: &Line| match &line.record {
            Record::Activity(Activity::Lesson(note)) => Some((line.day, note.clone())),
            _ => None,
        };
        LessonProgress {
            lesson,
            part,
            is_judged: true,
            events: lines.into_iter().filter_map(noted).collect(),
        }
    }

    /// Returns the lesson part that this run plays.
    pub fn current_part(&self) -> &LessonPart {
        &self.lesson.plan.parts[self.part]
    }

    /// Returns the tools and screens that the student can use.
    pub fn access(&self) -> &LessonAccess {
        &self.lesson.plan.access
    }

    /// Returns a step of the current part. Steps are counted from 0.
    pub fn step(&self, step: usize) -> Option<&LessonStep> {
        self.current_part().steps.get(step)
    }

    /// Returns whether the student can use a tool.
    pub fn has_tool(&self, tool: ToolId) -> bool {
        self.check_tool(tool).is_ok()
    }

    /// Rejects a tool that the lesson does not offer.
    ///
    /// # Errors
    /// The rejection `not_in_this_lesson`.
    pub fn check_tool(&self, tool: ToolId) -> Result<(), Rejection> {
        if self.current_part().has_automatic_capacity() && tool == ToolId::SetCapacityTier {
            let message = "the capacity tier follows usage automatically in this lesson";
            return Err(Rejection::new("not_in_this_lesson", message));
        }
        match &self.lesson.plan.access.tools {
            Some(tools) if !tools.contains(&tool) => {
                let known: Vec<&str> = tools.iter().map(|tool| tool.name()).collect();
                let message = format!(
                    "{tool} is not available in this lesson; the available tools are {}",
                    known.join(", ")
                );
                Err(Rejection::new("not_in_this_lesson", message))
            }
            _ => Ok(()),
        }
    }

    /// Rejects the simulation of the next week if the student has not answered the question of that week's step.
    /// `weeks` is the number of weeks already simulated.
    ///
    /// # Errors
    /// The rejection `guess_first`.
    pub fn check_guess_submitted(&self, weeks: u32) -> Result<(), Rejection> {
        let step = self.current_part().step_at_week(weeks).filter(|step| self.awaits_guess(*step));
        let guess = step.and_then(|step| self.step(step)).and_then(|step| step.guess.as_ref());
        match guess {
            Some(guess) => Err(Rejection::new(
                "guess_first",
                format!("answer the question of this step first: {}", guess.question),
            )),
            None => Ok(()),
        }
    }

    /// Returns the number of the latest attempt at a step.
    pub fn attempt(&self, step: usize) -> u32 {
        let attempt_number = |note: &RecordedLessonEvent| note.number;
        self.last_event(LessonEvent::Begun, step).and_then(attempt_number).unwrap_or(0)
    }

    /// Returns whether a step has started.
    pub fn has_started(&self, step: usize) -> bool {
        self.last_event(LessonEvent::Begun, step).is_some()
    }

    /// Returns the index of the last step that has started, or 0 if no step has started.
    pub fn last_started_step(&self) -> usize {
        (0..self.current_part().steps.len()).rev().find(|step| self.has_started(*step)).unwrap_or(0)
    }

    /// Returns the student's guess for a step. For a question with choices, the guess is the number of the choice, from
    /// 1.
    pub fn guess(&self, step: usize) -> Option<f64> {
        self.last_event(LessonEvent::Guess, step)?.value
    }

    /// Returns the recorded outcome of the guess of a step, if the outcome was measured.
    pub fn outcome(&self, step: usize) -> Option<&RecordedLessonEvent> {
        self.last_event(LessonEvent::Outcome, step)
    }

    /// Returns whether a step has a question that the student has not answered.
    pub fn awaits_guess(&self, step: usize) -> bool {
        self.step(step).is_some_and(|lesson_step| lesson_step.guess.is_some()) && self.guess(step).is_none()
    }

    /// Returns the number of hints that the student requested in a step.
    pub fn hint_count(&self, step: usize) -> usize {
        self.events_of_step(LessonEvent::Hint, step).count()
    }

    /// Returns the goal results of a step, in order. The list is empty before the step is over.
    pub fn goal_results(&self, step: usize) -> Vec<&RecordedLessonEvent> {
        self.events_of_step(LessonEvent::Goal, step).collect()
    }

    /// Returns whether the student reached every goal of every step.
    pub fn has_reached_all_goals(&self) -> bool {
        let wanted: usize = self.current_part().steps.iter().map(|step| step.goals.len()).sum();
        let reached = |(_, note): &&(u32, RecordedLessonEvent)| {
            note.event == LessonEvent::Goal && note.met == Some(true)
        };
        self.events.iter().filter(reached).count() == wanted
    }

    /// Returns the names of the triggered pitfalls, in the order in which they were triggered.
    pub fn triggered_pitfall_names(&self) -> Vec<&str> {
        let pitfalls = self.events.iter().filter(|(_, note)| note.event == LessonEvent::Pitfall);
        pitfalls.filter_map(|(_, note)| note.name.as_deref()).collect()
    }

    /// Returns the choices of a step's question, or `None` if the question has no choices.
    pub fn choices(&self, step: usize) -> Option<&[String]> {
        match &self.step(step)?.guess.as_ref()?.form {
            GuessForm::Choice { choices, .. } => Some(choices),
            GuessForm::Number { .. } => None,
        }
    }

    fn events_of_step(
        &self,
        event: LessonEvent,
        step: usize,
    ) -> impl DoubleEndedIterator<Item = &RecordedLessonEvent> {
        let number = step as u32 + 1;
        let matches_event = move |note: &&RecordedLessonEvent| note.event == event && note.step == number;
        self.events.iter().map(|(_, note)| note).filter(matches_event)
    }

    fn last_event(&self, event: LessonEvent, step: usize) -> Option<&RecordedLessonEvent> {
        self.events_of_step(event, step).next_back()
    }
}
