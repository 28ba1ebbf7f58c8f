//! Results of a class: ranking, table, text, and a page for a projector (docs/lessons/classes.md).

mod curves;
mod drawing;
mod guesses;
mod html;
mod ranking;
mod table;
mod text;

use std::sync::Arc;

pub use curves::{Scatter, StudentPoints, differing_decisions, differing_figures, scatter, student_curves};
pub use guesses::{ClassQuestion, PitfallCount, class_questions, pitfall_counts};
pub use html::class_to_html;
pub use ranking::{RankedStudent, rank_students};
pub use table::{column_descriptions, rows};
pub use text::{class_to_text, describe_collection, describe_state, format_score};

use novamind_base::similar_names;
use novamind_course::{
    Class, ClassCollection, ClassRun, CollectedClass, Evidence, GoalBound, Lesson, LessonPart, RunVerdict,
    ranked_goal, share_of_reference,
};

const DEFAULT_FIGURE: &str = "cash";

/// A class with its submissions and display options.
pub struct ClassView<'a> {
    /// The class.
    pub class: &'a Class,
    /// The lesson, if one was handed out.
    pub lesson: Option<&'a Arc<Lesson>>,
    /// The submissions.
    pub collection: &'a ClassCollection,
    /// Display options.
    pub display: ClassDisplayOptions,
}

/// Display options of a class.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ClassDisplayOptions {
    /// Shows ranks in place of labels.
    pub hides_names: bool,
    /// Highlighted student; `None` for the first of the ranking.
    pub highlighted_student: Option<String>,
    /// Decision of the scatter plot; `None` for the one in which students differ most.
    pub decision: Option<String>,
    /// Figure of the scatter plot; `None` for cash.
    pub figure: Option<String>,
}

impl<'a> ClassView<'a> {
    /// Returns a view of a class.
    pub fn new(class: &'a CollectedClass, display_options: ClassDisplayOptions) -> ClassView<'a> {
        let CollectedClass { class, lesson, collection } = class;
        ClassView { class, lesson: lesson.as_ref(), collection, display: display_options }
    }
}

impl ClassView<'_> {
    /// Checks that the selected student, decision and figure exist.
    ///
    /// # Errors
    /// Returns an error if no student has the label, or no run has the decision or the figure.
    pub fn check(&self) -> Result<(), String> {
        if let Some(label) = &self.display.highlighted_student
            && self.class.student(label).is_none()
        {
            let labels = self.class.students.iter().map(|student| student.label.as_str());
            return Err(unknown_name_message("student", label, similar_names(label, labels)));
        }
        if let Some(name) = &self.display.decision
            && !self.valid_runs().any(|run| run.evidence.decisions.contains_key(name))
        {
            let known = self.valid_runs().flat_map(|run| run.evidence.decisions.keys());
            return Err(unknown_name_message(
                "decision",
                name,
                similar_names(name, known.map(String::as_str)),
            ));
        }
        if let Some(name) = &self.display.figure
            && !self.valid_runs().any(|run| run.evidence.figures.contains_key(name))
        {
            let known = self.valid_runs().flat_map(|run| run.evidence.figures.keys());
            return Err(unknown_name_message("figure", name, similar_names(name, known.map(String::as_str))));
        }
        Ok(())
    }

    fn valid_runs(&self) -> impl Iterator<Item = &ClassRun> {
        self.collection
            .runs
            .iter()
            .filter(|run| matches!(run.verdict, RunVerdict::Finished | RunVerdict::NotFinished))
    }

    /// Returns the number of parts.
    pub fn part_count(&self) -> u32 {
        self.lesson.map_or(1, |lesson| lesson.plan.parts.len() as u32)
    }

    /// Returns the title of a part if there are several. Parts are numbered from 1.
    pub fn part_title(&self, part: u32) -> Option<&str> {
        let lesson_part = self.lesson?.plan.parts.get((part as usize).checked_sub(1)?)?;
        (self.part_count() > 1).then_some(lesson_part.title.as_str())
    }

    /// Returns a short title: the lesson or the run.
    pub fn title(&self) -> String {
        match (self.lesson, &self.class.run) {
            (Some(lesson), _) => lesson.plan.title.clone(),
            (None, Some(past)) => format!("Run {} from day {}", past.run, past.day),
            (None, None) => String::new(),
        }
    }

    fn part_of_run(&self, run: &ClassRun) -> Option<&LessonPart> {
        self.lesson?.plan.parts.get((run.evidence.part as usize).checked_sub(1)?)
    }

    /// Returns the value of a goal relative to the reference play on the same seed. Steps and goals are numbered from
    /// 0.
    fn goal_share(&self, run: &ClassRun, step: usize, goal: usize) -> Option<f64> {
        let value = |evidence: &Evidence| evidence.steps.get(step)?.goals.get(goal)?.value;
        let part = self.part_of_run(run)?;
        let bound: GoalBound = part.steps.get(step)?.goals.get(goal)?.bound;
        share_of_reference(Some(bound), value(&run.evidence)?, value(self.reference_play(run)?)?)
    }

    fn reference_play(&self, run: &ClassRun) -> Option<&Evidence> {
        let of = &run.evidence;
        let all = self.collection.references.iter().map(|reference| &reference.evidence);
        all.into_iter().find(|good| (good.part, good.seed) == (of.part, of.seed))
    }

    /// Returns the lesson's measure of a finished run relative to the reference play on the same seed: the last goal,
    /// or cash if it has none.
    fn score_share(&self, run: &ClassRun) -> Option<f64> {
        let part = self.part_of_run(run)?;
        match ranked_goal(part) {
            Some((step, goal)) => self.goal_share(run, step, goal),
            None => share_of_reference(
                None,
                run.evidence.cash.last()?.1,
                self.reference_play(run)?.cash.last()?.1,
            ),
        }
    }

    /// Describes the measure of the ranking.
    pub fn describe_measure(&self) -> String {
        let Some(lesson) = self.lesson else {
            return "cash on the last day that every run has reached".to_owned();
        };
        let of_part = |part: &LessonPart| match ranked_goal(part) {
            Some((step, goal)) => {
                let goal = &part.steps[step].goals[goal];
                // A statement has no name, so that the text of its goal stands for it.
                goal.measurement.describe().unwrap_or_else(|| lesson.fill_figures(&goal.text))
            }
            None => "final cash".to_owned(),
        };
        let goals: Vec<String> = lesson.plan.parts.iter().map(of_part).collect();
        let mean = if goals.len() > 1 { "; mean over the parts, 0 for unfinished ones" } else { "" };
        format!("{}, as a percentage of the reference play on the same seed{mean}", goals.join(" / "))
    }
}

fn unknown_name_message(what: &str, name: &str, near: Vec<&str>) -> String {
    match near.is_empty() {
        true => format!("the class has no {what} {name}"),
        false => format!("the class has no {what} {name}; similar: {}", near.join(", ")),
    }
}
