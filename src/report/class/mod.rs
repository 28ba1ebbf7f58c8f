//! Results of a class: ranking, table, text, and a page for a projector (docs/lessons/classes.md).

mod curves;
mod drawing;
mod guesses;
mod html;
mod ranking;
mod table;
mod words;

use std::sync::Arc;

pub use curves::{Scatter, StudentPoints, curves, decisions, figures, scatter};
pub use guesses::{AskedClass, PitfallMet, asked, pitfalls};
pub use html::as_html;
pub use ranking::{RankedStudent, ranked};
pub use table::{columns_table, rows};
pub use words::{collected_in_words, score_in_words, shown_in_words, state_in_words};

use novamind_base::nearest;
use novamind_course::{
    Class, ClassCollection, ClassRun, CollectedClass, Evidence, GoalBound, Lesson, LessonPart, RunVerdict,
    ranked_goal, share_of_good,
};

const CASH: &str = "cash";

/// A class with its submissions and display options.
pub struct ClassView<'a> {
    /// The class.
    pub class: &'a Class,
    /// The lesson, if one was handed out.
    pub lesson: Option<&'a Arc<Lesson>>,
    /// The submissions.
    pub collection: &'a ClassCollection,
    /// Display options.
    pub shown: Shown,
}

/// Display options of a class.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Shown {
    /// Shows ranks in place of labels.
    pub hides_names: bool,
    /// Highlighted student; `None` for the first of the ranking.
    pub lit: Option<String>,
    /// Decision of the scatter plot; `None` for the one in which students differ most.
    pub decision: Option<String>,
    /// Figure of the scatter plot; `None` for cash.
    pub figure: Option<String>,
}

impl<'a> ClassView<'a> {
    /// Returns a view of a class.
    pub fn of(class: &'a CollectedClass, shown: Shown) -> ClassView<'a> {
        let CollectedClass { class, lesson, collection } = class;
        ClassView { class, lesson: lesson.as_ref(), collection, shown }
    }
}

impl ClassView<'_> {
    /// Checks that the selected student, decision and figure exist.
    ///
    /// # Errors
    /// Returns an error if no student has the label, or no run has the decision or the figure.
    pub fn check(&self) -> Result<(), String> {
        if let Some(label) = &self.shown.lit
            && self.class.student(label).is_none()
        {
            let labels = self.class.students.iter().map(|student| student.label.as_str());
            return Err(unknown("student", label, nearest(label, labels)));
        }
        if let Some(name) = &self.shown.decision
            && !self.whole().any(|run| run.evidence.decisions.contains_key(name))
        {
            let known = self.whole().flat_map(|run| run.evidence.decisions.keys());
            return Err(unknown("decision", name, nearest(name, known.map(String::as_str))));
        }
        if let Some(name) = &self.shown.figure
            && !self.whole().any(|run| run.evidence.figures.contains_key(name))
        {
            let known = self.whole().flat_map(|run| run.evidence.figures.keys());
            return Err(unknown("figure", name, nearest(name, known.map(String::as_str))));
        }
        Ok(())
    }

    fn whole(&self) -> impl Iterator<Item = &ClassRun> {
        self.collection
            .runs
            .iter()
            .filter(|run| matches!(run.verdict, RunVerdict::Finished | RunVerdict::NotFinished))
    }

    /// Returns the number of parts.
    pub fn parts(&self) -> u32 {
        self.lesson.map_or(1, |lesson| lesson.plan.parts.len() as u32)
    }

    /// Returns the title of a part if there are several. Parts are numbered from 1.
    pub fn part_title(&self, part: u32) -> Option<&str> {
        let own = self.lesson?.plan.parts.get((part as usize).checked_sub(1)?)?;
        (self.parts() > 1).then_some(own.title.as_str())
    }

    /// Returns a short title: the lesson or the run.
    pub fn title(&self) -> String {
        match (self.lesson, &self.class.run) {
            (Some(lesson), _) => lesson.plan.title.clone(),
            (None, Some(past)) => format!("Run {} from day {}", past.run, past.day),
            (None, None) => String::new(),
        }
    }

    fn part_of(&self, run: &ClassRun) -> Option<&LessonPart> {
        self.lesson?.plan.parts.get((run.evidence.part as usize).checked_sub(1)?)
    }

    /// Returns the value of a goal relative to the reference play on the same seed. Steps and goals are numbered from
    /// 0.
    fn share_of_goal(&self, run: &ClassRun, step: usize, goal: usize) -> Option<f64> {
        let value = |own: &Evidence| own.steps.get(step)?.goals.get(goal)?.value;
        let part = self.part_of(run)?;
        let bound: GoalBound = part.steps.get(step)?.goals.get(goal)?.bound;
        share_of_good(Some(bound), value(&run.evidence)?, value(self.good(run)?)?)
    }

    fn good(&self, run: &ClassRun) -> Option<&Evidence> {
        let of = &run.evidence;
        let all = self.collection.references.iter().map(|reference| &reference.evidence);
        all.into_iter().find(|good| (good.part, good.seed) == (of.part, of.seed))
    }

    /// Returns the lesson's measure of a finished run relative to the reference play on the same seed: the last goal,
    /// or cash if it has none.
    fn share(&self, run: &ClassRun) -> Option<f64> {
        let part = self.part_of(run)?;
        match ranked_goal(part) {
            Some((step, goal)) => self.share_of_goal(run, step, goal),
            None => share_of_good(None, run.evidence.cash.last()?.1, self.good(run)?.cash.last()?.1),
        }
    }

    /// Describes the measure of the ranking.
    pub fn measure(&self) -> String {
        let Some(lesson) = self.lesson else {
            return "cash on the last day that every run has reached".to_owned();
        };
        let of_part = |part: &LessonPart| match ranked_goal(part) {
            Some((step, goal)) => {
                // The goal's target, after the colon, is not part of the measure.
                let text = lesson.filled(&part.steps[step].goals[goal].text);
                text.split_once(": ").map_or(text.clone(), |(measure, _)| measure.to_owned())
            }
            None => "final cash".to_owned(),
        };
        let goals: Vec<String> = lesson.plan.parts.iter().map(of_part).collect();
        let mean = if goals.len() > 1 { "; mean over the parts, 0 for unfinished ones" } else { "" };
        format!("{}, as a percentage of the reference play on the same seed{mean}", goals.join(" / "))
    }
}

fn unknown(what: &str, name: &str, near: Vec<&str>) -> String {
    match near.is_empty() {
        true => format!("the class has no {what} {name}"),
        false => format!("the class has no {what} {name}; similar: {}", near.join(", ")),
    }
}
