//! `class.csv`: a row for each run that came back, and what its columns mean.

use super::ClassView;
use novamind_course::{ClassRun, StepEvidence};

/// Columns that every class has: name and meaning.
const COLUMNS: [(&str, &str); 14] = [
    (
        "label",
        "label of the student, as the first line of the run says it, or as the place of the run names it",
    ),
    ("run", "name of the run"),
    ("part", "part of the lesson, counted from 1; 1 where a run was handed out"),
    ("seed", "seed of the run"),
    ("day", "last day that was simulated"),
    ("tries", "which try it is: the highest of its steps"),
    ("hints", "hints that were asked for"),
    ("goals", "goals of the part"),
    ("goals_reached", "goals that were reached"),
    ("guesses_right", "guesses among choices that were right"),
    ("pitfalls", "names of the pitfalls that were met, in their order"),
    ("cash", "cash at the end, dollars"),
    (
        "of_good",
        "the measure of the lesson as a share of the good play on the same seed: 1 is as good; empty where there is none",
    ),
    (
        "verdict",
        "finished, not finished, altered, twice, other lesson, other hand-out or unknown; only finished runs are ranked",
    ),
];

/// Columns of a step: beginning of the name and meaning; the number of the step follows, counted from 1.
const OF_STEP: [(&str, &str); 2] = [
    ("guess", "what was guessed before the step; of choices the number of the one taken"),
    ("outcome", "what came of it; of choices the number of the right one"),
];

/// Columns of a goal: beginning of the name and meaning; the numbers of step and goal follow, counted from 1.
const OF_GOAL: [(&str, &str); 2] = [
    ("goal", "what the goal was measured at"),
    ("goal_of_good", "that as a share of the good play on the same seed"),
];

/// Names of the columns and what they mean, for a class.
fn columns(view: &ClassView<'_>) -> Vec<(String, &'static str)> {
    let always = COLUMNS.map(|(name, meaning)| (name.to_owned(), meaning));
    let steps = (1..=most_steps(view))
        .flat_map(|step| OF_STEP.map(|(name, meaning)| (format!("{name}_{step}"), meaning)));
    let goals = goals(view).into_iter().flat_map(|(step, goal)| {
        OF_GOAL.map(|(name, meaning)| (format!("{name}_{}_{}", step + 1, goal + 1), meaning))
    });
    always.into_iter().chain(steps).chain(goals).collect()
}

/// What the columns mean, as a table with its heading first.
pub fn columns_table(view: &ClassView<'_>) -> Vec<Vec<String>> {
    let heading = vec!["column".to_owned(), "meaning".to_owned()];
    let all = columns(view).into_iter().map(|(name, meaning)| vec![name, meaning.to_owned()]);
    std::iter::once(heading).chain(all).collect()
}

/// The table, its heading first.
pub fn rows(view: &ClassView<'_>) -> Vec<Vec<String>> {
    let heading = columns(view).into_iter().map(|(name, _)| name).collect();
    std::iter::once(heading).chain(view.collection.runs.iter().map(|run| row(view, run))).collect()
}

fn row(view: &ClassView<'_>, run: &ClassRun) -> Vec<String> {
    let own = &run.evidence;
    let goals_of = |step: &StepEvidence| step.goals.iter().filter(|goal| goal.met).count();
    let part = view.part_of(run);
    let wanted: usize = part.map_or(0, |part| part.steps.iter().map(|step| step.goals.len()).sum());
    let always = [
        run.label.clone(),
        run.run.clone(),
        own.part.to_string(),
        own.seed.to_string(),
        own.day.to_string(),
        own.tries.to_string(),
        own.hints.to_string(),
        wanted.to_string(),
        own.steps.iter().map(goals_of).sum::<usize>().to_string(),
        super::guesses::right(view, run).to_string(),
        own.pitfalls.join(" "),
        written(own.cash.last().map(|(_, cash)| *cash)),
        written(view.share(run)),
        run.verdict.id().to_owned(),
    ];
    let steps = (0..most_steps(view)).flat_map(|step| {
        let own = own.steps.get(step);
        [written(own.and_then(|own| own.guess)), written(own.and_then(|own| own.outcome))]
    });
    let goals = goals(view).into_iter().flat_map(|(step, goal)| {
        let value = own.steps.get(step).and_then(|own| own.goals.get(goal)?.value);
        [written(value), written(view.share_of_goal(run, step, goal))]
    });
    always.into_iter().chain(steps).chain(goals).collect()
}

fn written(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

fn most_steps(view: &ClassView<'_>) -> usize {
    view.lesson.map_or(0, |lesson| lesson.plan.parts.iter().map(|part| part.steps.len()).max().unwrap_or(0))
}

/// Step and goal of every goal that some part has, counted from 0.
fn goals(view: &ClassView<'_>) -> Vec<(usize, usize)> {
    let parts = view.lesson.map(|lesson| lesson.plan.parts.as_slice()).unwrap_or_default();
    let most = |step: usize| {
        parts.iter().filter_map(|part| Some(part.steps.get(step)?.goals.len())).max().unwrap_or(0)
    };
    (0..most_steps(view)).flat_map(|step| (0..most(step)).map(move |goal| (step, goal))).collect()
}
