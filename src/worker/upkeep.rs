//! Periodic tasks of the session thread: checking time limits, and repairing a database that could not be written.

use std::time::{Duration, Instant};

use super::{Open, SessionThread};
use crate::message::News;
use novamind_session::TimeLeft;

const BETWEEN_LOOKS: Duration = Duration::from_secs(1);

/// Time between two attempts: each may simulate weeks again.
const BETWEEN_TRIES: Duration = Duration::from_secs(3);

impl SessionThread {
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

    /// Reports once that the database has fallen behind.
    pub(super) fn look_after_database(&mut self) {
        let Some(Open::Played(session)) = &self.open else { return };
        // Does not wait for the writer, which would delay the user: the last known failure is enough.
        if self.mending.is_none()
            && let Some(problem) = session.database().failure()
        {
            self.mending = Some(Instant::now() + BETWEEN_TRIES);
            self.say(News::DatabaseBehind(problem.0));
        }
    }

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
