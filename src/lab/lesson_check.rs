//! Check of a lesson on six seeds. The reference play must reach every goal. The pitfall play must miss a goal and
//! trigger its pitfall. The figures in the texts must be correct.

use std::sync::Arc;

use rayon::prelude::*;

use novamind_course::{Lesson, MEASURED_SEEDS, MeasuredFigure, ReferencePlay, measure_over_part};
use novamind_record::error::RunError;
use novamind_rules::calls_for_waiting_threads;
use novamind_session::{PartPlay, Session, play_part, play_part_with_hooks};

/// Allowed relative deviation of a measured figure from the stated figure.
pub const TOLERANCE: f64 = 0.15;

/// The result of a play on one seed.
#[derive(Debug, Clone, PartialEq)]
pub struct PlayResult {
    /// Seed of the play.
    pub seed: u64,
    /// Results of the goals of each part, in order.
    pub goals: Vec<GoalResult>,
    /// Names of the triggered pitfalls.
    pub pitfalls: Vec<String>,
}

/// The result of one goal in a play.
#[derive(Debug, Clone, PartialEq)]
pub struct GoalResult {
    /// Text of the lesson goal.
    pub text: String,
    /// Measured value of the goal; `None` if the goal has no measured value.
    pub value: Option<f64>,
    /// Target value of the goal; `None` if the goal has no target value.
    pub target: Option<f64>,
    /// Whether the play reached the goal.
    pub is_met: bool,
}

/// A figure that the lesson's texts state, with its measured mean.
#[derive(Debug, Clone, PartialEq)]
pub struct FigureResult {
    /// The figure as stated in the texts.
    pub stated: MeasuredFigure,
    /// Mean of the measured values over the seeds; NaN if no seed has a value.
    pub mean: f64,
}

impl FigureResult {
    /// Returns whether the stated value is within [`TOLERANCE`] of the measured mean.
    pub fn is_within_tolerance(&self) -> bool {
        (self.mean - self.stated.value).abs() <= TOLERANCE * self.stated.value.abs()
    }
}

/// The results of a lesson check.
#[derive(Debug, Clone, PartialEq)]
pub struct LessonCheck {
    /// Results of the reference play by seed.
    pub reference_results: Vec<PlayResult>,
    /// Results of the pitfall play by seed.
    pub pitfall_results: Vec<PlayResult>,
    /// Figures that the texts state, with measured values.
    pub figures: Vec<FigureResult>,
    /// Name of the pitfall that the pitfall play must trigger.
    pub pitfall: String,
}

impl LessonCheck {
    /// Returns the failed checks, one line each.
    pub fn describe_problems(&self) -> Vec<String> {
        let missed = self.reference_results.iter().flat_map(|play| {
            let missed = play.goals.iter().filter(|goal| !goal.is_met);
            missed.map(|goal| format!("seed {}: the reference play misses {}", play.seed, goal.text))
        });
        let reached = self.pitfall_results.iter().filter(|play| play.goals.iter().all(|goal| goal.is_met));
        let reached = reached.map(|play| format!("seed {}: the pitfall play reaches every goal", play.seed));
        let unmet = self.pitfall_results.iter().filter(|play| !play.pitfalls.contains(&self.pitfall));
        let unmet = unmet.map(|play| {
            format!("seed {}: the pitfall play does not trigger pitfall {}", play.seed, self.pitfall)
        });
        let wrong = self.figures.iter().filter(|figure| !figure.is_within_tolerance()).map(|figure| {
            let FigureResult { stated, mean } = figure;
            format!(
                "{} is stated as {} but measured as {}",
                stated.name,
                stated.formatted_value(),
                stated.format_value(*mean)
            )
        });
        missed.chain(reached).chain(unmet).chain(wrong).collect()
    }
}

/// Checks the plays and the figures of a lesson.
///
/// # Errors
/// Fails if a part cannot start or a play is rejected.
pub fn check_lesson(lesson: &Arc<Lesson>) -> Result<LessonCheck, RunError> {
    Ok(LessonCheck {
        figures: measure_figures(lesson)?,
        ..check_plays(lesson, &MEASURED_SEEDS.collect::<Vec<u64>>())?
    })
}

/// Checks the plays of a lesson on the given seeds, without measuring figures.
///
/// # Errors
/// Same errors as [`check_lesson`].
pub fn check_plays(lesson: &Arc<Lesson>, seeds: &[u64]) -> Result<LessonCheck, RunError> {
    let plays = |play: &ReferencePlay| -> Result<Vec<PlayResult>, RunError> {
        seeds.par_iter().map(|seed| run_play(lesson, play, *seed)).collect()
    };
    Ok(LessonCheck {
        reference_results: plays(&lesson.plan.good)?,
        pitfall_results: plays(&lesson.plan.bad)?,
        figures: Vec::new(),
        pitfall: lesson.plan.bad.pitfall.clone().unwrap_or_default(),
    })
}

fn run_play(lesson: &Arc<Lesson>, play: &ReferencePlay, seed: u64) -> Result<PlayResult, RunError> {
    let mut result = PlayResult { seed, goals: Vec::new(), pitfalls: Vec::new() };
    for (part, lesson_part) in lesson.plan.parts.iter().enumerate() {
        let part_play = PartPlay {
            lesson,
            part,
            seed: Some(seed),
            scheduled_calls: &play.plays,
            weeks: None,
            is_judged: true,
            needs_database: lesson.needs_database(),
        };
        let session = play_part(&part_play, calls_for_waiting_threads)?;
        let Some(lesson_progress) = session.lesson() else { continue };
        for (step, lesson_step) in lesson_part.steps.iter().enumerate() {
            let judged = lesson_progress.goal_results(step);
            result.goals.extend(lesson_step.goals.iter().enumerate().map(|(at, goal)| {
                let note = judged.get(at);
                GoalResult {
                    text: goal.text.clone(),
                    value: note.and_then(|note| note.value),
                    target: note.and_then(|note| note.bound),
                    is_met: note.is_some_and(|note| note.met == Some(true)),
                }
            }));
        }
        result.pitfalls.extend(lesson_progress.triggered_pitfall_names().into_iter().map(str::to_owned));
    }
    Ok(result)
}

/// Measures the figures of a lesson. Figures that are stated for the same play are measured in the same runs.
fn measure_figures(lesson: &Arc<Lesson>) -> Result<Vec<FigureResult>, RunError> {
    let mut plays: Vec<Vec<&MeasuredFigure>> = Vec::new();
    for figure in &lesson.plan.measured {
        let is_same = |of: &&mut Vec<&MeasuredFigure>| {
            of.first().is_some_and(|first| {
                first.part == figure.part
                    && first.plays == figure.plays
                    && first.scenario == figure.scenario
                    && first.parameters == figure.parameters
            })
        };
        match plays.iter_mut().find(is_same) {
            Some(of) => of.push(figure),
            None => plays.push(vec![figure]),
        }
    }
    let runs: Vec<(usize, u64)> =
        (0..plays.len()).flat_map(|play| MEASURED_SEEDS.map(move |seed| (play, seed))).collect();
    let values_by_run: Result<Vec<Vec<Option<f64>>>, RunError> =
        runs.par_iter().map(|(play, seed)| figure_values(lesson, &plays[*play], *seed)).collect();
    let values_by_run = values_by_run?;
    let mean = |figure: &MeasuredFigure| {
        let play_values = runs.iter().zip(&values_by_run).filter_map(|((play, _), values)| {
            let at =
                plays[*play].iter().position(|measured_figure| std::ptr::eq(*measured_figure, figure))?;
            values[at]
        });
        let values: Vec<f64> = play_values.collect();
        values.iter().sum::<f64>() / values.len() as f64
    };
    Ok(lesson
        .plan
        .measured
        .iter()
        .map(|figure| FigureResult { stated: figure.clone(), mean: mean(figure) })
        .collect())
}

/// Measures figures of one play on one seed.
fn figure_values(
    lesson: &Arc<Lesson>,
    figures: &[&MeasuredFigure],
    seed: u64,
) -> Result<Vec<Option<f64>>, RunError> {
    let Some(first) = figures.first() else { return Ok(Vec::new()) };
    let last = lesson.plan.parts[first.part].weeks();
    let world = lesson.with_figure_parameters(first);
    let play = PartPlay {
        lesson: &world,
        part: first.part,
        seed: Some(seed),
        scheduled_calls: &first.plays,
        weeks: figures.iter().map(|measured_figure| measured_figure.week.unwrap_or(last)).max(),
        is_judged: false,
        needs_database: figures.iter().any(|measured_figure| measured_figure.measurement.needs_database()),
    };
    let mut values = vec![None; figures.len()];
    let mut measure = |session: &mut Session, week: u32| {
        // The state of a bankrupt company does not change.
        let is_final_state = session.ended().is_some();
        for (value, figure) in values.iter_mut().zip(figures) {
            let wanted = figure.week.unwrap_or(last);
            if wanted == week || (is_final_state && wanted > week) {
                let problem =
                    |problem| RunError::InvalidRequest(format!("measured figure {}: {problem}", figure.name));
                *value = measure_over_part(&figure.measurement, session).map_err(problem)?;
            }
        }
        Ok(())
    };
    play_part_with_hooks(&play, calls_for_waiting_threads, &mut |_| {}, &mut measure)?;
    Ok(values)
}
