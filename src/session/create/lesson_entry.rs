//! The lesson options of a new run.

use std::sync::Arc;

use super::NewRun;
use novamind_record::lesson::Lesson;
use novamind_record::stamp::LessonStamp;

/// The lesson and part that a new run plays.
#[derive(Debug, Clone, PartialEq)]
pub struct LessonOptions {
    /// Lesson that the run plays.
    pub lesson: Arc<Lesson>,
    /// Part that the run plays, from 0.
    pub part: usize,
    /// Whether goals and pitfalls are checked; false for reference plays.
    pub is_judged: bool,
}

impl LessonOptions {
    pub(crate) fn stamp(&self) -> LessonStamp {
        let (name, digest) = (self.lesson.name.clone(), self.lesson.digest.clone());
        LessonStamp { name, digest, part: self.part as u32 + 1 }
    }

    pub(crate) fn apply_to(&self, new: NewRun) -> NewRun {
        let part = &self.lesson.plan.parts[self.part];
        let quiet = (!part.surges).then(|| ("demand_surge.probability".to_owned(), "0.0".to_owned()));
        let parameters = part.parameters.iter().map(|(key, value)| (key.clone(), value.to_string()));
        NewRun {
            seed: new.seed.or(Some(part.seed)),
            days: part.days,
            cash: part.cash,
            scenario: part.scenario.clone(),
            overrides: quiet.into_iter().chain(parameters).collect(),
            ..new
        }
    }
}
