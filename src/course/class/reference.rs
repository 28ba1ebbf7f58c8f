//! The reference play of a class's lesson, on the seeds of the submitted runs.

use std::collections::BTreeSet;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::evidence::{ClassRun, Evidence, RunVerdict, session_evidence};
use novamind_record::error::RunError;
use novamind_record::lesson::{GoalBound, Lesson, LessonPart};
use novamind_session::{PartPlay, RuleEvaluator, play_part};

/// The result of the reference play for one part of the lesson and one seed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClassReference {
    /// Results of the reference play; its `part` and `seed` identify the reference.
    pub evidence: Evidence,
}

/// Simulates the reference play for every part and seed of the valid runs.
///
/// # Errors
/// Returns an error if a part of the lesson cannot start or a tool call is rejected.
pub(super) fn play_references(
    lesson: &Arc<Lesson>,
    runs: &[ClassRun],
    answers: RuleEvaluator,
) -> Result<Vec<ClassReference>, RunError> {
    let counted =
        runs.iter().filter(|run| matches!(run.verdict, RunVerdict::Finished | RunVerdict::NotFinished));
    let wanted: BTreeSet<(u32, u64)> = counted.map(|run| (run.evidence.part, run.evidence.seed)).collect();
    wanted.into_iter().map(|(part, seed)| play_reference(lesson, part, seed, answers)).collect()
}

fn play_reference(
    lesson: &Arc<Lesson>,
    part: u32,
    seed: u64,
    answers: RuleEvaluator,
) -> Result<ClassReference, RunError> {
    let play = PartPlay {
        lesson,
        part: (part as usize).saturating_sub(1),
        seed: Some(seed),
        scheduled_calls: &lesson.plan.good.plays,
        weeks: None,
        is_judged: true,
        needs_database: lesson.needs_database(),
    };
    let session = play_part(&play, answers)?;
    Ok(ClassReference { evidence: session_evidence(&session, session.lesson(), seed) })
}

/// Returns the step and the goal that decide the ranking of a part, both counted from 0: the last goal of the last step
/// that has goals.
pub fn ranked_goal(part: &LessonPart) -> Option<(usize, usize)> {
    let step = part.steps.iter().rposition(|step| !step.goals.is_empty())?;
    Some((step, part.steps[step].goals.len() - 1))
}

/// Returns a student's value divided by the value of the reference play, so that higher is better. The ratio is
/// inverted if the bound of the goal is a maximum. Returns `None` if the denominator or the reference value is not
/// positive.
pub fn share_of_reference(bound: Option<GoalBound>, value: f64, good: f64) -> Option<f64> {
    let (of, all) = if matches!(bound, Some(GoalBound::AtMost(_))) { (good, value) } else { (value, good) };
    (all > 0.0 && good > 0.0).then(|| of / all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn share_of_reference_follows_the_goal_direction() {
        assert_eq!(share_of_reference(Some(GoalBound::AtLeast(1.0)), 3.0, 4.0), Some(0.75));
        assert_eq!(share_of_reference(Some(GoalBound::AtMost(1.0)), 8.0, 4.0), Some(0.5));
        assert_eq!(share_of_reference(None, -2.0, 4.0), Some(-0.5));
        assert_eq!(share_of_reference(None, 2.0, 0.0), None);
        assert_eq!(share_of_reference(Some(GoalBound::AtMost(1.0)), 0.0, 4.0), None);
    }
}
