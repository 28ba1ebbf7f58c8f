//! The session's thread with a database that could not be written: it says so, and tries again until there is room.

use std::time::{Duration, Instant};

use super::{Open, SessionThread};
use crate::message::News;

/// Time between two tries: each may simulate weeks again.
const BETWEEN_TRIES: Duration = Duration::from_secs(3);

impl SessionThread {
    /// Notices that the database falls behind, once.
    pub(super) fn look_after_database(&mut self) {
        let Some(Open::Played(session)) = &self.open else { return };
        // Whoever waits for the writer here would keep the person waiting; what it wrote last is known.
        if self.mending.is_none()
            && let Some(problem) = session.database_failure()
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
