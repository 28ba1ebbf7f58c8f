//! `class.csv` with one row per submitted run, and the descriptions of its columns.

use super::ClassView;
use crate::tables::column::{Column, columns};
use novamind_course::{ClassRun, LessonStep, StepEvidence};

struct ClassRow<'a> {
    view: &'a ClassView<'a>,
    run: &'a ClassRun,
}

impl ClassRow<'_> {
    fn steps(&self) -> &[LessonStep] {
        self.view.part_of_run(self.run).map_or(&[], |part| &part.steps)
    }

    fn step(&self, number: usize) -> Option<&StepEvidence> {
        self.run.evidence.steps.get(number)
    }
}

fn goals_met(step: &StepEvidence) -> usize {
    step.goals.iter().filter(|goal| goal.met).count()
}

// Steps and goals in column names are numbered from 1. No column has a unit.
fn columns<'a>(view: &ClassView<'_>) -> Vec<Column<ClassRow<'a>>> {
    let mut columns = columns! { row: ClassRow<'a>;
        "label", "", "label of the student, from the first line of the run or from its path"
            => row.run.label;
        "run", "", "name of the run" => row.run.run;
        "part", "", "part of the lesson, numbered from 1; 1 if a run was handed out" => row.run.evidence.part;
        "seed", "", "seed of the run" => row.run.evidence.seed;
        "day", "", "last simulated day" => row.run.evidence.day;
        "tries", "", "highest number of tries of any step" => row.run.evidence.tries;
        "hints", "", "hints used" => row.run.evidence.hints;
        "goals", "", "goals of the part" => row.steps().iter().map(|step| step.goals.len()).sum::<usize>();
        "goals_reached", "", "goals reached" => row.run.evidence.steps.iter().map(goals_met).sum::<usize>();
        "guesses_right", "", "correct guesses among choices" => super::guesses::count_correct_guesses(row.view, row.run);
        "pitfalls", "", "names of the pitfalls triggered, in order" => row.run.evidence.pitfalls.join(" ");
        "cash", "", "final cash, dollars" => format_optional(row.run.evidence.cash.last().map(|(_, cash)| *cash));
        "of_good", "", "score relative to the reference play on the same seed: 1 means equal; empty if there is no reference value" => format_optional(row.view.score_share(row.run));
        "verdict", "", "finished, not finished, altered, twice, other lesson, other hand-out or unknown; only finished runs \
         are ranked" => row.run.verdict.label();
    };
    for step in 0..max_steps(view) {
        columns.extend(columns! { row: ClassRow<'a>;
            format!("guess_{}", step + 1), "", "guess before the step; for choices, the number of the selected choice"
                => format_optional(row.step(step).and_then(|step_evidence| step_evidence.guess));
            format!("outcome_{}", step + 1), "", "outcome; for choices, the number of the correct choice"
                => format_optional(row.step(step).and_then(|evidence| evidence.outcome));
        });
    }
    for (step, goal) in all_goals(view) {
        columns.extend(columns! { row: ClassRow<'a>;
            format!("goal_{}_{}", step + 1, goal + 1), "", "measured value of the goal"
                => format_optional(row.step(step).and_then(|evidence| evidence.goals.get(goal)?.value));
            format!("goal_of_good_{}_{}", step + 1, goal + 1), "", "measured value relative to the reference play on the same seed"
                => format_optional(row.view.goal_share(row.run, step, goal));
        });
    }
    columns
}

/// Returns the descriptions of the columns of `class.csv`, with a header.
pub fn column_descriptions(view: &ClassView<'_>) -> Vec<Vec<String>> {
    let heading = vec!["column".to_owned(), "meaning".to_owned()];
    let all = columns(view)
        .into_iter()
        .map(|column| vec![column.heading.name.into_owned(), column.heading.meaning.to_owned()]);
    std::iter::once(heading).chain(all).collect()
}

/// Returns the rows of `class.csv`, with a header.
pub fn rows(view: &ClassView<'_>) -> Vec<Vec<String>> {
    let columns = columns(view);
    let heading = columns.iter().map(|column| column.heading.name.clone().into_owned()).collect();
    let rows = view.collection.runs.iter().map(|run| ClassRow { view, run });
    std::iter::once(heading)
        .chain(rows.map(|row| columns.iter().map(|column| (column.cell)(&row)).collect()))
        .collect()
}

fn format_optional(value: Option<f64>) -> Option<String> {
    value.map(|value| value.to_string())
}

fn max_steps(view: &ClassView<'_>) -> usize {
    view.lesson.map_or(0, |lesson| lesson.plan.parts.iter().map(|part| part.steps.len()).max().unwrap_or(0))
}

fn all_goals(view: &ClassView<'_>) -> Vec<(usize, usize)> {
    let parts = view.lesson.map(|lesson| lesson.plan.parts.as_slice()).unwrap_or_default();
    let most = |step: usize| {
        parts.iter().filter_map(|part| Some(part.steps.get(step)?.goals.len())).max().unwrap_or(0)
    };
    (0..max_steps(view)).flat_map(|step| (0..most(step)).map(move |goal| (step, goal))).collect()
}
