//! What came back of a class: the ranking, the table, the words, and a page for the projector (docs/lessons/classes.md).

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

/// The figure of the scatter that is shown where none is named.
const CASH: &str = "cash";

/// A class and what came back of it, as it is to be shown.
pub struct ClassView<'a> {
    /// What was handed out.
    pub class: &'a Class,
    /// The lesson, if that was handed out.
    pub lesson: Option<&'a Arc<Lesson>>,
    /// What came back.
    pub collection: &'a ClassCollection,
    /// How it is shown.
    pub shown: Shown,
}

/// How a class is shown.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Shown {
    /// Ranks stand for labels.
    pub hides_names: bool,
    /// The student whose curve is lit; the first of the ranking if none is named.
    pub lit: Option<String>,
    /// The decision of the scatter; the one in which students differ most if none is named.
    pub decision: Option<String>,
    /// The figure of the scatter; cash if none is named.
    pub figure: Option<String>,
}

impl<'a> ClassView<'a> {
    /// A class as it is to be shown.
    pub fn of(class: &'a CollectedClass, shown: Shown) -> ClassView<'a> {
        let CollectedClass { class, lesson, collection } = class;
        ClassView { class, lesson: lesson.as_ref(), collection, shown }
    }
}

impl ClassView<'_> {
    /// Checks that what is to be shown is there.
    ///
    /// # Errors
    /// Nobody has the label; no run has the decision or the figure.
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

    /// Runs that were found whole and are the student's own.
    fn whole(&self) -> impl Iterator<Item = &ClassRun> {
        self.collection
            .runs
            .iter()
            .filter(|run| matches!(run.verdict, RunVerdict::Finished | RunVerdict::NotFinished))
    }

    /// How many parts are played.
    pub fn parts(&self) -> u32 {
        self.lesson.map_or(1, |lesson| lesson.plan.parts.len() as u32)
    }

    /// Title of a part, where there are several; parts are counted from 1.
    pub fn part_title(&self, part: u32) -> Option<&str> {
        let own = self.lesson?.plan.parts.get((part as usize).checked_sub(1)?)?;
        (self.parts() > 1).then_some(own.title.as_str())
    }

    /// What is played, in short.
    pub fn title(&self) -> String {
        match (self.lesson, &self.class.run) {
            (Some(lesson), _) => lesson.plan.title.clone(),
            (None, Some(past)) => format!("Run {} from day {} on", past.run, past.day),
            (None, None) => String::new(),
        }
    }

    /// The part that a run plays.
    fn part_of(&self, run: &ClassRun) -> Option<&LessonPart> {
        self.lesson?.plan.parts.get((run.evidence.part as usize).checked_sub(1)?)
    }

    /// Value of a goal as a share of what the good play has on the same seed; steps and goals are counted from 0.
    fn share_of_goal(&self, run: &ClassRun, step: usize, goal: usize) -> Option<f64> {
        let value = |own: &Evidence| own.steps.get(step)?.goals.get(goal)?.value;
        let part = self.part_of(run)?;
        let bound: GoalBound = part.steps.get(step)?.goals.get(goal)?.bound;
        share_of_good(Some(bound), value(&run.evidence)?, value(self.good(run)?)?)
    }

    /// The good play on the seed of a run.
    fn good(&self, run: &ClassRun) -> Option<&Evidence> {
        let of = &run.evidence;
        let all = self.collection.references.iter().map(|reference| &reference.evidence);
        all.into_iter().find(|good| (good.part, good.seed) == (of.part, of.seed))
    }

    /// The lesson's measure of a run that is over, as a share of what the good play has on the same seed: its last goal, or
    /// cash where it has none.
    fn share(&self, run: &ClassRun) -> Option<f64> {
        let part = self.part_of(run)?;
        match ranked_goal(part) {
            Some((step, goal)) => self.share_of_goal(run, step, goal),
            None => share_of_good(None, run.evidence.cash.last()?.1, self.good(run)?.cash.last()?.1),
        }
    }

    /// What the ranking goes by, in words.
    pub fn measure(&self) -> String {
        let Some(lesson) = self.lesson else {
            return "cash on the last day that every run has reached".to_owned();
        };
        let of_part = |part: &LessonPart| match ranked_goal(part) {
            Some((step, goal)) => lesson.filled(&part.steps[step].goals[goal].text),
            None => "cash at the end".to_owned(),
        };
        let goals: Vec<String> = lesson.plan.parts.iter().map(of_part).collect();
        let mean =
            if goals.len() > 1 { "; the mean of the parts, 0 for one that is not finished" } else { "" };
        format!("{}, as a share of the good play on the same seed{mean}", goals.join(" / "))
    }
}

fn unknown(what: &str, name: &str, near: Vec<&str>) -> String {
    match near.is_empty() {
        true => format!("the class has no {what} {name}"),
        false => format!("the class has no {what} {name}; near it: {}", near.join(", ")),
    }
}
