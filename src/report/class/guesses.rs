//! Students' guesses compared with the outcomes.

use super::ClassView;
use super::curves::StudentPoints;
use novamind_course::{ClassRun, GuessForm};

/// A question of the lesson with the guesses of all students.
pub struct ClassQuestion<'a> {
    /// Part of the lesson, numbered from 1.
    pub part: u32,
    /// Text of the question.
    pub question: &'a str,
    /// Possible answers; empty if the question asks for a number.
    pub choices: &'a [String],
    /// Label, guess and outcome of every student who has both a guess and an outcome.
    pub answers: Vec<(&'a str, f64, f64)>,
}

impl<'a> ClassQuestion<'a> {
    /// Returns a point for each student, with the guess on the horizontal and the outcome on the vertical axis.
    pub fn points(&self) -> Vec<StudentPoints<'a>> {
        let answers = self.answers.iter();
        answers
            .map(|(label, guess, outcome)| StudentPoints {
                label: Some(label),
                points: vec![(*guess, *outcome)],
            })
            .collect()
    }
}

/// Returns the questions of the lesson with the students' guesses, in order.
pub fn class_questions<'a>(view: &'a ClassView<'a>) -> Vec<ClassQuestion<'a>> {
    let parts = view.lesson.map(|lesson| lesson.plan.parts.as_slice()).unwrap_or_default();
    let mut all = Vec::new();
    for (part, lesson_part) in (1..).zip(parts) {
        for (step, lesson_step) in lesson_part.steps.iter().enumerate() {
            let Some(guess) = &lesson_step.guess else { continue };
            let choices: &[String] = match &guess.form {
                GuessForm::Choice { choices, .. } => choices,
                GuessForm::Number { .. } => &[],
            };
            let answers = first_tries(view, part).filter_map(|run| {
                let step = run.evidence.steps.get(step)?;
                Some((run.label.as_str(), step.guess?, step.outcome?))
            });
            all.push(ClassQuestion { part, question: &guess.question, choices, answers: answers.collect() });
        }
    }
    all
}

/// Returns the first run of each student in a part. Ignores guesses of later tries, because the student then knows the
/// outcome.
fn first_tries<'a>(view: &'a ClassView<'a>, part: u32) -> impl Iterator<Item = &'a ClassRun> {
    let part_runs: Vec<&ClassRun> = view.valid_runs().filter(|run| run.evidence.part == part).collect();
    let is_first = |at: usize| at == 0 || part_runs[at - 1].label != part_runs[at].label;
    let firsts: Vec<&ClassRun> =
        (0..part_runs.len()).filter(|at| is_first(*at)).map(|at| part_runs[at]).collect();
    firsts.into_iter()
}

pub(super) fn count_correct_guesses(view: &ClassView<'_>, run: &ClassRun) -> usize {
    let part = view.part_of_run(run);
    let steps = part.map(|part| part.steps.as_slice()).unwrap_or_default();
    let is_choice = |step: &novamind_course::LessonStep| {
        step.guess.as_ref().is_some_and(|guess| matches!(guess.form, GuessForm::Choice { .. }))
    };
    let all = steps.iter().zip(&run.evidence.steps).filter(|(step, _)| is_choice(step));
    all.filter(|(_, step_evidence)| {
        step_evidence.guess.is_some() && step_evidence.guess == step_evidence.outcome
    })
    .count()
}

/// A pitfall that at least one student triggered.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PitfallCount<'a> {
    /// Name of the pitfall.
    pub name: &'a str,
    /// Explanation of the pitfall.
    pub explanation: String,
    /// Number of students who triggered the pitfall.
    pub students: usize,
}

/// Returns the pitfalls that students triggered, most frequent first.
pub fn pitfall_counts<'a>(view: &'a ClassView<'a>) -> Vec<PitfallCount<'a>> {
    let known = view.lesson.map(|lesson| lesson.plan.pitfalls.as_slice()).unwrap_or_default();
    let count_students = |name: &str| {
        let labels: std::collections::BTreeSet<&str> = view
            .valid_runs()
            .filter(|run| run.evidence.pitfalls.iter().any(|pitfall| pitfall == name))
            .map(|run| run.label.as_str())
            .collect();
        labels.len()
    };
    let say = |text: &str| view.lesson.map(|lesson| lesson.fill_figures(text)).unwrap_or_default();
    let counted = known.iter().map(|pitfall| PitfallCount {
        name: &pitfall.name,
        explanation: say(&pitfall.say),
        students: count_students(&pitfall.name),
    });
    let mut all: Vec<PitfallCount<'a>> = counted.filter(|pitfall_count| pitfall_count.students > 0).collect();
    all.sort_by(|one, other| other.students.cmp(&one.students).then_with(|| one.name.cmp(other.name)));
    all
}
