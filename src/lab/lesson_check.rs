//! Whether a lesson does what it promises, on six seeds: the good play reaches every goal, the bad one misses one and meets
//! its pitfall, and the figures that its texts name hold.

use std::sync::Arc;

use rayon::prelude::*;

use novamind_course::{Lesson, MEASURED_SEEDS, MeasuredFigure, ReferencePlay, measure_over_part};
use novamind_record::error::RunError;
use novamind_rules::answers_to_companies;
use novamind_session::{PartPlay, Session, play_part, play_part_watched};

/// How far a measured figure may be from the one that a lesson states, as a share of it.
pub const TOLERANCE: f64 = 0.15;

/// What a reference play came to on a seed.
#[derive(Debug, Clone, PartialEq)]
pub struct PlayResult {
    /// Seed.
    pub seed: u64,
    /// Each goal of each part, in order: its text, what was measured, what was to be reached, whether it was.
    pub goals: Vec<GoalResult>,
    /// Names of the pitfalls that were met.
    pub pitfalls: Vec<String>,
}

/// What a goal came to.
#[derive(Debug, Clone, PartialEq)]
pub struct GoalResult {
    /// Its text.
    pub text: String,
    /// What was measured; none where there is none.
    pub value: Option<f64>,
    /// What was to be reached.
    pub bound: Option<f64>,
    /// Whether it was reached.
    pub met: bool,
}

/// A figure that texts name, measured again.
#[derive(Debug, Clone, PartialEq)]
pub struct FigureResult {
    /// The figure as the lesson states it.
    pub stated: MeasuredFigure,
    /// Its mean over the seeds; not a number where it has none.
    pub mean: f64,
}

impl FigureResult {
    /// Whether the stated value holds.
    pub fn holds(&self) -> bool {
        (self.mean - self.stated.value).abs() <= TOLERANCE * self.stated.value.abs()
    }
}

/// What the check of a lesson found.
#[derive(Debug, Clone, PartialEq)]
pub struct LessonCheck {
    /// The good play on each seed.
    pub good: Vec<PlayResult>,
    /// The bad play on each seed.
    pub bad: Vec<PlayResult>,
    /// The figures that texts name.
    pub figures: Vec<FigureResult>,
    /// The pitfall that the bad play is to meet.
    pub pitfall: String,
}

impl LessonCheck {
    /// What does not hold, a line each.
    pub fn problems(&self) -> Vec<String> {
        let missed = self.good.iter().flat_map(|play| {
            let missed = play.goals.iter().filter(|goal| !goal.met);
            missed.map(|goal| format!("seed {}: the good play misses {}", play.seed, goal.text))
        });
        let reached = self.bad.iter().filter(|play| play.goals.iter().all(|goal| goal.met));
        let reached = reached.map(|play| format!("seed {}: the bad play reaches every goal", play.seed));
        let unmet = self.bad.iter().filter(|play| !play.pitfalls.contains(&self.pitfall));
        let unmet = unmet
            .map(|play| format!("seed {}: the bad play does not meet pitfall {}", play.seed, self.pitfall));
        let wrong = self.figures.iter().filter(|figure| !figure.holds()).map(|figure| {
            let FigureResult { stated, mean } = figure;
            format!("{} is stated as {} and is {}", stated.name, stated.written(), stated.write(*mean))
        });
        missed.chain(reached).chain(unmet).chain(wrong).collect()
    }
}

/// Checks a lesson.
///
/// # Errors
/// A part cannot begin, or a play is refused.
pub fn check_lesson(lesson: &Arc<Lesson>) -> Result<LessonCheck, RunError> {
    Ok(LessonCheck {
        figures: measured(lesson)?,
        ..check_plays(lesson, &MEASURED_SEEDS.collect::<Vec<u64>>())?
    })
}

/// Checks the reference plays of a lesson on some seeds, and no measured figure.
///
/// # Errors
/// The same.
pub fn check_plays(lesson: &Arc<Lesson>, seeds: &[u64]) -> Result<LessonCheck, RunError> {
    let plays = |play: &ReferencePlay| -> Result<Vec<PlayResult>, RunError> {
        seeds.par_iter().map(|seed| played(lesson, play, *seed)).collect()
    };
    Ok(LessonCheck {
        good: plays(&lesson.plan.good)?,
        bad: plays(&lesson.plan.bad)?,
        figures: Vec::new(),
        pitfall: lesson.plan.bad.pitfall.clone().unwrap_or_default(),
    })
}

/// All parts of a lesson as a reference play has them, on a seed.
fn played(lesson: &Arc<Lesson>, play: &ReferencePlay, seed: u64) -> Result<PlayResult, RunError> {
    let mut result = PlayResult { seed, goals: Vec::new(), pitfalls: Vec::new() };
    for (part, own) in lesson.plan.parts.iter().enumerate() {
        let of_part = PartPlay {
            lesson,
            part,
            seed: Some(seed),
            plays: &play.plays,
            weeks: None,
            is_judged: true,
            asks_database: lesson.asks_database(),
        };
        let session = play_part(&of_part, answers_to_companies)?;
        let Some(standing) = session.lesson() else { continue };
        for (step, own) in own.steps.iter().enumerate() {
            let judged = standing.goals(step);
            result.goals.extend(own.goals.iter().enumerate().map(|(at, goal)| {
                let note = judged.get(at);
                GoalResult {
                    text: goal.text.clone(),
                    value: note.and_then(|note| note.value),
                    bound: note.and_then(|note| note.bound),
                    met: note.is_some_and(|note| note.met == Some(true)),
                }
            }));
        }
        result.pitfalls.extend(standing.pitfalls().into_iter().map(str::to_owned));
    }
    Ok(result)
}

/// The measured figures of a lesson; those of one play are measured in the same runs.
fn measured(lesson: &Arc<Lesson>) -> Result<Vec<FigureResult>, RunError> {
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
    let of_runs: Result<Vec<Vec<Option<f64>>>, RunError> =
        runs.par_iter().map(|(play, seed)| values_of(lesson, &plays[*play], *seed)).collect();
    let of_runs = of_runs?;
    let mean = |figure: &MeasuredFigure| {
        let of_play = runs.iter().zip(&of_runs).filter_map(|((play, _), values)| {
            let at = plays[*play].iter().position(|own| std::ptr::eq(*own, figure))?;
            values[at]
        });
        let values: Vec<f64> = of_play.collect();
        values.iter().sum::<f64>() / values.len() as f64
    };
    Ok(lesson.plan.measured.iter().map(|own| FigureResult { stated: own.clone(), mean: mean(own) }).collect())
}

/// Figures that are measured in one play, on a seed.
fn values_of(
    lesson: &Arc<Lesson>,
    figures: &[&MeasuredFigure],
    seed: u64,
) -> Result<Vec<Option<f64>>, RunError> {
    let Some(first) = figures.first() else { return Ok(Vec::new()) };
    let last = lesson.plan.parts[first.part].weeks();
    let world = lesson.in_world_of(first);
    let play = PartPlay {
        lesson: &world,
        part: first.part,
        seed: Some(seed),
        plays: &first.plays,
        weeks: figures.iter().map(|own| own.week.unwrap_or(last)).max(),
        is_judged: false,
        asks_database: figures.iter().any(|own| own.measurement.needs_database()),
    };
    let mut values = vec![None; figures.len()];
    let mut measure = |session: &mut Session, week: u32| {
        // A company that is bankrupt stays as it is.
        let stays = session.ended().is_some();
        for (value, own) in values.iter_mut().zip(figures) {
            let wanted = own.week.unwrap_or(last);
            if wanted == week || (stays && wanted > week) {
                let problem =
                    |problem| RunError::NotPossible(format!("measured figure {}: {problem}", own.name));
                *value = measure_over_part(&own.measurement, session).map_err(problem)?;
            }
        }
        Ok(())
    };
    play_part_watched(&play, answers_to_companies, &mut |_| {}, &mut measure)?;
    Ok(values)
}
