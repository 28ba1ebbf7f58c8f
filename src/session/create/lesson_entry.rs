//! The lesson that a new run is a part of.

use std::sync::Arc;

use super::NewRun;
use novamind_record::lesson::Lesson;
use novamind_record::stamp::LessonStamp;

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
