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
pub use text::{class_to_text, describe_collection, describe_submission_count, format_score};

use novamind_base::similar_names;
use novamind_course::{
    Class, ClassCollection, ClassRun, CollectedClass, Evidence, GoalBound, Lesson, LessonPart, RunVerdict,
    ranked_goal, share_of_reference,
};

const DEFAULT_FIGURE: &str = "cash";

/// The results of a class, and the options for displaying them.
pub struct ClassView<'a> {
    /// What was handed out, and to which students.
    pub class: &'a Class,
    /// The lesson of the class; `None` if a run was handed out.
    pub lesson: Option<&'a Arc<Lesson>>,
    /// The submissions, and the results of the reference play.
    pub collection: &'a ClassCollection,
    /// How the results are displayed.
    pub display: ClassDisplayOptions,
}

/// Options for displaying the results of a class.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ClassDisplayOptions {
    /// Whether ranks are shown instead of labels.
    pub hides_names: bool,
    /// Label of the highlighted student; `None` to highlight the first student of the ranking.
    pub highlighted_student: Option<String>,
    /// Decision on the horizontal axis of the scatter plot; `None` for the decision in which students differ most.
    pub decision: Option<String>,
    /// Figure on the vertical axis of the scatter plot; `None` for cash.
    pub figure: Option<String>,
}

impl<'a> ClassView<'a> {
    /// Creates a view of a class with display options.
    pub fn new(class: &'a CollectedClass, display_options: ClassDisplayOptions) -> ClassView<'a> {
        let CollectedClass { class, lesson, collection } = class;
        ClassView { class, lesson: lesson.as_ref(), collection, display: display_options }
    }
}

impl ClassView<'_> {
    /// Checks that the student, the decision and the figure in the display options exist.
    ///
    /// # Errors
    /// Returns an error if no student has the label, or no run has the decision or the figure.
    pub fn check(&self) -> Result<(), String> {
        if let Some(label) = &self.display.highlighted_student
            && self.class.student_by_label(label).is_none()
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

    /// Returns the number of parts of the lesson, or 1 if a run was handed out.
    pub fn part_count(&self) -> u32 {
        self.lesson.map_or(1, |lesson| lesson.plan.parts.len() as u32)
    }

    /// Returns the title of a part, or `None` if the lesson has only one part. Parts are numbered from 1.
    pub fn part_title(&self, part: u32) -> Option<&str> {
        let lesson_part = self.lesson?.plan.parts.get((part as usize).checked_sub(1)?)?;
        (self.part_count() > 1).then_some(lesson_part.title.as_str())
    }

    /// Returns the title of the lesson, or a title that names the run that was handed out.
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

    /// Returns the value of a goal divided by its value in the reference play on the same seed. Steps and goals are
    /// numbered from 0.
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

    /// Returns the score of a run relative to the reference play on the same seed. The score is based on the last goal
    /// or, if the part has no goals, on cash.
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

    /// Describes the measure by which students are ranked.
    pub fn describe_measure(&self) -> String {
        let Some(lesson) = self.lesson else {
            return "cash on the last day that every run has reached".to_owned();
        };
        let describe_part_goal = |part: &LessonPart| match ranked_goal(part) {
            Some((step, goal)) => {
                let goal = &part.steps[step].goals[goal];
                // An SQL statement has no name, so the text of the goal is shown instead.
                goal.measurement.describe().unwrap_or_else(|| lesson.fill_figures(&goal.text))
            }
            None => "final cash".to_owned(),
        };
        let goals: Vec<String> = lesson.plan.parts.iter().map(describe_part_goal).collect();
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
