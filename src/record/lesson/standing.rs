//! Where a student stands in a lesson: what follows from its plan, the days that passed, and the lines of the record.

use std::sync::Arc;

use super::definition::{GuessForm, LessonAccess, LessonPart, LessonStep};
use super::lesson_file::Lesson;
use crate::trajectory::record::{Activity, LessonEvent, LessonNote};
use crate::trajectory::{Line, Record};
use novamind_tools::{Refusal, ToolId};

/// A lesson that is played, and what happened in it.
#[derive(Debug, Clone, PartialEq)]
pub struct LessonStanding {
    /// The lesson.
    pub lesson: Arc<Lesson>,
    /// The part that this run is, counted from 0.
    pub part: usize,
    /// Whether goals and pitfalls are looked at.
    pub is_judged: bool,
    /// What happened, in order, each with its day.
    pub notes: Vec<(u32, LessonNote)>,
}

impl LessonPart {
    /// Whether it begins with an empty company, in a world in which nothing is set on the way.
    pub fn begins_empty(&self) -> bool {
        let is_set = |step: &LessonStep| !step.parameters.is_empty();
        self.start_weeks == 0 && self.start.is_empty() && !self.steps.iter().any(is_set)
    }

    /// Weeks from the first day of the company to the end of the last step.
    pub fn weeks(&self) -> u32 {
        self.start_weeks + self.steps.iter().map(|step| step.weeks).sum::<u32>()
    }

    /// Weeks that have passed when a step begins, and when it is over; steps are counted from 0.
    pub fn weeks_of(&self, step: usize) -> (u32, u32) {
        let before: u32 = self.steps.iter().take(step).map(|own| own.weeks).sum();
        let begin = self.start_weeks + before;
        (begin, begin + self.steps.get(step).map_or(0, |own| own.weeks))
    }

    /// The step that holds the week after so many; none once all are over.
    pub fn step_after(&self, weeks: u32) -> Option<usize> {
        (0..self.steps.len()).find(|step| weeks < self.weeks_of(*step).1)
    }
}

impl LessonStanding {
    /// A lesson whose record says this.
    pub fn of<'a>(
        lesson: Arc<Lesson>,
        part: usize,
        lines: impl IntoIterator<Item = &'a Line>,
    ) -> LessonStanding {
        let noted = |line: &Line| match &line.record {
            Record::Activity(Activity::Lesson(note)) => Some((line.day, note.clone())),
            _ => None,
        };
        LessonStanding { lesson, part, is_judged: true, notes: lines.into_iter().filter_map(noted).collect() }
    }

    /// The part that this run is.
    pub fn own_part(&self) -> &LessonPart {
        &self.lesson.plan.parts[self.part]
    }

    /// What of the program the student has.
    pub fn access(&self) -> &LessonAccess {
        &self.lesson.plan.access
    }

    /// A step of it, counted from 0.
    pub fn step(&self, step: usize) -> Option<&LessonStep> {
        self.own_part().steps.get(step)
    }

    /// Whether the student has a tool.
    pub fn has_tool(&self, tool: ToolId) -> bool {
        self.refuse_tool(tool).is_ok()
    }

    /// Refuses a tool that the lesson does not have.
    ///
    /// # Errors
    /// `not_in_this_lesson`.
    pub fn refuse_tool(&self, tool: ToolId) -> Result<(), Refusal> {
        if self.own_part().moves_capacity() && tool == ToolId::SetCapacityTier {
            let message = "capacity follows usage by itself in this lesson";
            return Err(Refusal::new("not_in_this_lesson", message));
        }
        match &self.lesson.plan.access.tools {
            Some(tools) if !tools.contains(&tool) => {
                let known: Vec<&str> = tools.iter().map(|tool| tool.name()).collect();
                let message = format!("{tool} is not in this lesson; it has {}", known.join(", "));
                Err(Refusal::new("not_in_this_lesson", message))
            }
            _ => Ok(()),
        }
    }

    /// Refuses to go on after so many weeks while the question of the step is open.
    ///
    /// # Errors
    /// `guess_first`.
    pub fn refuse_before_guess(&self, weeks: u32) -> Result<(), Refusal> {
        let step = self.own_part().step_after(weeks).filter(|step| self.awaits_guess(*step));
        let guess = step.and_then(|step| self.step(step)).and_then(|step| step.guess.as_ref());
        match guess {
            Some(guess) => Err(Refusal::new("guess_first", format!("first your guess: {}", guess.question))),
            None => Ok(()),
        }
    }

    /// The newest try of a step.
    pub fn tries(&self, step: usize) -> u32 {
        let of_try = |note: &LessonNote| note.number;
        self.last(LessonEvent::Begun, step).and_then(of_try).unwrap_or(0)
    }

    /// Whether a step has begun.
    pub fn has_begun(&self, step: usize) -> bool {
        self.last(LessonEvent::Begun, step).is_some()
    }

    /// The last step that has begun; the first if none has.
    pub fn last_begun(&self) -> usize {
        (0..self.own_part().steps.len()).rev().find(|step| self.has_begun(*step)).unwrap_or(0)
    }

    /// What was guessed in a step; of choices the number of the one taken, counted from 1.
    pub fn guess(&self, step: usize) -> Option<f64> {
        self.last(LessonEvent::Guess, step)?.value
    }

    /// What came of what was to be guessed in a step, and whether the guess was right where it was a choice.
    pub fn outcome(&self, step: usize) -> Option<&LessonNote> {
        self.last(LessonEvent::Outcome, step)
    }

    /// Whether a step asks for a guess that is not there yet.
    pub fn awaits_guess(&self, step: usize) -> bool {
        self.step(step).is_some_and(|own| own.guess.is_some()) && self.guess(step).is_none()
    }

    /// How many hints of a step were asked for.
    pub fn hints(&self, step: usize) -> usize {
        self.notes_of(LessonEvent::Hint, step).count()
    }

    /// What the goals of a step came to, in their order; empty before it is over.
    pub fn goals(&self, step: usize) -> Vec<&LessonNote> {
        self.notes_of(LessonEvent::Goal, step).collect()
    }

    /// Whether every goal of every step was reached.
    pub fn has_reached_all(&self) -> bool {
        let wanted: usize = self.own_part().steps.iter().map(|step| step.goals.len()).sum();
        let reached =
            |(_, note): &&(u32, LessonNote)| note.event == LessonEvent::Goal && note.met == Some(true);
        self.notes.iter().filter(reached).count() == wanted
    }

    /// Names of the pitfalls that were met, in their order.
    pub fn pitfalls(&self) -> Vec<&str> {
        let met = self.notes.iter().filter(|(_, note)| note.event == LessonEvent::Pitfall);
        met.filter_map(|(_, note)| note.name.as_deref()).collect()
    }

    /// The choices of a guess, if it is one.
    pub fn choices(&self, step: usize) -> Option<&[String]> {
        match &self.step(step)?.guess.as_ref()?.form {
            GuessForm::Choice { choices, .. } => Some(choices),
            GuessForm::Number { .. } => None,
        }
    }

    fn notes_of(&self, event: LessonEvent, step: usize) -> impl DoubleEndedIterator<Item = &LessonNote> {
        let number = step as u32 + 1;
        let is_it = move |note: &&LessonNote| note.event == event && note.step == number;
        self.notes.iter().map(|(_, note)| note).filter(is_it)
    }

    fn last(&self, event: LessonEvent, step: usize) -> Option<&LessonNote> {
        self.notes_of(event, step).next_back()
    }
}
