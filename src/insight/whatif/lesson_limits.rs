//! Restrictions of a what-if in an unfinished lesson: no results before the guess, and no calls of unavailable tools.

use std::path::Path;

use super::decision_edit::DecisionEdit;
use crate::counterfactual::past::Past;
use crate::counterfactual::script::Move;
use novamind_record::lesson::{Lesson, LessonPart, LessonStanding};
use novamind_record::trajectory::Trajectory;
use novamind_session::not_readable;
use novamind_tools::{Refusal, ToolId};

/// Returns the student's standing in an unfinished lesson, and whether the lesson of the run changes the capacity automatically.
///
/// # Errors
/// `not_readable`.
pub(super) fn lesson_of(folder: &Path, past: &Past) -> Result<(Option<LessonStanding>, bool), Refusal> {
    let Some(stamp) = past.manifest.lesson.as_ref() else { return Ok((None, false)) };
    let lesson = Lesson::of_run(folder, &stamp.name).map_err(|error| not_readable(&error))?;
    let part = (stamp.part as usize).clamp(1, lesson.plan.parts.len().max(1)) - 1;
    let moves_capacity = lesson.plan.parts.get(part).is_some_and(LessonPart::moves_capacity);
    if past.ended {
        return Ok((None, moves_capacity));
    }
    let trajectory =
        Trajectory::read(&folder.join("trajectory.jsonl")).map_err(|error| not_readable(&error))?;
    Ok((Some(LessonStanding::of(lesson.into(), part, &trajectory.lines)), moves_capacity))
}

/// Rejects edits of decisions that the student could not make.
///
/// # Errors
/// `not_in_this_lesson`.
pub(crate) fn refuse_locked(
    standing: &LessonStanding,
    decided: &[DecisionEdit],
    moves: &[Move],
) -> Result<(), Refusal> {
    decided.iter().filter_map(|edit| tool_of(edit, moves)).try_for_each(|tool| standing.refuse_tool(tool))
}

/// Returns the tool whose calls an edit adds, changes or removes.
fn tool_of(edit: &DecisionEdit, moves: &[Move]) -> Option<ToolId> {
    let called = |seq: u64| {
        moves.iter().find_map(|step| match step {
            Move::Call(call) if call.seq == seq => Some(call.tool),
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
