//! Restrictions of a what-if in an unfinished lesson: no results before the guess and no calls to unavailable tools.

use std::path::Path;

use super::decision_edit::DecisionEdit;
use crate::counterfactual::recorded_run::RecordedRun;
use crate::counterfactual::recorded_steps::RecordedStep;
use novamind_record::lesson::{Lesson, LessonPart, LessonProgress};
use novamind_record::trajectory::Trajectory;
use novamind_session::unreadable_record_rejection;
use novamind_tools::{Rejection, ToolId};

/// Returns the student's progress in an unfinished lesson, and whether the lesson changes the capacity automatically.
///
/// # Errors
/// `not_readable`.
pub(super) fn lesson_state(
    folder: &Path,
    past: &RecordedRun,
) -> Result<(Option<LessonProgress>, bool), Rejection> {
    let Some(stamp) = past.manifest.lesson.as_ref() else { return Ok((None, false)) };
    let lesson =
        Lesson::from_run(folder, &stamp.name).map_err(|error| unreadable_record_rejection(&error))?;
    let part = (stamp.part as usize).clamp(1, lesson.plan.parts.len().max(1)) - 1;
    let changes_capacity = lesson.plan.parts.get(part).is_some_and(LessonPart::has_automatic_capacity);
    if past.is_ended {
        return Ok((None, changes_capacity));
    }
    let trajectory = Trajectory::read(&folder.join("trajectory.jsonl"))
        .map_err(|error| unreadable_record_rejection(&error))?;
    Ok((Some(LessonProgress::from_lines(lesson.into(), part, &trajectory.lines)), changes_capacity))
}

/// Rejects edits with tools that the lesson has not unlocked.
///
/// # Errors
/// `not_in_this_lesson`.
pub(crate) fn check_tools_unlocked(
    standing: &LessonProgress,
    decided: &[DecisionEdit],
    moves: &[RecordedStep],
) -> Result<(), Rejection> {
    decided.iter().filter_map(|edit| edited_tool(edit, moves)).try_for_each(|tool| standing.check_tool(tool))
}

/// Returns the tool whose calls an edit adds, changes or removes.
fn edited_tool(edit: &DecisionEdit, moves: &[RecordedStep]) -> Option<ToolId> {
    let called = |seq: u64| {
        moves.iter().find_map(|step| match step {
            RecordedStep::Call(call) if call.seq == seq => Some(call.tool),
            _ => None,
        })
    };
    match edit {
        DecisionEdit::Scale { tool, .. } | DecisionEdit::Keep(tool) | DecisionEdit::Add { tool, .. } => {
            Some(*tool)
        }
        DecisionEdit::Drop(seq) | DecisionEdit::Change { seq, .. } => called(*seq),
        DecisionEdit::CapacityFollowsUsage => Some(ToolId::SetCapacityTier),
        DecisionEdit::Set { .. } => None,
    }
}
