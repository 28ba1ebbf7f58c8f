//! Whether a lesson does what it promises, on six seeds: the good play reaches every goal, the bad one misses one and meets
//! its pitfall, and the figures that its texts name hold.

use std::sync::Arc;

use rayon::prelude::*;

use crate::rules::answers_to_companies;
use crate::session::{
    Configuration, Lesson, LessonEvent, MeasuredFigure, PartPlay, ReferencePlay, RunError, play_part,
};

/// Seeds of the check.
pub const SEEDS: std::ops::RangeInclusive<u64> = 1..=6;

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
        let unmet =
            unmet.map(|play| format!("seed {}: the bad play does not meet pitfall {}", play.seed, self.pitfall));
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
pub fn check_lesson(lesson: &Arc<Lesson>, configuration: &Configuration) -> Result<LessonCheck, RunError> {
    let plays = |play: &ReferencePlay| -> Result<Vec<PlayResult>, RunError> {
        let seeds: Vec<u64> = SEEDS.collect();
        seeds.into_par_iter().map(|seed| played(lesson, play, seed, configuration)).collect()
    };
    let figures: Result<Vec<FigureResult>, RunError> = lesson
        .plan
        .measured
        .par_iter()
        .map(|stated| Ok(FigureResult { mean: mean_of(lesson, stated, configuration)?, stated: stated.clone() }))
        .collect();
    Ok(LessonCheck {
        good: plays(&lesson.plan.good)?,
        bad: plays(&lesson.plan.bad)?,
        figures: figures?,
        pitfall: lesson.plan.bad.pitfall.clone().unwrap_or_default(),
    })
}

/// All parts of a lesson as a reference play has them, on a seed.
fn played(
    lesson: &Arc<Lesson>,
    play: &ReferencePlay,
    seed: u64,
    configuration: &Configuration,
) -> Result<PlayResult, RunError> {
    let mut result = PlayResult { seed, goals: Vec::new(), pitfalls: Vec::new() };
    for (part, own) in lesson.plan.parts.iter().enumerate() {
        let of_part =
            PartPlay { lesson, part, seed: Some(seed), plays: &play.plays, weeks: None, is_judged: true };
        let session = play_part(&of_part, configuration, &answers_to_companies)?;
        let Some(standing) = session.lesson() else { continue };
        for (step, own) in own.steps.iter().enumerate() {
            let judged = standing.goals(step);
            result.goals.extend(own.goals.iter().enumerate().map(|(at, goal)| {
                let note = judged.get(at).filter(|note| note.event == LessonEvent::Goal);
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

/// Mean of a measured figure over the seeds.
fn mean_of(
    lesson: &Arc<Lesson>,
    stated: &MeasuredFigure,
    configuration: &Configuration,
) -> Result<f64, RunError> {
    let (mut sum, mut count) = (0.0, 0_u32);
    for seed in SEEDS {
        let play = PartPlay {
            lesson,
            part: stated.part,
            seed: Some(seed),
            plays: &stated.plays,
            weeks: stated.week,
            is_judged: false,
        };
        let mut session = play_part(&play, configuration, &answers_to_companies)?;
        let problem = |problem| RunError::NotPossible(format!("measured figure {}: {problem}", stated.name));
        if let Some(value) = stated.measurement.over_part(&mut session).map_err(problem)? {
            (sum, count) = (sum + value, count + 1);
        }
    }
    Ok(sum / f64::from(count))
}
