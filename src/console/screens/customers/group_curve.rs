//! The participation curve of the open or selected group, as estimated by market studies.

use crate::effect::Effect;
use novamind_insight::CurveExplorer;
use novamind_session::identifiers::Group;
use novamind_tools::Rejection;
use novamind_worker::page_questions::EstimatedCurveQuestion;
use novamind_worker::question::Pending;

/// The curve of a group, and the question that requests a newer curve.
#[derive(Default)]
pub struct GroupCurve {
    pending: Pending<EstimatedCurveQuestion>,
    curve: Option<(Group, Result<CurveExplorer, Rejection>)>,
    is_outdated: bool,
}

impl GroupCurve {
    /// Marks the curve as outdated, because the company has changed. The old curve is shown until the new curve
    /// arrives.
    pub fn set_outdated(&mut self) {
        self.is_outdated = true;
        self.pending.cancel();
    }

    /// Requests the curve of a group, unless it is present and current or already requested.
    pub fn request(&mut self, group: Group) -> Vec<Effect> {
        if !self.is_outdated && self.of_group(group).is_some() {
            // The answer for another group would replace the curve.
            self.pending.cancel();
            return Vec::new();
        }
        if self.is_requested(group) {
            return Vec::new();
        }
        vec![Effect::Ask(self.pending.ask(EstimatedCurveQuestion(group)))]
    }

    /// Stores the answer if it has arrived.
    pub fn take_answer(&mut self) {
        if let Some((EstimatedCurveQuestion(group), found)) = self.pending.try_take() {
            self.curve = Some((group, found));
            self.is_outdated = false;
        }
    }

    /// Returns whether the curve of a group has been requested and has not arrived.
    pub fn is_requested(&self, group: Group) -> bool {
        self.pending.question().is_some_and(|question| question.0 == group)
    }

    /// Returns the curve of a group, or the reason why it is not available. Returns `None` until it arrives.
    pub fn of_group(&self, group: Group) -> Option<&Result<CurveExplorer, Rejection>> {
        self.curve.as_ref().filter(|(shown, _)| *shown == group).map(|(_, curve)| curve)
    }

    #[cfg(test)]
    pub fn set_answer(&mut self, answer: Result<CurveExplorer, Rejection>) {
        self.pending.set_answer(answer);
        self.take_answer();
    }
}
