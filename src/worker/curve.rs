//! The curve of a group: drawn by the session's thread, from what the player may know.

use std::sync::Arc;

use super::{Open, SessionThread};
use crate::message::News;
use novamind_insight::{CurveExplorer, CurveLook};
use novamind_session::Refusal;
use novamind_session::identifiers::Group;

impl SessionThread {
    /// Draws the curve of a group, and says what was found; the number says which question it answers.
    pub(super) fn find_curve(&mut self, number: u64, group: Group) {
        let found = self.curve_of(group);
        // A line that the disk refuses is noticed as after any other work.
        self.with_run(|_| None);
        self.say(News::Curve(number, Box::new(found.map(Arc::new))));
    }

    /// At the moment that is shown. A look at the truth is a line of the run, which is not the one of a replay.
    fn curve_of(&mut self, group: Group) -> Result<CurveExplorer, Refusal> {
        let (is_allowed, day) = match &self.open {
            None => return Err(Refusal::new("not_possible", "no run is open")),
            Some(Open::Played(session)) => (session.may_look_inside(), session.day()),
            Some(Open::Replayed(playback)) => (playback.may_look_inside(), playback.session().day()),
        };
        let look = match is_allowed {
            true => Some(CurveLook::begin(self.session_to_look_into(false)?, group, day)?),
            false => None,
        };
        let session = match &self.open {
            Some(Open::Played(session)) => session,
            Some(Open::Replayed(playback)) => playback.session(),
            None => return Err(Refusal::new("not_possible", "no run is open")),
        };
        look.map_or_else(
            || CurveExplorer::estimated(session, group),
            |look| Ok(CurveExplorer::true_at(session, &look)),
        )
    }
}
