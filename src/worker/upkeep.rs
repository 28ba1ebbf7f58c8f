//! What the session's thread does from time to time: it looks at time limits while the rules have some, and tries to write a
//! database that could not be written until there is room.

use std::time::{Duration, Instant};

use super::{Open, SessionThread};
use crate::message::News;
use novamind_session::TimeLeft;

const BETWEEN_LOOKS: Duration = Duration::from_secs(1);

/// Time between two tries: each may simulate weeks again.
const BETWEEN_TRIES: Duration = Duration::from_secs(3);

impl SessionThread {
    /// Looks at the limits when it is time.
    pub(super) fn look_at_limits(&mut self) {
        let now = Instant::now();
        if self.limits.is_none_or(|due| due > now) {
            return;
        }
        self.limits = Some(now + BETWEEN_LOOKS);
        let Some(Open::Played(session)) = &mut self.open else { return };
        let reached = session.activity().check_limits();
        let left = session.log().time_left();
        let minutes: Vec<i64> = left.iter().map(TimeLeft::whole_minutes).collect();
        if minutes != self.minutes_left {
            self.minutes_left = minutes;
            self.say(News::TimeLeft(left));
        }
        reached.into_iter().for_each(|limit| self.say(News::Limit(limit)));
    }

    /// Notices that the database falls behind, once.
    pub(super) fn look_after_database(&mut self) {
        let Some(Open::Played(session)) = &self.open else { return };
        // Whoever waits for the writer here would keep the person waiting; what it wrote last is known.
        if self.mending.is_none()
            && let Some(problem) = session.database().failure()
        {
            self.mending = Some(Instant::now() + BETWEEN_TRIES);
            self.say(News::DatabaseBehind(problem.0));
        }
    }

    /// Tries to bring the database up to date when it is time.
    pub(super) fn mend(&mut self) {
        if self.mending.is_none_or(|due| due > Instant::now()) {
            return;
        }
        let Some(Open::Played(session)) = &mut self.open else { return };
        if session.mend_database().is_err() {
            self.mending = Some(Instant::now() + BETWEEN_TRIES);
            return;
        }
        self.mending = None;
        let Some(Open::Played(session)) = &self.open else { return };
        self.queries.connect(session);
        self.say(News::DatabaseWhole);
    }
}
